//! The skeleton of a body from the positions of its bones.
//!
//! A joint's +Y axis runs along its bone, from head to tail, as Blender's bones do. Its +Z axis is as near to the front of
//! the body as that allows (upwards for feet, toes, eyes and jaw, which point forwards), so that left and right are mirror
//! images and a limb bends about one axis.

use std::sync::Arc;

use glam::{Affine3A, Mat3, Vec3};

use super::written::round_to_file;
use super::{JointTree, RigJoint, SidedJoint, Skeleton};
use crate::{Error, Result, Side};

/// Where the bones of a body begin and end, in model space, metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BonePositions {
    /// Position of each joint.
    pub heads: Vec<Vec3>,
    /// Far end of each joint's bone.
    pub tails: Vec<Vec3>,
}

impl BonePositions {
    /// Moves elbows and wrists, with their twist joints, exactly onto the line through the shoulder along ±X, from which
    /// rounding put them a few micrometres off, so that the T-pose is exact.
    pub fn straighten(&mut self, tree: &JointTree) {
        for side in Side::ALL {
            let Some(shoulder) = tree.rig_joint(SidedJoint::Upperarm.on(side)) else { continue };
            let Some(&Vec3 { y, z, .. }) = self.heads.get(shoulder) else { continue };
            for (j, name) in tree.names().iter().enumerate() {
                let of_side = RigJoint::from_name(name).filter(|joint| joint.side() == Some(side));
                let Some(main) = of_side.and_then(|joint| joint.sided()).map(SidedJoint::main_joint) else {
                    continue;
                };
                if !matches!(main, SidedJoint::Upperarm | SidedJoint::Lowerarm | SidedJoint::Hand) {
                    continue;
                }
                self.heads[j] = self.heads[j].with_y(y).with_z(z);
                if main != SidedJoint::Hand {
                    self.tails[j] = self.tails[j].with_y(y).with_z(z);
                }
            }
        }
    }

    /// The skeleton of a body of this rig, its bind pose rounded so that writing it to a file and reading it changes nothing.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the number of heads or tails is not the number of joints, or as
    /// [`Skeleton::from_bind`].
    pub fn skeleton(&self, tree: &Arc<JointTree>) -> Result<Skeleton> {
        if self.heads.len() != tree.len() || self.tails.len() != tree.len() {
            let (heads, tails) = (self.heads.len(), self.tails.len());
            let message = format!("expected {} joints, got {heads} and {tails}", tree.len());
            return Err(Error::invalid("bone positions", message));
        }
        let bones = self.heads.iter().zip(&self.tails).map(|(head, tail)| *tail - *head);
        let mut bind: Vec<Affine3A> = bones
            .clone()
            .zip(tree.names().iter().zip(tree.parents()))
            .zip(&self.heads)
            .map(|((bone, (name, parent)), head)| {
                let rotation = match parent {
                    None => Mat3::IDENTITY,
                    Some(_) => orientation(bone, z_hint(name)),
                };
                Affine3A::from_mat3_translation(rotation, *head)
            })
            .collect();
        round_to_file(tree.parents(), &mut bind);
        Skeleton::from_bind(tree.clone(), bind, bones.map(|bone| Some(bone.length())).collect())
    }
}

/// The direction that a joint's +Z axis is nearest to.
fn z_hint(name: &str) -> Vec3 {
    match RigJoint::from_name(name) {
        Some(RigJoint::Jaw | RigJoint::Sided(SidedJoint::Foot | SidedJoint::Ball | SidedJoint::Eye, _)) => {
            Vec3::Y
        }
        _ => Vec3::Z,
    }
}

/// The rotation with +Y along `bone` and +Z as near to `hint` as possible; columns are the joint's axes.
fn orientation(bone: Vec3, hint: Vec3) -> Mat3 {
    let y = bone.try_normalize().unwrap_or(Vec3::Y);
    let off_axis = |v: Vec3| (v - y * v.dot(y)).try_normalize();
    // A bone along the hint itself takes the next axis.
    let z =
        if y.dot(hint).abs() < 0.99 { off_axis(hint) } else { off_axis(Vec3::new(hint.z, hint.x, hint.y)) }
            .unwrap_or(Vec3::Z);
    Mat3::from_cols(y.cross(z), y, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arm() -> (Arc<JointTree>, BonePositions) {
        let names = ["Root", "upperarm_l", "upperarm_r", "foot_l"].map(String::from).to_vec();
        let tree = JointTree::new(names, vec![None, Some(0), Some(0), Some(0)]).unwrap();
        let shape = BonePositions {
            heads: vec![
                Vec3::ZERO,
                Vec3::new(0.2, 1.4, 0.0),
                Vec3::new(-0.2, 1.4, 0.0),
                Vec3::new(0.1, 0.1, 0.0),
            ],
            tails: vec![
                Vec3::Y,
                Vec3::new(0.5, 1.4, 0.0),
                Vec3::new(-0.5, 1.4, 0.0),
                Vec3::new(0.1, 0.0, 0.15),
            ],
        };
        (Arc::new(tree), shape)
    }

    #[test]
    fn bones_lie_along_y_and_sides_mirror() {
        let (tree, shape) = arm();
        let skeleton = shape.skeleton(&tree).unwrap();
        for (j, bind) in skeleton.bind().iter().enumerate() {
            assert!((bind.matrix3.determinant() - 1.0).abs() < 1e-5);
            let tip = bind.transform_point3(skeleton.ends()[j].unwrap());
            if j > 0 {
                assert!((tip - shape.tails[j]).length() < 1e-6, "{} {tip}", tree.names()[j]);
            }
        }
        let (l, r) = (skeleton.bind()[1].matrix3, skeleton.bind()[2].matrix3);
        let mirror = |v: glam::Vec3A| glam::Vec3A::new(-v.x, v.y, v.z);
        assert!((mirror(l.y_axis) - r.y_axis).length() < 1e-6);
        assert!((mirror(l.z_axis) - r.z_axis).length() < 1e-6);
        assert!((mirror(l.x_axis) + r.x_axis).length() < 1e-6);
        assert!(skeleton.bind()[3].matrix3.z_axis.y > 0.5, "a foot's z axis points up");
    }

    #[test]
    fn a_bone_without_length_still_has_a_rotation() {
        let (tree, mut shape) = arm();
        shape.tails = shape.heads.clone();
        for bind in shape.skeleton(&tree).unwrap().bind() {
            assert!((bind.matrix3.determinant() - 1.0).abs() < 1e-5);
        }
        shape.heads.pop();
        assert!(shape.skeleton(&tree).is_err());
    }
}
