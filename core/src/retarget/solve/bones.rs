//! The bones that point the same way in source and target.

use glam::Vec3;

use super::super::JointMap;
use crate::math::RigidTransform;
use crate::skeleton::Skeleton;

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
pub(super) const LIMBS: [(&str, &str); 6] = [
    ("upperarm", "lowerarm"),
    ("lowerarm", "hand"),
    ("hand", "middle_01"),
    ("thigh", "calf"),
    ("calf", "foot"),
    ("foot", "ball"),
];

impl Bone {
    /// The bone of this limb joint, such as `foot_l`, where both skeletons have it with a length.
    pub(super) fn of(name: &str, map: &JointMap, source: &Skeleton, target: &Skeleton) -> Option<Self> {
        let (stem, side) = name.rsplit_once('_')?;
        let tip = next(stem)?;
        let joint = map.source_of(name)?;
        let candidates = match stem {
            "hand" => &["hand_tip", "middle_01", "index_01"][..],
            _ => &[tip.as_str()],
        };
        let tips =
            candidates.iter().filter_map(|tip| Some(Tip::Joint(map.source_of(&format!("{tip}_{side}"))?)));
        // A knee is no end site: only hands, feet and the last bones of fingers may end in one.
        let may_end = !["upperarm", "lowerarm", "thigh", "calf"].contains(&stem);
        let end = source.ends().get(joint).copied().flatten().filter(|_| may_end).map(Tip::End);
        let model = source.model_from_joints();
        let source_tip = tips.chain(end).find(|tip| vector(&model, joint, *tip).length() > SHORTEST)?;
        Some(Self {
            target: target.find(name)?,
            target_tip: target.find(&format!("{tip}_{side}"))?,
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
fn next(stem: &str) -> Option<String> {
    if let Some((_, tip)) = LIMBS.iter().find(|(joint, _)| *joint == stem) {
        return Some((*tip).to_owned());
    }
    let finger = stem.strip_suffix("_01").map(|f| format!("{f}_02"));
    finger.or_else(|| stem.strip_suffix("_02").map(|f| format!("{f}_03")))
}
