//! The shadow of a figure on the ground.

use glam::{Vec2, Vec3};

/// Points along a side of the square of ground that takes the shadow.
const SIDE: usize = 96;
/// Half the side of that square, metres.
const REACH: f32 = 1.0;
/// Number of points of the grid.
pub(super) const GROUND_POINTS: usize = SIDE * SIDE;

/// The points of the grid around a centre (x, z), row by row along x.
pub(super) fn ground_points(centre: Vec2) -> impl Iterator<Item = Vec3> {
    let step = |i: usize| REACH * (2.0 * i as f32 / (SIDE - 1) as f32 - 1.0);
    (0..GROUND_POINTS).map(move |k| {
        let at = centre + Vec2::new(step(k % SIDE), step(k / SIDE));
        Vec3::new(at.x, 0.0, at.y)
    })
}

/// Share of the light that reaches the ground, on a grid over model space's x and z.
pub(super) struct GroundLight {
    centre: Vec2,
    shares: Vec<f32>,
}

impl GroundLight {
    /// From the shares at the [`ground_points`] of the centre.
    pub(super) fn new(centre: Vec2, mut shares: Vec<f32>) -> Self {
        soften(&mut shares);
        Self { centre, shares }
    }

    /// The share at a place (x, z); it fades to 1 at the rim of the grid.
    pub(super) fn at(&self, place: Vec2) -> f32 {
        let last = (SIDE - 1) as f32;
        let at = ((place - self.centre) / REACH + 1.0) * (0.5 * last);
        if at.min_element() < 0.0 || at.max_element() >= last {
            return 1.0;
        }
        let (x, y) = (at.x as usize, at.y as usize);
        let (fx, fy) = (at.x - x as f32, at.y - y as f32);
        let get = |x: usize, y: usize| self.shares[y * SIDE + x];
        let value = (get(x, y) * (1.0 - fx) + get(x + 1, y) * fx) * (1.0 - fy)
            + (get(x, y + 1) * (1.0 - fx) + get(x + 1, y + 1) * fx) * fy;
        let radius = (at / (0.5 * last) - 1.0).length();
        let fade = ((1.0 - radius) / 0.5).clamp(0.0, 1.0);
        1.0 - (1.0 - value) * fade * fade * (3.0 - 2.0 * fade)
    }
}

/// Blurs the grid by a few centimetres: the key light's directions are too few to give one smooth shadow.
fn soften(grid: &mut [f32]) {
    let last = SIDE - 1;
    for _ in 0..3 {
        for stride in [1, SIDE] {
            let before = grid.to_vec();
            for (k, value) in grid.iter_mut().enumerate() {
                let along = if stride == 1 { k % SIDE } else { k / SIDE };
                let low = if along == 0 { k } else { k - stride };
                let high = if along == last { k } else { k + stride };
                *value = 0.25 * before[low] + 0.5 * before[k] + 0.25 * before[high];
            }
        }
    }
}
