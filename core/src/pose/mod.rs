//! Two-bone inverse kinematics, joint limits, swing-twist decomposition, the leg with its sole, and static poses by name, for
//! poses of a [`Skeleton`](crate::skeleton::Skeleton).

pub(crate) mod figure;
pub mod ik;
mod leg;
pub mod limits;
mod named;
mod swing_twist;
pub(crate) mod twist;

pub(crate) use leg::{Leg, Sole};
pub use named::{Girth, POSES, named};
pub use swing_twist::SwingTwist;
