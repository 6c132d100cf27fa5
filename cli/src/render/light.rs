//! The studio: a bright room with a large softbox as key, a wide fill and two strips behind the figure.

use glam::Vec3;

/// A soft light: radiance falls off around its direction as `1 / (1 + k (1 - cos))^4`.
struct Softbox {
    towards: Vec3,
    radiance: Vec3,
    sharpness: f32,
}

impl Softbox {
    fn shape(&self, d: Vec3) -> f32 {
        let x = 1.0 / (1.0 + self.sharpness * (1.0 - d.dot(self.towards)));
        x * x * x * x
    }
}

/// The surroundings in view space: they turn with the camera, so that every view is lit alike.
pub(crate) struct Studio {
    key: Softbox,
    others: [Softbox; 3],
}

impl Studio {
    pub(crate) fn new() -> Self {
        let towards = |x: f32, y: f32, z: f32| Vec3::new(x, y, z).normalize_or_zero();
        Self {
            key: Softbox {
                towards: towards(-0.62, 0.60, 0.62),
                radiance: Vec3::new(1.0, 0.96, 0.92) * 8.2,
                sharpness: 5.5,
            },
            others: [
                Softbox {
                    towards: towards(0.85, 0.15, 0.55),
                    radiance: Vec3::new(0.86, 0.93, 1.0) * 0.75,
                    sharpness: 2.5,
                },
                Softbox {
                    towards: towards(0.80, 0.35, -0.62),
                    radiance: Vec3::new(0.90, 0.96, 1.0) * 3.4,
                    sharpness: 9.0,
                },
                Softbox {
                    towards: towards(-0.86, 0.25, -0.55),
                    radiance: Vec3::new(1.0, 0.97, 0.94) * 1.8,
                    sharpness: 9.0,
                },
            ],
        }
    }

    /// Radiance from a direction, linear RGB.
    pub(crate) fn radiance(&self, d: Vec3) -> Vec3 {
        let up = 0.5 + 0.5 * d.y;
        let room =
            Vec3::new(0.20, 0.185, 0.175).lerp(Vec3::new(0.37, 0.39, 0.42), up * up * (3.0 - 2.0 * up));
        self.others.iter().fold(room + self.key.radiance * self.key.shape(d), |sum, light| {
            sum + light.radiance * light.shape(d)
        })
    }

    /// How much a direction belongs to the key light, for its highlight and shadow.
    pub(crate) fn key_share(&self, d: Vec3) -> f32 {
        self.key.shape(d)
    }

    /// Highlights: direction and radiance of the lights that show as such.
    pub(crate) fn highlights(&self) -> [(Vec3, Vec3); 2] {
        let rim = &self.others[1];
        [(self.key.towards, self.key.radiance), (rim.towards, rim.radiance)]
    }
}
