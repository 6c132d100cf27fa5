//! A hierarchy of joints and the pose it rests in.

use glam::{Quat, Vec3};

use super::Joint;
use super::Pose;
use crate::math::{RigidTransform, unit};
use crate::{Error, Result};

/// The most joints that a skeleton may have.
pub const MAX_JOINTS: usize = 4096;

/// A hierarchy of joints, ours or that of a motion file, with the local transforms it rests in.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    names: Vec<String>,
    parents: Vec<Option<u32>>,
    pose: Pose,
    ends: Vec<Option<Vec3>>,
}

impl Skeleton {
    /// From parts, one entry per joint. `ends` are the far ends of bones in joint space, metres, where something says
    /// so: end sites of BVH, bone lengths of our rig. Several joints may have no parent.
    ///
    /// # Errors
    /// [`Error::Invalid`] when there is no joint or more than [`MAX_JOINTS`], the lengths differ, a name is empty or
    /// taken, a parent does not stand first, or a number is not finite. Rotations are normalised.
    pub fn new(
        names: Vec<String>,
        parents: Vec<Option<u32>>,
        mut locals: Vec<RigidTransform>,
        ends: Vec<Option<Vec3>>,
    ) -> Result<Self> {
        let fail = |message: String| Err(Error::invalid("skeleton", message));
        let count = names.len();
        if count == 0 || count > MAX_JOINTS {
            return fail(format!("expected 1 to {MAX_JOINTS} joints, got {count}"));
        }
        if [parents.len(), locals.len(), ends.len()] != [count; 3] {
            let lengths = [parents.len(), locals.len(), ends.len()];
            return fail(format!("{count} names with {lengths:?} parents, transforms, ends"));
        }
        let mut seen = std::collections::BTreeSet::new();
        for (j, (name, local)) in names.iter().zip(&mut locals).enumerate() {
            if name.is_empty() || !seen.insert(name) {
                return fail(format!("joint {j}: name `{name}` is empty or taken"));
            }
            if parents[j].is_some_and(|p| p as usize >= j) {
                return fail(format!("joint `{name}`: parent {:?} does not stand before {j}", parents[j]));
            }
            let end = ends[j].unwrap_or(Vec3::ZERO);
            if !(local.translation.is_finite() && end.is_finite() && local.rotation.is_finite()) {
                return fail(format!("joint `{name}`: rest pose is not finite"));
            }
            if local.rotation.length_squared() < 1e-12 {
                return fail(format!("joint `{name}`: rest rotation is zero"));
            }
            local.rotation = unit(local.rotation);
        }
        Ok(Self { names, parents, pose: Pose { locals }, ends })
    }

    /// The bind pose of a body's joints, which is what they rest in; see [`Body::joints`](crate::Body::joints).
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of_joints(joints: &[Joint]) -> Result<Self> {
        let model: Vec<RigidTransform> = joints
            .iter()
            .map(|joint| {
                let (_, rotation, translation) = joint.model_from_joint.to_scale_rotation_translation();
                RigidTransform { rotation, translation }
            })
            .collect();
        let locals = joints
            .iter()
            .zip(&model)
            .map(|(joint, &local)| match joint.parent.and_then(|p| model.get(p as usize)) {
                Some(parent) => parent.inverse().then(local),
                None => local,
            })
            .collect();
        Self::new(
            joints.iter().map(|j| j.name.clone()).collect(),
            joints.iter().map(|j| j.parent).collect(),
            locals,
            joints.iter().map(|j| Some(Vec3::Y * j.length)).collect(),
        )
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// A skeleton is never empty.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// Names, unique.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Parents, which stand before their joints.
    pub fn parents(&self) -> &[Option<u32>] {
        &self.parents
    }

    /// The pose at rest.
    pub fn pose(&self) -> &Pose {
        &self.pose
    }

    /// The rotations at rest, `parent_from_joint`.
    pub fn rotations(&self) -> impl Iterator<Item = Quat> + '_ {
        self.pose.locals.iter().map(|l| l.rotation)
    }

    /// Far ends of bones in joint space, metres, where they are known.
    pub fn ends(&self) -> &[Option<Vec3>] {
        &self.ends
    }

    /// The joint with this name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }

    /// The joint with this name, which has to be there.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the joint that is missing.
    pub fn require(&self, name: &str) -> Result<usize> {
        self.find(name).ok_or_else(|| {
            Error::invalid("skeleton", format!("expected a joint `{name}`, which is not there"))
        })
    }

    /// Where the joints rest: `model_from_joint`.
    pub fn model_from_joints(&self) -> Vec<RigidTransform> {
        self.pose.model_from_joints(&self.parents)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Parts = (Vec<String>, Vec<Option<u32>>, Vec<RigidTransform>, Vec<Option<Vec3>>);

    fn joints() -> Parts {
        let names = ["hips", "leg"].map(String::from).to_vec();
        (names, vec![None, Some(0)], vec![RigidTransform::IDENTITY; 2], vec![None; 2])
    }

    #[test]
    fn names_what_is_wrong() {
        type Case = (&'static str, fn(&mut Parts));
        let cases: &[Case] = &[
            ("expected 1 to", |j| j.0.clear()),
            ("2 names with", |j| j.2.truncate(1)),
            ("`hips` is empty or taken", |j| j.0[1] = "hips".into()),
            ("`leg`: parent Some(1)", |j| j.1[1] = Some(1)),
            ("`leg`: rest pose is not finite", |j| j.2[1].translation.y = f32::NAN),
            ("`hips`: rest rotation is zero", |j| j.2[0].rotation = Quat::from_xyzw(0., 0., 0., 0.)),
        ];
        for (expected, spoil) in cases {
            let mut parts = joints();
            spoil(&mut parts);
            let error = Skeleton::new(parts.0, parts.1, parts.2, parts.3).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }

    #[test]
    fn a_bind_pose_comes_back() {
        let bind = glam::Affine3A::from_rotation_translation(
            Quat::from_euler(glam::EulerRot::XYZ, 0.3, -0.8, 1.0),
            Vec3::new(0.1, 1.0, -0.3),
        );
        let joints: Vec<Joint> = [(None, bind), (Some(0), bind * bind)]
            .into_iter()
            .enumerate()
            .map(|(j, (parent, model_from_joint))| Joint {
                name: format!("j{j}"),
                parent,
                model_from_joint,
                length: 0.1,
            })
            .collect();
        let rest = Skeleton::of_joints(&joints).unwrap();
        for (found, joint) in rest.model_from_joints().iter().zip(&joints) {
            assert!(found.to_affine().abs_diff_eq(joint.model_from_joint, 1e-5));
        }
    }
}
