//! The views of one figure side by side.

use glam::Vec2;

use super::camera::{Camera, DISTANCE, View};
use super::figure::bounds;
use super::image::Image;
use super::lit_figure::LitFigure;
use super::picture::Picture;
use super::tile::{Tile, body_camera};

/// Margins around a whole body, metres: above, below, and left and right together.
const ABOVE: f32 = 0.07;
const BELOW: f32 = 0.17;
const BESIDE: f32 = 0.16;
/// Width of a head's tile by its height: 0.3 m by 0.34 m.
const HEAD_ASPECT: f32 = 0.86;

/// All the views of one figure side by side in a picture of exactly this size, at one scale.
pub(crate) fn draw_views(figure: &LitFigure, views: &[View], width: usize, height: usize) -> Image {
    let picture = Picture::FINE;
    let frames: Vec<Frame> = views.iter().map(|view| Frame::new(figure, *view)).collect();
    let layout = Layout::new(&frames, width, height);
    let shares: Vec<f32> = frames.iter().map(|frame| layout.share(frame)).collect();
    // What is left over is shared out evenly, what is missing is taken evenly.
    let extra = (width as f32 - shares.iter().sum::<f32>()) / views.len().max(1) as f32;
    let mut image = Image::new(width, height, picture.backdrop[0]);
    let mut right = 0.0;
    for (frame, share) in frames.iter().zip(shares) {
        let left = right;
        right = (left + share + extra).max(left);
        let (x0, x1) = ((left + 0.5) as usize, ((right + 0.5) as usize).min(width));
        if x1 <= x0 {
            continue;
        }
        let camera = layout.camera(frame, x1 - x0);
        let tile = Tile { width: x1 - x0, height, view: frame.view, camera, grounded: true, floor: None };
        image.paste(&picture.draw(figure, &tile), x0, 0);
    }
    image
}

/// Extent of a figure in a view, metres about the model's axis.
struct Frame {
    view: View,
    left: f32,
    right: f32,
    bottom: f32,
    top: f32,
}

impl Frame {
    fn new(figure: &LitFigure, view: View) -> Self {
        let turn = view.view_from_model();
        let (_, high) = figure.figure.bounds();
        let head = high.y - 0.285;
        let points = figure.figure.parts.iter().flat_map(|part| part.positions.iter().copied());
        let (low, high) = if view.is_head() {
            bounds(points.filter(|p| p.y > head + 0.04).map(|p| turn * p))
        } else {
            bounds(points.map(|p| turn * p))
        };
        let bottom = if view.is_head() { head } else { 0.0 };
        Self { view, left: low.x, right: high.x, bottom, top: high.y }
    }
}

/// How views share a picture: whole bodies have one scale, heads fill the height.
struct Layout {
    height: usize,
    /// Pixels per metre of whole bodies.
    scale: f32,
    /// Pixels left over below and above whole bodies.
    slack: f32,
}

impl Layout {
    fn new(frames: &[Frame], width: usize, height: usize) -> Self {
        let bodies = || frames.iter().filter(|frame| !frame.view.is_head());
        let body: f32 = bodies().map(|f| f.right - f.left + BESIDE).sum();
        let heads = (frames.len() - bodies().count()) as f32 * head_width(height);
        let tallest = bodies().fold(0.1_f32, |tallest, f| tallest.max(f.top));
        let by_height = height as f32 / (tallest + ABOVE + BELOW);
        if body <= 0.0 {
            return Self { height, scale: by_height, slack: 0.0 };
        }
        let scale = by_height.min((width as f32 - heads).max(width as f32 * 0.2) / body);
        let slack = (height as f32 - scale * (tallest + ABOVE + BELOW)).max(0.0) * 0.5;
        Self { height, scale, slack }
    }

    /// Width that a view asks for, pixels.
    fn share(&self, frame: &Frame) -> f32 {
        if frame.view.is_head() {
            head_width(self.height)
        } else {
            (frame.right - frame.left + BESIDE) * self.scale
        }
    }

    /// The camera of a view in a tile of this width.
    fn camera(&self, frame: &Frame, width: usize) -> Camera {
        let middle = (frame.left + frame.right) * 0.5;
        if !frame.view.is_head() {
            return body_camera(width, self.height, self.scale, BELOW * self.scale + self.slack, middle);
        }
        let span = frame.top - frame.bottom + 0.05;
        let scale = (self.height as f32 / span).min(width as f32 / (frame.right - frame.left + 0.03));
        let axis = Vec2::new(middle, (frame.top + frame.bottom) * 0.5 + 0.005);
        let centre = Vec2::new(width as f32 * 0.5, self.height as f32 * 0.5);
        Camera { axis, centre, scale, distance: DISTANCE }
    }
}

fn head_width(height: usize) -> f32 {
    height as f32 * HEAD_ASPECT
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::lit_figure::tests::ball;

    #[test]
    fn views_fill_the_picture_and_repeat_exactly() {
        let views = [View::Front, View::Side];
        let image = draw_views(&ball(), &views, 160, 90);
        assert_eq!((image.width, image.height, image.pixels.len()), (160, 90, 160 * 90 * 3));
        assert_eq!(image.pixels, draw_views(&ball(), &views, 160, 90).pixels);
        // Both balls are lit: warm skin in the middle of each half, background in the corner.
        for x in [40, 120] {
            let at = (45 * 160 + x) * 3;
            assert!(image.pixels[at] > image.pixels[at + 2] && image.pixels[at] > 60);
        }
        let corner = [image.pixels[0], image.pixels[1], image.pixels[2]];
        assert!(corner.iter().zip(Picture::FINE.backdrop[0]).all(|(a, b)| a.abs_diff(b) <= 1));
    }

    #[test]
    fn tiny_pictures_do_not_fail() {
        let views = [View::Front, View::Face, View::Side];
        for (w, h) in [(1, 1), (3, 2), (2, 30)] {
            assert_eq!(draw_views(&ball(), &views, w, h).pixels.len(), w * h * 3);
        }
    }
}
