//! One view of one figure as a rectangle of a picture.

use glam::{Vec2, Vec3};

use super::camera::{Camera, DISTANCE, View};
use super::floor::Floor;

/// What a rectangle of a picture shows of a figure.
pub(crate) struct Tile {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) view: View,
    pub(super) camera: Camera,
    /// Whether the shadow on the ground shows.
    pub(super) grounded: bool,
    /// What is drawn on the ground, if anything.
    pub(super) floor: Option<Floor>,
}

impl Tile {
    /// A tile of this size that shows the figure's whole body at a fixed scale: `scale` pixels a metre, the
    /// ground `foot` pixels above the lower edge.
    pub(crate) fn at_scale(
        width: usize,
        height: usize,
        view: View,
        scale: f32,
        foot: f32,
        middle: f32,
    ) -> Self {
        let camera = body_camera(width, height, scale, foot, middle);
        Self { width, height, view, camera, grounded: true, floor: None }
    }

    /// A square tile that shows `span` metres around a place of the figure.
    pub(crate) fn close_up(size: usize, view: View, place: Vec3, span: f32) -> Self {
        let seen = view.view_from_model() * place;
        // What lies nearer to the lens is shown larger: the span is that at the place.
        let scale = size as f32 / span * (DISTANCE - seen.z) / DISTANCE;
        // The axis goes through the place itself, so that it stays in the middle.
        let centre = Vec2::splat(size as f32 * 0.5);
        let camera = Camera { axis: seen.truncate(), centre, scale, distance: DISTANCE };
        Self { width: size, height: size, view, camera, grounded: false, floor: None }
    }
}

/// The lens sits 1.1 m above the ground; `foot` pixels above the lower edge lies the ground under the figure.
pub(super) fn body_camera(width: usize, height: usize, scale: f32, foot: f32, middle: f32) -> Camera {
    const EYE_HEIGHT: f32 = 1.1;
    let horizon = height as f32 - foot - EYE_HEIGHT * scale;
    let centre = Vec2::new(width as f32 * 0.5, horizon);
    Camera { axis: Vec2::new(middle, EYE_HEIGHT), centre, scale, distance: DISTANCE }
}
