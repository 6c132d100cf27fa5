//! The skinning transforms of a posed character's joints, in the layout of the kernels.

use glam::{Vec3, Vec4};

use super::block::Chunk;
use super::buffers::Target;
use super::{SkinMethod, dual_quaternion, joint_translation, linear};
use crate::math::RigidTransformF64;

/// The skinning transforms of all joints for one method.
#[derive(Clone, Debug, Default)]
pub(super) struct Palette {
    method: SkinMethod,
    /// A fixed number per joint, which depends on the method.
    vectors: Vec<Vec4>,
}

impl Palette {
    /// Fills it from posed `model_from_joint` · bind `joint_from_model` of each joint.
    pub(super) fn fill(
        &mut self,
        method: SkinMethod,
        posed: &[RigidTransformF64],
        joint_from_model: &[RigidTransformF64],
    ) {
        self.method = method;
        self.vectors.clear();
        for (posed, bind) in posed.iter().zip(joint_from_model) {
            match method {
                SkinMethod::Linear => self.vectors.extend(linear::rows(&posed.then(*bind))),
                SkinMethod::DualQuaternion => {
                    self.vectors.extend(dual_quaternion::dual_quaternion(&posed.then(*bind)));
                }
                SkinMethod::JointTranslation => {
                    let moved = posed.translation - bind.inverse().translation;
                    self.vectors.push(moved.extend(0.0).as_vec4());
                }
            }
        }
    }

    /// Poses the vertices of a chunk.
    pub(super) fn skin(&self, chunk: Chunk<'_>, offsets: Option<&[Vec3]>, target: &mut Target<'_>) {
        match self.method {
            SkinMethod::Linear => {
                let (rows, _) = self.vectors.as_chunks();
                chunk.run(offsets, target, |block| linear::deform(rows, block));
            }
            SkinMethod::DualQuaternion => {
                let (quaternions, _) = self.vectors.as_chunks();
                chunk.run(offsets, target, |block| dual_quaternion::deform(quaternions, block));
            }
            SkinMethod::JointTranslation => {
                chunk.run(offsets, target, |block| joint_translation::deform(&self.vectors, block));
            }
        }
    }
}
