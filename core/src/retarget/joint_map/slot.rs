//! The targets of joint matching.

use std::cmp::Ordering;

use crate::Side;
use crate::skeleton::RigJoint;
use crate::skeleton::humanoid::humanoid_bones;

/// What a source joint can drive: a joint of the rig or the direction of a hand. Ordered by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slot {
    /// A joint of the rig.
    Joint(RigJoint),
    /// The direction of a hand, for sources whose fingers are one joint; the rig has no such joint.
    HandTip(Side),
}

impl Slot {
    /// All slots: the humanoid bones and the tips of the hands.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        let joints = humanoid_bones().iter().map(|bone| Self::Joint(bone.joint));
        joints.chain(Side::ALL.map(Self::HandTip))
    }

    /// The slot with this name, such as `hand_l` or `hand_tip_l`.
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

    /// Its side; `None` for a central joint.
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
