//! Converts the arrays of an archive to a motion of the body model with that number of joints.

use std::fmt::Display;
use std::path::Path;

use glam::{DVec3, Vec3};

use super::array::Archive;
use super::smpl::{self, BodyModel};
use crate::Error;
use crate::clip::MAX_FRAMES;
use crate::error::{Fault, Located, NpzError};
use crate::format::motion::raw::{RawMotion, Recorder};
use crate::format::motion::{Found, ReadOptions, check_start, clip_name};
use crate::format::npz::Result;
use crate::math::Rotation;
use crate::space::{Axis, Unit};

/// Reads an archive; the clip is named after the file.
pub(super) fn read(bytes: &[u8], path: &Path, options: &ReadOptions) -> crate::Result<RawMotion> {
    motion(bytes, &clip_name(path), options).map_err(|error| Error::file(path, error))
}

fn motion(bytes: &[u8], name: &str, options: &ReadOptions) -> Result<RawMotion> {
    check_start(bytes, &[b"PK\x03\x04", b"PK\x05\x06"], "a zip archive")?;
    let mut archive = Archive::open(bytes)?;
    let poses = read_poses(&mut archive)?;
    let Some(BodyModel { name: model, skeleton }) = smpl::body_model(poses.width / 3)? else {
        let expected = "66, 72, 156 or 165 numbers a frame (SMPL, SMPL-H, SMPL-X)";
        return wrong("poses", expected, poses.width);
    };
    let Some((key, trans)) = archive.first(&["trans", "transl", "smpl_trans"])? else {
        return Err(archive.missing("trans"));
    };
    if trans.shape.len() != 2 || trans.width() != 3 || trans.rows() != poses.frames {
        return wrong(
            key,
            format_args!("a shape of ({}, 3)", poses.frames),
            format_args!("{:?}", trans.shape),
        );
    }
    let mut rate_found = Found::File;
    let rate = match options.frames_per_second {
        Some(rate) => {
            rate_found = Found::Asked;
            rate
        }
        None => match archive.first(&["mocap_framerate", "mocap_frame_rate", "fps"])? {
            Some((key, rate)) => match rate.values.as_slice() {
                [rate] if (0.1..=1000.0).contains(rate) => *rate,
                other => {
                    let got = other.iter().take(3).collect::<Vec<_>>();
                    return wrong(key, "one number of 0.1 to 1000", format_args!("{got:?}"));
                }
            },
            None => return Err(archive.missing("mocap_framerate")),
        },
    };

    let mut recorder = Recorder::new(skeleton.len());
    let rest = &skeleton.rest_pose().locals;
    let mut pose = rest.clone();
    for (turns, at) in poses.values.chunks_exact(poses.width).zip(trans.values.chunks_exact(3)) {
        for (local, turn) in pose.iter_mut().zip(turns.chunks_exact(3)) {
            local.rotation = rotation(DVec3::from_slice(turn));
        }
        pose[0].translation = DVec3::from_slice(at).as_vec3();
        recorder.push(&pose);
    }
    let take = recorder.take(name.to_owned(), rate, rest);
    Ok(RawMotion {
        format: model,
        skeleton,
        takes: vec![take],
        unit: Some(Unit::Metre),
        up: Some(Axis::Z),
        rest_is_upright: true,
        rate_found,
        warnings: vec![
            "the file has no skeleton: lengths of bones are assumed, those of a person of 1.70 m".to_owned(),
            format!(
                "`{key}` is taken for the place of the pelvis: the {model} body model adds a constant of its own, by which the \
                 whole clip is shifted"
            ),
        ],
    })
}

/// The error for an array with unexpected content.
fn wrong<T>(array: &str, expected: impl Display, found: impl Display) -> Result<T> {
    Err(NpzError::from(Fault::unexpected(expected, found)).within(array.to_owned()))
}

/// The rotation of an axis-angle vector, whose length is the angle; `NaN` where it is not finite.
fn rotation(turn: DVec3) -> Rotation {
    let angle = turn.length();
    let (sin, cos) = libm::sincos(angle / 2.0);
    // sin(a/2) / a, which tends to one half at 0.
    let scale = if angle < 1e-9 { 0.5 } else { sin / angle };
    let axis: Vec3 = (turn * scale).as_vec3();
    Rotation::from_xyzw(axis.x, axis.y, axis.z, cos as f32)
}

/// Frames × width values, three per joint.
struct Poses {
    frames: usize,
    width: usize,
    values: Vec<f64>,
}

/// Reads one array of all joints, or one array per part in joint order, of which those after the body are optional.
fn read_poses(archive: &mut Archive) -> Result<Poses> {
    if let Some((key, poses)) = archive.first(&["poses", "smpl_poses", "fullpose"])? {
        let (frames, width) = (poses.rows(), poses.width());
        check_frames(key, &poses.shape, frames)?;
        return Ok(Poses { frames, width, values: poses.values });
    }
    let Some((key, root)) = archive.first(&["root_orient", "global_orient"])? else {
        return Err(archive.missing("poses, or root_orient and pose_body"));
    };
    let frames = root.rows();
    check_frames(key, &root.shape, frames)?;
    let Some(body) = archive.first(&["pose_body", "body_pose"])? else {
        return Err(archive.missing("pose_body"));
    };
    let mut parts = vec![(key, root), body];
    let one_of: [(&[&'static str], &[&'static str]); 3] = [
        (&["pose_jaw", "jaw_pose"], &[]),
        (&["pose_eye"], &["leye_pose", "reye_pose"]),
        (&["pose_hand"], &["left_hand_pose", "right_hand_pose"]),
    ];
    for (whole, halves) in one_of {
        if let Some(part) = archive.first(whole)? {
            parts.push(part);
            continue;
        }
        for half in halves {
            parts.extend(archive.first(&[half])?);
        }
    }
    for (key, part) in &parts {
        if part.rows() != frames {
            return wrong(key, format_args!("{frames} frames"), format_args!("a shape of {:?}", part.shape));
        }
    }
    let width = parts.iter().map(|(_, part)| part.width()).sum();
    let mut values = Vec::with_capacity(parts.iter().map(|(_, part)| part.values.len()).sum());
    for frame in 0..frames {
        for (_, part) in &parts {
            let width = part.width();
            values.extend_from_slice(&part.values[frame * width..(frame + 1) * width]);
        }
    }
    Ok(Poses { frames, width, values })
}

fn check_frames(key: &str, shape: &[u64], frames: usize) -> Result<()> {
    if shape.len() < 2 || frames == 0 || frames > MAX_FRAMES {
        let expected = format!("1 to {MAX_FRAMES} frames by joints");
        return wrong(key, expected, format_args!("a shape of {shape:?}"));
    }
    Ok(())
}
