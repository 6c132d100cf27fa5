//! Rigid motions: a rotation and a translation.

use glam::{Affine3A, Vec3};

use super::Rotation;

/// A rotation followed by a translation, without scale. It takes points of one space to another; the name of the variable says
/// which, as in `parent_from_joint` or `model_from_joint`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidTransform {
    /// Unit quaternion.
    pub rotation: Rotation,
    /// Metres, in the space that it leads to.
    pub translation: Vec3,
}

impl RigidTransform {
    /// No motion.
    pub const IDENTITY: Self = Self { rotation: Rotation::IDENTITY, translation: Vec3::ZERO };

    /// As a matrix.
    pub fn to_affine(self) -> Affine3A {
        Affine3A::from_rotation_translation(self.rotation.into(), self.translation)
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
}

/// How far a squared length may be from 1 for a quaternion to be of unit length: the rounding of normalising one.
const UNIT_TOLERANCE: f32 = 1e-6;

/// The quaternion at unit length. One that is of unit length already stays as it is to the last bit, so that what is
/// written to a file and read again does not change.
pub(crate) fn unit(rotation: Rotation) -> Rotation {
    if (rotation.length_squared() - 1.0).abs() <= UNIT_TOLERANCE { rotation } else { rotation.normalize() }
}
