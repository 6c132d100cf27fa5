//! Two-bone inverse kinematics, joint limits, swing-twist decomposition, and the leg with its sole, for poses of a
//! [`Skeleton`](crate::skeleton::Skeleton).

pub mod ik;
mod leg;
pub mod limits;
mod swing_twist;

pub(crate) use leg::{Leg, Sole};
pub use swing_twist::SwingTwist;
