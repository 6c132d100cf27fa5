//! Which directions of the surroundings each point of a figure sees: one small depth map per direction.

use glam::{Vec2, Vec3};

use super::parallel::map_parallel;
use super::raster::{Window, depth_map};

/// Side of a depth map in texels. A person with arms spread spans 2 m: a texel is then 5 mm.
const MAP_SIZE: usize = 400;

/// Directions spread evenly over the sphere (Fibonacci spiral), from +Y down to -Y.
pub(crate) fn directions(count: usize) -> Vec<Vec3> {
    // pi (3 - sqrt 5)
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    (0..count)
        .map(|i| {
            let y = 1.0 - (2.0 * i as f64 + 1.0) / count as f64;
            let r = (1.0 - y * y).sqrt();
            let turn = GOLDEN_ANGLE * i as f64;
            Vec3::new((r * libm::cos(turn)) as f32, y as f32, (r * libm::sin(turn)) as f32)
        })
        .collect()
}

/// What stands in the way of light.
pub(crate) struct Occluder<'a> {
    pub(crate) positions: &'a [Vec3],
    pub(crate) triangles: &'a [[u32; 3]],
}

/// For every direction one flag per point: the point sees the surroundings there.
pub(crate) struct Visibility {
    /// `open[direction][point / 64]`, bit `point % 64`.
    open: Vec<Vec<u64>>,
}

impl Visibility {
    /// Looks from every point, `(position, normal)`, into every direction. Directions behind a point's own surface
    /// are closed.
    pub(crate) fn new(occluder: &Occluder<'_>, points: &[(Vec3, Vec3)], directions: &[Vec3]) -> Self {
        Self { open: map_parallel(directions, |direction| open_towards(occluder, points, *direction)) }
    }

    /// Whether the point sees the surroundings in this direction.
    pub(crate) fn is_open(&self, direction: usize, point: usize) -> bool {
        self.open[direction][point / 64] >> (point % 64) & 1 == 1
    }
}

fn open_towards(occluder: &Occluder<'_>, points: &[(Vec3, Vec3)], towards: Vec3) -> Vec<u64> {
    // Seen from the light, x to the right and y downwards as in a picture, so that fronts wind as they do there.
    let right = if towards.y.abs() < 0.9 { Vec3::Y.cross(towards) } else { Vec3::Z.cross(towards) };
    let right = right.normalize_or(Vec3::X);
    let down = right.cross(towards);
    let flat = |p: Vec3| Vec2::new(p.dot(right), p.dot(down));
    let (low, high) =
        occluder.positions.iter().fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(low, high), p| {
            let p = flat(*p);
            (low.min(p), high.max(p))
        });
    let span = (high - low).max_element().max(1e-3);
    let scale = (MAP_SIZE - 2) as f32 / span;
    let texel = span / (MAP_SIZE - 2) as f32;
    let place = |p: Vec3| ((flat(p) - low) * scale + 1.0).extend(-p.dot(towards));
    let projected: Vec<Vec3> = occluder.positions.iter().map(|p| place(*p)).collect();
    let window = Window { origin: [0.0; 2], size: [MAP_SIZE; 2] };
    let map = depth_map(window, &projected, occluder.triangles);

    let mut open = vec![0_u64; points.len().div_ceil(64)];
    for (i, (position, normal)) in points.iter().enumerate() {
        let facing = normal.dot(towards);
        // Grazing directions carry little light and would only show the map's texels.
        if facing <= 0.02 {
            continue;
        }
        let p = place(*position + *normal * (1.5 * texel));
        let (x, y) = (p.x as i32, p.y as i32);
        let inside = (0..MAP_SIZE as i32).contains(&x) && (0..MAP_SIZE as i32).contains(&y);
        if !inside || p.z <= map[y as usize * MAP_SIZE + x as usize] + texel {
            open[i / 64] |= 1 << (i % 64);
        }
    }
    open
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::figure::Welded;
    use crate::render::figure::tests::sphere;

    #[test]
    fn directions_cover_the_sphere_evenly() {
        let all = directions(256);
        assert!(all.iter().all(|d| (d.length() - 1.0).abs() < 1e-6));
        assert!(all.iter().sum::<Vec3>().length() < 0.5);
    }

    #[test]
    fn a_sphere_sees_half_and_a_point_beneath_it_less() {
        let part = sphere(Vec3::new(0.0, 1.0, 0.0), 0.5, 48);
        let welded = Welded::new(&part);
        let mut points: Vec<_> =
            welded.positions.iter().copied().zip(welded.normals.iter().copied()).collect();
        points.push((Vec3::ZERO, Vec3::Y));
        let all = directions(128);
        let occluder = Occluder { positions: &part.positions, triangles: &part.triangles };
        let seen = Visibility::new(&occluder, &points, &all);
        for i in 0..points.len() - 1 {
            let count = (0..all.len()).filter(|d| seen.is_open(*d, i)).count();
            assert!((56..=68).contains(&count), "point {i} sees {count} of 128");
        }
        // The sphere of radius 1/2 at distance 1 hides 1 - cos 30 degrees = 13 % of the hemisphere.
        let below = (0..all.len()).filter(|d| seen.is_open(*d, points.len() - 1)).count();
        assert!((52..=58).contains(&below), "{below}");
    }
}
