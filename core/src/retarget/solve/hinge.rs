//! Elbows and knees: where their bones point is the source's, which way they fold is anatomy.
//!
//! Skeletons disagree about how an upper arm is rolled when it hangs straight, and many let the forearm roll at the
//! elbow. Transferred as it stands, such a roll folds our elbow sideways. So the upper bone's roll is chosen such that
//! the lower bone folds about the hinge: by the mean disagreement of a clip, weighted by how far the limb is bent, and
//! what remains of it in a frame as far as the limb is bent there. The lower bone then only swings; the roll that it
//! had goes on to hand or foot.

use glam::{Vec2, Vec3};

use super::bones::Bone;
use super::twist::wrapped;
use super::{Joints, Reference};
use crate::Side;
use crate::math::{RigidTransform, Rotation, smoothstep};
use crate::skeleton::SidedJoint;

/// Bends at which a frame's own plane begins to count and counts fully, radians (15° and 40°).
const BENT: [f32; 2] = [0.26, 0.70];
/// A fold this far from the hinge is no fold of this limb but one beyond straight, radians (100° and 140°).
const REVERSED: [f32; 2] = [1.75, 2.44];

/// An arm or a leg.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limb {
    pub(super) upper: Bone,
    pub(super) lower: Bone,
    /// Where the upper bone points, in its joint's space.
    along: Vec3,
    /// Where the lower bone points at rest, in its joint's space.
    lower_along: Vec3,
    /// The side to which the lower bone folds, in the upper joint's space: ±Z.
    flexion: f32,
    /// `upper_from_lower` at rest.
    rest: Rotation,
}

impl Limb {
    /// The target's limb, where source and target have its bones.
    pub(super) fn of(
        reference: &Reference,
        [upper, lower]: [SidedJoint; 2],
        side: Side,
        flexion: f32,
    ) -> Option<Self> {
        let joints: &Joints = reference.joints;
        let bone = |joint: SidedJoint| Bone::of(joint.on(side), reference.map, joints.source, joints.target);
        let (upper, lower) = (bone(upper)?, bone(lower)?);
        let along = |bone: &Bone| {
            let rotation = joints.target_rest[bone.target].rotation.conjugate();
            (rotation * bone.of_target(&joints.target_rest)).try_normalize()
        };
        let of = |joint: usize| joints.target_rest[joint].rotation;
        let rest = of(upper.target).conjugate() * of(lower.target);
        Some(Self { upper, lower, along: along(&upper)?, lower_along: along(&lower)?, flexion, rest })
    }

    /// Points both bones where the source's point: `model` are the target's rotations in model space.
    pub(super) fn aim(&self, source: &[RigidTransform], model: &mut [Rotation]) {
        for (bone, along) in [(&self.upper, self.along), (&self.lower, self.lower_along)] {
            let rotation = &mut model[bone.target];
            *rotation = towards(*rotation, along, bone.of_source(source));
        }
    }

    /// How far the fold is from the hinge, about the upper bone, and how far the limb is bent.
    ///
    /// The hinge is the lower joint's X axis. With both in the upper joint's space, this is the turn about Y after which
    /// the lower bone is at a right angle to the hinge, on the side to which it folds.
    pub(super) fn fold(&self, model: &[Rotation]) -> (f32, f32) {
        let lower = model[self.upper.target].conjugate() * (model[self.lower.target] * self.lower_along);
        let hinge = self.rest * Vec3::X;
        let [across, of_hinge] = [lower, hinge].map(|v| Vec2::new(v.x, v.z).length());
        let [fold, at_hinge] = [lower, hinge].map(|v| libm::atan2f(v.x, v.z));
        let cos = (-hinge.y * lower.y / (of_hinge * across).max(1e-6)).clamp(-1.0, 1.0);
        (wrapped(fold - at_hinge + self.flexion * libm::acosf(cos)), libm::atan2f(across, lower.y))
    }

    /// Rolls the upper bone by the clip's `mean` and by what remains in this frame; the lower bone only swings.
    pub(super) fn fold_about_hinge(&self, mean: f32, model: &mut [Rotation]) {
        let (fold, bend) = self.fold(model);
        let rest = wrapped(fold - mean);
        let weight = smooth(BENT, bend) * (1.0 - smooth(REVERSED, rest.abs()));
        let direction = model[self.lower.target] * self.lower_along;
        let upper = &mut model[self.upper.target];
        *upper = (*upper * Rotation::from_rotation_y(mean + weight * rest)).normalize();
        let upper = *upper;
        model[self.lower.target] = towards(upper * self.rest, self.lower_along, direction);
    }
}

/// The mean disagreement of a clip, from those of its frames.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MeanFold(Vec2);

impl MeanFold {
    pub(super) fn add(&mut self, (fold, bend): (f32, f32)) {
        let (sin, cos) = libm::sincosf(fold);
        let weight = libm::sinf(bend);
        self.0 += Vec2::new(cos, sin) * weight * weight;
    }

    /// None is taken out where limbs hardly ever bend, or where they fold on all sides.
    pub(super) fn angle(self, frames: usize) -> f32 {
        let clear = smooth([0.01, 0.05], self.0.length() / frames.max(1) as f32);
        clear * libm::atan2f(self.0.y, self.0.x)
    }
}

/// Turned by the shortest arc so that `along`, in the joint's space, points where it should in model space.
fn towards(rotation: Rotation, along: Vec3, direction: Vec3) -> Rotation {
    match direction.try_normalize() {
        Some(direction) => (Rotation::from_rotation_arc(rotation * along, direction) * rotation).normalize(),
        None => rotation,
    }
}

/// 0 below the first, 1 above the second, eased between.
fn smooth([from, to]: [f32; 2], value: f32) -> f32 {
    smoothstep((value - from) / (to - from))
}
