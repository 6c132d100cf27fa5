//! The skeleton: joints with their names and parents, the pose they rest in, skin weights, and what other programs call
//! the joints.
//!
//! A [`Skeleton`] is a hierarchy with the local transforms it rests in, of our rig or of any other; a [`Pose`] gives
//! every joint a local transform. Rotations are quaternions x, y, z, w, `parent_from_joint`; metres; joints stand
//! after their parents.

pub mod humanoid;
mod kinematics;
mod rest;
mod rig_joint;
#[expect(clippy::module_inception, reason = "the file of the type of that name")]
mod skeleton;
mod skin_weights;
pub(crate) mod written;

pub use kinematics::{Pose, model_from_joints};
pub use rest::{MAX_JOINTS, Skeleton};
pub use rig_joint::{Finger, RigJoint, SidedJoint};
pub use skeleton::{BonePositions, Joint, Skeleton};
pub use skin_weights::{Influences, SkinWeights};
