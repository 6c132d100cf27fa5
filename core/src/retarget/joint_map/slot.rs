//! What a source joint may drive.

use std::cmp::Ordering;

use crate::Side;
use crate::skeleton::RigJoint;
use crate::skeleton::humanoid::humanoid_bones;

/// What a source joint may drive: a joint of our rig, or the direction of a hand. In the order of their names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slot {
    /// A joint of our rig.
    Joint(RigJoint),
    /// Where a hand points, for sources whose fingers are one joint: no joint of ours, a direction.
    HandTip(Side),
}

impl Slot {
    /// All that a source may drive: the humanoid bones and the tips of the hands.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        let joints = humanoid_bones().iter().map(|bone| Self::Joint(bone.joint));
        joints.chain(Side::ALL.map(Self::HandTip))
    }

    /// The slot of this name, such as `hand_l` or `hand_tip_l`.
    pub(super) fn from_name(name: &str) -> Option<Self> {
        Self::all().find(|slot| slot.name() == name)
    }

    /// Its name.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Joint(joint) => joint.name(),
            Self::HandTip(Side::Left) => "hand_tip_l",
            Self::HandTip(Side::Right) => "hand_tip_r",
        }
    }

    /// The side that it is on; `None` in the middle.
    pub(super) fn side(self) -> Option<Side> {
        match self {
            Self::Joint(joint) => joint.side(),
            Self::HandTip(side) => Some(side),
        }
    }
}

impl Ord for Slot {
    fn cmp(&self, other: &Self) -> Ordering {
        self.name().cmp(other.name())
    }
}

impl PartialOrd for Slot {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl From<RigJoint> for Slot {
    fn from(joint: RigJoint) -> Self {
        Self::Joint(joint)
    }
}
