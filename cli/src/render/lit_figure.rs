//! A figure with the light that arrives at each of its vertices and at the ground below.

use glam::{Vec2, Vec3};

use super::camera::View;
use super::figure::{Figure, Material, Welded, bounds};
use super::ground::{GROUND_POINTS, GroundLight, ground_points};
use super::light::Studio;
use super::raster::Varying;
use super::visibility::{Occluder, Visibility, directions};

/// A figure with what each of its vertices sees of the surroundings.
pub(crate) struct LitFigure {
    pub(super) figure: Figure,
    welded: Vec<Welded>,
    /// First visibility point of each part; the ground's points follow the last part's.
    firsts: Vec<usize>,
    ground_first: usize,
    ground_centre: Vec2,
    eyeballs: Vec<Eyeball>,
    directions: Vec<Vec3>,
    visibility: Visibility,
}

/// Ellipsoid around one eye.
struct Eyeball {
    centre: Vec3,
    radii: Vec3,
}

impl LitFigure {
    /// Looks from every vertex into `quality` directions (64 is rough, 256 fine).
    pub(crate) fn new(figure: Figure, quality: usize) -> Self {
        let welded: Vec<_> = figure.parts.iter().map(Welded::new).collect();
        let (low, high) = figure.bounds();
        let ground_centre = Vec2::new(low.x + high.x, low.z + high.z) * 0.5;
        let mut points = Vec::new();
        let mut firsts = Vec::new();
        for part in &welded {
            firsts.push(points.len());
            points.extend(part.positions.iter().copied().zip(part.normals.iter().copied()));
        }
        let ground_first = points.len();
        points.extend(ground_points(ground_centre).map(|p| (p, Vec3::Y)));
        let directions = directions(quality);
        let visibility = {
            let skin = figure.parts.iter().find(|p| p.material == Material::Skin).or(figure.parts.first());
            let (positions, triangles): (&[Vec3], &[[u32; 3]]) =
                skin.map_or((&[], &[]), |part| (&part.positions, &part.triangles));
            Visibility::new(&Occluder { positions, triangles }, &points, &directions)
        };
        let eyeballs = eyeballs(&figure);
        Self { figure, welded, firsts, ground_first, ground_centre, eyeballs, directions, visibility }
    }

    /// Light on every vertex of a part, as seen in a view.
    pub(super) fn varyings(&self, part: usize, view: View, studio: &Studio) -> Vec<Varying> {
        let turn = view.view_from_model();
        let welded = &self.welded[part];
        let count = welded.positions.len();
        let mut sums = [(); 5].map(|()| vec![0.0_f32; count]);
        let weight = 4.0 / self.directions.len() as f32;
        let mut key_total = 0.0;
        for (d, direction) in self.directions.iter().enumerate() {
            let seen = turn * *direction;
            let radiance = studio.radiance(seen);
            let key = studio.key_share(seen);
            key_total += key;
            for i in 0..count {
                if !self.visibility.is_open(d, self.firsts[part] + i) {
                    continue;
                }
                let cos = welded.normals[i].dot(*direction);
                // Light that comes up from the ground fades where the figure itself shades the ground.
                let bounce = if direction.y < 0.0 {
                    let h = welded.positions[i].y.max(0.0);
                    (h + 0.01) / (h + 0.10)
                } else {
                    1.0
                };
                let share = cos * weight * bounce;
                for (sum, value) in sums.iter_mut().zip([radiance.x, radiance.y, radiance.z]) {
                    sum[i] += share * value;
                }
                sums[3][i] += key;
                sums[4][i] += cos * weight;
            }
        }
        let material = self.figure.parts[part].material;
        // Light travels below the skin, red the furthest; this also hides the limits of the depth maps. The last two,
        // shares of what is open, are smoothed alike.
        const REACH: [f32; 5] = [0.012, 0.007, 0.005, 0.006, 0.006];
        let steps =
            REACH.map(|reach| if material == Material::Skin { welded.diffusion_steps(reach) } else { 1 });
        for (sum, steps) in sums.iter_mut().zip(steps) {
            for _ in 0..steps {
                *sum = welded.diffuse(sum);
            }
        }
        let key_total = key_total.max(1e-6);
        self.figure.parts[part]
            .positions
            .iter()
            .zip(&welded.welded_from_vertex)
            .map(|(position, w)| {
                let w = *w as usize;
                Varying {
                    position: turn * *position,
                    normal: turn * welded.normals[w],
                    light: Vec3::new(sums[0][w], sums[1][w], sums[2][w]),
                    local: self.in_eyeball(material, *position),
                    open: Vec3::new((sums[3][w] / key_total).min(1.0), sums[4][w].min(1.0), 0.0),
                }
            })
            .collect()
    }

    fn in_eyeball(&self, material: Material, position: Vec3) -> Vec3 {
        if !matches!(material, Material::Eye | Material::Lashes) {
            return Vec3::ZERO;
        }
        let distance = |eye: &Eyeball| (eye.centre - position).length_squared();
        let nearest = self.eyeballs.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.map_or(Vec3::Z, |eye| (position - eye.centre) / eye.radii)
    }

    /// Share of the light that reaches the ground in a view.
    pub(super) fn ground(&self, view: View, studio: &Studio) -> GroundLight {
        let turn = view.view_from_model();
        let mut light = vec![0.0_f32; GROUND_POINTS];
        let mut total = 0.0;
        for (d, direction) in self.directions.iter().enumerate().filter(|(_, d)| d.y > 0.02) {
            let share = direction.y * studio.radiance(turn * *direction).element_sum();
            total += share;
            for (k, light) in light.iter_mut().enumerate() {
                if self.visibility.is_open(d, self.ground_first + k) {
                    *light += share;
                }
            }
        }
        for value in &mut light {
            *value /= total.max(1e-6);
        }
        GroundLight::new(self.ground_centre, light)
    }
}

fn eyeballs(figure: &Figure) -> Vec<Eyeball> {
    let eyes = figure.parts.iter().filter(|part| part.material == Material::Eye);
    let points: Vec<Vec3> = eyes.flat_map(|part| part.positions.iter().copied()).collect();
    let (low, high) = bounds(points.iter().copied());
    let middle = (low.x + high.x) * 0.5;
    [false, true]
        .into_iter()
        .filter_map(|left| {
            let (low, high) = bounds(points.iter().copied().filter(|p| (p.x > middle) == left));
            let radii = (high - low) * 0.5;
            (radii.min_element() > 1e-4).then(|| Eyeball { centre: (low + high) * 0.5, radii })
        })
        .collect()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::render::figure::tests::sphere;

    pub(in crate::render) fn ball() -> LitFigure {
        let part = sphere(Vec3::new(0.0, 0.9, 0.0), 0.9, 32);
        LitFigure::new(Figure::new(vec![part], Vec3::new(0.5, 0.4, 0.3)).unwrap(), 64)
    }

    #[test]
    fn the_ground_darkens_under_the_figure() {
        let ground = ball().ground(View::Front, &Studio::new());
        assert!(ground.at(Vec2::ZERO) < 0.5);
        assert!(ground.at(Vec2::new(0.99, 0.0)) > 0.97);
        assert!((ground.at(Vec2::new(3.0, 0.0)) - 1.0).abs() < 1e-6);
    }
}
