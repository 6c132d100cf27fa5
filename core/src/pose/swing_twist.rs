//! Swing-twist decomposition: a rotation as a swing of the bone and a twist about it.
//!
//! A joint's +Y axis runs along its bone. A rotation is uniquely a twist about +Y followed by a swing about an axis in the
//! XZ plane, unless it swings the bone by half a turn (Dobrowolski, "Swing-twist decomposition in Clifford algebra", 2015).
//!
//! ```text
//!        +Y (bone)
//!         │ ↻ twist
//!         │
//!         o───── +X            swing axis = swing.x · X + swing.y · Z, its length the angle
//!        ╱
//!      +Z                      rotation = swing · twist
//! ```

use glam::Vec2;

use crate::math::Rotation;

/// `rotation = swing · twist`: where the bone points, and its roll about itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwingTwist {
    /// The swing's axis times its angle, radians: its components along X and Z. Its length is at most π.
    pub swing: Vec2,
    /// Angle about +Y, radians, −π to π.
    pub twist: f32,
}

impl SwingTwist {
    /// Decomposes a unit quaternion. When it swings the bone by half a turn, which leaves the twist open, the twist is 0.
    pub fn of(rotation: Rotation) -> Self {
        let q = if rotation.w < 0.0 { -rotation } else { rotation };
        let along = libm::sqrtf(q.y * q.y + q.w * q.w);
        if along < 1e-7 {
            return Self { swing: Vec2::new(q.x, q.z) * std::f32::consts::PI, twist: 0.0 };
        }
        let (sin, cos) = (q.y / along, q.w / along);
        // swing = q · twist⁻¹, whose y is zero and whose w is `along`.
        let axis = Vec2::new(q.x * cos + q.z * sin, q.z * cos - q.x * sin);
        let length = axis.length();
        let angle = 2.0 * libm::atan2f(length, along);
        let scale = if length < 1e-7 { 2.0 } else { angle / length };
        Self { swing: axis * scale, twist: 2.0 * libm::atan2f(sin, cos) }
    }

    /// The rotation composed of both.
    pub fn rotation(self) -> Rotation {
        Rotation::from_scaled_axis(glam::Vec3::new(self.swing.x, 0.0, self.swing.y))
            * Rotation::from_rotation_y(self.twist)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn swing_times_twist_is_the_rotation(x in -1.0f32..1.0, y in -1.0f32..1.0, z in -1.0f32..1.0, w in -1.0f32..1.0) {
            let q = Rotation::from_xyzw(x, y, z, w);
            prop_assume!(q.length_squared() > 1e-3);
            let q = q.normalize();
            let back = SwingTwist::of(q).rotation();
            // Rounding of f32. Near half turns the twist is ill-conditioned, but the product is not.
            prop_assert!(back.dot(q).abs() > 1.0 - 1e-5, "{q} {back}");
        }

        #[test]
        fn swing_and_twist_are_recovered(x in -1.7f32..1.7, z in -1.7f32..1.7, twist in -3.0f32..3.0) {
            let given = SwingTwist { swing: Vec2::new(x, z), twist };
            let found = SwingTwist::of(given.rotation());
            prop_assert!(found.swing.distance(given.swing) < 1e-4, "{found:?}");
            prop_assert!((found.twist - twist).abs() < 1e-4, "{found:?}");
        }
    }

    #[test]
    fn half_turns_are_finite() {
        for q in [Rotation::from_xyzw(1.0, 0.0, 0.0, 0.0), Rotation::from_xyzw(0.0, 1.0, 0.0, 0.0)] {
            let parts = SwingTwist::of(q);
            assert!(parts.swing.is_finite() && parts.twist.is_finite());
            assert!(parts.rotation().dot(q).abs() > 1.0 - 1e-5);
        }
    }
}
