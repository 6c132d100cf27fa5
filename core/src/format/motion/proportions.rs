//! The size and stance of an unknown skeleton, from which [`units_and_axes`](super::units_and_axes) infers unit and up axis.

use glam::Vec3;

use super::raw::{RawMotion, Take};
use crate::math::RigidTransform;
use crate::skeleton::model_from_joints;
use crate::space::Axis;

/// Path length from fingertip to toe along the bones, divided by stature: 1.25 for skeletons that end at wrists and ankles,
/// 1.5 for those with fingers and toes.
const SPAN_PER_STATURE: f64 = 1.4;
/// Ratio of two extents from which the longer one decides the up axis.
const CLEAR: f32 = 1.5;
/// Minimum number of joints of a person.
const FIGURE: usize = 10;
/// Maximum number of frames to sample.
const SAMPLES: usize = 24;

/// Extents and lowest point of the body, averaged over a set of poses.
#[derive(Clone, Copy, Debug, Default)]
struct Stance {
    extents: Vec3,
    lowest: Vec3,
}

impl Stance {
    /// The axis along which the body is clearly upright.
    fn upright(self) -> Option<Axis> {
        let [_, y, z] = self.extents.to_array();
        if y > CLEAR * z { Some(Axis::Y) } else { (z > CLEAR * y).then_some(Axis::Z) }
    }

    /// Whether the lowest joints are near zero, as on a floor.
    fn on_floor(self, axis: Axis) -> bool {
        let up = axis.direction();
        self.lowest.dot(up).abs() < 0.2 * self.extents.dot(up)
    }
}

/// The body among a file's joints: those connected by bones of fixed length. A root on the floor from which the hips move
/// away is not part of it.
pub(super) struct Proportions {
    lengths: Vec<f32>,
    member: Vec<bool>,
}

impl Proportions {
    pub(super) fn of(raw: &RawMotion) -> Self {
        let mut steps: Vec<Vec3> = rest_of(raw).iter().map(|l| l.translation).collect();
        let longest = steps.iter().map(|s| s.length()).fold(0.0, f32::max);
        let mut loose = vec![false; raw.skeleton.len()];
        for track in raw.takes.iter().flat_map(|take| &take.tracks) {
            let (joint, count) = (track.joint as usize, track.values.len().max(1));
            let mean = track.values.iter().sum::<Vec3>() / count as f32;
            let spread = track.values.iter().map(|v| v.distance(mean)).fold(0.0, f32::max);
            // Bones may stretch a little.
            loose[joint] |= spread > 0.25 * mean.length() + 0.05 * longest;
            steps[joint] = mean;
        }
        let mut lengths: Vec<f32> = steps.iter().map(|s| s.length()).collect();
        let mut top = Vec::with_capacity(loose.len());
        let mut sizes = vec![0usize; loose.len()];
        for (joint, parent) in raw.skeleton.parents().iter().enumerate() {
            let above = parent.filter(|_| !loose[joint]).and_then(|p| top.get(p as usize).copied());
            top.push(above.unwrap_or(joint));
            sizes[top[joint]] += 1;
            if above.is_none() {
                lengths[joint] = 0.0;
            }
        }
        let largest = (0..sizes.len()).rev().max_by_key(|&joint| sizes[joint]);
        Self { lengths, member: top.iter().map(|&t| Some(t) == largest).collect() }
    }

    /// Whether there are enough joints for a person: a door must not be scaled to human size.
    pub(super) fn is_figure(&self) -> bool {
        self.member.iter().filter(|m| **m).count() >= FIGURE
    }

    /// The body's stature in the file's unit, from the longest path along its bones, which is independent of the pose; 0
    /// without bones.
    pub(super) fn stature(&self, raw: &RawMotion) -> f64 {
        let count = self.lengths.len();
        // The longest path downwards from each joint; children come after their parents.
        let (mut down, mut span) = (vec![0.0f64; count], 0.0f64);
        for joint in (0..count).rev().filter(|&j| self.member[j]) {
            let end = raw.skeleton.ends()[joint].map_or(0.0, |end| f64::from(end.length()));
            span = span.max(down[joint] + end);
            down[joint] = down[joint].max(end);
            if let Some(parent) =
                raw.skeleton.parents()[joint].map(|p| p as usize).filter(|&p| self.member[p])
            {
                let way = down[joint] + f64::from(self.lengths[joint]);
                span = span.max(down[parent] + way);
                down[parent] = down[parent].max(way);
            }
        }
        span / SPAN_PER_STATURE
    }

    /// The axis along which the body is clearly upright, from its rest pose and its motion. These may disagree, when a person
    /// lies down or a root rotates the file's axes. Overruling the file takes agreement of both, or feet on a floor.
    pub(super) fn upright(&self, raw: &RawMotion) -> Option<Axis> {
        let rest = (!raw.rest_is_upright).then(|| self.stance(raw, std::iter::once(rest_of(raw).to_vec())));
        let rest = rest.and_then(Stance::upright);
        let stance = self.stance(raw, raw.takes.iter().flat_map(|take| poses(raw, take)));
        match (rest, stance.upright()) {
            (_, Some(moved)) if rest == Some(moved) || stance.on_floor(moved) => Some(moved),
            (Some(rest), Some(_)) => Some(rest),
            (rest, moved) if raw.up.is_none() => rest.or(moved),
            _ => None,
        }
    }

    fn stance(&self, raw: &RawMotion, poses: impl Iterator<Item = Vec<RigidTransform>>) -> Stance {
        let (mut sum, mut count, mut world) = (Stance::default(), 0.0f32, Vec::new());
        for pose in poses {
            model_from_joints(raw.skeleton.parents(), &pose, &mut world);
            let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            for joint in (0..world.len()).filter(|&j| self.member[j]) {
                let RigidTransform { rotation, translation } = world[joint];
                let end = translation + rotation * raw.skeleton.ends()[joint].unwrap_or(Vec3::ZERO);
                low = low.min(translation).min(end);
                high = high.max(translation).max(end);
            }
            sum.extents += high - low;
            sum.lowest += low;
            count += 1.0;
        }
        Stance { extents: sum.extents / count.max(1.0), lowest: sum.lowest / count.max(1.0) }
    }
}

/// Local rest transform of each joint.
pub(super) fn rest_of(raw: &RawMotion) -> &[RigidTransform] {
    &raw.skeleton.rest_pose().locals
}

/// Evenly spaced poses of a take.
pub(super) fn poses<'a>(
    raw: &'a RawMotion,
    take: &'a Take,
) -> impl Iterator<Item = Vec<RigidTransform>> + 'a {
    let frames = take.rotations.len() / raw.skeleton.len();
    let samples = frames.min((SAMPLES / raw.takes.len().max(1)).max(1));
    (0..samples).map(move |i| {
        let frame = i * frames / samples;
        let mut pose = rest_of(raw).to_vec();
        for (local, rotation) in pose.iter_mut().zip(&take.rotations[frame * raw.skeleton.len()..]) {
            local.rotation = *rotation;
        }
        for track in &take.tracks {
            if let (Some(local), Some(v)) = (pose.get_mut(track.joint as usize), track.values.get(frame)) {
                local.translation = *v;
            }
        }
        pose
    })
}
