//! Skeletons: joint trees, rest and bind pose, forward kinematics, skin weights, and the names of joints in other programs.
//!
//! A [`JointTree`] has names and parents. A [`Skeleton`] is a joint tree with a rest pose, of the rig or of any file. A
//! [`Pose`] has a transform `parent_from_joint` per joint; translations are in metres, rotations are quaternions x, y, z, w.
//! Parents come before their joints, so that forward kinematics is one pass:
//!
//! ```text
//! model_from_joint(hand) = parent_from_joint(root) · … · parent_from_joint(forearm) · parent_from_joint(hand)
//!                        = model_from_joint(forearm) · parent_from_joint(hand)
//! ```

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
pub(crate) use kinematics::{model_from_some_joints, with_ancestors};
pub use rig_joint::{Finger, RigJoint, SidedJoint};
pub use skeleton::Skeleton;
pub use skin_weights::{Influences, SkinWeights};
pub use tree::{JointTree, MAX_JOINTS};
