//! What is drawn on the ground of a motion: a grid to judge distances by, and marks where feet stand.

use glam::{Vec2, Vec3};

use super::image::linear;
use super::tile::Tile;

/// Side of a cell of the grid, metres.
pub(crate) const GRID: f32 = 0.5;
/// Half the width of a line of the grid, metres, and how much light it takes.
const LINE: f32 = 0.005;
const DARKNESS: f32 = 0.42;
/// Middle radius of a mark and half the width of its ring, metres: it shows around the foot that stands on it.
const RADIUS: f32 = 0.06;
const RING: f32 = 0.01;
/// How opaque the ring of a mark is, and what is inside: the foot shows through.
const OPACITY: [f32; 2] = [0.9, 0.45];
/// Colours of marks of the left and the right foot, sRGB.
const COLOURS: [[u8; 3]; 2] = [[214, 96, 20], [20, 92, 200]];

/// A point on which a foot stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mark {
    /// x and z on the ground, model space, metres.
    pub(crate) at: Vec2,
    /// 0 for the left foot, 1 for the right.
    pub(crate) foot: usize,
}

/// The ground of one frame.
#[derive(Clone, Debug)]
pub(crate) struct Floor {
    /// Where the origin of the picture is in the motion, x and z, metres: the grid belongs to the motion.
    pub(crate) origin: Vec2,
    pub(crate) marks: Vec<Mark>,
}

/// What a pixel shows of the ground.
pub(super) struct Seen {
    /// Share of the light that the grid leaves.
    pub(super) line: f32,
    /// Colour of a mark, linear RGB, and its opacity.
    pub(super) mark: Option<(Vec3, f32)>,
}

impl Floor {
    /// What a pixel of a tile shows.
    pub(super) fn seen(&self, tile: &Tile, x: f32, y: f32) -> Seen {
        let model_from_view = tile.view.view_from_model().transpose();
        let place = |x: f32, y: f32| {
            let ground = tile.camera.ground(Vec2::new(x, y))?;
            let p = model_from_view * Vec3::new(ground.x, 0.0, ground.y);
            Some(Vec2::new(p.x, p.z) + self.origin)
        };
        let nothing = Seen { line: 1.0, mark: None };
        let (Some(here), Some(beside), Some(below)) = (place(x, y), place(x + 1.0, y), place(x, y + 1.0))
        else {
            return nothing;
        };
        let footprint = (beside - here).abs() + (below - here).abs();
        let across = |at: f32, width: f32| {
            let distance = (at - GRID * (at / GRID + 0.5).floor()).abs();
            // Far away, where lines would run into each other, they fade.
            covered(distance, LINE, width) * (1.5 - 3.0 * width / GRID).clamp(0.0, 1.0)
        };
        let lines = across(here.x, footprint.x).max(across(here.y, footprint.y));
        let width = footprint.max_element();
        let disc = |mark: &Mark| {
            let distance = here.distance(mark.at);
            let ring = OPACITY[0] * covered((distance - RADIUS).abs(), RING, width);
            let opacity = ring.max(OPACITY[1] * covered(distance, RADIUS, width));
            (opacity > 0.0).then(|| (linear(COLOURS[mark.foot]), opacity))
        };
        let mark = self.marks.iter().filter_map(disc).max_by(|a, b| a.1.total_cmp(&b.1));
        Seen { line: 1.0 - DARKNESS * lines, mark }
    }
}

/// Share of a pixel of this width that a line covers, from the distance between the middles of both.
fn covered(distance: f32, half: f32, width: f32) -> f32 {
    let width = width.max(1e-6);
    let (low, high) = (distance - 0.5 * width, distance + 0.5 * width);
    ((high.min(half) - low.max(-half)) / width).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::View;

    fn tile(floor: Floor) -> Tile {
        Tile { floor: Some(floor), ..Tile::at_scale(1600, 1200, View::Front, 600.0, 160.0, 0.0) }
    }

    /// The pixel of a place on the ground.
    fn pixel(tile: &Tile, x: f32, z: f32) -> Vec2 {
        tile.camera.project(tile.view.view_from_model() * Vec3::new(x, 0.0, z)).truncate()
    }

    #[test]
    fn lines_are_half_a_metre_apart_and_move_with_the_origin() {
        for origin in [Vec2::ZERO, Vec2::new(0.2, -0.1)] {
            let tile = tile(Floor { origin, marks: Vec::new() });
            let seen = |x: f32, z: f32| {
                let at = pixel(&tile, x - origin.x, z - origin.y);
                tile.floor.as_ref().unwrap().seen(&tile, at.x, at.y).line
            };
            for place in [-0.5, 0.0, 0.5] {
                assert!(seen(place, 0.25) < 0.7, "{}", seen(place, 0.25));
                assert!(seen(0.25, place) < 0.8);
            }
            assert_eq!(seen(0.25, 0.25), 1.0);
        }
    }

    #[test]
    fn a_mark_is_a_disc_with_a_rim_around_its_place() {
        let floor = Floor { origin: Vec2::ZERO, marks: vec![Mark { at: Vec2::new(0.2, 0.1), foot: 1 }] };
        let tile = tile(floor);
        let mark = |x: f32, z: f32| {
            let at = pixel(&tile, x, z);
            tile.floor.as_ref().unwrap().seen(&tile, at.x, at.y).mark
        };
        let (colour, share) = mark(0.2 + RADIUS, 0.1).unwrap();
        assert!(colour.z > colour.x && share > 0.5, "{colour} {share}");
        assert!((mark(0.2, 0.1).unwrap().1 - OPACITY[1]).abs() < 0.05);
        assert!(mark(0.0, 0.1).is_none());
        let sky = tile.floor.as_ref().unwrap().seen(&tile, 800.0, 1.0);
        assert_eq!((sky.line, sky.mark), (1.0, None));
    }
}
