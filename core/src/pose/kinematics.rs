//! Local transforms of joints, and forward kinematics.

use glam::{Affine3A, Quat, Vec3};

use crate::space::Space;

/// A joint's transform to its parent: `parent_from_joint`, a rigid motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// Unit quaternion.
    pub rotation: Quat,
    /// Metres, in the parent's space.
    pub translation: Vec3,
}

impl Local {
    /// No motion.
    pub const IDENTITY: Self = Self { rotation: Quat::IDENTITY, translation: Vec3::ZERO };

    /// As a matrix.
    pub fn to_affine(self) -> Affine3A {
        Affine3A::from_rotation_translation(self.rotation, self.translation)
    }

    /// `self` after `inner`: `parent_from_joint · joint_from_inner`.
    pub fn then(self, inner: Self) -> Self {
        Self {
            rotation: self.rotation * inner.rotation,
            translation: self.translation + self.rotation * inner.translation,
        }
    }

    /// The motion back: `joint_from_parent`.
    pub fn inverse(self) -> Self {
        let rotation = self.rotation.conjugate();
        Self { rotation, translation: rotation * -self.translation }
    }

    /// A joint's transform to the model, ours, in a space: see [`Space::model_from_joint`].
    pub fn model_from_joint_in(self, space: Space) -> Self {
        let (rotation, translation) = space.model_from_joint(self.rotation, self.translation);
        Self { rotation, translation }
    }

    /// A joint's transform to its parent, ours, in a space; the model is the parent of a joint without one.
    pub fn parent_from_joint_in(self, space: Space, parent: Option<u32>) -> Self {
        if parent.is_none() {
            return self.model_from_joint_in(space);
        }
        let (rotation, translation) = space.parent_from_joint(self.rotation, self.translation);
        Self { rotation, translation }
    }

    /// A joint's transform to its parent in a space, as ours.
    pub fn parent_from_joint_out_of(self, space: Space, parent: Option<u32>) -> Self {
        let (rotation, translation) = match parent {
            None => space.model_from_joint_to_ours(self.rotation, self.translation),
            Some(_) => space.parent_from_joint(self.rotation, self.translation),
        };
        Self { rotation, translation }
    }
}

/// How far a squared length may be from 1 for a quaternion to be of unit length: the rounding of normalising one.
const UNIT_TOLERANCE: f32 = 1e-6;

/// The quaternion at unit length. One that is of unit length already stays as it is to the last bit, so that what is
/// written to a file and read again does not change.
pub(crate) fn unit(rotation: Quat) -> Quat {
    if (rotation.length_squared() - 1.0).abs() <= UNIT_TOLERANCE { rotation } else { rotation.normalize() }
}

/// One local transform per joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// `parent_from_joint`, in the order of the joints.
    pub locals: Vec<Local>,
}

impl Pose {
    /// Where the joints are: `model_from_joint` of each, by [`model_from_joints`].
    pub fn model_from_joints(&self, parents: &[Option<u32>]) -> Vec<Local> {
        let mut out = Vec::with_capacity(self.locals.len());
        model_from_joints(parents, &self.locals, &mut out);
        out
    }
}

/// Forward kinematics: fills `out` with `model_from_joint` of each joint. Parents stand before their joints; a
/// parent that does not is taken for none.
pub fn model_from_joints(parents: &[Option<u32>], locals: &[Local], out: &mut Vec<Local>) {
    out.clear();
    for (parent, local) in parents.iter().zip(locals) {
        let above = parent.and_then(|p| out.get(p as usize).copied());
        out.push(above.map_or(*local, |above: Local| above.then(*local)));
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn a_chain_ends_at_the_same_place_in_every_space() {
        let step =
            |angle| Local { rotation: Quat::from_rotation_x(angle), translation: Vec3::new(1.0, 2.0, 3.0) };
        let (root, child) = (step(0.3), step(-1.1));
        for space in [Space::YUp, Space::ZUp, Space::Unity] {
            let there = [root.parent_from_joint_in(space, None), child.parent_from_joint_in(space, Some(0))];
            let end = there[0].then(there[1]);
            let expected = root.then(child).model_from_joint_in(space);
            assert!(end.translation.distance(expected.translation) < 1e-6, "{space:?}");
            assert!(end.rotation.dot(expected.rotation).abs() > 1.0 - 1e-6, "{space:?}");
            let back = there[0].parent_from_joint_out_of(space, None);
            assert!(back.translation == root.translation && back.rotation.dot(root.rotation) > 1.0 - 1e-6);
            assert_eq!(there[1].parent_from_joint_out_of(space, Some(0)), child);
        }
    }

    #[test]
    fn an_elbow_bent_by_a_right_angle() {
        let step = Local { rotation: Quat::IDENTITY, translation: Vec3::X };
        let bent = Local { rotation: Quat::from_rotation_z(FRAC_PI_2), ..step };
        let pose = Pose { locals: vec![step, bent, step] };
        let joints = pose.model_from_joints(&[None, Some(0), Some(1)]);
        assert!(joints[2].translation.distance(Vec3::new(2.0, 1.0, 0.0)) < 1e-6);
        let matrix = step.to_affine() * bent.to_affine() * step.to_affine();
        assert!((matrix.translation - joints[2].to_affine().translation).length() < 1e-6);
        let back = joints[2].inverse().then(joints[2]);
        assert!(back.translation.length() < 1e-6 && back.rotation.angle_between(Quat::IDENTITY) < 1e-3);
    }
}
