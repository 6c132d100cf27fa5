//! The skeleton: joints with their names and parents, the pose they rest in, skin weights, and what other programs call
//! the joints.
//!
//! A [`JointTree`] is names and parents; a [`Skeleton`] is a tree in the pose it rests in, of our rig or of any other; a
//! [`Pose`] gives every joint a transform to its parent. Rotations are quaternions x, y, z, w, `parent_from_joint`; metres; joints stand
//! after their parents.

mod bind_joint;
mod bones;
pub mod humanoid;
mod kinematics;
mod rig_joint;
#[expect(clippy::module_inception, reason = "the file of the type of that name")]
mod skeleton;
mod skin_weights;
mod tree;
pub(crate) mod written;

pub use bind_joint::BindJoint;
pub use bones::BonePositions;
pub use kinematics::{Pose, model_from_joints};
pub use rig_joint::{Finger, RigJoint, SidedJoint};
pub use skeleton::Skeleton;
pub use skin_weights::{Influences, SkinWeights};
pub use tree::{JointTree, MAX_JOINTS};
