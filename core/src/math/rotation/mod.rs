//! Rotations with the same bits on every processor.
//!
//! glam's `f32` quaternion has an SSE2, a NEON and a scalar implementation. They sum in different orders, and NEON fuses
//! multiplications with additions, so that results differ between machines in their last bits. This type computes in
//! scalars, rounds every operation, and keeps the order that glam uses on x86-64.

use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::fmt;
use std::ops::{Mul, MulAssign, Neg};

use glam::{DQuat, EulerRot, Mat3, Quat, Vec3};

/// A rotation in space as a unit quaternion `x i + y j + z k + w`, right-handed. A quaternion and its negative are the same
/// rotation.
///
/// `a * b` applies `b`, then `a`; `a * v` rotates the vector `v`. Constructors expect finite numbers and unit vectors; no
/// method normalises its result unless it says so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    /// X of the axis times the sine of half the angle.
    pub x: f32,
    /// Y of the axis times the sine of half the angle.
    pub y: f32,
    /// Z of the axis times the sine of half the angle.
    pub z: f32,
    /// The cosine of half the angle.
    pub w: f32,
}

impl Rotation {
    /// No rotation.
    pub const IDENTITY: Self = Self::from_xyzw(0.0, 0.0, 0.0, 1.0);

    /// The quaternion of these components.
    pub const fn from_xyzw(x: f32, y: f32, z: f32, w: f32) -> Self {
        Self { x, y, z, w }
    }

    /// The quaternion of the components x, y, z, w.
    pub const fn from_array([x, y, z, w]: [f32; 4]) -> Self {
        Self { x, y, z, w }
    }

    /// The components x, y, z, w.
    pub const fn to_array(self) -> [f32; 4] {
        [self.x, self.y, self.z, self.w]
    }

    /// Rotation about +X, radians.
    pub fn from_rotation_x(angle: f32) -> Self {
        let (sin, cos) = libm::sincosf(angle * 0.5);
        Self::from_xyzw(sin, 0.0, 0.0, cos)
    }

    /// Rotation about +Y, radians.
    pub fn from_rotation_y(angle: f32) -> Self {
        let (sin, cos) = libm::sincosf(angle * 0.5);
        Self::from_xyzw(0.0, sin, 0.0, cos)
    }

    /// Rotation about +Z, radians.
    pub fn from_rotation_z(angle: f32) -> Self {
        let (sin, cos) = libm::sincosf(angle * 0.5);
        Self::from_xyzw(0.0, 0.0, sin, cos)
    }

    /// Rotation about a unit axis, radians.
    pub fn from_axis_angle(axis: Vec3, angle: f32) -> Self {
        let (sin, cos) = libm::sincosf(angle * 0.5);
        let v = axis * sin;
        Self::from_xyzw(v.x, v.y, v.z, cos)
    }

    /// Rotation about the direction of `v` by its length, radians.
    pub fn from_scaled_axis(v: Vec3) -> Self {
        let angle = v.length();
        if angle == 0.0 { Self::IDENTITY } else { Self::from_axis_angle(v / angle, angle) }
    }

    /// The shortest rotation that takes one unit vector to another, normalised; for opposite vectors, half a turn about any
    /// axis at a right angle to them.
    pub fn from_rotation_arc(from: Vec3, to: Vec3) -> Self {
        const PARALLEL: f32 = 1.0 - 2.0 * f32::EPSILON;
        let cos = from.dot(to);
        if cos > PARALLEL {
            Self::IDENTITY
        } else if cos < -PARALLEL {
            Self::from_axis_angle(from.any_orthonormal_vector(), PI)
        } else {
            let axis = from.cross(to);
            Self::from_xyzw(axis.x, axis.y, axis.z, 1.0 + cos).normalize()
        }
    }

    /// Rotation by three angles about the axes of `order`, radians.
    pub fn from_euler(order: EulerRot, a: f32, b: f32, c: f32) -> Self {
        // glam computes this in scalars on every processor.
        Quat::from_euler(order, a, b, c).into()
    }

    /// The rotation of an orthonormal, right-handed matrix.
    pub fn from_mat3(matrix: &Mat3) -> Self {
        // glam computes this in scalars on every processor.
        Quat::from_mat3(matrix).into()
    }

    /// The axis times the angle, radians; the angle is in 0..=2π.
    pub fn to_scaled_axis(self) -> Vec3 {
        let v = self.vector();
        let sin = v.length();
        if sin >= 1e-8 { v / sin * (2.0 * libm::atan2f(sin, self.w)) } else { Vec3::ZERO }
    }

    /// The components x, y, z: the axis times the sine of half the angle.
    pub fn vector(self) -> Vec3 {
        Vec3::new(self.x, self.y, self.z)
    }

    /// The inverse of a unit quaternion.
    pub fn conjugate(self) -> Self {
        Self::from_xyzw(-self.x, -self.y, -self.z, self.w)
    }

    /// Dot product of the components: the cosine of half the angle between two rotations, or its negative.
    pub fn dot(self, other: Self) -> f32 {
        (self.x * other.x + self.z * other.z) + (self.y * other.y + self.w * other.w)
    }

    /// The quaternion's length squared, 1 but for rounding.
    pub fn length_squared(self) -> f32 {
        self.dot(self)
    }

    /// The quaternion scaled to unit length; not finite when all components are zero.
    pub fn normalize(self) -> Self {
        let length = self.length_squared().sqrt();
        Self::from_xyzw(self.x / length, self.y / length, self.z / length, self.w / length)
    }

    /// Whether all components are finite.
    pub fn is_finite(self) -> bool {
        self.to_array().iter().all(|c| c.is_finite())
    }

    /// Whether no component differs by more than `tolerance`. `q` and `-q` differ, although they are the same rotation.
    pub fn abs_diff_eq(self, other: Self, tolerance: f32) -> bool {
        self.to_array().iter().zip(other.to_array()).all(|(a, b)| (a - b).abs() <= tolerance)
    }

    /// Angle between two rotations, radians, 0 to π; near 0 it is accurate to about 1e-3 only.
    pub fn angle_between(self, other: Self) -> f32 {
        arc_cosine(self.dot(other).abs()) * 2.0
    }

    /// Spherical linear interpolation along the shorter arc, from `self` at `t` = 0 to `end` at 1.
    pub fn slerp(self, end: Self, t: f32) -> Self {
        let cos = self.dot(end);
        let (end, cos) = if cos < 0.0 { (-end, -cos) } else { (end, cos) };
        if cos > 1.0 - f32::EPSILON {
            // The sine of the angle is too close to zero to divide by.
            return self.sum(1.0 - t, end, t).normalize();
        }
        let angle = arc_cosine(cos);
        let (from_self, from_end, whole) = (sine(angle * (1.0 - t)), sine(angle * t), sine(angle));
        let sum = self.sum(from_self, end, from_end);
        Self::from_xyzw(sum.x / whole, sum.y / whole, sum.z / whole, sum.w / whole)
    }

    /// `self · a + other · b` by component, not normalised.
    pub(crate) fn sum(self, a: f32, other: Self, b: f32) -> Self {
        Self::from_xyzw(
            self.x * a + other.x * b,
            self.y * a + other.y * b,
            self.z * a + other.z * b,
            self.w * a + other.w * b,
        )
    }
}

impl Mul for Rotation {
    type Output = Self;

    fn mul(self, b: Self) -> Self {
        let a = self;
        Self::from_xyzw(
            (a.w * b.x + a.x * b.w) + (a.y * b.z - a.z * b.y),
            (a.w * b.y - a.x * b.z) + (a.y * b.w + a.z * b.x),
            (a.w * b.z + a.x * b.y) + (a.z * b.w - a.y * b.x),
            (a.w * b.w - a.x * b.x) + (-(a.y * b.y) - a.z * b.z),
        )
    }
}

impl MulAssign for Rotation {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Mul<Vec3> for Rotation {
    type Output = Vec3;

    fn mul(self, v: Vec3) -> Vec3 {
        let b = self.vector();
        (v * (self.w * self.w - b.dot(b)) + b * (v.dot(b) * 2.0)) + b.cross(v) * (self.w * 2.0)
    }
}

impl Neg for Rotation {
    type Output = Self;

    /// The same rotation as the opposite quaternion.
    fn neg(self) -> Self {
        Self::from_xyzw(-self.x, -self.y, -self.z, -self.w)
    }
}

impl Default for Rotation {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl From<Quat> for Rotation {
    fn from(q: Quat) -> Self {
        Self::from_array(q.to_array())
    }
}

impl From<Rotation> for Quat {
    fn from(rotation: Rotation) -> Self {
        Self::from_array(rotation.to_array())
    }
}

impl From<DQuat> for Rotation {
    /// Rounded to `f32`.
    fn from(q: DQuat) -> Self {
        Self::from_array(q.to_array().map(|c| c as f32))
    }
}

impl From<Rotation> for DQuat {
    fn from(rotation: Rotation) -> Self {
        Self::from_array(rotation.to_array().map(f64::from))
    }
}

impl fmt::Display for Rotation {
    /// The components in brackets: `[x, y, z, w]`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}, {}, {}, {}]", self.x, self.y, self.z, self.w)
    }
}

/// The arc cosine of a number from −1 to 1, in radians, accurate to about 1e-7: the minimax polynomial of degree 7 of
/// DirectXMath's `XMScalarACos`.
fn arc_cosine(cos: f32) -> f32 {
    #[expect(clippy::approx_constant, reason = "a coefficient, which happens to be near π/2")]
    const COEFFICIENTS: [f32; 8] = [
        -0.001_262_491_1,
        0.006_670_09,
        -0.017_088_126,
        0.030_891_88,
        -0.050_174_303,
        0.088_978_99,
        -0.214_598_8,
        1.570_796_3,
    ];
    let x = cos.abs();
    let angle = horner(&COEFFICIENTS, x) * (1.0 - x).max(0.0).sqrt();
    if cos >= 0.0 { angle } else { PI - angle }
}

/// The sine of an angle in radians, accurate to about 1e-7: the minimax polynomial of degree 11 of DirectXMath's `XMVectorSin`.
fn sine(angle: f32) -> f32 {
    const COEFFICIENTS: [f32; 6] =
        [-2.388_985_9e-8, 2.752_556_2e-6, -0.000_198_408_74, 0.008_333_331, -0.166_666_67, 1.0];
    const TURNS_PER_RADIAN: f32 = 0.159_154_94;
    let x = angle - TAU * (angle * TURNS_PER_RADIAN).round_ties_even();
    let x = if x.abs() <= FRAC_PI_2 { x } else { PI.copysign(x) - x };
    horner(&COEFFICIENTS, x * x) * x
}

/// Evaluates a polynomial, highest power first, by Horner's scheme.
fn horner(coefficients: &[f32], x: f32) -> f32 {
    coefficients[1..].iter().fold(coefficients[0], |sum, c| sum * x + c)
}

#[cfg(test)]
mod tests;
