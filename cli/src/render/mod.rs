//! A small, deterministic software renderer: a figure of named parts in, a shaded picture out.
//!
//! Triangles are rasterised by the `euc` crate. Light is gathered once per figure: 256 directions over the sphere, each
//! with its own depth map, say which part of the surroundings every vertex sees; each view then sums the radiance
//! of the studio over the directions that are open. That gives soft key, fill and rim light, ambient occlusion and
//! the contact shadow on the ground from one mechanism, without ray tracing and without random numbers.
//!
//! Only exactly rounded operations of the standard library and the `libm` crate are used, so that a picture has the
//! same bytes on every host, whatever the number of threads.

mod animation;
mod camera;
mod figure;
mod floor;
mod font;
mod ground;
mod image;
mod light;
mod lit_figure;
mod material;
mod palette;
mod parallel;
mod picture;
mod raster;
mod stage;
mod tile;
mod views;
mod visibility;

pub(crate) use animation::Animation;
pub(crate) use camera::View;
pub(crate) use figure::{Figure, Material, Part};
pub(crate) use floor::{Floor, Mark};
pub(crate) use font::{draw_text, text_width};
pub(crate) use image::Image;
pub(crate) use lit_figure::LitFigure;
pub(crate) use picture::Picture;
pub(crate) use stage::Stage;
pub(crate) use tile::Tile;
pub(crate) use views::draw_views;
