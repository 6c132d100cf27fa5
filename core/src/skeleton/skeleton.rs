//! A skeleton: a joint tree and its rest pose.

use std::sync::Arc;

use glam::{Affine3A, Mat3A, Vec3};

use super::{JointTree, Pose, RigJoint, model_from_joints};
use crate::math::{RigidTransform, Rotation, unit};
use crate::{Error, Result};

/// A joint tree with its rest pose: of a body, a character file or a motion file.
///
/// | What | Per joint | Space |
/// |---|---|---|
/// | [`rest_pose`](Self::rest_pose) | rotation and translation, `parent_from_joint` | parent; metres |
/// | [`bind`](Self::bind) | matrix `model_from_joint` without scale; files store its inverse | model; metres |
/// | [`ends`](Self::ends) | far end of the bone, where it is known | joint; metres |
#[derive(Clone, Debug)]
pub struct Skeleton {
    tree: Arc<JointTree>,
    rest_pose: Pose,
    bind: Vec<Affine3A>,
    ends: Vec<Option<Vec3>>,
    humanoid: Vec<(RigJoint, u32)>,
}

/// Bind matrices are not compared: they are the rest pose again, and those read from a file differ in their last bits from
/// those computed by forward kinematics.
impl PartialEq for Skeleton {
    fn eq(&self, other: &Self) -> bool {
        self.tree == other.tree && self.rest_pose == other.rest_pose && self.ends == other.ends
    }
}

impl Skeleton {
    /// From one entry per joint: names, parents, `parent_from_joint` at rest, and `ends`, the far ends of bones in joint
    /// space, metres, where they are known (end sites of BVH, bone lengths of the rig). Several joints may have no parent.
    /// Rotations are normalised.
    ///
    /// # Errors
    /// As [`JointTree::new`]; [`Error::Invalid`] when the lengths differ, a number is not finite or a rotation is zero.
    pub fn new(
        names: Vec<String>,
        parents: Vec<Option<u32>>,
        locals: Vec<RigidTransform>,
        ends: Vec<Option<Vec3>>,
    ) -> Result<Self> {
        Self::from_rest_pose(Arc::new(JointTree::new(names, parents)?), locals, ends)
    }

    /// As [`new`](Self::new), for an existing joint tree.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn from_rest_pose(
        tree: Arc<JointTree>,
        locals: Vec<RigidTransform>,
        ends: Vec<Option<Vec3>>,
    ) -> Result<Self> {
        let (locals, ends) = checked(&tree, locals, ends)?;
        let mut model = Vec::new();
        model_from_joints(tree.parents(), &locals, &mut model);
        let bind = model.into_iter().map(RigidTransform::to_affine).collect();
        Ok(Self { tree, rest_pose: Pose { locals }, bind, ends, humanoid: Vec::new() })
    }

    /// From the bind pose, `model_from_joint` without scale, metres, which becomes the rest pose. `bone_lengths` are the
    /// lengths of bones along their joints' +Y axes, metres, where they are known.
    ///
    /// # Errors
    /// As [`new`](Self::new), and [`Error::Invalid`] naming the joint when a matrix is not a rotation and a translation or a
    /// length is negative.
    pub fn from_bind(
        tree: Arc<JointTree>,
        bind: Vec<Affine3A>,
        bone_lengths: Vec<Option<f32>>,
    ) -> Result<Self> {
        check_bind(&tree, &bind, &bone_lengths)?;
        let model: Vec<RigidTransform> = bind
            .iter()
            .map(|model_from_joint| {
                let (_, rotation, translation) = model_from_joint.to_scale_rotation_translation();
                RigidTransform { rotation: rotation.into(), translation }
            })
            .collect();
        let local = |(&joint, parent): (&RigidTransform, &Option<u32>)| match parent
            .and_then(|p| model.get(p as usize))
        {
            Some(parent) => parent.inverse().then(joint),
            None => joint,
        };
        let locals = model.iter().zip(tree.parents()).map(local).collect();
        let ends = bone_lengths.into_iter().map(|length| length.map(|length| Vec3::Y * length)).collect();
        let (locals, ends) = checked(&tree, locals, ends)?;
        Ok(Self { tree, rest_pose: Pose { locals }, bind, ends, humanoid: Vec::new() })
    }

    /// The same skeleton with a table of the joints that are human bones, as its file states it: joint of the rig, index of the
    /// joint. Entries without a joint are left out.
    #[must_use]
    pub(crate) fn with_humanoid(mut self, humanoid: Vec<(RigJoint, u32)>) -> Self {
        self.humanoid =
            humanoid.into_iter().filter(|(_, joint)| (*joint as usize) < self.tree.len()).collect();
        self
    }

    /// The same skeleton with its joints under other names.
    ///
    /// # Errors
    /// [`Error::Invalid`] when two joints get the same name, or one an empty name.
    pub fn renamed(&self, name: impl Fn(&str) -> String) -> Result<Self> {
        let names = self.names().iter().map(|old| name(old)).collect();
        Ok(Self { tree: Arc::new(JointTree::new(names, self.parents().to_vec())?), ..self.clone() })
    }

    /// The joint tree: names and parents.
    pub fn tree(&self) -> &Arc<JointTree> {
        &self.tree
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.tree.len()
    }

    /// Always false: a skeleton has at least one joint.
    pub fn is_empty(&self) -> bool {
        self.tree.is_empty()
    }

    /// Names, each unique.
    pub fn names(&self) -> &[String] {
        self.tree.names()
    }

    /// Index of each joint's parent, which is less than the joint's own; `None` for a root.
    pub fn parents(&self) -> &[Option<u32>] {
        self.tree.parents()
    }

    /// Index of the joint with this name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.tree.find(name)
    }

    /// Index of the joint with this name, which must exist.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the joint that is missing.
    pub fn require(&self, name: &str) -> Result<usize> {
        self.tree.require(name)
    }

    /// A joint's ancestors, from its parent upwards.
    pub(crate) fn ancestors(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        let parents = self.parents();
        std::iter::successors(parents[joint], |&p| parents[p as usize]).map(|p| p as usize)
    }

    /// The joints that the file's own table calls human bones: joint of the rig, index of the joint. Empty without a table.
    pub fn humanoid(&self) -> &[(RigJoint, u32)] {
        &self.humanoid
    }

    /// The rest pose: `parent_from_joint` of each joint, metres.
    pub fn rest_pose(&self) -> &Pose {
        &self.rest_pose
    }

    /// Rotations of the rest pose, `parent_from_joint`.
    pub fn rest_rotations(&self) -> impl Iterator<Item = Rotation> + '_ {
        self.rest_pose.locals.iter().map(|l| l.rotation)
    }

    /// Far ends of bones in joint space, metres, where they are known.
    pub fn ends(&self) -> &[Option<Vec3>] {
        &self.ends
    }

    /// Length of a joint's bone, metres, where it is known.
    pub fn bone_length(&self, joint: usize) -> Option<f32> {
        self.ends.get(joint)?.map(|end| if end.x == 0.0 && end.z == 0.0 { end.y } else { end.length() })
    }

    /// The bind pose: the matrix `model_from_joint` of each joint, without scale, metres. It equals the rest pose but is as
    /// exact as its file, while [`model_from_joints`](Self::model_from_joints) rounds at every joint of a chain.
    pub fn bind(&self) -> &[Affine3A] {
        &self.bind
    }

    /// The rest pose in model space by forward kinematics: `model_from_joint` of each joint, metres.
    pub fn model_from_joints(&self) -> Vec<RigidTransform> {
        self.rest_pose.model_from_joints(self.parents())
    }
}

/// Tolerance on the entries of RᵀR − I of a joint's rotation R.
const ROTATION_TOLERANCE: f32 = 1e-4;

/// Checks that the bind pose consists of rotations and translations, and that lengths of bones are not negative.
fn check_bind(tree: &JointTree, bind: &[Affine3A], bone_lengths: &[Option<f32>]) -> Result<()> {
    for ((name, bind), length) in tree.names().iter().zip(bind).zip(bone_lengths) {
        let fail = |message: &str| Err(Error::invalid("skeleton", format!("joint `{name}`: {message}")));
        if !bind.is_finite() {
            return fail("bind pose is not finite");
        }
        let m = bind.matrix3;
        let off = (m.transpose() * m - Mat3A::IDENTITY).to_cols_array();
        if off.iter().any(|v| v.abs() > ROTATION_TOLERANCE) || m.determinant() < 0.0 {
            return fail("bind pose must be a rotation and a translation, got scale, shear or a mirror");
        }
        if let Some(length) = *length
            && !(0.0..f32::INFINITY).contains(&length)
        {
            return fail(&format!("expected a bone length of 0 or more, got {length}"));
        }
    }
    Ok(())
}

/// Checks the arrays that accompany a joint tree and normalises rotations.
fn checked(
    tree: &JointTree,
    mut locals: Vec<RigidTransform>,
    ends: Vec<Option<Vec3>>,
) -> Result<(Vec<RigidTransform>, Vec<Option<Vec3>>)> {
    let fail = |message: String| Err(Error::invalid("skeleton", message));
    let count = tree.len();
    if [locals.len(), ends.len()] != [count; 2] {
        let lengths = [locals.len(), ends.len()];
        return fail(format!("{count} names with {lengths:?} transforms, ends"));
    }
    for ((name, local), end) in tree.names().iter().zip(&mut locals).zip(&ends) {
        let end = end.unwrap_or(Vec3::ZERO);
        if !(local.translation.is_finite() && end.is_finite() && local.rotation.is_finite()) {
            return fail(format!("joint `{name}`: rest pose is not finite"));
        }
        if local.rotation.length_squared() < 1e-12 {
            return fail(format!("joint `{name}`: rest rotation is zero"));
        }
        local.rotation = unit(local.rotation);
    }
    Ok((locals, ends))
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
            ("`hips`: rest rotation is zero", |j| j.2[0].rotation = Rotation::from_xyzw(0., 0., 0., 0.)),
        ];
        for (expected, spoil) in cases {
            let mut parts = joints();
            spoil(&mut parts);
            let error = Skeleton::new(parts.0, parts.1, parts.2, parts.3).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
    }

    #[test]
    fn a_bind_pose_that_is_not_rigid_is_refused() {
        let (names, parents, ..) = joints();
        let tree = Arc::new(JointTree::new(names, parents).unwrap());
        let error = |bind: Affine3A, length: Option<f32>| {
            let bind = vec![Affine3A::IDENTITY, bind];
            Skeleton::from_bind(tree.clone(), bind, vec![None, length]).unwrap_err().to_string()
        };
        let mirror = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
        for (bind, length, expected) in [
            (Affine3A::from_scale(Vec3::splat(1.1)), None, "`leg`: bind pose must be a rotation"),
            (mirror, None, "got scale, shear or a mirror"),
            (Affine3A::from_translation(Vec3::NAN), None, "`leg`: bind pose is not finite"),
            (Affine3A::IDENTITY, Some(-0.1), "`leg`: expected a bone length of 0 or more, got -0.1"),
            (Affine3A::IDENTITY, Some(f32::NAN), "got NaN"),
        ] {
            let error = error(bind, length);
            assert!(error.contains(expected), "expected `{expected}` in `{error}`");
        }
    }

    #[test]
    fn joints_get_other_names() {
        let (names, parents, locals, ends) = joints();
        let skeleton = Skeleton::new(names, parents, locals, ends).unwrap();
        let renamed = skeleton.renamed(|name| format!("my_{name}")).unwrap();
        assert_eq!(renamed.names(), ["my_hips", "my_leg"]);
        assert_eq!((renamed.rest_pose(), renamed.bind()), (skeleton.rest_pose(), skeleton.bind()));
        assert!(
            skeleton.renamed(|_| "same".into()).unwrap_err().to_string().contains("`same` is empty or taken")
        );
    }

    #[test]
    fn a_bind_pose_comes_back() {
        let bind = Affine3A::from_rotation_translation(
            Rotation::from_euler(glam::EulerRot::XYZ, 0.3, -0.8, 1.0).into(),
            Vec3::new(0.1, 1.0, -0.3),
        );
        let (names, parents, ..) = joints();
        let tree = Arc::new(JointTree::new(names, parents).unwrap());
        let bind = vec![bind, bind * bind];
        let skeleton = Skeleton::from_bind(tree.clone(), bind.clone(), vec![Some(0.1), None]).unwrap();
        assert_eq!(skeleton.bind(), bind);
        assert_eq!([0, 1, 2].map(|j| skeleton.bone_length(j)), [Some(0.1), None, None]);
        let again =
            Skeleton::from_rest_pose(tree, skeleton.rest_pose().locals.clone(), vec![None; 2]).unwrap();
        for (found, bind) in again.bind().iter().zip(&bind) {
            assert!(found.abs_diff_eq(*bind, 1e-5));
        }
    }
}
