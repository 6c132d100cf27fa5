//! Views and the camera: a long lens seven metres away, or more for motions that need the room, whose axis stays level, as on an architect's shift camera,
//! so that uprights stay upright and the same person has the same height in every view.

use glam::{Mat3, Vec2, Vec3};

/// Direction and framing of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum View {
    /// From the front.
    Front,
    /// From the person's left.
    Side,
    /// From behind.
    Back,
    /// Turned by 35 degrees.
    ThreeQuarter,
    /// The head from the front.
    Face,
    /// The head, turned by 35 degrees.
    FaceThreeQuarter,
    /// The head from the person's left.
    Profile,
    /// From above, the person's left to the right.
    #[value(skip)]
    Above,
}

impl View {
    /// Angle about +Y that turns the figure into this view, in radians.
    pub(crate) fn yaw(self) -> f32 {
        match self {
            Self::Front | Self::Face | Self::Above => 0.0,
            Self::Side | Self::Profile => -std::f32::consts::FRAC_PI_2,
            Self::Back => std::f32::consts::PI,
            Self::ThreeQuarter | Self::FaceThreeQuarter => -0.611,
        }
    }

    /// Whether only the head is framed.
    pub(crate) fn is_head(self) -> bool {
        matches!(self, Self::Face | Self::FaceThreeQuarter | Self::Profile)
    }

    /// `view_from_model`: turns model space into the view's space, whose +Z points at the camera.
    pub(crate) fn view_from_model(self) -> Mat3 {
        if self == Self::Above {
            return Mat3::from_cols(Vec3::X, Vec3::Z, Vec3::NEG_Y);
        }
        let (sin, cos) = (libm::sinf(self.yaw()), libm::cosf(self.yaw()));
        Mat3::from_cols(Vec3::new(cos, 0.0, -sin), Vec3::Y, Vec3::new(sin, 0.0, cos))
    }
}

/// Distance from the camera to the plane z = 0 for a single figure, in metres.
pub(super) const DISTANCE: f32 = 7.0;

/// A level camera in view space at (x, height, distance) that looks along -Z.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    /// Where the optical axis meets the plane z = 0, metres.
    pub(crate) axis: Vec2,
    /// Where the optical axis meets the picture, pixels from the top left corner.
    pub(crate) centre: Vec2,
    /// Pixels per metre in the plane z = 0.
    pub(crate) scale: f32,
    /// Distance to the plane z = 0, metres.
    pub(crate) distance: f32,
}

impl Camera {
    /// Pixel and distance along the axis (metres, smaller is nearer) of a point in view space.
    pub(crate) fn project(&self, p: Vec3) -> Vec3 {
        let distance = (self.distance - p.z).max(0.1);
        let zoom = self.scale * self.distance / distance;
        Vec3::new(
            self.centre.x + zoom * (p.x - self.axis.x),
            self.centre.y - zoom * (p.y - self.axis.y),
            distance,
        )
    }

    /// The camera's place in view space.
    pub(crate) fn eye(&self) -> Vec3 {
        self.axis.extend(self.distance)
    }

    /// The point of the ground, (x, z) in view space, that a pixel shows, if it looks below the horizon.
    pub(crate) fn ground(&self, pixel: Vec2) -> Option<Vec2> {
        let down = pixel.y - self.centre.y;
        if down <= 0.0 || self.axis.y <= 0.0 {
            return None;
        }
        let distance = self.scale * self.distance * self.axis.y / down;
        let x = self.axis.x + (pixel.x - self.centre.x) * distance / (self.scale * self.distance);
        Some(Vec2::new(x, self.distance - distance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_turn_the_right_way() {
        // The character's left is +X: in the side view it looks at the camera, the face then points to the picture's left.
        let side = View::Side.view_from_model();
        assert!((side * Vec3::X - Vec3::Z).length() < 1e-6);
        assert!((side * Vec3::Z + Vec3::X).length() < 1e-6);
        let back = View::Back.view_from_model();
        assert!((back * Vec3::Z + Vec3::Z).length() < 1e-6);
        // From above the head is nearest, the left hand on the right, the toes below.
        let above = View::Above.view_from_model();
        assert_eq!([Vec3::Y, Vec3::X, Vec3::Z].map(|v| above * v), [Vec3::Z, Vec3::X, Vec3::NEG_Y]);
    }

    #[test]
    fn ground_inverts_projection() {
        let camera = Camera {
            axis: Vec2::new(0.1, 1.0),
            centre: Vec2::new(200.0, 150.0),
            scale: 300.0,
            distance: 9.0,
        };
        let pixel = camera.project(Vec3::new(-0.4, 0.0, 0.7));
        let ground = camera.ground(pixel.truncate()).unwrap();
        assert!((ground - Vec2::new(-0.4, 0.7)).length() < 1e-4);
        assert!(camera.ground(Vec2::new(0.0, 10.0)).is_none());
    }
}
