//! Rigid transforms: a rotation and a translation.

use glam::{Affine3A, Vec3};

use super::Rotation;

/// A rotation followed by a translation, without scale. It takes points from one space to another, and variables are named
/// after both: `a_from_b` takes points from space b to space a. It stands for a 4×4 matrix that multiplies column vectors:
///
/// ```text
///            ┌ r00 r01 r02 tx ┐
/// a_from_b = │ r10 r11 r12 ty │        point_in_a = a_from_b · point_in_b = R · point_in_b + t
///            │ r20 r21 r22 tz │
///            └  0   0   0   1 ┘        columns of R: the axes of b in a; t: the origin of b in a
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidTransform {
    /// Unit quaternion.
    pub rotation: Rotation,
    /// Origin of the inner space in the outer one (of b in a), metres.
    pub translation: Vec3,
}

impl RigidTransform {
    /// Leaves points where they are.
    pub const IDENTITY: Self = Self { rotation: Rotation::IDENTITY, translation: Vec3::ZERO };

    /// The same transform as an affine matrix.
    pub fn to_affine(self) -> Affine3A {
        Affine3A::from_rotation_translation(self.rotation.into(), self.translation)
    }

    /// Composition: `a_from_b.then(b_from_c)` is `a_from_c`, which applies `inner` to a point first, then `self`.
    ///
    /// ```text
    /// ┌ R  t ┐   ┌ R' t'┐   ┌ R·R'  R·t' + t ┐
    /// └ 0  1 ┘ · └ 0  1 ┘ = └  0       1     ┘
    /// ```
    pub fn then(self, inner: Self) -> Self {
        Self {
            rotation: self.rotation * inner.rotation,
            translation: self.translation + self.rotation * inner.translation,
        }
    }

    /// The inverse: `b_from_a` of `a_from_b`, which is `Rᵀ · (point − t)`.
    pub fn inverse(self) -> Self {
        let rotation = self.rotation.conjugate();
        Self { rotation, translation: rotation * -self.translation }
    }
}

/// How far a quaternion's squared length may be from 1 to count as unit length: the rounding error of normalising.
const UNIT_TOLERANCE: f32 = 1e-6;

/// The quaternion scaled to unit length. One that already has unit length is returned unchanged to the last bit, so that
/// writing to a file and reading again changes nothing.
pub(crate) fn unit(rotation: Rotation) -> Rotation {
    if (rotation.length_squared() - 1.0).abs() <= UNIT_TOLERANCE { rotation } else { rotation.normalize() }
}
