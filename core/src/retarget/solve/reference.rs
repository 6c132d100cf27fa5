//! Alignment of the rest poses of source and target: one constant rotation per joint.
//!
//! All rotations here are in model space. Let the alignment `A` rotate the target's joint from its rest pose to the pose in
//! which the source rests. A source joint that rotates from `R` at rest to `W` then moves the target's joint from `T` at rest
//! to
//!
//! ```text
//! W · R⁻¹ · A · T = W · offset        offset = R⁻¹ · A · T
//! ```
//!
//! The offset is computed here, once per pair of skeletons.
//!
//! The trunk is aligned by the source's facing only (and by its lean, if that is large), as spines differ too much between
//! skeletons to match them bone by bone. Limbs are aligned by directions, each bone after the one before it by the shortest
//! arc, which adds no roll. Where an elbow or knee is bent at rest its plane gives the roll, and in a hand with fingers the
//! row of knuckles does.

use glam::{Mat3, Vec3};

use super::super::JointMap;
use super::bones::Bone;
use super::{FootMode, Joints};
use crate::Side;
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::{RigJoint, SidedJoint};

/// Bends and leans below this are attributed to the skeleton's design and not to its pose, radians (15°).
const POSED: f32 = 0.26;
/// If legs are spread from the vertical by more than this, feet are tilted with them instead of flat, as in the zero poses of
/// CMU's skeletons, radians (12°).
const SPLAYED: f32 = 0.21;
/// If the bone of a foot laid flat differs from the source's by more than this, the source's foot is not flat at rest,
/// radians (25°).
const FLAT: f32 = 0.44;

/// Source and target in their rest poses.
pub(super) struct Reference<'a> {
    pub(super) map: &'a JointMap,
    pub(super) joints: &'a Joints<'a>,
    /// Rotation about +Y from the target's facing to the source's.
    facing: Rotation,
    /// `A` of the trunk.
    trunk: Rotation,
}

impl<'a> Reference<'a> {
    pub(super) fn new(map: &'a JointMap, joints: &'a Joints<'a>) -> Self {
        let yaw = |model: &[RigidTransform], find: &dyn Fn(RigJoint) -> Option<usize>| {
            let across = |joint: SidedJoint| {
                let [left, right] = joint.both().map(|joint| find(joint).map(|j| model[j].translation));
                left.zip(right).map_or(Vec3::ZERO, |(l, r)| l - r)
            };
            let left = across(SidedJoint::Thigh) + across(SidedJoint::Upperarm);
            libm::atan2f(-left.z, left.x)
        };
        let up = |model: &[RigidTransform], find: &dyn Fn(RigJoint) -> Option<usize>| {
            let mid = |joint: SidedJoint| {
                let [left, right] = joint.both().map(|joint| find(joint).map(|j| model[j].translation));
                left.zip(right).map(|(l, r)| (l + r) / 2.0)
            };
            mid(SidedJoint::Upperarm)
                .zip(mid(SidedJoint::Thigh))
                .and_then(|(top, bottom)| (top - bottom).try_normalize())
        };
        let of_source = |joint: RigJoint| map.source_of(joint);
        let of_target = |joint: RigJoint| joints.target.rig_joint(joint);
        let angle = yaw(&joints.source_rest, &of_source) - yaw(&joints.target_rest, &of_target);
        let facing = Rotation::from_rotation_y(angle);
        let up = up(&joints.source_rest, &of_source).zip(up(&joints.target_rest, &of_target));
        let lean = up.map_or(Rotation::IDENTITY, |(source, target)| {
            let target = facing * target;
            if source.angle_between(target) > POSED {
                Rotation::from_rotation_arc(target, source)
            } else {
                Rotation::IDENTITY
            }
        });
        Self { map, joints, facing, trunk: lean * facing }
    }

    /// The offset `R⁻¹ · A · T` of a target joint that a source joint drives, with the alignment `A`.
    pub(super) fn offset(&self, source: usize, target: usize, alignment: Rotation) -> Rotation {
        let (r, t) = (self.joints.source_rest[source].rotation, self.joints.target_rest[target].rotation);
        (r.conjugate() * alignment * t).normalize()
    }

    /// `A` of pelvis, spine, neck, head and clavicles.
    pub(super) fn trunk(&self) -> Rotation {
        self.trunk
    }

    /// `A` of an arm: upper arm, forearm, hand.
    pub(super) fn arm(&self, side: Side) -> [Rotation; 3] {
        let [upper, lower] = self.hinge([SidedJoint::Upperarm, SidedJoint::Lowerarm], side, Vec3::Z);
        let hand = self.bone(SidedJoint::Hand.on(side), lower);
        [upper, lower, self.knuckles(side).unwrap_or(hand)]
    }

    /// `A` of a leg: thigh, calf, foot.
    pub(super) fn leg(&self, side: Side, mode: FootMode) -> [Rotation; 3] {
        let [upper, lower] = self.hinge([SidedJoint::Thigh, SidedJoint::Calf], side, Vec3::NEG_Z);
        [upper, lower, self.foot(side, lower, mode)]
    }

    /// `A` of a finger bone, after that of the bone before it.
    pub(super) fn finger(&self, joint: RigJoint, before: Rotation) -> Rotation {
        self.bone(joint, before)
    }

    /// Directions of a bone in source and target at rest.
    fn pair(&self, joint: RigJoint) -> Option<(Vec3, Vec3)> {
        let bone = Bone::of(joint, self.map, self.joints.source, self.joints.target)?;
        let source = bone.of_source(&self.joints.source_rest).try_normalize()?;
        Some((source, bone.of_target(&self.joints.target_rest).try_normalize()?))
    }

    /// `A` of a bone: the shortest arc after the alignment of the bone before it.
    fn bone(&self, joint: RigJoint, before: Rotation) -> Rotation {
        match self.pair(joint) {
            Some((source, target)) => {
                (Rotation::from_rotation_arc(before * target, source) * before).normalize()
            }
            None => before,
        }
    }

    /// `A` of the upper and lower bone of a limb, which flexes towards `flexion` in the upper joint's space.
    fn hinge(&self, limb: [SidedJoint; 2], side: Side, flexion: Vec3) -> [Rotation; 2] {
        let [upper, lower] = limb.map(|joint| joint.on(side));
        let mut first = self.bone(upper, self.trunk);
        if let (Some((source, target)), Some((bent, _)), Some(joint)) =
            (self.pair(upper), self.pair(lower), self.joints.target.rig_joint(upper))
            && source.angle_between(bent) > POSED
        {
            let flexion = self.joints.target_rest[joint].rotation * flexion;
            first = align(target, flexion, source, bent).unwrap_or(first);
        }
        [first, self.bone(lower, first)]
    }

    /// `A` of a hand by its direction and the row of its knuckles; `None` without them.
    fn knuckles(&self, side: Side) -> Option<Rotation> {
        let (source, target) = self.pair(SidedJoint::Hand.on(side))?;
        let [index, pinky] = [SidedJoint::Index01.on(side), SidedJoint::Pinky01.on(side)];
        let [a, b] = [self.map.source_of(index)?, self.map.source_of(pinky)?];
        let [c, d] = [self.joints.target.rig_joint(index)?, self.joints.target.rig_joint(pinky)?];
        let (rest, ours) = (&self.joints.source_rest, &self.joints.target_rest);
        let row = rest[a].translation - rest[b].translation;
        align(target, ours[c].translation - ours[d].translation, source, row)
    }

    /// `A` of a foot: by its sole, which is on the floor at rest whatever the slope of the bone, or by the bone.
    fn foot(&self, side: Side, calf: Rotation, mode: FootMode) -> Rotation {
        let foot = SidedJoint::Foot.on(side);
        let Some((source, target)) = self.pair(foot) else { return self.facing };
        let by_bone = self.bone(foot, calf);
        let up = self.up_of_foot(side);
        let flat = align(Vec3::Y, target, up, source);
        match flat.filter(|flat| mode == FootMode::Sole && (*flat * target).angle_between(source) < FLAT) {
            Some(flat) => flat,
            None => by_bone,
        }
    }

    /// The direction up from the sole at rest.
    fn up_of_foot(&self, side: Side) -> Vec3 {
        let at = |joint: SidedJoint| {
            self.map.source_of(joint.on(side)).map(|j| self.joints.source_rest[j].translation)
        };
        let leg =
            at(SidedJoint::Thigh).zip(at(SidedJoint::Foot)).map_or(Vec3::Y, |(thigh, foot)| thigh - foot);
        let aside = leg.dot(self.facing * Vec3::X);
        if libm::atan2f(aside.abs(), leg.y) > SPLAYED { leg.normalize_or(Vec3::Y) } else { Vec3::Y }
    }
}

/// The rotation that takes the direction `from` to `to` and `from_second` as near to `to_second` as that allows.
fn align(from: Vec3, from_second: Vec3, to: Vec3, to_second: Vec3) -> Option<Rotation> {
    let basis = |first: Vec3, second: Vec3| {
        let x = first.try_normalize()?;
        let z = x.cross(second).try_normalize()?;
        Some(Mat3::from_cols(x, z.cross(x), z))
    };
    let rotation = basis(to, to_second)? * basis(from, from_second)?.transpose();
    Some(Rotation::from_mat3(&rotation).normalize())
}
