//! Clips made of two clips: mixed, or one layered on the other.

use std::sync::Arc;

use super::Clip;
use super::edit::clip_of_poses;
use super::sample::{Sampler, Wrap, mix};
use crate::math::{RigidTransform, Rotation, smoothstep};
use crate::skeleton::{Pose, Skeleton};
use crate::{Error, Result};

/// How much each joint takes part: 0 not at all, 1 fully.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMask {
    weights: Vec<f32>,
}

impl JointMask {
    /// Every joint.
    pub fn all(rest: &Skeleton) -> Self {
        Self { weights: vec![1.0; rest.len()] }
    }

    /// A share of each joint.
    ///
    /// # Errors
    /// [`Error::Invalid`] when there is not one per joint, or one is not in 0..=1.
    pub fn of_weights(rest: &Skeleton, weights: &[f32]) -> Result<Self> {
        if weights.len() != rest.len() {
            let message = format!("expected {} joints, got {}", rest.len(), weights.len());
            return Err(Error::invalid("joint mask", message));
        }
        if let Some(joint) = weights.iter().position(|weight| !(0.0..=1.0).contains(weight)) {
            let (name, weight) = (&rest.names()[joint], weights[joint]);
            return Err(Error::invalid("joint mask", format!("`{name}`: expected 0 to 1, got {weight}")));
        }
        Ok(Self { weights: weights.to_vec() })
    }

    /// The joints below and including those named: `spine_01` is the upper body, `pelvis` everything that moves.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming a joint that is missing.
    pub fn below(rest: &Skeleton, names: &[&str]) -> Result<Self> {
        let mut weights = vec![0.0; rest.len()];
        for name in names {
            weights[rest.require(name)?] = 1.0;
        }
        for (joint, parent) in rest.parents().iter().enumerate() {
            if parent.is_some_and(|p| weights[p as usize] > 0.0) {
                weights[joint] = 1.0;
            }
        }
        Ok(Self { weights })
    }

    /// The share of a joint; 0 for one that does not exist.
    pub fn weight(&self, joint: usize) -> f32 {
        self.weights.get(joint).copied().unwrap_or(0.0)
    }
}

/// Mixes poses of the same skeleton in place: `a` becomes `a` at weight 0 and `b` at 1.
pub fn blend_pose(a: &mut Pose, b: &Pose, weight: f32, mask: &JointMask) {
    for (joint, (a, b)) in a.locals.iter_mut().zip(&b.locals).enumerate() {
        *a = mix(*a, *b, weight * mask.weight(joint));
    }
}

/// Adds to a pose, in place, what `layer` differs from `reference` by: rotations in joint space, translations in the
/// parent's.
pub fn add_pose(base: &mut Pose, layer: &Pose, reference: &Pose, weight: f32, mask: &JointMask) {
    for (joint, (base, (layer, reference))) in
        base.locals.iter_mut().zip(layer.locals.iter().zip(&reference.locals)).enumerate()
    {
        let weight = weight * mask.weight(joint);
        let by = reference.rotation.conjugate() * layer.rotation;
        let by = if by.w < 0.0 { -by } else { by };
        *base = RigidTransform {
            rotation: (base.rotation * Rotation::IDENTITY.slerp(by, weight)).normalize(),
            translation: base.translation + (layer.translation - reference.translation) * weight,
        };
    }
}

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
mod tests {
    use super::*;
    use crate::testing::clips::swing;

    #[test]
    fn half_a_blend_is_half_way() {
        let (a, b) = (swing("a", 0.0, 11), swing("b", 1.0, 11));
        let half = blend(&a, &b, 0.5, None).unwrap();
        for frame in 0..11 {
            let wanted = a.rotations(frame)[1].slerp(b.rotations(frame)[1], 0.5);
            assert!(half.rotations(frame)[1].dot(wanted) > 1.0 - 1e-6);
        }
        assert_eq!(blend(&a, &b, 0.0, None).unwrap().rotations(4), a.rotations(4));
        assert!(blend(&a, &b, 1.5, None).unwrap_err().to_string().contains("got 1.5"));
    }

    #[test]
    fn a_mask_keeps_what_it_does_not_cover() {
        let (a, b) = (swing("a", 0.0, 11), swing("b", 1.0, 11));
        let mask = JointMask::below(a.skeleton(), &["child"]).unwrap();
        let mixed = blend(&a, &b, 1.0, Some(&mask)).unwrap();
        assert_eq!(mixed.rotations(10)[0], a.rotations(10)[0]);
        assert_eq!(mixed.rotations(10)[1], b.rotations(10)[1]);
        let half = JointMask::of_weights(a.skeleton(), &[0.0, 0.5]).unwrap();
        let mixed = blend(&a, &b, 1.0, Some(&half)).unwrap();
        let wanted = a.rotations(10)[1].slerp(b.rotations(10)[1], 0.5);
        assert!(
            mixed.rotations(10)[1].dot(wanted) > 1.0 - 1e-6 && mixed.rotations(10)[0] == a.rotations(10)[0]
        );
        for (weights, said) in
            [(&[1.0][..], "expected 2 joints, got 1"), (&[0.0, 1.5], "`child`"), (&[f32::NAN, 0.0], "NaN")]
        {
            assert!(JointMask::of_weights(a.skeleton(), weights).unwrap_err().to_string().contains(said));
        }
        assert!(JointMask::below(a.skeleton(), &["tail"]).unwrap_err().to_string().contains("`tail`"));
    }

    #[test]
    fn what_is_added_is_the_difference_to_the_reference() {
        let (a, b) = (swing("a", 0.3, 11), swing("b", 1.0, 11));
        let same = additive(&a, &b, &b.pose(0), 0.0, None).unwrap();
        assert!(same.rotations(9)[1].dot(a.rotations(9)[1]) > 1.0 - 1e-6);
        let sum = additive(&a, &b, &b.pose(0), 1.0, None).unwrap();
        let difference = b.rotations(0)[1].conjugate() * b.rotations(9)[1];
        assert!(sum.rotations(9)[1].dot(a.rotations(9)[1] * difference).abs() > 1.0 - 1e-5);
        assert!(additive(&a, &b, &Pose::default(), 1.0, None).unwrap_err().to_string().contains("got 0"));
    }

    #[test]
    fn a_crossfade_starts_as_the_first_and_goes_on_where_it_was() {
        let (a, b) = (swing("a", 0.2, 31), swing("b", 1.0, 31));
        let both = crossfade(&a, &b, 0.4).unwrap();
        assert_eq!(both.frame_count(), 49);
        assert_eq!(both.pose(0), a.pose(0));
        assert!(both.rotations(48)[1].dot(b.rotations(30)[1]) > 1.0 - 1e-6);
        let steps = (1..49)
            .map(|f| both.pose(f).locals[0].translation.distance(both.pose(f - 1).locals[0].translation));
        assert!(steps.fold(0.0, f32::max) < 0.12, "it does not jump");
        assert!(crossfade(&a, &b, 5.0).is_err());
    }
}
