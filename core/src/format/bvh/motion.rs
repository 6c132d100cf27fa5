//! A whole file: the joints rest at their offsets, the frames are the one motion.

use std::path::Path;

use super::Result;
use super::lexer::Lexer;
use super::{frames, hierarchy};
use crate::Error;
use crate::format::motion::raw::{self, RawMotion};
use crate::format::motion::{Found, ReadOptions, clip_name};
use crate::math::RigidTransform;

/// Reads the text of a file; the clip is named after it.
pub(super) fn read(bytes: &[u8], path: &Path, options: &ReadOptions) -> crate::Result<RawMotion> {
    motion(bytes, &clip_name(path), options).map_err(|error| Error::file(path, error))
}

fn motion(bytes: &[u8], name: &str, options: &ReadOptions) -> Result<RawMotion> {
    let mut lexer = Lexer::new(bytes);
    let mut skeleton = hierarchy::read(&mut lexer)?;
    let mut warnings = Vec::new();
    raw::make_unique(&mut skeleton.names, &mut warnings);
    let rest: Vec<RigidTransform> = skeleton
        .offsets
        .iter()
        .map(|&translation| RigidTransform { rotation: glam::Quat::IDENTITY, translation })
        .collect();
    let mut take = frames::read(&mut lexer, &skeleton, &rest, name)?;
    let mut rate_found = Found::File;
    if let Some(rate) = options.frames_per_second {
        (take.frames_per_second, rate_found) = (rate, Found::Asked);
    }
    Ok(RawMotion {
        format: "BVH",
        names: skeleton.names,
        parents: skeleton.parents,
        rest,
        ends: skeleton.ends,
        takes: vec![take],
        unit: None,
        up: None,
        rest_is_upright: false,
        rate_found,
        warnings,
    })
}
