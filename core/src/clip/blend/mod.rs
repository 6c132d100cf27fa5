//! Combining clips: blends, crossfades and additive layers.

mod mask;
mod pose;

use std::sync::Arc;

use super::Clip;
use super::edit::clip_of_poses;
use super::sample::{Sampler, Wrap};
use crate::math::smoothstep;
use crate::skeleton::Pose;
use crate::{Error, Result};
pub use mask::JointMask;
pub use pose::{Layer, add_pose, blend_pose, blend_poses};

/// Interpolates two clips, `a` at weight 0, `b` at 1, at the rate and of the length of `a`. If `b` is shorter its last frame
/// is held. Walks should have the same length and phase.
///
/// # Errors
/// [`Error::Invalid`] when the clips have different skeletons, [`Error::Request`] when the weight is not in 0..=1.
pub fn blend(a: &Clip, b: &Clip, weight: f32, mask: Option<&JointMask>) -> Result<Clip> {
    same_skeleton(a, b)?;
    in_unit("weight", weight)?;
    let mask = mask.cloned().unwrap_or_else(|| JointMask::all(a.skeleton()));
    map_frames(a, |seconds, pose, scratch| {
        Sampler::new(b, Wrap::Once).sample_into(seconds, scratch);
        blend_pose(pose, scratch, weight, &mask);
    })
}

/// Blends any number of clips frame by frame with [`blend_poses`], at the rate and of the length of the first. The last frame
/// of a shorter one is held. Unlike in [`blend`], the weights are relative and the order of the layers does not matter.
///
/// # Errors
/// [`Error::Request`] when there is no layer or a weight is negative or not finite, [`Error::Invalid`] when the clips have
/// different skeletons.
pub fn blend_layers(layers: &[Layer<'_, Clip>]) -> Result<Clip> {
    let Some(first) = layers.first().map(|layer| layer.of) else {
        return Err(Error::request("layers", "expected at least one, got none"));
    };
    for (i, layer) in layers.iter().enumerate() {
        same_skeleton(first, layer.of)?;
        if !(layer.weight.is_finite() && layer.weight >= 0.0) {
            let message = format!("layer {i}: expected a finite number from 0, got {}", layer.weight);
            return Err(Error::request("weight", message));
        }
    }
    let mut sampled = vec![Pose::default(); layers.len()];
    map_frames(first, |seconds, pose, _| {
        for (layer, sampled) in layers.iter().zip(&mut sampled) {
            Sampler::new(layer.of, Wrap::Once).sample_into(seconds, sampled);
        }
        let poses = layers.iter().zip(&sampled).map(|(layer, of)| Layer {
            of,
            weight: layer.weight,
            mask: layer.mask,
        });
        blend_poses(&poses.collect::<Vec<_>>(), first.skeleton().rest_pose(), pose);
    })
}

/// Plays `b` after `a`, blending the last `seconds` of `a` into the beginning of `b`, at the rate of `a`. `b` is moved along
/// the floor to where `a` is when the blend begins.
///
/// # Errors
/// As [`blend`], and [`Error::Request`] when the fade is negative or longer than one of the clips.
pub fn crossfade(a: &Clip, b: &Clip, seconds: f64) -> Result<Clip> {
    same_skeleton(a, b)?;
    let longest = a.duration().min(b.duration());
    if !(0.0..=longest).contains(&seconds) {
        return Err(Error::request("crossfade", format!("expected 0 to {longest} s, got {seconds}")));
    }
    let start = a.duration() - seconds;
    let rate = a.frames_per_second();
    let frames = libm::floor((start + b.duration()) * rate + 1e-6) as usize + 1;
    let pose_at_start = Sampler::new(a, Wrap::Once).sample(start);
    let moves: Vec<(u32, glam::Vec3)> = b
        .top_tracks()
        .map(|t| (t.joint, (pose_at_start.locals[t.joint as usize].translation - t.values[0]).with_y(0.0)))
        .collect();
    let mut mixed = Pose::default();
    let mask = JointMask::all(a.skeleton());
    let poses = (0..frames).map(|frame| {
        let at = frame as f64 / rate;
        let mut pose = Sampler::new(a, Wrap::Once).sample(at);
        if at > start {
            Sampler::new(b, Wrap::Once).sample_into(at - start, &mut mixed);
            for (joint, by) in &moves {
                mixed.locals[*joint as usize].translation += *by;
            }
            let share = if seconds > 0.0 { ((at - start) / seconds).min(1.0) as f32 } else { 1.0 };
            blend_pose(&mut pose, &mixed, smoothstep(share), &mask);
        }
        pose
    });
    clip_of_poses(a.name(), a.skeleton(), rate, poses)
}

/// Adds the difference between `layer` and the pose `reference` to `base`, at the rate and of the length of `base`; a shorter
/// layer repeats.
///
/// # Errors
/// [`Error::Invalid`] when the clips have different skeletons or the reference has another number of joints,
/// [`Error::Request`] when the weight is not in 0..=1.
pub fn additive(
    base: &Clip,
    layer: &Clip,
    reference: &Pose,
    weight: f32,
    mask: Option<&JointMask>,
) -> Result<Clip> {
    same_skeleton(base, layer)?;
    in_unit("weight", weight)?;
    if reference.locals.len() != base.skeleton().len() {
        let got = reference.locals.len();
        return Err(Error::invalid(
            "reference pose",
            format!("expected {} joints, got {got}", base.skeleton().len()),
        ));
    }
    let mask = mask.cloned().unwrap_or_else(|| JointMask::all(base.skeleton()));
    map_frames(base, |seconds, pose, scratch| {
        Sampler::new(layer, Wrap::Loop).sample_into(seconds, scratch);
        add_pose(pose, scratch, reference, weight, &mask);
    })
}

/// Changes every frame of a clip; `change` gets the time in seconds, the pose, and a scratch pose to reuse.
fn map_frames(clip: &Clip, mut change: impl FnMut(f64, &mut Pose, &mut Pose)) -> Result<Clip> {
    let mut scratch = Pose::default();
    let poses = (0..clip.frame_count()).map(|frame| {
        let mut pose = clip.pose(frame);
        change(frame as f64 / clip.frames_per_second(), &mut pose, &mut scratch);
        pose
    });
    clip_of_poses(clip.name(), clip.skeleton(), clip.frames_per_second(), poses)
}

fn same_skeleton(a: &Clip, b: &Clip) -> Result<()> {
    if Arc::ptr_eq(a.skeleton(), b.skeleton()) || a.skeleton() == b.skeleton() {
        return Ok(());
    }
    let message = format!("`{}` and `{}` are clips of different skeletons", a.name(), b.name());
    Err(Error::invalid("clip", message))
}

fn in_unit(field: &str, value: f32) -> Result<()> {
    if (0.0..=1.0).contains(&value) {
        return Ok(());
    }
    Err(Error::request(field, format!("expected 0 to 1, got {value}")))
}

#[cfg(test)]
mod tests;
