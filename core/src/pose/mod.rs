//! What joints do: inverse kinematics, joint limits, swing and twist, the leg and its sole; on poses of a
//! [`Skeleton`](crate::skeleton::Skeleton).

pub mod ik;
mod leg;
pub mod limits;
mod swing_twist;

pub(crate) use leg::{Leg, Sole};
pub use swing_twist::SwingTwist;
