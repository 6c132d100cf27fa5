//! Clips made of several: mixed, faded from one to the next, or added on top.

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

/// A clip between two, at the rate and of the length of the first: `a` at weight 0, `b` at 1. When `b` is shorter its
/// last frame is held; make both equally long and in step first, with [`resample`](super::resample), when they walk.
///
/// # Errors
/// [`Error::Invalid`] when the clips are of different skeletons, [`Error::Request`] when the weight is not in 0..=1.
pub fn blend(a: &Clip, b: &Clip, weight: f32, mask: Option<&JointMask>) -> Result<Clip> {
    same_skeleton(a, b)?;
    in_unit("weight", weight)?;
    let mask = mask.cloned().unwrap_or_else(|| JointMask::all(a.skeleton()));
    over(a, |seconds, pose, scratch| {
        Sampler::new(b, Wrap::Once).sample_into(seconds, scratch);
        blend_pose(pose, scratch, weight, &mask);
    })
}

/// A clip of any number of clips, mixed by [`blend_poses`] frame by frame, at the rate and of the length of the first. The
/// last frame of a shorter one is held. Unlike [`blend`], which goes from one clip to another, no layer comes before another.
///
/// # Errors
/// [`Error::Request`] when there is no layer or a weight is negative or not finite, [`Error::Invalid`] when the clips are of
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
    over(first, |seconds, pose, _| {
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

/// One clip after the other, with `seconds` in which the end of `a` turns into the beginning of `b`. The second clip is
/// moved along the floor so that it goes on where the first arrives.
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
    let meeting = Sampler::new(a, Wrap::Once).sample(start);
    let moves: Vec<(u32, glam::Vec3)> = b
        .top_tracks()
        .map(|t| (t.joint, (meeting.locals[t.joint as usize].translation - t.values[0]).with_y(0.0)))
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

/// A clip with a layer on it: what `layer` differs from `reference` by is added to `base`, at the rate and of the
/// length of `base`; a shorter layer starts anew.
///
/// # Errors
/// [`Error::Invalid`] when the clips are of different skeletons or the reference has another number of joints,
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
    over(base, |seconds, pose, scratch| {
        Sampler::new(layer, Wrap::Loop).sample_into(seconds, scratch);
        add_pose(pose, scratch, reference, weight, &mask);
    })
}

/// The frames of a clip, each changed with a scratch pose beside it.
fn over(clip: &Clip, mut change: impl FnMut(f64, &mut Pose, &mut Pose)) -> Result<Clip> {
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
