//! Volume, mass and body mass index.

use glam::DVec3;
use serde::Serialize;

/// Mean density of a living body with air in its lungs, kg/m³.
///
/// Tissue of 20 % fat has 1,050 kg/m³ (Siri 1961, "Body composition from fluid spaces and density"); the surface
/// also encloses the air left in the lungs after quiet breathing, about 2.5 l in 73 l (functional residual
/// capacity), which leaves 1,015 kg/m³.
pub const BODY_DENSITY: f64 = 1_015.0;

/// What follows from the volume that the surface encloses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mass {
    /// Enclosed volume, m³.
    pub volume_m3: f64,
    /// Volume times [`BODY_DENSITY`], kg.
    pub mass_kg: f64,
    /// Mass over stature squared, kg/m².
    pub bmi: f64,
}

impl Mass {
    /// From enclosed volume (m³) and stature (m).
    pub fn new(volume_m3: f64, stature: f64) -> Self {
        let mass_kg = volume_m3 * BODY_DENSITY;
        Self { volume_m3, mass_kg, bmi: mass_kg / (stature * stature) }
    }
}

/// Volume enclosed by a closed surface of quads, each split along its diagonal 0–2, by the divergence theorem: m³ for
/// positions in metres, positive where faces are counter-clockwise from outside.
pub fn enclosed_volume(at: impl Fn(u32) -> DVec3, quads: &[[u32; 4]]) -> f64 {
    let mut six_times = 0.0;
    for quad in quads {
        let [a, b, c, d] = quad.map(&at);
        // a·(b×c) + a·(c×d) = a·((b − d)×c).
        six_times += a.dot((b - d).cross(c));
    }
    six_times / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_holds_its_volume() {
        let corner = |i: u32| {
            DVec3::new(f64::from(i & 1) * 2.0, f64::from((i >> 1) & 1) * 3.0, f64::from((i >> 2) & 1))
                + DVec3::splat(5.0)
        };
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        assert!((enclosed_volume(corner, &quads) - 6.0).abs() < 1e-12);
    }
}
