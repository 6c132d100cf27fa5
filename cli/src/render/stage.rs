//! The frames of a motion, all seen from the same place.

use glam::{Vec2, Vec3};

use super::camera::{Camera, DISTANCE, View};
use super::figure::bounds;
use super::floor::{Floor, GRID};
use super::font::{draw_text, text_width};
use super::image::Image;
use super::lit_figure::LitFigure;
use super::picture::Picture;
use super::tile::Tile;

/// Margins around the motion, metres: above, below, and left and right together.
const ABOVE: f32 = 0.1;
const BELOW: f32 = 0.1;
const BESIDE: f32 = 0.3;
/// Height of the lens above the ground, metres: high enough to look down at the feet.
const EYE_HEIGHT: f32 = 1.9;
/// Height of the captions below, as a share of the picture's, and the ink.
const CAPTION: f32 = 0.06;
const INK: [u8; 3] = [70, 72, 76];

/// Where a motion is seen: room for all its frames in every view, at one scale.
pub(crate) struct Stage {
    low: Vec3,
    high: Vec3,
    views: Vec<View>,
    size: (usize, usize),
}

impl Stage {
    /// For figures within these bounds, metres, in pictures of this size with the views side by side.
    pub(crate) fn new((low, high): (Vec3, Vec3), views: &[View], size: (usize, usize)) -> Self {
        Self { low: low.min(Vec3::ZERO), high, views: views.to_vec(), size }
    }

    /// One frame, with a caption at the left below it.
    pub(crate) fn draw(&self, figure: &LitFigure, floor: &Floor, caption: &str) -> Image {
        let picture = Picture::FINE;
        let (width, height) = self.size;
        let boxes: Vec<(Vec3, Vec3)> = self.views.iter().map(|view| self.seen(*view)).collect();
        let widths: Vec<f32> = boxes.iter().map(|(low, high)| high.x - low.x + BESIDE).collect();
        let asked: f32 = widths.iter().sum();
        let mut image = Image::new(width, height, picture.backdrop[0]);
        let mut right = 0.0;
        for ((view, seen), share) in self.views.iter().zip(&boxes).zip(&widths) {
            let left = right;
            right = left + width as f32 * share / asked;
            let (x0, x1) = ((left + 0.5) as usize, ((right + 0.5) as usize).min(width));
            if x1 > x0 {
                let camera = Self::camera(seen, x1 - x0, height, width as f32 / asked);
                let floor = Some(floor.clone());
                let tile = Tile { width: x1 - x0, height, view: *view, camera, grounded: true, floor };
                image.paste(&picture.draw(figure, &tile), x0, 0);
            }
        }
        self.write(&mut image, caption);
        image
    }

    /// The bounds as a view turns them.
    fn seen(&self, view: View) -> (Vec3, Vec3) {
        let turn = view.view_from_model();
        let corner = |i: usize| {
            let pick = |bit: usize, low: f32, high: f32| if i >> bit & 1 == 1 { high } else { low };
            Vec3::new(
                pick(0, self.low.x, self.high.x),
                pick(1, self.low.y, self.high.y),
                pick(2, self.low.z, self.high.z),
            )
        };
        bounds((0..8).map(|i| turn * corner(i)))
    }

    /// The camera for what is seen in a tile; `widest` is the scale at which it fits sideways, pixels a metre.
    fn camera((low, high): &(Vec3, Vec3), width: usize, height: usize, widest: f32) -> Camera {
        // The lens stands back from the nearest point, which then is not much larger than the farthest.
        let distance = DISTANCE + high.z.max(0.0);
        let nearest = distance / (distance - high.z).max(0.1);
        let horizon = |z: f32| EYE_HEIGHT * distance / (distance - z).max(0.1);
        // Metres in the plane z = 0 from the lens' height down to the floor's nearest point and up to the top, which may
        // be lower than the lens.
        let below = horizon(high.z) + BELOW;
        // What is below the lens is the higher in the picture the farther it is.
        let highest = if high.y > EYE_HEIGHT { high.z } else { low.z };
        let above = (high.y - EYE_HEIGHT) * distance / (distance - highest).max(0.1) + ABOVE;
        let room = height as f32 * (1.0 - CAPTION);
        let scale = (widest / nearest).min(room / (below + above));
        let slack = room - scale * (below + above);
        let axis = Vec2::new((low.x + high.x) * 0.5, EYE_HEIGHT);
        let centre = Vec2::new(width as f32 * 0.5, 0.5 * slack + scale * above);
        Camera { axis, centre, scale, distance }
    }

    /// The caption, and the length of the grid's cells where there is room for it.
    fn write(&self, image: &mut Image, caption: &str) {
        let (width, height) = self.size;
        let dot = (height / 180).clamp(1, 4);
        let top = height.saturating_sub(9 * dot);
        let whole = format!("{caption}  grid {GRID} m");
        let text =
            if text_width(whole.trim_start(), dot) + 6 * dot <= width { whole.trim_start() } else { caption };
        draw_text(image, 3 * dot, top, dot, INK, text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::lit_figure::tests::ball;

    /// Whether the whole box is in the picture of each view.
    fn fits(low: Vec3, high: Vec3, size: (usize, usize)) {
        let views = [View::Front, View::Side, View::ThreeQuarter];
        let stage = Stage::new((low, high), &views, size);
        let widest = |seen: &(Vec3, Vec3)| size.0 as f32 / (seen.1.x - seen.0.x + BESIDE);
        for view in views {
            let seen = stage.seen(view);
            let camera = Stage::camera(&seen, size.0, size.1, widest(&seen));
            for i in 0..8 {
                let pick = |bit: usize, low: f32, high: f32| if i >> bit & 1 == 1 { high } else { low };
                let corner = Vec3::new(
                    pick(0, seen.0.x, seen.1.x),
                    pick(1, seen.0.y, seen.1.y),
                    pick(2, seen.0.z, seen.1.z),
                );
                let p = camera.project(corner);
                assert!(p.x > -0.5 && p.x < size.0 as f32 + 0.5, "{view:?} {corner} {p}");
                assert!(p.y > -0.5 && p.y < size.1 as f32, "{view:?} {corner} {p}");
            }
        }
    }

    #[test]
    fn every_frame_fits_into_the_picture() {
        fits(Vec3::new(-0.9, 0.0, -0.2), Vec3::new(0.9, 1.8, 0.3), (300, 300));
        fits(Vec3::new(-0.5, 0.0, -4.0), Vec3::new(0.5, 2.3, 4.0), (640, 240));
        fits(Vec3::new(-5.0, 0.0, -0.3), Vec3::new(5.0, 1.2, 0.3), (240, 400));
    }

    #[test]
    fn a_frame_has_the_grid_and_repeats_exactly() {
        let stage =
            Stage::new((Vec3::new(-0.9, 0.0, -0.9), Vec3::new(0.9, 1.8, 0.9)), &[View::Front], (120, 120));
        let floor = Floor { origin: Vec2::ZERO, marks: Vec::new() };
        let image = stage.draw(&ball(), &floor, "0.50 s");
        assert_eq!(image.pixels, stage.draw(&ball(), &floor, "0.50 s").pixels);
        let moved = Floor { origin: Vec2::splat(0.25), ..floor };
        assert_ne!(image.pixels, stage.draw(&ball(), &moved, "0.50 s").pixels);
    }
}
