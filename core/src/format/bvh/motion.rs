//! A whole file: the OFFSETs are the rest pose, the frames are its one motion.

use std::path::Path;

use super::lexer::Lexer;
use super::{frames, hierarchy};
use crate::Error;
use crate::error::BvhError;
use crate::format::motion::raw::{self, RawMotion};
use crate::format::motion::{Found, ReadOptions, clip_name};
use crate::math::RigidTransform;
use crate::skeleton::Skeleton;
use crate::text;

/// Reads the text of a file; the clip is named after the file.
pub(super) fn read(bytes: &[u8], path: &Path, options: &ReadOptions) -> crate::Result<RawMotion> {
    let text = text::decode(bytes);
    let text = text.map_err(|fault| Error::file(path, BvhError { line: 1, fault }))?;
    let mut lexer = Lexer::new(&text);
    let mut joints = hierarchy::read(&mut lexer).map_err(|error| Error::file(path, error))?;
    let mut warnings = Vec::new();
    raw::make_unique(&mut joints.names, &mut warnings);
    let rest: Vec<RigidTransform> = joints
        .offsets
        .iter()
        .map(|&translation| RigidTransform { rotation: crate::math::Rotation::IDENTITY, translation })
        .collect();
    let asked = options.frames_per_second;
    let frames = frames::read(&mut lexer, &joints, &rest, asked).map_err(|error| Error::file(path, error))?;
    warnings.extend(frames.warning);
    let take = frames.recorder.take(clip_name(path), frames.rate, &rest);
    let skeleton = Skeleton::new(joints.names, joints.parents, rest, joints.ends);
    Ok(RawMotion {
        format: "BVH",
        skeleton: skeleton.map_err(|error| Error::file(path, Box::new(error)))?,
        takes: vec![take],
        unit: None,
        up: None,
        rest_is_upright: false,
        rate_found: if asked.is_some() { Found::Asked } else { Found::File },
        warnings,
    })
}
