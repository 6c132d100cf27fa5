//! The joints of the rig as types, and the table of their names: one row per joint, sided joints without their side.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::LazyLock;

use super::{JointTree, Skeleton};
use crate::{Result, Side};

/// A joint of the rig.
///
/// The rig is MakeHuman's `game_engine` rig (Unreal-like names) with eyes, jaw and twist joints. A skeleton may lack
/// some of them and have others: see [`Skeleton::rig_joint`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RigJoint {
    /// On the ground, below the body.
    Root,
    /// The hips, from which legs and spine hang.
    Pelvis,
    /// Lowest joint of the spine.
    Spine01,
    /// Middle joint of the spine.
    Spine02,
    /// Highest joint of the spine, in the chest: clavicles and neck hang from it.
    Spine03,
    /// The neck.
    Neck01,
    /// The head.
    Head,
    /// The lower jaw.
    Jaw,
    /// A joint of the left or right side.
    Sided(SidedJoint, Side),
}

/// A joint that the rig has on both sides; [`on`](Self::on) gives the [`RigJoint`] of one side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SidedJoint {
    /// Collar bone.
    Clavicle,
    /// Shoulder.
    Upperarm,
    /// Elbow.
    Lowerarm,
    /// Wrist.
    Hand,
    /// Hip.
    Thigh,
    /// Knee.
    Calf,
    /// Ankle.
    Foot,
    /// Ball of the foot.
    Ball,
    /// Eye.
    Eye,
    /// Thumb, the joint nearest to the palm.
    Thumb01,
    /// Thumb, the joint in the middle.
    Thumb02,
    /// Thumb, the joint at the tip.
    Thumb03,
    /// Index finger, the joint nearest to the palm.
    Index01,
    /// Index finger, the joint in the middle.
    Index02,
    /// Index finger, the joint at the tip.
    Index03,
    /// Middle finger, the joint nearest to the palm.
    Middle01,
    /// Middle finger, the joint in the middle.
    Middle02,
    /// Middle finger, the joint at the tip.
    Middle03,
    /// Ring finger, the joint nearest to the palm.
    Ring01,
    /// Ring finger, the joint in the middle.
    Ring02,
    /// Ring finger, the joint at the tip.
    Ring03,
    /// Little finger, the joint nearest to the palm.
    Pinky01,
    /// Little finger, the joint in the middle.
    Pinky02,
    /// Little finger, the joint at the tip.
    Pinky03,
    /// Undoes the upper arm's roll at the shoulder.
    UpperarmTwist01,
    /// Undoes half of the upper arm's roll, half-way along it.
    UpperarmTwist02,
    /// Takes half of the hand's roll, half-way along the forearm.
    LowerarmTwist01,
    /// Takes the hand's roll at the wrist.
    LowerarmTwist02,
    /// Undoes the thigh's roll at the hip.
    ThighTwist01,
    /// Takes the foot's roll at the ankle.
    CalfTwist01,
}

/// A finger, including the thumb. Each has three joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Finger {
    /// The thumb.
    Thumb,
    /// The index finger.
    Index,
    /// The middle finger.
    Middle,
    /// The ring finger.
    Ring,
    /// The little finger.
    Pinky,
}

/// Whether a joint is a bone of the standard humanoid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bone {
    /// A bone that Unity and VRM require.
    Required,
    /// A bone that they support.
    Optional,
    /// Not a humanoid bone: the root and the twist joints.
    No,
}
use Bone::{No, Optional, Required};

/// Names of a joint: native, Unity, Mixamo, VRM, Blender. `humanoid.rs` adds the side to those of sided joints.
pub(super) type Names = [&'static str; 5];

/// The central joints, in the order of the enum.
pub(super) const CENTRAL: [(RigJoint, Names, Bone); 8] = [
    (RigJoint::Root, ["Root", "Root", "Root", "root", "root"], No),
    (RigJoint::Pelvis, ["pelvis", "Hips", "Hips", "hips", "hips"], Required),
    (RigJoint::Spine01, ["spine_01", "Spine", "Spine", "spine", "spine"], Required),
    (RigJoint::Spine02, ["spine_02", "Chest", "Spine1", "chest", "chest"], Optional),
    (RigJoint::Spine03, ["spine_03", "UpperChest", "Spine2", "upperChest", "upper_chest"], Optional),
    (RigJoint::Neck01, ["neck_01", "Neck", "Neck", "neck", "neck"], Optional),
    (RigJoint::Head, ["head", "Head", "Head", "head", "head"], Required),
    (RigJoint::Jaw, ["jaw", "Jaw", "Jaw", "jaw", "jaw"], Optional),
];

/// The sided joints, in the order of the enum, their names without the side.
#[rustfmt::skip]
pub(super) const SIDED: [(SidedJoint, Names, Bone); 30] = [
    (SidedJoint::Clavicle, ["clavicle", "Shoulder", "Shoulder", "Shoulder", "shoulder"], Optional),
    (SidedJoint::Upperarm, ["upperarm", "UpperArm", "Arm", "UpperArm", "upper_arm"], Required),
    (SidedJoint::Lowerarm, ["lowerarm", "LowerArm", "ForeArm", "LowerArm", "forearm"], Required),
    (SidedJoint::Hand, ["hand", "Hand", "Hand", "Hand", "hand"], Required),
    (SidedJoint::Thigh, ["thigh", "UpperLeg", "UpLeg", "UpperLeg", "thigh"], Required),
    (SidedJoint::Calf, ["calf", "LowerLeg", "Leg", "LowerLeg", "shin"], Required),
    (SidedJoint::Foot, ["foot", "Foot", "Foot", "Foot", "foot"], Required),
    (SidedJoint::Ball, ["ball", "Toes", "ToeBase", "Toes", "toe"], Optional),
    (SidedJoint::Eye, ["eye", "Eye", "Eye", "Eye", "eye"], Optional),
    (SidedJoint::Thumb01, ["thumb_01", "ThumbProximal", "HandThumb1", "ThumbMetacarpal", "thumb.01"], Optional),
    (SidedJoint::Thumb02, ["thumb_02", "ThumbIntermediate", "HandThumb2", "ThumbProximal", "thumb.02"], Optional),
    (SidedJoint::Thumb03, ["thumb_03", "ThumbDistal", "HandThumb3", "ThumbDistal", "thumb.03"], Optional),
    (SidedJoint::Index01, ["index_01", "IndexProximal", "HandIndex1", "IndexProximal", "f_index.01"], Optional),
    (SidedJoint::Index02, ["index_02", "IndexIntermediate", "HandIndex2", "IndexIntermediate", "f_index.02"], Optional),
    (SidedJoint::Index03, ["index_03", "IndexDistal", "HandIndex3", "IndexDistal", "f_index.03"], Optional),
    (SidedJoint::Middle01, ["middle_01", "MiddleProximal", "HandMiddle1", "MiddleProximal", "f_middle.01"], Optional),
    (SidedJoint::Middle02, ["middle_02", "MiddleIntermediate", "HandMiddle2", "MiddleIntermediate", "f_middle.02"], Optional),
    (SidedJoint::Middle03, ["middle_03", "MiddleDistal", "HandMiddle3", "MiddleDistal", "f_middle.03"], Optional),
    (SidedJoint::Ring01, ["ring_01", "RingProximal", "HandRing1", "RingProximal", "f_ring.01"], Optional),
    (SidedJoint::Ring02, ["ring_02", "RingIntermediate", "HandRing2", "RingIntermediate", "f_ring.02"], Optional),
    (SidedJoint::Ring03, ["ring_03", "RingDistal", "HandRing3", "RingDistal", "f_ring.03"], Optional),
    (SidedJoint::Pinky01, ["pinky_01", "LittleProximal", "HandPinky1", "LittleProximal", "f_pinky.01"], Optional),
    (SidedJoint::Pinky02, ["pinky_02", "LittleIntermediate", "HandPinky2", "LittleIntermediate", "f_pinky.02"], Optional),
    (SidedJoint::Pinky03, ["pinky_03", "LittleDistal", "HandPinky3", "LittleDistal", "f_pinky.03"], Optional),
    (SidedJoint::UpperarmTwist01, ["upperarm_twist_01", "UpperArmTwist1", "ArmTwist1", "UpperArmTwist1", "upper_arm_twist.01"], No),
    (SidedJoint::UpperarmTwist02, ["upperarm_twist_02", "UpperArmTwist2", "ArmTwist2", "UpperArmTwist2", "upper_arm_twist.02"], No),
    (SidedJoint::LowerarmTwist01, ["lowerarm_twist_01", "LowerArmTwist1", "ForeArmTwist1", "LowerArmTwist1", "forearm_twist.01"], No),
    (SidedJoint::LowerarmTwist02, ["lowerarm_twist_02", "LowerArmTwist2", "ForeArmTwist2", "LowerArmTwist2", "forearm_twist.02"], No),
    (SidedJoint::ThighTwist01, ["thigh_twist_01", "UpperLegTwist1", "UpLegTwist1", "UpperLegTwist1", "thigh_twist.01"], No),
    (SidedJoint::CalfTwist01, ["calf_twist_01", "LowerLegTwist1", "LegTwist1", "LowerLegTwist1", "shin_twist.01"], No),
];

/// Native names in the order of [`RigJoint::all`], and the joints by name.
struct NativeNames {
    names: Vec<String>,
    joints: BTreeMap<String, RigJoint>,
}

static NATIVE: LazyLock<NativeNames> = LazyLock::new(|| {
    let name = |joint: RigJoint| match joint {
        RigJoint::Sided(joint, side) => format!("{}{}", joint.name(), side.joint_suffix()),
        _ => CENTRAL[joint.index()].1[0].to_owned(),
    };
    let names: Vec<String> = RigJoint::all().map(name).collect();
    let joints = names.iter().cloned().zip(RigJoint::all()).collect();
    NativeNames { names, joints }
});

impl RigJoint {
    /// All joints: central, then left, then right.
    pub fn all() -> impl Iterator<Item = Self> + Clone {
        let central = CENTRAL.into_iter().map(|row| row.0);
        central.chain(Side::ALL.into_iter().flat_map(|side| SidedJoint::all().map(move |j| j.on(side))))
    }

    /// The joint with this name, such as `upperarm_l`.
    pub fn from_name(name: &str) -> Option<Self> {
        NATIVE.joints.get(name).copied()
    }

    /// Its name, such as `upperarm_l`.
    pub fn name(self) -> &'static str {
        &NATIVE.names[self.index()]
    }

    /// Its side; `None` for a central joint.
    pub const fn side(self) -> Option<Side> {
        match self {
            Self::Sided(_, side) => Some(side),
            _ => None,
        }
    }

    /// The joint without its side; `None` for a central joint.
    pub const fn sided(self) -> Option<SidedJoint> {
        match self {
            Self::Sided(joint, _) => Some(joint),
            _ => None,
        }
    }

    /// The finger that it belongs to and its number from the palm outwards, 1 to 3.
    pub fn finger(self) -> Option<(Finger, usize)> {
        self.sided()?.finger()
    }

    /// Whether it is a twist joint, which only takes part of a limb's roll.
    pub fn is_twist(self) -> bool {
        self.sided().is_some_and(SidedJoint::is_twist)
    }

    /// Its index in the order of [`all`](Self::all).
    pub(super) const fn index(self) -> usize {
        match self {
            Self::Root => 0,
            Self::Pelvis => 1,
            Self::Spine01 => 2,
            Self::Spine02 => 3,
            Self::Spine03 => 4,
            Self::Neck01 => 5,
            Self::Head => 6,
            Self::Jaw => 7,
            Self::Sided(joint, side) => CENTRAL.len() + side.index() * SIDED.len() + joint as usize,
        }
    }
}

impl fmt::Display for RigJoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl SidedJoint {
    /// All sided joints.
    pub fn all() -> impl ExactSizeIterator<Item = Self> + Clone {
        SIDED.into_iter().map(|row| row.0)
    }

    /// The joint on this side.
    pub const fn on(self, side: Side) -> RigJoint {
        RigJoint::Sided(self, side)
    }

    /// The left and the right joint.
    pub const fn both(self) -> [RigJoint; 2] {
        [self.on(Side::Left), self.on(Side::Right)]
    }

    /// Its name without the side, such as `upperarm`.
    pub const fn name(self) -> &'static str {
        SIDED[self as usize].1[0]
    }

    /// The finger that it belongs to and its number from the palm outwards, 1 to 3.
    pub fn finger(self) -> Option<(Finger, usize)> {
        let number = |finger: Finger| finger.joints().iter().position(|joint| *joint == self);
        Finger::ALL.into_iter().find_map(|finger| Some((finger, number(finger)? + 1)))
    }

    /// The joint whose bone a twist joint lies on; any other joint itself.
    pub const fn main_joint(self) -> Self {
        match self {
            Self::UpperarmTwist01 | Self::UpperarmTwist02 => Self::Upperarm,
            Self::LowerarmTwist01 | Self::LowerarmTwist02 => Self::Lowerarm,
            Self::ThighTwist01 => Self::Thigh,
            Self::CalfTwist01 => Self::Calf,
            _ => self,
        }
    }

    /// Whether it is a twist joint, which only takes part of a limb's roll.
    pub fn is_twist(self) -> bool {
        self.main_joint() != self
    }
}

impl Finger {
    /// All five, in the order of [`Finger::index`].
    pub const ALL: [Self; 5] = [Self::Thumb, Self::Index, Self::Middle, Self::Ring, Self::Pinky];

    /// 0 for the thumb to 4 for the little finger.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Its joints from the palm outwards.
    pub const fn joints(self) -> [SidedJoint; 3] {
        use SidedJoint as J;
        match self {
            Self::Thumb => [J::Thumb01, J::Thumb02, J::Thumb03],
            Self::Index => [J::Index01, J::Index02, J::Index03],
            Self::Middle => [J::Middle01, J::Middle02, J::Middle03],
            Self::Ring => [J::Ring01, J::Ring02, J::Ring03],
            Self::Pinky => [J::Pinky01, J::Pinky02, J::Pinky03],
        }
    }
}

impl JointTree {
    /// Index of this joint of the rig, if it is present.
    pub fn rig_joint(&self, joint: RigJoint) -> Option<usize> {
        self.find(joint.name())
    }
}

impl Skeleton {
    /// Index of this joint of the rig, if it is present.
    pub fn rig_joint(&self, joint: RigJoint) -> Option<usize> {
        self.find(joint.name())
    }

    /// Index of this joint of the rig, which must be present.
    ///
    /// # Errors
    /// As [`require`](Self::require).
    pub fn require_rig_joint(&self, joint: RigJoint) -> Result<usize> {
        self.require(joint.name())
    }

    /// The joint of the rig that each joint is, by name; `None` for other names.
    pub fn rig_joints(&self) -> impl Iterator<Item = Option<RigJoint>> + '_ {
        self.names().iter().map(|name| RigJoint::from_name(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_types() {
        assert!(CENTRAL.iter().enumerate().all(|(index, row)| row.0.index() == index));
        assert!(SIDED.iter().enumerate().all(|(index, row)| row.0 as usize == index));
        assert_eq!(RigJoint::all().count(), 68);
        for (index, joint) in RigJoint::all().enumerate() {
            assert_eq!(joint.index(), index);
            assert_eq!(RigJoint::from_name(joint.name()), Some(joint));
            assert_eq!(joint.side(), Side::of_joint_name(joint.name()), "{joint}");
            assert_eq!(joint.is_twist(), joint.name().contains("twist"), "{joint}");
        }
        assert_eq!(SidedJoint::UpperarmTwist02.on(Side::Right).name(), "upperarm_twist_02_r");
        assert_eq!(RigJoint::from_name("tail"), None);
    }

    #[test]
    fn fingers_have_three_joints() {
        for (index, finger) in Finger::ALL.into_iter().enumerate() {
            assert_eq!(finger.index(), index);
            for (i, joint) in finger.joints().into_iter().enumerate() {
                assert_eq!(joint.finger(), Some((finger, i + 1)));
                assert!(joint.name().ends_with(&format!("_0{}", i + 1)), "{joint:?}");
            }
        }
        assert_eq!(RigJoint::all().filter(|joint| joint.finger().is_some()).count(), 30);
    }
}
