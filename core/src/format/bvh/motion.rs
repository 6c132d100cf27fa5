//! A whole file: the OFFSETs are the rest pose, the frames are its one motion.

use std::path::Path;

use super::lexer::Lexer;
use super::{frames, hierarchy};
use crate::Error;
use crate::format::motion::raw::{self, RawMotion};
use crate::format::motion::{Found, ReadOptions, clip_name};
use crate::math::RigidTransform;
use crate::skeleton::Skeleton;

/// Reads the text of a file; the clip is named after the file.
pub(super) fn read(bytes: &[u8], path: &Path, options: &ReadOptions) -> crate::Result<RawMotion> {
    let mut lexer = Lexer::new(bytes);
    let mut joints = hierarchy::read(&mut lexer).map_err(|error| Error::file(path, error))?;
    let mut warnings = Vec::new();
    raw::make_unique(&mut joints.names, &mut warnings);
    let rest: Vec<RigidTransform> = joints
        .offsets
        .iter()
        .map(|&translation| RigidTransform { rotation: crate::math::Rotation::IDENTITY, translation })
        .collect();
    let take = frames::read(&mut lexer, &joints, &rest, &clip_name(path));
    let mut take = take.map_err(|error| Error::file(path, error))?;
    let mut rate_found = Found::File;
    if let Some(rate) = options.frames_per_second {
        (take.frames_per_second, rate_found) = (rate, Found::Asked);
    }
    let skeleton = Skeleton::new(joints.names, joints.parents, rest, joints.ends);
    Ok(RawMotion {
        format: "BVH",
        skeleton: skeleton.map_err(|error| Error::file(path, Box::new(error)))?,
        takes: vec![take],
        unit: None,
        up: None,
        rest_is_upright: false,
        rate_found,
        warnings,
    })
}
