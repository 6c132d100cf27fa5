//! The bones that point the same way in source and target.

use glam::Vec3;

use super::super::JointMap;
use super::super::joint_map::Slot;
use crate::math::RigidTransform;
use crate::skeleton::{RigJoint, SidedJoint, Skeleton};

/// Below this two joints are one, metres: no direction can be read from them.
const SHORTEST: f32 = 1e-4;

/// Where a bone of the source ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tip {
    /// At this joint.
    Joint(usize),
    /// Here, in the space of the bone's own joint.
    End(Vec3),
}

/// A bone of the target, from joint to joint, and the same of the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bone {
    pub(super) target: usize,
    pub(super) target_tip: usize,
    pub(super) source: usize,
    pub(super) source_tip: Tip,
}

/// Both limbs of a side: joint and where its bone ends.
pub(super) const LIMBS: [(SidedJoint, SidedJoint); 6] = [
    (SidedJoint::Upperarm, SidedJoint::Lowerarm),
    (SidedJoint::Lowerarm, SidedJoint::Hand),
    (SidedJoint::Hand, SidedJoint::Middle01),
    (SidedJoint::Thigh, SidedJoint::Calf),
    (SidedJoint::Calf, SidedJoint::Foot),
    (SidedJoint::Foot, SidedJoint::Ball),
];

impl Bone {
    /// The bone of this joint of a limb or finger, where both skeletons have it with a length.
    pub(super) fn of(ours: RigJoint, map: &JointMap, source: &Skeleton, target: &Skeleton) -> Option<Self> {
        let RigJoint::Sided(stem, side) = ours else { return None };
        let tip = next(stem)?.on(side);
        let joint = map.source_of(ours)?;
        let candidates = match stem {
            SidedJoint::Hand => vec![Slot::HandTip(side), tip.into(), SidedJoint::Index01.on(side).into()],
            _ => vec![tip.into()],
        };
        let tips = candidates.into_iter().filter_map(|tip| Some(Tip::Joint(map.source_for(tip)?)));
        // A knee is no end site: only hands, feet and the last bones of fingers may end in one.
        let may_end = !matches!(
            stem,
            SidedJoint::Upperarm | SidedJoint::Lowerarm | SidedJoint::Thigh | SidedJoint::Calf
        );
        let end = source.ends().get(joint).copied().flatten().filter(|_| may_end).map(Tip::End);
        let model = source.model_from_joints();
        let source_tip = tips.chain(end).find(|tip| vector(&model, joint, *tip).length() > SHORTEST)?;
        Some(Self {
            target: target.rig_joint(ours)?,
            target_tip: target.rig_joint(tip)?,
            source: joint,
            source_tip,
        })
    }

    /// From the source's joint to its tip, in model space.
    pub(super) fn of_source(&self, model_from_joints: &[RigidTransform]) -> Vec3 {
        vector(model_from_joints, self.source, self.source_tip)
    }

    /// From the target's joint to its tip, in model space.
    pub(super) fn of_target(&self, model_from_joints: &[RigidTransform]) -> Vec3 {
        model_from_joints[self.target_tip].translation - model_from_joints[self.target].translation
    }
}

fn vector(model: &[RigidTransform], joint: usize, tip: Tip) -> Vec3 {
    match tip {
        Tip::Joint(tip) => model[tip].translation - model[joint].translation,
        Tip::End(end) => model[joint].rotation * end,
    }
}

/// The joint at the far end of a limb's or finger's bone.
fn next(joint: SidedJoint) -> Option<SidedJoint> {
    let of_limb = LIMBS.iter().find(|(from, _)| *from == joint).map(|(_, to)| *to);
    of_limb.or_else(|| {
        let (finger, number) = joint.finger()?;
        // Joints count from 1, so that this is the one after.
        finger.joints().get(number).copied()
    })
}
