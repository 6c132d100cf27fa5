//! Poses: where the joints of a skeleton are, on top of the room [`rig`](crate::rig).
//!
//! A [`RestPose`] is a hierarchy with the local transforms it rests in, of our rig or of any other; a [`Pose`] gives
//! every joint a local transform. Rotations are quaternions x, y, z, w, `parent_from_joint`; metres; joints stand
//! after their parents.

pub mod ik;
mod kinematics;
pub mod limits;
mod rest;
mod swing_twist;

pub(crate) use kinematics::unit;
pub use kinematics::{Local, Pose, model_from_joints};
pub use rest::{MAX_JOINTS, RestPose};
pub use swing_twist::SwingTwist;
