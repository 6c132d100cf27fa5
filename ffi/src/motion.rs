//! Motions: files as they were read, retargeted to bodies.

use std::ffi::c_char;
use std::path::Path;
use std::sync::Arc;

use anthronet::clip::{Clip, MAX_FRAMES, MAX_ROTATIONS};
use anthronet::format::{self, Motion, ReadOptions};
use anthronet::math::RigidTransform;
use anthronet::retarget::feet::FeetOptions;
use anthronet::retarget::{self, FingerMode, Overrides, RetargetOptions, RootMotion, TransferOptions};
use anthronet::skeleton::{MAX_JOINTS, Skeleton};
use anthronet::space::{Axis, Space};

use crate::body::anthronet_body;
use crate::bytes::{anthronet_bytes, json};
use crate::clip::anthronet_clip;
use crate::options::{Descriptor, choice, described, flag, given, space};
use crate::pointer::{Out, anthronet_text, at, at_most, file, free, read, slice, text};
use crate::skeleton::anthronet_transform;
use crate::status::{ANTHRONET_ERROR_INDEX, Fault, Outcome, anthronet_error, anthronet_status, guard};

/// Fingers of the motion where it has any, else relaxed.
pub const ANTHRONET_FINGERS_SOURCE: u32 = 0;
/// Relaxed hands.
pub const ANTHRONET_FINGERS_RELAXED: u32 = 1;
/// Fingers as in the bind pose.
pub const ANTHRONET_FINGERS_REST: u32 = 2;

/// As the file says, or else found from the proportions of its skeleton.
pub const ANTHRONET_UP_FOUND: u32 = 0;
/// +Y points up in the file.
pub const ANTHRONET_UP_Y: u32 = 1;
/// +Z points up in the file.
pub const ANTHRONET_UP_Z: u32 = 2;
/// +X points up in the file.
pub const ANTHRONET_UP_X: u32 = 3;
/// +X points down in the file.
pub const ANTHRONET_UP_NEGATIVE_X: u32 = 4;
/// +Y points down in the file, as in the axes of cameras.
pub const ANTHRONET_UP_NEGATIVE_Y: u32 = 5;
/// +Z points down in the file.
pub const ANTHRONET_UP_NEGATIVE_Z: u32 = 6;

/// What the constants above stand for, in their order.
const UPS: [Option<Axis>; 7] = [
    None,
    Some(Axis::Y),
    Some(Axis::Z),
    Some(Axis::X),
    Some(Axis::NegativeX),
    Some(Axis::NegativeY),
    Some(Axis::NegativeZ),
];

/// How a motion file is read; these values override those in the file. Zeros leave everything to the file.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_motion_options {
    /// Set by the caller: `sizeof(anthronet_motion_options)`.
    pub struct_size: u32,
    /// `ANTHRONET_UP_…`.
    pub up: u32,
    /// Metres per unit of length, such as 0.01.
    pub metres_per_unit: f64,
    /// Frames per second: frames were recorded at this rate, curves are sampled at it.
    pub frames_per_second: f64,
    /// Which of several people in an `.npz`, from 1; 0 reads the first, with a warning.
    pub person: u32,
}

// SAFETY: numbers alone, the size first.
unsafe impl Descriptor for anthronet_motion_options {}

/// How a motion is retargeted to a body; all zeros are the defaults.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_retarget_options {
    /// Set by the caller: `sizeof(anthronet_retarget_options)`.
    pub struct_size: u32,
    /// `ANTHRONET_FINGERS_…`.
    pub fingers: u32,
    /// 1 does not keep joints within the limits of human joints.
    pub no_limits: u32,
    /// 1 does not keep feet that touch the floor from sliding and sinking in.
    pub no_feet: u32,
    /// 1 removes root motion.
    pub in_place: u32,
    /// 1 blends the end into the beginning, so that the clip loops.
    pub looped: u32,
    /// 1 puts root motion on the joint `Root` instead of the pelvis.
    pub root_motion: u32,
    /// Bytes of `mapping_json`.
    pub mapping_length: u32,
    /// Which joint of the motion drives which joint of the rig, or none, as JSON: `{"LeftArm": "upperarm_l", "Tail": null}`;
    /// joints that it does not name are matched automatically. NULL matches all of them.
    pub mapping_json: *const c_char,
    /// Frames per second of the result; 0 keeps those of the motion.
    pub frames_per_second: f64,
    /// 1 accepts a motion that seems to be no person's, or in which nobody stands.
    pub force: u32,
}

// SAFETY: numbers and a pointer that may be NULL, the size first.
unsafe impl Descriptor for anthronet_retarget_options {}

/// A motion file as it was read: at least one clip of the file's own skeleton. Immutable.
pub struct anthronet_motion(Motion);

fn options(pointer: *const anthronet_motion_options) -> Outcome<ReadOptions> {
    let asked = described(pointer, "options")?;
    let options = ReadOptions {
        unit: None,
        up: choice(&UPS, asked.up, "up")?,
        person: asked.person.checked_sub(1).map(|person| person as usize),
        frames_per_second: given(asked.frames_per_second),
    };
    match given(asked.metres_per_unit) {
        None => Ok(options),
        Some(metres) => Ok(options.with_metres_per_unit(metres)?),
    }
}

fn give(out: Out<*mut anthronet_motion>, motion: Motion) {
    motion.report.warnings.iter().for_each(|warning| crate::log::warning(warning));
    out.give(anthronet_motion(motion));
}

/// Reads a motion file: .bvh, .fbx, .glb, .gltf, .vrm, .vrma, .npz (AMASS, SMPL-X), .usd, .usda, .usdc, .usdz.
/// `read_options` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_motion_open_path(
    path: *const c_char,
    path_length: u64,
    read_options: *const anthronet_motion_options,
    out_motion: *mut *mut anthronet_motion,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_motion, "out_motion")?;
        let path = Path::new(text(path, path_length, "path")?);
        give(out, format::read_motion(path, &options(read_options)?)?);
        Ok(())
    })
}

/// Reads a motion file from memory. `name` is the file's: its extension says the format, and a clip without a name gets
/// it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_motion_open_memory(
    data: *const u8,
    length: u64,
    name: *const c_char,
    name_length: u64,
    read_options: *const anthronet_motion_options,
    out_motion: *mut *mut anthronet_motion,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_motion, "out_motion")?;
        let bytes = file(data, length, "data")?;
        let name = Path::new(text(name, name_length, "name")?);
        give(out, format::read_motion_from_bytes(bytes, name, &options(read_options)?)?);
        Ok(())
    })
}

/// A motion of a skeleton of another program, such as an action of an armature. Arrays are read only during the call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_motion_source {
    /// Set by the caller: `sizeof(anthronet_motion_source)`.
    pub struct_size: u32,
    /// `ANTHRONET_SPACE_…` of the transforms; lengths are metres.
    pub space: u32,
    /// Number of joints.
    pub joint_count: u32,
    /// Number of frames.
    pub frame_count: u32,
    /// Frames per second.
    pub frames_per_second: f64,
    /// Name of the clip.
    pub name: anthronet_text,
    /// Name of each joint; none twice.
    pub joint_names: *const anthronet_text,
    /// Place of each joint's parent, before the joint's own; −1 for none.
    pub parents: *const i32,
    /// Where each joint rests, relative to its parent.
    pub rest: *const anthronet_transform,
    /// Frame by frame, each joint relative to its parent: frames × joints.
    pub frames: *const anthronet_transform,
}

// SAFETY: numbers, pointers that may be NULL and a text of NULL, the size first.
unsafe impl Descriptor for anthronet_motion_source {}

/// Makes a motion from poses, to be retargeted like one that was read from a file.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_motion_from_poses(
    source: *const anthronet_motion_source,
    out_motion: *mut *mut anthronet_motion,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_motion, "out_motion")?;
        read(source, "source")?;
        let source = described(source, "source")?;
        let (joints, frames) = (u64::from(source.joint_count), u64::from(source.frame_count));
        at_most("joint_count", "joints", MAX_JOINTS as u64, joints)?;
        at_most("frame_count", "frames", MAX_FRAMES as u64, frames)?;
        at_most("frames", "frames x joints", MAX_ROTATIONS as u64, frames * joints)?;
        let space = space(source.space)?;
        let names = slice(source.joint_names, joints, "joint_names")?
            .iter()
            .map(|name| Ok(text(name.data, name.length, "joint_names")?.to_owned()));
        let parents = slice(source.parents, joints, "parents")?.iter().map(|p| match p {
            -1 => Ok(None),
            0.. => Ok(Some(*p as u32)),
            _ => Err(Fault::new(ANTHRONET_ERROR_INDEX, format!("parents: expected -1 or more, got {p}"))),
        });
        let parents = parents.collect::<Outcome<Vec<_>>>()?;
        let rest = locals(slice(source.rest, joints, "rest")?, &parents, space);
        let rest = Skeleton::new(
            names.collect::<Outcome<_>>()?,
            parents,
            rest,
            vec![None; source.joint_count as usize],
        )?;
        let poses = slice(source.frames, frames * joints, "frames")?;
        let poses = locals(poses, rest.parents(), space);
        let name = text(source.name.data, source.name.length, "name")?.to_owned();
        let clip = Clip::from_poses(name, Arc::new(rest), source.frames_per_second, &poses)?;
        give(out, Motion::of_clip(clip));
        Ok(())
    })
}

/// Joints relative to their parents, frame by frame, in a space, as the library's own.
pub(crate) fn locals(
    transforms: &[anthronet_transform],
    parents: &[Option<u32>],
    space: Space,
) -> Vec<RigidTransform> {
    let joints = transforms.iter().zip(parents.iter().cycle());
    joints
        .map(|(joint, parent)| RigidTransform::from(joint).parent_from_joint_out_of(space, *parent))
        .collect()
}

/// Frees a motion; NULL is nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_motion_free(motion: *mut anthronet_motion) {
    free(motion);
}

/// Number of clips: at least one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_motion_clip_count(
    motion: *const anthronet_motion,
    out_count: *mut u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        Out::new(out_count, "out_count")?.write(read(motion, "motion")?.0.clips.len() as u32);
        Ok(())
    })
}

/// The name of a clip; valid as long as the motion.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_motion_clip_name(
    motion: *const anthronet_motion,
    clip: u32,
    out_name: *mut anthronet_text,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_name, "out_name")?;
        let clip = at(&read(motion, "motion")?.0.clips, clip, "clip")?;
        out.write(anthronet_text::of(clip.name()));
        Ok(())
    })
}

/// How the file was read, as JSON: format, unit, up axis, frame rate, how each was found, warnings.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_motion_report(
    motion: *const anthronet_motion,
    out_json: *mut *mut anthronet_bytes,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_json, "out_json")?;
        out.give(json(&read(motion, "motion")?.0.report)?);
        Ok(())
    })
}

/// Retargets one clip of a motion to a body. `retarget_options` may be NULL, and so may `out_report`; it receives JSON:
/// which joint drives which, which joints drive none, how sure it is that the motion is a person's (`confidence`: `value` from 0
/// to 1 and `doubts`, which are also logged as a warning), errors of directions, limits and feet. Below a confidence of
/// 0.5 the motion is refused, unless joints are mapped or `force` is set.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_motion_retarget(
    motion: *const anthronet_motion,
    clip: u32,
    body: *const anthronet_body,
    retarget_options: *const anthronet_retarget_options,
    out_clip: *mut *mut anthronet_clip,
    out_report: *mut *mut anthronet_bytes,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_clip, "out_clip")?;
        let out_report = Out::optional(out_report, "out_report")?;
        let motion = &read(motion, "motion")?.0;
        let body = read(body, "body")?;
        let options = options_of(&described(retarget_options, "options")?)?;
        let (clip, report) =
            retarget::retarget_clip(at(&motion.clips, clip, "clip")?, body.body.skeleton(), &options)?;
        report.check(&options)?;
        let report_json = json(&report)?;
        if let Some(warning) = report.confidence.warning() {
            crate::log::warning(&warning);
        }
        for note in report.notes() {
            crate::log::info(&note);
        }
        out.give(anthronet_clip(clip));
        if let Some(out) = out_report {
            out.give(report_json);
        }
        Ok(())
    })
}

fn options_of(asked: &anthronet_retarget_options) -> Outcome<RetargetOptions> {
    const FINGERS: [FingerMode; 3] = [FingerMode::Source, FingerMode::Relaxed, FingerMode::Rest];
    const ROOTS: [RootMotion; 2] = [RootMotion::Pelvis, RootMotion::Root];
    let transfer = TransferOptions {
        fingers: choice(&FINGERS, asked.fingers, "fingers")?,
        root: choice(&ROOTS, asked.root_motion, "root_motion")?,
        ..TransferOptions::default()
    };
    let mapping = match text(asked.mapping_json, asked.mapping_length.into(), "mapping_json")? {
        "" => Overrides::new(),
        json => retarget::read_overrides(json, Path::new("mapping_json"))?,
    };
    Ok(RetargetOptions {
        mapping,
        transfer,
        limits: !flag(asked.no_limits, "no_limits")?,
        feet: (!flag(asked.no_feet, "no_feet")?).then(FeetOptions::default),
        in_place: flag(asked.in_place, "in_place")?,
        looped: flag(asked.looped, "looped")?,
        force: flag(asked.force, "force")?,
        frames_per_second: given(asked.frames_per_second),
    })
}
