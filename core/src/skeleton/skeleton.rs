//! Joints: hierarchy, which is the same for everybody, and bind pose, which is a body's own.
//!
//! A joint's +Y axis runs along its bone, from the joint to its far end, as Blender's bones do. Its +Z axis leans
//! towards the front of the body (upwards for feet, eyes and jaw, which point forwards), so that left and right
//! are mirror images and a limb bends on one axis.

use glam::{Affine3A, Mat3, Vec3};

use super::rig_joint::{RigJoint, SidedJoint};
use super::written::settle;
use crate::{Error, Result, Side};

/// The hierarchy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Skeleton {
    names: Vec<String>,
    parents: Vec<Option<u32>>,
}

/// One joint of a body in its bind pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name, UE-like: `upperarm_l`.
    pub name: String,
    /// Parent; parents come first.
    pub parent: Option<u32>,
    /// Bind pose: joint space to model space, rotation and translation, metres.
    pub model_from_joint: Affine3A,
    /// Length of the bone, metres.
    pub length: f32,
}

/// Where a body's joints begin and end, metres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BonePositions {
    /// One place per joint.
    pub heads: Vec<Vec3>,
    /// The far ends of the bones.
    pub tails: Vec<Vec3>,
}

impl BonePositions {
    /// Puts elbows and wrists exactly on the line through the shoulder along ±X, where rounding left them a few
    /// micrometres off it: the T-pose is exact.
    pub fn straighten(&mut self, skeleton: &Skeleton) {
        for side in Side::ALL {
            let Some(shoulder) = skeleton.rig_joint(SidedJoint::Upperarm.on(side)) else { continue };
            let Some(&Vec3 { y, z, .. }) = self.heads.get(shoulder) else { continue };
            for (j, name) in skeleton.names().iter().enumerate() {
                let of_side = RigJoint::from_name(name).filter(|joint| joint.side() == Some(side));
                let Some(limb) = of_side.and_then(|joint| joint.sided()).map(SidedJoint::limb) else {
                    continue;
                };
                if !matches!(limb, SidedJoint::Upperarm | SidedJoint::Lowerarm | SidedJoint::Hand) {
                    continue;
                }
                self.heads[j] = self.heads[j].with_y(y).with_z(z);
                if limb != SidedJoint::Hand {
                    self.tails[j] = self.tails[j].with_y(y).with_z(z);
                }
            }
        }
    }
}

impl Skeleton {
    /// A hierarchy from names and parents.
    ///
    /// # Errors
    /// [`Error::Invalid`] when a parent does not come first, a name is empty or appears twice, or there is not
    /// exactly one root.
    pub fn new(names: Vec<String>, parents: Vec<Option<u32>>) -> Result<Self> {
        let fail = |message: String| Err(Error::invalid("skeleton", message));
        if names.len() != parents.len() || names.is_empty() {
            return fail(format!("{} names for {} parents", names.len(), parents.len()));
        }
        for (j, (name, parent)) in names.iter().zip(&parents).enumerate() {
            if name.is_empty() || names[..j].contains(name) {
                return fail(format!("joint {j}: name `{name}` is empty or taken"));
            }
            if parent.map_or(j != 0, |p| p as usize >= j) {
                return fail(format!("joint {name}: parent {parent:?} does not come before {j}"));
            }
        }
        Ok(Self { names, parents })
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// A skeleton is never empty.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// Names, parents first.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Parents; only the first joint has none.
    pub fn parents(&self) -> &[Option<u32>] {
        &self.parents
    }

    /// The joint with this name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }

    /// The bind pose of a body, rounded to what a file gives back of it.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the shape has another number of joints.
    pub fn bind(&self, shape: &BonePositions) -> Result<Vec<Joint>> {
        if shape.heads.len() != self.len() || shape.tails.len() != self.len() {
            return Err(Error::invalid(
                "skeleton shape",
                format!(
                    "expected {} joints, got {} and {}",
                    self.len(),
                    shape.heads.len(),
                    shape.tails.len()
                ),
            ));
        }
        let mut joints: Vec<Joint> = (0..self.len())
            .map(|j| {
                let bone = shape.tails[j] - shape.heads[j];
                let rotation = if self.parents[j].is_none() {
                    Mat3::IDENTITY
                } else {
                    orientation(bone, leaning(&self.names[j]))
                };
                Joint {
                    name: self.names[j].clone(),
                    parent: self.parents[j],
                    model_from_joint: Affine3A::from_mat3_translation(rotation, shape.heads[j]),
                    length: bone.length(),
                }
            })
            .collect();
        settle(&mut joints);
        Ok(joints)
    }
}

/// Where a joint's +Z axis leans to.
fn leaning(name: &str) -> Vec3 {
    match RigJoint::from_name(name) {
        Some(RigJoint::Jaw | RigJoint::Sided(SidedJoint::Foot | SidedJoint::Ball | SidedJoint::Eye, _)) => {
            Vec3::Y
        }
        _ => Vec3::Z,
    }
}

fn orientation(bone: Vec3, lean: Vec3) -> Mat3 {
    let y = bone.try_normalize().unwrap_or(Vec3::Y);
    let off_axis = |v: Vec3| (v - y * v.dot(y)).try_normalize();
    // A bone along its own leaning direction takes the next axis.
    let z =
        if y.dot(lean).abs() < 0.99 { off_axis(lean) } else { off_axis(Vec3::new(lean.z, lean.x, lean.y)) }
            .unwrap_or(Vec3::Z);
    Mat3::from_cols(y.cross(z), y, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arm() -> (Skeleton, BonePositions) {
        let names = ["Root", "upperarm_l", "upperarm_r", "foot_l"].map(String::from).to_vec();
        let skeleton = Skeleton::new(names, vec![None, Some(0), Some(0), Some(0)]).unwrap();
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
        (skeleton, shape)
    }

    #[test]
    fn bones_lie_along_y_and_sides_mirror() {
        let (skeleton, shape) = arm();
        let joints = skeleton.bind(&shape).unwrap();
        for (j, joint) in joints.iter().enumerate() {
            let m = joint.model_from_joint.matrix3;
            assert!((m.determinant() - 1.0).abs() < 1e-5);
            let tip = joint.model_from_joint.transform_point3(Vec3::Y * joint.length);
            if j > 0 {
                assert!((tip - shape.tails[j]).length() < 1e-6, "{} {tip}", joint.name);
            }
        }
        let (l, r) = (joints[1].model_from_joint.matrix3, joints[2].model_from_joint.matrix3);
        let mirror = |v: glam::Vec3A| glam::Vec3A::new(-v.x, v.y, v.z);
        assert!((mirror(l.y_axis) - r.y_axis).length() < 1e-6);
        assert!((mirror(l.z_axis) - r.z_axis).length() < 1e-6);
        assert!((mirror(l.x_axis) + r.x_axis).length() < 1e-6);
        assert!(joints[3].model_from_joint.matrix3.z_axis.y > 0.5, "a foot's z axis points up");
    }

    #[test]
    fn a_bone_without_length_is_still_a_rotation() {
        let (skeleton, mut shape) = arm();
        shape.tails = shape.heads.clone();
        for joint in skeleton.bind(&shape).unwrap() {
            assert!((joint.model_from_joint.matrix3.determinant() - 1.0).abs() < 1e-5);
        }
        shape.heads.pop();
        assert!(skeleton.bind(&shape).is_err());
    }

    #[test]
    fn parents_must_come_first() {
        let names = ["a", "b"].map(String::from).to_vec();
        assert!(Skeleton::new(names.clone(), vec![None, Some(1)]).is_err());
        assert!(Skeleton::new(names.clone(), vec![None, None]).is_err());
        assert!(Skeleton::new(vec!["a".into(), "a".into()], vec![None, Some(0)]).is_err());
        assert!(Skeleton::new(names, vec![None]).is_err());
    }
}
