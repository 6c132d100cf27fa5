//! From figures to a picture: light per figure, then tiles of views side by side.

use std::num::NonZero;
use std::thread;

use glam::{Vec2, Vec3};

use super::camera::{Camera, DISTANCE, View};
use super::figure::{Figure, Material, Welded, bounds};
use super::image::{Image, linear, srgb_from_linear};
use super::light::Studio;
use super::material::Shading;
use super::raster::{Mesh, Samples, Varying, Window};
use super::visibility::{Occluder, Visibility, directions};

/// Points along a side of the square of ground that takes the contact shadow.
const GROUND_POINTS: usize = 96;
/// Half the side of that square, metres.
const GROUND_REACH: f32 = 1.0;
/// Samples in a band of a tile that is rendered at once: bounds the memory.
const BAND_SAMPLES: usize = 1 << 20;

/// A figure with what each of its vertices sees of the surroundings.
pub(crate) struct LitFigure {
    figure: Figure,
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
        for k in 0..GROUND_POINTS * GROUND_POINTS {
            let step = |i: usize| GROUND_REACH * (2.0 * i as f32 / (GROUND_POINTS - 1) as f32 - 1.0);
            let at = ground_centre + Vec2::new(step(k % GROUND_POINTS), step(k / GROUND_POINTS));
            points.push((Vec3::new(at.x, 0.0, at.y), Vec3::Y));
        }
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
    fn varyings(&self, part: usize, view: View, studio: &Studio) -> Vec<Varying> {
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

    /// Share of the light that reaches the ground, on a grid over model space's x and z.
    fn ground(&self, view: View, studio: &Studio) -> Vec<f32> {
        let turn = view.view_from_model();
        let mut light = vec![0.0_f32; GROUND_POINTS * GROUND_POINTS];
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
        soften(&mut light);
        light
    }

    /// How tall and how wide the figure is in a view: left, right, top, in metres about the model's axis.
    fn frame(&self, view: View) -> Frame {
        let turn = view.view_from_model();
        let (_, high) = self.figure.bounds();
        let head = high.y - 0.285;
        let points = self.figure.parts.iter().flat_map(|part| part.positions.iter().copied());
        let (low, high) = if view.is_head() {
            bounds(points.filter(|p| p.y > head + 0.04).map(|p| turn * p))
        } else {
            bounds(points.map(|p| turn * p))
        };
        Frame { left: low.x, right: high.x, bottom: if view.is_head() { head } else { 0.0 }, top: high.y }
    }
}

/// Extent of a figure in a view, metres.
struct Frame {
    left: f32,
    right: f32,
    bottom: f32,
    top: f32,
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

/// One view of one figure as a rectangle of a picture.
pub(crate) struct Tile {
    width: usize,
    height: usize,
    view: View,
    camera: Camera,
    /// Whether the shadow on the ground shows.
    grounded: bool,
}

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
        Self { width, height, view, camera, grounded: true }
    }

    /// A square tile that shows `span` metres around a place of the figure.
    pub(crate) fn close_up(size: usize, view: View, place: Vec3, span: f32) -> Self {
        let seen = view.view_from_model() * place;
        // What lies nearer to the lens is shown larger: the span is that at the place.
        let scale = size as f32 / span * (DISTANCE - seen.z) / DISTANCE;
        // The axis goes through the place itself, so that it stays in the middle.
        let camera = Camera { axis: seen.truncate(), centre: Vec2::splat(size as f32 * 0.5), scale };
        Self { width: size, height: size, view, camera, grounded: false }
    }
}

/// The lens sits 1.1 m above the ground; `foot` pixels above the lower edge lies the ground under the figure.
fn body_camera(width: usize, height: usize, scale: f32, foot: f32, middle: f32) -> Camera {
    const EYE_HEIGHT: f32 = 1.1;
    let horizon = height as f32 - foot - EYE_HEIGHT * scale;
    Camera { axis: Vec2::new(middle, EYE_HEIGHT), centre: Vec2::new(width as f32 * 0.5, horizon), scale }
}

/// All the views of one figure side by side in a picture of exactly this size, at one scale.
pub(crate) fn draw_views(figure: &LitFigure, views: &[View], width: usize, height: usize) -> Image {
    let picture = Picture::FINE;
    let frames: Vec<Frame> = views.iter().map(|view| figure.frame(*view)).collect();
    // Whole bodies share a scale. Heads fill the height, in a tile of 0.3 m by 0.34 m.
    let head_width = |height: usize| height as f32 * 0.86;
    let gap = 0.16;
    let body: f32 =
        views.iter().zip(&frames).filter(|(v, _)| !v.is_head()).map(|(_, f)| f.right - f.left + gap).sum();
    let heads = views.iter().filter(|v| v.is_head()).count() as f32 * head_width(height);
    let tallest =
        frames.iter().zip(views).filter(|(_, v)| !v.is_head()).fold(0.1_f32, |t, (f, _)| t.max(f.top));
    let (above, below) = (0.07, 0.17);
    let by_height = height as f32 / (tallest + above + below);
    let by_width = if body > 0.0 { (width as f32 - heads).max(width as f32 * 0.2) / body } else { by_height };
    let scale = by_height.min(by_width);
    let slack =
        if body > 0.0 { (height as f32 - scale * (tallest + above + below)).max(0.0) * 0.5 } else { 0.0 };

    let shares: Vec<f32> = views
        .iter()
        .zip(&frames)
        .map(|(v, f)| if v.is_head() { head_width(height) } else { (f.right - f.left + gap) * scale })
        .collect();
    // What is left over is shared out evenly, what is missing is taken evenly.
    let extra = (width as f32 - shares.iter().sum::<f32>()) / views.len().max(1) as f32;
    let mut image = Image::new(width, height, picture.backdrop[0]);
    let mut right = 0.0;
    for ((view, frame), share) in views.iter().zip(&frames).zip(shares) {
        let left = right;
        right = (left + share + extra).max(left);
        let (x0, x1) = ((left + 0.5) as usize, ((right + 0.5) as usize).min(width));
        if x1 <= x0 {
            continue;
        }
        let middle = (frame.left + frame.right) * 0.5;
        let camera = if view.is_head() {
            let span = frame.top - frame.bottom + 0.05;
            let scale = (height as f32 / span).min((x1 - x0) as f32 / (frame.right - frame.left + 0.03));
            let axis = Vec2::new(middle, (frame.top + frame.bottom) * 0.5 + 0.005);
            Camera { axis, centre: Vec2::new((x1 - x0) as f32 * 0.5, height as f32 * 0.5), scale }
        } else {
            body_camera(x1 - x0, height, scale, below * scale + slack, middle)
        };
        let tile = Tile { width: x1 - x0, height, view: *view, camera, grounded: true };
        image.paste(&picture.draw(figure, &tile), x0, 0);
    }
    image
}

struct Prepared {
    material: Material,
    projected: Vec<Vec3>,
    varyings: Vec<Varying>,
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
        };
        let parts: Vec<Prepared> = (0..figure.figure.parts.len())
            .map(|part| {
                let varyings = figure.varyings(part, tile.view, &studio);
                let projected = varyings.iter().map(|v| camera.project(v.position)).collect();
                Prepared { material: figure.figure.parts[part].material, projected, varyings }
            })
            .collect();
        let ground = figure.ground(tile.view, &studio);
        let shading = Shading {
            studio: &studio,
            eye: camera.eye(),
            forward: tile.view.view_from_model() * Vec3::Z,
            skin: figure.figure.skin,
        };

        let rows =
            (BAND_SAMPLES / (tile.width * self.samples * self.samples).max(1)).clamp(1, tile.height.max(1));
        let bands: Vec<usize> = (0..tile.height).step_by(rows).collect();
        let threads = thread::available_parallelism().map_or(1, NonZero::get).min(8);
        let draw_band = |first: usize| {
            let count = rows.min(tile.height - first);
            self.band(figure, tile, &parts, &shading, &ground, first, count)
        };
        let draw_band = &draw_band;
        let pixels: Vec<u8> = thread::scope(|scope| {
            let workers: Vec<_> = bands
                .chunks(bands.len().div_ceil(threads).max(1))
                .map(|bands| {
                    scope.spawn(move || bands.iter().flat_map(|b| draw_band(*b)).collect::<Vec<u8>>())
                })
                .collect();
            workers
                .into_iter()
                .flat_map(|worker| worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
                .collect()
        });
        Image { width: tile.width, height: tile.height, pixels }
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "one call site; the arguments are the tile's prepared state"
    )]
    fn band(
        &self,
        figure: &LitFigure,
        tile: &Tile,
        parts: &[Prepared],
        shading: &Shading<'_>,
        shadows: &[f32],
        first: usize,
        count: usize,
    ) -> Vec<u8> {
        let fine = self.samples;
        let window = Window { origin: [0.0, (first * fine) as f32], size: [tile.width * fine, count * fine] };
        let mut samples = Samples::new(window);
        let mesh = |i: usize| Mesh {
            projected: &parts[i].projected,
            varyings: &parts[i].varyings,
            triangles: &figure.figure.parts[i].triangles,
        };
        for (i, part) in parts.iter().enumerate().filter(|(_, part)| part.material != Material::Lashes) {
            samples.draw(&mesh(i), |v| shading.shade(part.material, v));
        }
        samples.close_cracks();
        for (i, part) in parts.iter().enumerate().filter(|(_, part)| part.material == Material::Lashes) {
            samples.draw_veil(&mesh(i), |v| shading.shade(part.material, v));
        }

        let [top, bottom] = self.backdrop.map(linear);
        let model_from_view = tile.view.view_from_model().transpose();
        let mut out = Vec::with_capacity(tile.width * count * 3);
        for y in 0..count {
            let row = (first + y) as f32 + 0.5;
            let behind = top.lerp(bottom, row / tile.height as f32);
            for x in 0..tile.width {
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
                if empty > 0.0 {
                    let ground = tile.camera.ground(Vec2::new(x as f32 + 0.5, row)).filter(|_| tile.grounded);
                    let shadow = ground.map_or(1.0, |g| {
                        let p = model_from_view * Vec3::new(g.x, 0.0, g.y);
                        let light = sample_ground(shadows, Vec2::new(p.x, p.z) - figure.ground_centre);
                        1.0 - (1.0 - light) * away_from_sides(x, tile.width)
                    });
                    colour += behind * (shadow * empty);
                }
                let grain = dither(x, first + y);
                out.extend(colour.to_array().map(|c| srgb_from_linear(c, grain)));
            }
        }
        out
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

/// Blurs the grid by a few centimetres: the key light's directions are too few to give one smooth shadow.
fn soften(grid: &mut [f32]) {
    let last = GROUND_POINTS - 1;
    for _ in 0..3 {
        for stride in [1, GROUND_POINTS] {
            let before = grid.to_vec();
            for (k, value) in grid.iter_mut().enumerate() {
                let along = if stride == 1 { k % GROUND_POINTS } else { k / GROUND_POINTS };
                let low = if along == 0 { k } else { k - stride };
                let high = if along == last { k } else { k + stride };
                *value = 0.25 * before[low] + 0.5 * before[k] + 0.25 * before[high];
            }
        }
    }
}

/// The ground's light at a place relative to the grid's centre; fades to full light at the grid's rim.
fn sample_ground(ground: &[f32], at: Vec2) -> f32 {
    let last = (GROUND_POINTS - 1) as f32;
    let at = (at / GROUND_REACH + 1.0) * (0.5 * last);
    if at.min_element() < 0.0 || at.max_element() >= last {
        return 1.0;
    }
    let (x, y) = (at.x as usize, at.y as usize);
    let (fx, fy) = (at.x - x as f32, at.y - y as f32);
    let get = |x: usize, y: usize| ground[y * GROUND_POINTS + x];
    let value = (get(x, y) * (1.0 - fx) + get(x + 1, y) * fx) * (1.0 - fy)
        + (get(x, y + 1) * (1.0 - fx) + get(x + 1, y + 1) * fx) * fy;
    let radius = (at / (0.5 * last) - 1.0).length();
    let fade = ((1.0 - radius) / 0.5).clamp(0.0, 1.0);
    1.0 - (1.0 - value) * fade * fade * (3.0 - 2.0 * fade)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::figure::tests::sphere;

    fn ball() -> LitFigure {
        let part = sphere(Vec3::new(0.0, 0.9, 0.0), 0.9, 32);
        LitFigure::new(Figure::new(vec![part], Vec3::new(0.5, 0.4, 0.3)).unwrap(), 64)
    }

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
    fn the_ground_darkens_under_the_figure() {
        let ball = ball();
        let ground = ball.ground(View::Front, &Studio::new());
        assert!(sample_ground(&ground, Vec2::ZERO) < 0.5);
        assert!(sample_ground(&ground, Vec2::new(0.99, 0.0)) > 0.97);
        assert!((sample_ground(&ground, Vec2::new(3.0, 0.0)) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn tiny_pictures_do_not_fail() {
        let views = [View::Front, View::Face, View::Side];
        for (w, h) in [(1, 1), (3, 2), (2, 30)] {
            assert_eq!(draw_views(&ball(), &views, w, h).pixels.len(), w * h * 3);
        }
    }
}
