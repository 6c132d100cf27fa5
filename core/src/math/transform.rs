//! Rigid motions: a rotation and a translation.

use glam::{Affine3A, Quat, Vec3};

use crate::space::Space;

/// A rotation followed by a translation, without scale. It takes points of one space to another; the name of the variable says
/// which, as in `parent_from_joint` or `model_from_joint`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidTransform {
    /// Unit quaternion.
    pub rotation: Quat,
    /// Metres, in the space that it leads to.
    pub translation: Vec3,
}

impl RigidTransform {
    /// No motion.
    pub const IDENTITY: Self = Self { rotation: Quat::IDENTITY, translation: Vec3::ZERO };

    /// As a matrix.
    pub fn to_affine(self) -> Affine3A {
        Affine3A::from_rotation_translation(self.rotation, self.translation)
    }

    /// `self` after `inner`: `a_from_b.then(b_from_c)` is `a_from_c`.
    pub fn then(self, inner: Self) -> Self {
        Self {
            rotation: self.rotation * inner.rotation,
            translation: self.translation + self.rotation * inner.translation,
        }
    }

    /// The motion back: of `a_from_b`, `b_from_a`.
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
