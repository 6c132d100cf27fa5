//! Rigid transforms: a rotation and a translation.

use glam::{Affine3A, DAffine3, DMat3, DQuat, DVec3, Vec3};

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

    /// The same transform as an affine matrix in double precision.
    pub(crate) fn to_affine_f64(self) -> DAffine3 {
        DAffine3::from_rotation_translation(self.rotation.into(), self.translation.as_dvec3())
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

/// A [`RigidTransform`] in double precision, for what rounding must not add up in: chains of a file's joints, and a joint's two
/// poses, which cancel where it rests.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RigidTransformF64 {
    /// Unit quaternion.
    pub(crate) rotation: DQuat,
    /// Metres, or the unit of a file.
    pub(crate) translation: DVec3,
}

impl RigidTransformF64 {
    /// A transform without its scale and shear: the origin stays and so does the direction of the X axis, the Y axis is made
    /// orthogonal to it.
    pub(crate) fn without_scale(transform: &DAffine3) -> Self {
        let x = transform.matrix3.x_axis.try_normalize().unwrap_or(DVec3::X);
        let y = (transform.matrix3.y_axis - x * x.dot(transform.matrix3.y_axis)).try_normalize();
        let y = y.unwrap_or_else(|| x.any_orthonormal_vector());
        let rotation = DQuat::from_mat3(&DMat3::from_cols(x, y, x.cross(y)));
        Self { rotation, translation: transform.translation }
    }

    /// The same transform as an affine matrix.
    pub(crate) fn to_affine(self) -> DAffine3 {
        DAffine3::from_rotation_translation(self.rotation, self.translation)
    }

    /// Composition, as [`RigidTransform::then`].
    pub(crate) fn then(self, inner: Self) -> Self {
        Self {
            rotation: self.rotation * inner.rotation,
            translation: self.translation + self.rotation * inner.translation,
        }
    }

    /// The inverse, as [`RigidTransform::inverse`].
    pub(crate) fn inverse(self) -> Self {
        let rotation = self.rotation.conjugate();
        Self { rotation, translation: rotation * -self.translation }
    }

    /// `parent_from_joint` of `model_from_joint` and `model_from_parent`.
    pub(crate) fn relative_to(self, parent: Self) -> Self {
        let back = parent.rotation.conjugate();
        Self { rotation: back * self.rotation, translation: back * (self.translation - parent.translation) }
    }

    /// Rounded to single precision.
    pub(crate) fn rounded(self) -> RigidTransform {
        RigidTransform { rotation: self.rotation.into(), translation: self.translation.as_vec3() }
    }
}

/// How far a quaternion's squared length may be from 1 to count as unit length: the rounding error of normalising.
const UNIT_TOLERANCE: f32 = 1e-6;

/// The quaternion scaled to unit length. One that already has unit length is returned unchanged to the last bit, so that
/// writing to a file and reading again changes nothing.
pub(crate) fn unit(rotation: Rotation) -> Rotation {
    if (rotation.length_squared() - 1.0).abs() <= UNIT_TOLERANCE { rotation } else { rotation.normalize() }
}
