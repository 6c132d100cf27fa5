//! Elbows and knees: directions of bones come from the source, the axis about which they bend from anatomy.
//!
//! Skeletons differ in the roll of a straight arm, and many roll the forearm at the elbow. Transferred unchanged, such a roll
//! bends the rig's elbow sideways. So the upper bone is rolled until the lower bone bends about the hinge axis: by the clip's
//! mean hinge angle, weighted by how far the limb bends, and by the rest of the frame's hinge angle as far as the limb is bent
//! in it. The lower bone then only swings, and its roll moves to hand or foot.
//!
//! ```text
//!     hinge axis X                 hinge angle: rotation about the upper bone (Y) from where
//!         │    ╱ lower bone        the hinge lets the lower bone go to where it is
//!         │  ╱
//!         o───────── Z, flexion
//!   (upper bone Y points at the reader)
//! ```

use glam::{Vec2, Vec3};

use super::bones::Bone;
use super::{Joints, Reference};
use crate::Side;
use crate::math::{RigidTransform, Rotation, smoothstep};
use crate::pose::twist::wrapped;
use crate::skeleton::SidedJoint;

/// Bends from which a frame's own hinge angle begins to count and counts fully, radians (15° and 40°).
const BENT: [f32; 2] = [0.26, 0.70];
/// Hinge angles from which a bend begins to count as hyperextension and fully does, radians (100° and 140°).
const REVERSED: [f32; 2] = [1.75, 2.44];

/// An arm or a leg with a hinge in the middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct HingedLimb {
    pub(super) upper: Bone,
    pub(super) lower: Bone,
    /// Direction of the upper bone in its joint's space.
    along: Vec3,
    /// Direction of the lower bone in its joint's space.
    lower_along: Vec3,
    /// The side to which the lower bone flexes, in the upper joint's space: 1 for +Z, −1 for −Z.
    flexion: f32,
    /// Rotation of `upper_from_lower` at rest.
    rest: Rotation,
}

impl HingedLimb {
    /// The target's limb; `None` unless source and target have its bones.
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

    /// Rotates both bones to the directions of the source's; `model` are the target's rotations in model space.
    pub(super) fn aim(&self, source: &[RigidTransform], model: &mut [Rotation]) {
        for (bone, along) in [(&self.upper, self.along), (&self.lower, self.lower_along)] {
            let rotation = &mut model[bone.target];
            *rotation = towards(*rotation, along, bone.of_source(source));
        }
    }

    /// The hinge angle, about the upper bone, and how far the limb is bent, both in radians.
    ///
    /// The hinge axis is the lower joint's X axis. In the upper joint's space, the hinge angle is the rotation of the hinge
    /// about Y after which the lower bone is at a right angle to it, on the flexion side.
    pub(super) fn hinge_angle(&self, model: &[Rotation]) -> (f32, f32) {
        let lower = model[self.upper.target].conjugate() * (model[self.lower.target] * self.lower_along);
        let hinge = self.rest * Vec3::X;
        let [across, of_hinge] = [lower, hinge].map(|v| Vec2::new(v.x, v.z).length());
        let [at_lower, at_hinge] = [lower, hinge].map(|v| libm::atan2f(v.x, v.z));
        let cos = (-hinge.y * lower.y / (of_hinge * across).max(1e-6)).clamp(-1.0, 1.0);
        (wrapped(at_lower - at_hinge + self.flexion * libm::acosf(cos)), libm::atan2f(across, lower.y))
    }

    /// Rolls the upper bone by the clip's mean hinge angle and by the rest of this frame's; the lower bone only swings.
    pub(super) fn bend_about_hinge(&self, mean: f32, model: &mut [Rotation]) {
        let (angle, bend) = self.hinge_angle(model);
        let rest = wrapped(angle - mean);
        let weight = smooth(BENT, bend) * (1.0 - smooth(REVERSED, rest.abs()));
        let direction = model[self.lower.target] * self.lower_along;
        let upper = &mut model[self.upper.target];
        *upper = (*upper * Rotation::from_rotation_y(mean + weight * rest)).normalize();
        let upper = *upper;
        model[self.lower.target] = towards(upper * self.rest, self.lower_along, direction);
    }
}

/// The mean hinge angle of a clip, as a sum of unit vectors weighted by the squared sine of the bend.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MeanHingeAngle(Vec2);

impl MeanHingeAngle {
    pub(super) fn add(&mut self, (angle, bend): (f32, f32)) {
        let (sin, cos) = libm::sincosf(angle);
        let weight = libm::sinf(bend);
        self.0 += Vec2::new(cos, sin) * weight * weight;
    }

    /// The mean, radians; 0 for limbs that hardly ever bend or that bend to all sides.
    pub(super) fn angle(self, frames: usize) -> f32 {
        let clear = smooth([0.01, 0.05], self.0.length() / frames.max(1) as f32);
        clear * libm::atan2f(self.0.y, self.0.x)
    }
}

/// Rotates by the shortest arc so that `along`, in the joint's space, takes this direction in model space.
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
