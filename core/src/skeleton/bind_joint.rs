//! Joints in the bind pose, as hosts and files of other spaces have them.

use glam::Mat4;

use super::Skeleton;
use crate::math::RigidTransform;
use crate::space::Space;

/// A joint in the bind pose, in some [`Space`]. Matrices multiply column vectors; metres.
#[derive(Clone, Copy, Debug)]
pub struct BindJoint {
    /// Place of the parent, before the joint's own.
    pub parent: Option<u32>,
    /// From the joint along its +Y axis to where its bone ends, metres, where that is known.
    pub bone_length: Option<f32>,
    /// Relative to the parent, or to the model where there is none.
    pub parent_from_joint: RigidTransform,
    /// From the joint's space to the model's.
    pub model_from_joint: Mat4,
    /// The inverse bind matrix.
    pub joint_from_model: Mat4,
}

impl Skeleton {
    /// The joints in the bind pose, in a space, parents first.
    pub fn bind_joints(&self, space: Space) -> impl Iterator<Item = BindJoint> + '_ {
        let locals = self.parents().iter().zip(&self.rest_pose().locals);
        self.bind().iter().zip(locals).enumerate().map(
            move |(joint, (model_from_joint, (&parent, local)))| BindJoint {
                parent,
                bone_length: self.bone_length(joint),
                parent_from_joint: local.parent_from_joint_in(space, parent),
                model_from_joint: space.model_from_joint_matrix((*model_from_joint).into()),
                joint_from_model: space.joint_from_model_matrix(model_from_joint.inverse().into()),
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use crate::math::Rotation;
    use glam::Vec3;

    use super::*;

    #[test]
    fn both_matrices_and_the_chain_of_parents_agree_in_every_space() {
        let local = |angle| RigidTransform {
            rotation: Rotation::from_rotation_z(angle),
            translation: Vec3::new(0.1, 1.0, -0.3),
        };
        let skeleton = Skeleton::new(
            ["hips", "leg"].map(String::from).to_vec(),
            vec![None, Some(0)],
            vec![local(0.4), local(-1.3)],
            vec![None, Some(Vec3::Y * 0.5)],
        )
        .unwrap();
        for space in [Space::Gltf, Space::Blender, Space::Unity] {
            let joints: Vec<_> = skeleton.bind_joints(space).collect();
            assert_eq!(joints.iter().map(|joint| joint.parent).collect::<Vec<_>>(), [None, Some(0)]);
            assert_eq!(joints.iter().map(|joint| joint.bone_length).collect::<Vec<_>>(), [None, Some(0.5)]);
            let chain = joints[0].parent_from_joint.then(joints[1].parent_from_joint);
            assert!(joints[1].model_from_joint.abs_diff_eq(chain.to_affine().into(), 1e-6), "{space:?}");
            for joint in joints {
                let product = joint.joint_from_model * joint.model_from_joint;
                assert!(product.abs_diff_eq(Mat4::IDENTITY, 1e-6), "{space:?}");
            }
        }
    }
}
