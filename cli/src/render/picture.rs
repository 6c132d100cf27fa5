//! Pixels of a tile: a lit figure drawn over its backdrop.

use glam::{Vec2, Vec3};

use super::camera::Camera;
use super::figure::Material;
use super::ground::GroundLight;
use super::image::{Image, linear, srgb_from_linear};
use super::light::Studio;
use super::lit_figure::LitFigure;
use super::material::Shading;
use super::parallel::map_parallel;
use super::raster::{Mesh, Samples, Varying, Window};
use super::tile::Tile;

/// Samples in a band of a tile that is rendered at once: bounds the memory.
const BAND_SAMPLES: usize = 1 << 20;

/// How a picture is made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Picture {
    /// Samples along each side of a pixel.
    pub(crate) samples: usize,
    /// Background at the top and at the bottom, sRGB.
    pub(crate) backdrop: [[u8; 3]; 2],
}

impl Picture {
    /// For single figures: four by four samples, a light grey room.
    pub(crate) const FINE: Self = Self { samples: 4, backdrop: [[236, 237, 239], [222, 223, 226]] };
    /// For many small figures.
    pub(crate) const SHEET: Self = Self { samples: 3, backdrop: [[234, 235, 237], [234, 235, 237]] };
}

impl Picture {
    /// Renders one tile.
    pub(crate) fn draw(&self, figure: &LitFigure, tile: &Tile) -> Image {
        let studio = Studio::new();
        let fine = self.samples as f32;
        let camera = Camera {
            axis: tile.camera.axis,
            centre: tile.camera.centre * fine,
            scale: tile.camera.scale * fine,
            distance: tile.camera.distance,
        };
        let parts = (0..figure.figure.parts.len()).map(|part| {
            let varyings = figure.varyings(part, tile.view, &studio);
            let projected = varyings.iter().map(|v| camera.project(v.position)).collect();
            let drawn = &figure.figure.parts[part];
            ProjectedPart { material: drawn.material, triangles: &drawn.triangles, projected, varyings }
        });
        let drawing = Drawing {
            picture: self,
            tile,
            parts: parts.collect(),
            ground: figure.ground(tile.view, &studio),
            shading: Shading {
                studio: &studio,
                eye: camera.eye(),
                forward: tile.view.view_from_model() * Vec3::Z,
                skin: figure.figure.skin,
            },
        };
        let rows =
            (BAND_SAMPLES / (tile.width * self.samples * self.samples).max(1)).clamp(1, tile.height.max(1));
        let bands: Vec<usize> = (0..tile.height).step_by(rows).collect();
        let pixels = map_parallel(&bands, |first| drawing.band(*first, rows.min(tile.height - first)));
        Image { width: tile.width, height: tile.height, pixels: pixels.concat() }
    }
}

/// A part of the body, projected into a tile.
struct ProjectedPart<'a> {
    material: Material,
    triangles: &'a [[u32; 3]],
    projected: Vec<Vec3>,
    varyings: Vec<Varying>,
}

/// All that the bands of a tile share.
struct Drawing<'a> {
    picture: &'a Picture,
    tile: &'a Tile,
    parts: Vec<ProjectedPart<'a>>,
    ground: GroundLight,
    shading: Shading<'a>,
}

impl Drawing<'_> {
    /// The pixels of `count` rows from row `first` on.
    fn band(&self, first: usize, count: usize) -> Vec<u8> {
        let fine = self.picture.samples;
        let samples = self.samples(first * fine, count * fine);
        let [top, bottom] = self.picture.backdrop.map(linear);
        let mut out = Vec::with_capacity(self.tile.width * count * 3);
        for y in 0..count {
            let row = (first + y) as f32 + 0.5;
            let behind = top.lerp(bottom, row / self.tile.height as f32);
            for x in 0..self.tile.width {
                let mut sum = Vec3::ZERO;
                let mut covered = 0.0;
                for k in 0..fine * fine {
                    let [r, g, b, a] = samples.get(x * fine + k % fine, y * fine + k / fine);
                    sum += Vec3::new(r, g, b);
                    covered += a;
                }
                let share = 1.0 / (fine * fine) as f32;
                let mut colour = sum * share;
                let empty = 1.0 - covered * share;
                let floor = self.tile.floor.as_ref().map(|floor| floor.seen(self.tile, x as f32 + 0.5, row));
                if empty > 0.0 {
                    let line = floor.as_ref().map_or(1.0, |seen| seen.line);
                    colour += behind * (self.shadow(x, row) * line * empty);
                }
                if let Some((mark, share)) = floor.and_then(|seen| seen.mark) {
                    colour = colour.lerp(mark, share);
                }
                let grain = dither(x, first + y);
                out.extend(colour.to_array().map(|c| srgb_from_linear(c, grain)));
            }
        }
        out
    }

    /// The parts drawn into `count` rows of samples from row `first` on.
    fn samples(&self, first: usize, count: usize) -> Samples {
        let width = self.tile.width * self.picture.samples;
        let mut samples = Samples::new(Window { origin: [0.0, first as f32], size: [width, count] });
        let shade = |material| move |v: &Varying| self.shading.shade(material, v);
        let (veils, solids): (Vec<_>, Vec<_>) =
            self.parts.iter().partition(|part| part.material == Material::Lashes);
        for part in solids {
            samples.draw(&part.mesh(), shade(part.material));
        }
        samples.close_cracks();
        for part in veils {
            samples.draw_veil(&part.mesh(), shade(part.material));
        }
        samples
    }

    /// How bright the backdrop is at a pixel, 0 to 1.
    fn shadow(&self, x: usize, row: f32) -> f32 {
        let pixel = Vec2::new(x as f32 + 0.5, row);
        let Some(ground) = self.tile.camera.ground(pixel).filter(|_| self.tile.grounded) else {
            return 1.0;
        };
        let p = self.tile.view.view_from_model().transpose() * Vec3::new(ground.x, 0.0, ground.y);
        let light = self.ground.at(Vec2::new(p.x, p.z));
        1.0 - (1.0 - light) * away_from_sides(x, self.tile.width)
    }
}

impl ProjectedPart<'_> {
    fn mesh(&self) -> Mesh<'_> {
        Mesh { projected: &self.projected, varyings: &self.varyings, triangles: self.triangles }
    }
}

/// 0 at a tile's left and right edge, 1 from a quarter of its width on: shadows end before the neighbour begins.
fn away_from_sides(x: usize, width: usize) -> f32 {
    let t = (4.0 * (x.min(width - 1 - x) as f32 + 0.5) / width as f32).min(1.0);
    t * t * (3.0 - 2.0 * t)
}

/// A fixed grain between -0.5 and 0.5 that hides the steps of eight bits in gradients.
fn dither(x: usize, y: usize) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x9E37_79B1) ^ (y as u32).wrapping_mul(0x85EB_CA77);
    h = (h ^ h >> 15).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ h >> 12).wrapping_mul(0x297A_2D39);
    (h >> 8) as f32 / 16_777_216.0 - 0.5
}
