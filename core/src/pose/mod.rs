//! Poses: where the joints of a skeleton are, on top of the room [`rig`](crate::rig).
//!
//! A [`RestPose`] is a hierarchy with the local transforms it rests in, of our rig or of any other; a [`Pose`] gives
//! every joint a local transform. Rotations are quaternions x, y, z, w, `parent_from_joint`; metres; joints stand
//! after their parents.

mod kinematics;
mod rest;

pub(crate) use kinematics::unit;
pub use kinematics::{Local, Pose, model_from_joints};
pub use rest::{MAX_JOINTS, RestPose};
