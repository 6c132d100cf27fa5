//! Bones of source and target that correspond.

use glam::Vec3;

use super::super::JointMap;
use super::super::joint_map::Slot;
use crate::math::RigidTransform;
use crate::skeleton::{RigJoint, SidedJoint, Skeleton};

/// Joints closer than this count as one, metres, as they give no direction.
const SHORTEST: f32 = 1e-4;

/// Where a bone of the source ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tip {
    /// At this joint.
    Joint(usize),
    /// At this point in the space of the bone's own joint.
    End(Vec3),
}

/// A bone of the target, from joint to joint, and the corresponding bone of the source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bone {
    pub(super) target: usize,
    pub(super) target_tip: usize,
    pub(super) source: usize,
    pub(super) source_tip: Tip,
}

/// The bones of arm and leg: joint at the near end, joint at the far end.
pub(super) const LIMB_BONES: [(SidedJoint, SidedJoint); 6] = [
    (SidedJoint::Upperarm, SidedJoint::Lowerarm),
    (SidedJoint::Lowerarm, SidedJoint::Hand),
    (SidedJoint::Hand, SidedJoint::Middle01),
    (SidedJoint::Thigh, SidedJoint::Calf),
    (SidedJoint::Calf, SidedJoint::Foot),
    (SidedJoint::Foot, SidedJoint::Ball),
];

impl Bone {
    /// The bone that begins at this joint of a limb or finger; `None` unless both skeletons have it, with a length.
    pub(super) fn of(ours: RigJoint, map: &JointMap, source: &Skeleton, target: &Skeleton) -> Option<Self> {
        let RigJoint::Sided(stem, side) = ours else { return None };
        let tip = next(stem)?.on(side);
        let joint = map.source_of(ours)?;
        let candidates = match stem {
            SidedJoint::Hand => vec![Slot::HandTip(side), tip.into(), SidedJoint::Index01.on(side).into()],
            _ => vec![tip.into()],
        };
        let tips = candidates.into_iter().filter_map(|tip| Some(Tip::Joint(map.source_for(tip)?)));
        // Only hands, feet and fingers may end in an end site; the others end in a joint.
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

    /// From the source's joint to its tip, in model space, metres.
    pub(super) fn of_source(&self, model_from_joints: &[RigidTransform]) -> Vec3 {
        vector(model_from_joints, self.source, self.source_tip)
    }

    /// From the target's joint to its tip, in model space, metres.
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
    let of_limb = LIMB_BONES.iter().find(|(from, _)| *from == joint).map(|(_, to)| *to);
    of_limb.or_else(|| {
        let (finger, number) = joint.finger()?;
        // Numbers count from 1, so this is the next joint.
        finger.joints().get(number).copied()
    })
}
