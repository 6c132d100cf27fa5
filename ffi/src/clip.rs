//! Clips of a body's skeleton: built in or retargeted; sampled, edited, blended.

use std::ffi::c_char;

use anthronet::clip;
use anthronet::clip::{BUILTIN, Clip, JointMask, MAX_FRAMES, MAX_ROTATIONS, Sampler, Wrap};
use anthronet::math::RigidTransform;
use anthronet::skeleton::Pose;
use anthronet::space::Space;

use crate::body::anthronet_body;
use crate::context::anthronet_context;
use crate::options::{Descriptor, DescriptorOut, choice, space};
use crate::pointer::{Out, OutSlice, anthronet_text, at, at_most, exactly, finite, free, read, slice, text};
use crate::skeleton::anthronet_transform;
use crate::status::{Fault, Outcome, anthronet_error, anthronet_status, guard};

/// The clip holds its first or last frame outside its duration.
pub const ANTHRONET_WRAP_ONCE: u32 = 0;
/// The clip starts over; its last frame is its first.
pub const ANTHRONET_WRAP_LOOP: u32 = 1;
/// As `ANTHRONET_WRAP_LOOP` with root motion: every cycle continues where the last one ended.
pub const ANTHRONET_WRAP_ROOT_MOTION: u32 = 2;

/// Each joint relative to its parent: what animation tracks hold.
pub const ANTHRONET_RELATIVE_TO_PARENT: u32 = 0;
/// Each joint relative to the model: what skinning takes.
pub const ANTHRONET_RELATIVE_TO_MODEL: u32 = 1;

/// A motion of a body's joints, frame by frame. Immutable.
pub struct anthronet_clip(pub(crate) Clip);

/// A clip in numbers.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_clip_info {
    /// Set by the caller: `sizeof(anthronet_clip_info)`.
    pub struct_size: u32,
    /// Number of frames.
    pub frame_count: u32,
    /// Number of joints.
    pub joint_count: u32,
    /// 0; fills the structure up.
    pub reserved: u32,
    /// Frames per second.
    pub frames_per_second: f64,
    /// From the first frame to the last, seconds.
    pub duration: f64,
    /// Its name; valid as long as the clip.
    pub name: anthronet_text,
}

// SAFETY: numbers and a text of NULL, the size first.
unsafe impl Descriptor for anthronet_clip_info {}

fn make(
    out_clip: *mut *mut anthronet_clip,
    error: *mut anthronet_error,
    make: impl FnOnce() -> Outcome<Clip>,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_clip, "out_clip")?;
        out.give(anthronet_clip(make()?));
        Ok(())
    })
}

/// Number of built-in clips.
#[unsafe(no_mangle)]
pub extern "C" fn anthronet_clip_builtin_count() -> u32 {
    BUILTIN.len() as u32
}

/// The name of a built-in clip, such as `walk`; always valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_builtin_name(
    index: u32,
    out_name: *mut anthronet_text,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_name, "out_name")?;
        out.write(anthronet_text::of(at(&BUILTIN, index, "index")?));
        Ok(())
    })
}

/// Makes a built-in clip for a body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_builtin(
    name: *const c_char,
    name_length: u64,
    body: *const anthronet_body,
    out_clip: *mut *mut anthronet_clip,
    error: *mut anthronet_error,
) -> anthronet_status {
    make(out_clip, error, || {
        Ok(clip::builtin(text(name, name_length, "name")?, read(body, "body")?.body.skeleton())?)
    })
}

/// Makes a clip from poses of a body, such as an action of its armature: `frames` holds, frame by frame, every joint
/// relative to its parent in `in_space`; `count` = frames × joints.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_from_poses(
    body: *const anthronet_body,
    name: *const c_char,
    name_length: u64,
    frames_per_second: f64,
    in_space: u32,
    frames: *const anthronet_transform,
    count: u64,
    out_clip: *mut *mut anthronet_clip,
    error: *mut anthronet_error,
) -> anthronet_status {
    make(out_clip, error, || {
        let name = text(name, name_length, "name")?.to_owned();
        let rest = read(body, "body")?.body.skeleton();
        let joints = rest.len() as u64;
        at_most("count", "transforms", (MAX_FRAMES as u64 * joints).min(MAX_ROTATIONS as u64), count)?;
        if !count.is_multiple_of(joints) {
            return Err(Fault::size("count", format_args!("expected frames x {joints} joints, got {count}")));
        }
        let poses = crate::motion::locals(slice(frames, count, "frames")?, rest.parents(), space(in_space)?);
        Ok(Clip::from_poses(name, rest.clone(), frames_per_second, &poses)?)
    })
}

/// Frees a clip; NULL is nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_free(clip: *mut anthronet_clip) {
    free(clip);
}

/// Describes a clip.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_describe(
    clip: *const anthronet_clip,
    out_info: *mut anthronet_clip_info,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = DescriptorOut::new(out_info, "out_info")?;
        let clip = &read(clip, "clip")?.0;
        out.write(&anthronet_clip_info {
            struct_size: 0,
            frame_count: clip.frame_count() as u32,
            joint_count: clip.skeleton().len() as u32,
            reserved: 0,
            frames_per_second: clip.frames_per_second(),
            duration: clip.duration(),
            name: anthronet_text::of(clip.name()),
        });
        Ok(())
    })
}

/// The pose of a clip at a time, from −1e9 to 1e9 seconds: fills `count` joints. `wrap` is `ANTHRONET_WRAP_…`, `relative`
/// `ANTHRONET_RELATIVE_TO_…`; `context` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_sample(
    clip: *const anthronet_clip,
    context: *mut anthronet_context,
    seconds: f64,
    wrap: u32,
    relative: u32,
    in_space: u32,
    out_joints: *mut anthronet_transform,
    count: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let wrap = choice(&[Wrap::Once, Wrap::Loop, Wrap::RootMotion], wrap, "wrap")?;
        let (to_model, space) = (to_model(relative)?, space(in_space)?);
        time(seconds)?;
        let clip = &read(clip, "clip")?.0;
        exactly("count", clip.skeleton().len(), count.into())?;
        let mut out = OutSlice::new(out_joints, count.into(), "out_joints")?;
        let mut own = anthronet_context::default();
        let anthronet_context { pose, model, .. } = anthronet_context::of(context, &mut own)?;
        Sampler::new(clip, wrap).sample_into(seconds, pose);
        write(clip, &pose.locals, model, to_model, space, &mut out);
        Ok(())
    })
}

/// All frames of a clip in order: fills `count` = frames × joints transforms.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_bake(
    clip: *const anthronet_clip,
    relative: u32,
    in_space: u32,
    out_joints: *mut anthronet_transform,
    count: u64,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let (to_model, space) = (to_model(relative)?, space(in_space)?);
        let clip = &read(clip, "clip")?.0;
        exactly("count", clip.frame_count() * clip.skeleton().len(), count)?;
        let mut out = OutSlice::new(out_joints, count, "out_joints")?;
        let (mut pose, mut model) = (Pose::default(), Vec::new());
        for frame in 0..clip.frame_count() {
            clip.pose_into(frame, &mut pose);
            write(clip, &pose.locals, &mut model, to_model, space, &mut out);
        }
        Ok(())
    })
}

/// The clip at another rate, frames per second.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_resample(
    clip: *const anthronet_clip,
    frames_per_second: f64,
    out_clip: *mut *mut anthronet_clip,
    error: *mut anthronet_error,
) -> anthronet_status {
    make(out_clip, error, || Ok(clip::resample(&read(clip, "clip")?.0, frames_per_second)?))
}

/// The clip without root motion.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_in_place(
    clip: *const anthronet_clip,
    out_clip: *mut *mut anthronet_clip,
    error: *mut anthronet_error,
) -> anthronet_status {
    make(out_clip, error, || Ok(clip::in_place(&read(clip, "clip")?.0)?))
}

/// The clip with its end blended into its beginning during the last `seconds`, so that it loops.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_looped(
    clip: *const anthronet_clip,
    seconds: f64,
    out_clip: *mut *mut anthronet_clip,
    error: *mut anthronet_error,
) -> anthronet_status {
    make(out_clip, error, || Ok(clip::looped(&read(clip, "clip")?.0, seconds)?))
}

/// Blends two clips of one body: `weight` 0 is the first, 1 the second.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_blend(
    first: *const anthronet_clip,
    second: *const anthronet_clip,
    weight: f32,
    out_clip: *mut *mut anthronet_clip,
    error: *mut anthronet_error,
) -> anthronet_status {
    make(out_clip, error, || {
        finite("weight", weight.into())?;
        Ok(clip::blend(&read(first, "first")?.0, &read(second, "second")?.0, weight, None)?)
    })
}

/// As `anthronet_clip_blend` with a weight per joint: `mask` has `count` numbers, one per joint, from 0 (the first clip) to
/// 1 (blended fully), such as `anthronet_clip_joint_mask` makes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_blend_masked(
    first: *const anthronet_clip,
    second: *const anthronet_clip,
    weight: f32,
    mask: *const f32,
    count: u32,
    out_clip: *mut *mut anthronet_clip,
    error: *mut anthronet_error,
) -> anthronet_status {
    make(out_clip, error, || {
        finite("weight", weight.into())?;
        let (first, second) = (&read(first, "first")?.0, &read(second, "second")?.0);
        let mask = joint_mask(first, mask, count)?;
        Ok(clip::blend(first, second, weight, Some(&mask))?)
    })
}

/// Adds a clip to another of the same body: the difference between `layer` and the pose `reference` times `weight`, 0 to 1,
/// is added to `base`. A layer shorter than the base starts over. `reference` has `count` joints,
/// each relative to its parent in `in_space`; NULL and 0 stand for the layer's first frame. `mask` is that of
/// `anthronet_clip_blend_masked`; NULL and 0 stand for every joint.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_additive(
    base: *const anthronet_clip,
    layer: *const anthronet_clip,
    weight: f32,
    reference: *const anthronet_transform,
    count: u32,
    in_space: u32,
    mask: *const f32,
    mask_count: u32,
    out_clip: *mut *mut anthronet_clip,
    error: *mut anthronet_error,
) -> anthronet_status {
    make(out_clip, error, || {
        finite("weight", weight.into())?;
        let space = space(in_space)?;
        let (base, layer) = (&read(base, "base")?.0, &read(layer, "layer")?.0);
        let reference = match reference.is_null() && count == 0 {
            true => layer.pose(0),
            false => {
                let rest = base.skeleton();
                exactly("count", rest.len(), count.into())?;
                let joints = slice(reference, count.into(), "reference")?;
                Pose { locals: crate::motion::locals(joints, rest.parents(), space) }
            }
        };
        let mask = match mask.is_null() && mask_count == 0 {
            true => None,
            false => Some(joint_mask(base, mask, mask_count)?),
        };
        Ok(clip::additive(base, layer, &reference, weight, mask.as_ref())?)
    })
}

/// The mask of a part of the body: fills `count` entries, one per joint of the clip, with 1 for the joint of that name
/// in the rig and all below it, else with 0. `spine_01` is the upper body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_joint_mask(
    clip: *const anthronet_clip,
    name: *const c_char,
    name_length: u64,
    out_mask: *mut f32,
    count: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let rest = read(clip, "clip")?.0.skeleton();
        exactly("count", rest.len(), count.into())?;
        let mut out = OutSlice::new(out_mask, count.into(), "out_mask")?;
        let mask = JointMask::below(rest, &[text(name, name_length, "name")?])?;
        out.write((0..rest.len()).map(|joint| mask.weight(joint)));
        Ok(())
    })
}

/// A mask of the caller's for the joints of a clip.
fn joint_mask(clip: &Clip, mask: *const f32, count: u32) -> Outcome<JointMask> {
    exactly("mask", clip.skeleton().len(), count.into())?;
    Ok(JointMask::of_weights(clip.skeleton(), slice(mask, count.into(), "mask")?)?)
}

/// Plays two clips of one body one after the other, blended over the `seconds` by which they overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_clip_crossfade(
    first: *const anthronet_clip,
    second: *const anthronet_clip,
    seconds: f64,
    out_clip: *mut *mut anthronet_clip,
    error: *mut anthronet_error,
) -> anthronet_status {
    make(out_clip, error, || {
        Ok(clip::crossfade(&read(first, "first")?.0, &read(second, "second")?.0, seconds)?)
    })
}

/// Whether the caller wants transforms relative to the model.
fn to_model(relative: u32) -> Outcome<bool> {
    choice(&[false, true], relative, "relative")
}

/// A walk that goes on for longer than this leaves what a float holds.
fn time(seconds: f64) -> Outcome {
    const LONGEST: f64 = 1e9;
    if seconds.abs() <= LONGEST {
        return Ok(());
    }
    let message = format_args!("expected a number from -{LONGEST} to {LONGEST}, got {seconds}");
    Err(Fault::request("seconds", message))
}

/// Writes a pose for the caller; `model` is room for its joints relative to the model.
fn write(
    clip: &Clip,
    locals: &[RigidTransform],
    model: &mut Vec<RigidTransform>,
    to_model: bool,
    space: Space,
    out: &mut OutSlice<anthronet_transform>,
) {
    let parents = clip.skeleton().parents();
    if to_model {
        anthronet::skeleton::model_from_joints(parents, locals, model);
        out.write(model.iter().map(|joint| joint.model_from_joint_in(space).into()));
    } else {
        let joints = locals.iter().zip(parents);
        out.write(joints.map(|(joint, parent)| joint.parent_from_joint_in(space, *parent).into()));
    }
}
