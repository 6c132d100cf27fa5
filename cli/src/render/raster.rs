//! Triangles to pixels, over the `euc` rasteriser.
//!
//! The vertices arrive projected: x, y in pixels, z the depth (smaller is nearer). Attributes are interpolated
//! linearly on the screen; with a seven-metre lens and millimetre triangles perspective correction changes nothing.

use euc::buffer::Buffer2d;
use euc::rasterizer::{BackfaceCullingDisabled, Triangles};
use euc::{DepthStrategy, Interpolate, Pipeline};
use glam::Vec3;

/// Depth of a sample that nothing covers.
pub(crate) const NOTHING: f32 = f32::MAX;

/// What is interpolated over a triangle and handed to the shader.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Varying {
    /// Position in view space, metres.
    pub(crate) position: Vec3,
    /// Normal in view space, not of unit length between vertices.
    pub(crate) normal: Vec3,
    /// Irradiance, linear RGB.
    pub(crate) light: Vec3,
    /// Part's own coordinates: for eyes and lashes the place relative to the eyeball, whose surface has length 1.
    pub(crate) local: Vec3,
    /// Share of the key light that arrives, share of the whole surroundings that is open, unused.
    pub(crate) open: Vec3,
}

impl Interpolate for Varying {
    fn lerp2(a: Self, b: Self, x: f32, y: f32) -> Self {
        Self::lerp3(a, b, b, x, y, 0.0)
    }

    fn lerp3(a: Self, b: Self, c: Self, x: f32, y: f32, z: f32) -> Self {
        let mix = |a: Vec3, b: Vec3, c: Vec3| a * x + b * y + c * z;
        Self {
            position: mix(a.position, b.position, c.position),
            normal: mix(a.normal, b.normal, c.normal),
            light: mix(a.light, b.light, c.light),
            local: mix(a.local, b.local, c.local),
            open: mix(a.open, b.open, c.open),
        }
    }
}

/// Part of a picture: `size` samples whose top left corner lies at `origin`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window {
    pub(crate) origin: [f32; 2],
    pub(crate) size: [usize; 2],
}

impl Window {
    /// Pixel coordinates to what euc wants: -1..1, +y up.
    fn device(&self, p: Vec3) -> [f32; 4] {
        [
            (p.x - self.origin[0]) * 2.0 / self.size[0] as f32 - 1.0,
            1.0 - (p.y - self.origin[1]) * 2.0 / self.size[1] as f32,
            p.z,
            1.0,
        ]
    }

    /// The triangles' indices, three by three, that may touch the window and have an area: euc divides by it.
    /// On request only those whose front (counter-clockwise) faces the eye.
    fn visible(&self, projected: &[Vec3], triangles: &[[u32; 3]], front_only: bool) -> Vec<u32> {
        let low = self.origin;
        let high = [low[0] + self.size[0] as f32, low[1] + self.size[1] as f32];
        let mut out = Vec::new();
        for t in triangles {
            let [a, b, c] = t.map(|i| projected[i as usize]);
            let (min, max) = (a.min(b).min(c), a.max(b).max(c));
            let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
            let inside = max.x >= low[0] && min.x <= high[0] && max.y >= low[1] && min.y <= high[1];
            // With y downwards a counter-clockwise triangle has a negative area.
            let front = !front_only || area < 0.0;
            if inside && front && area.abs() > 1e-5 {
                out.extend_from_slice(t);
            }
        }
        out
    }
}

struct DepthOnly<'a> {
    window: Window,
    projected: &'a [Vec3],
}

impl Pipeline for DepthOnly<'_> {
    type Vertex = u32;
    type VsOut = f32;
    type Pixel = ();

    fn vert(&self, vertex: &u32) -> ([f32; 4], f32) {
        (self.window.device(self.projected[*vertex as usize]), 0.0)
    }

    fn frag(&self, _: &f32) {}
}

/// The smallest depth per sample of what faces the eye, row by row; [`NOTHING`] where nothing does.
pub(crate) fn depth_map(window: Window, projected: &[Vec3], triangles: &[[u32; 3]]) -> Vec<f32> {
    let mut pixels = Buffer2d::new(window.size, ());
    let mut depth = Buffer2d::new(window.size, NOTHING);
    let indices = window.visible(projected, triangles, true);
    DepthOnly { window, projected }.draw::<Triangles<'_, _, BackfaceCullingDisabled>, _>(
        &indices,
        &mut pixels,
        Some(&mut depth),
    );
    depth.as_ref().to_vec()
}

struct Shaded<'a, F> {
    window: Window,
    projected: &'a [Vec3],
    varyings: &'a [Varying],
    shader: F,
    write_depth: bool,
}

impl<F: Fn(&Varying) -> [f32; 4]> Pipeline for Shaded<'_, F> {
    type Vertex = u32;
    type VsOut = Varying;
    type Pixel = [f32; 4];

    fn vert(&self, vertex: &u32) -> ([f32; 4], Varying) {
        let vertex = *vertex as usize;
        (self.window.device(self.projected[vertex]), self.varyings[vertex])
    }

    fn frag(&self, varying: &Varying) -> [f32; 4] {
        (self.shader)(varying)
    }

    fn get_depth_strategy(&self) -> DepthStrategy {
        if self.write_depth { DepthStrategy::IfLessWrite } else { DepthStrategy::IfLessNoWrite }
    }
}

/// One mesh as the rasteriser takes it.
pub(crate) struct Mesh<'a> {
    /// Pixels and depth per vertex.
    pub(crate) projected: &'a [Vec3],
    pub(crate) varyings: &'a [Varying],
    pub(crate) triangles: &'a [[u32; 3]],
}

/// The samples of a window.
pub(crate) struct Samples {
    window: Window,
    colour: Buffer2d<[f32; 4]>,
    veil: Buffer2d<[f32; 4]>,
    depth: Buffer2d<f32>,
}

impl Samples {
    pub(crate) fn new(window: Window) -> Self {
        Self {
            window,
            colour: Buffer2d::new(window.size, [0.0; 4]),
            veil: Buffer2d::new(window.size, [0.0; 4]),
            depth: Buffer2d::new(window.size, NOTHING),
        }
    }

    /// Draws an opaque mesh.
    pub(crate) fn draw(&mut self, mesh: &Mesh<'_>, shader: impl Fn(&Varying) -> [f32; 4]) {
        let indices = self.window.visible(mesh.projected, mesh.triangles, false);
        let pipeline = self.pipeline(mesh, shader, true);
        pipeline.draw::<Triangles<'_, _, BackfaceCullingDisabled>, _>(
            &indices,
            &mut self.colour,
            Some(&mut self.depth),
        );
    }

    /// Draws a translucent mesh (lashes) over what is there; call after every opaque one.
    pub(crate) fn draw_veil(&mut self, mesh: &Mesh<'_>, shader: impl Fn(&Varying) -> [f32; 4]) {
        let indices = self.window.visible(mesh.projected, mesh.triangles, false);
        let pipeline = self.pipeline(mesh, shader, false);
        pipeline.draw::<Triangles<'_, _, BackfaceCullingDisabled>, _>(
            &indices,
            &mut self.veil,
            Some(&mut self.depth),
        );
    }

    fn pipeline<'a, F: Fn(&Varying) -> [f32; 4]>(
        &self,
        mesh: &Mesh<'a>,
        shader: F,
        write_depth: bool,
    ) -> Shaded<'a, F> {
        Shaded {
            window: self.window,
            projected: mesh.projected,
            varyings: mesh.varyings,
            shader,
            write_depth,
        }
    }

    /// Closes cracks one sample wide: euc tests each triangle's own rounded edges, so that a sample on a shared edge
    /// may belong to neither side. Such a sample lies between two neighbours at one depth and far behind both.
    pub(crate) fn close_cracks(&mut self) {
        let [width, height] = self.window.size;
        let depth = self.depth.as_ref().to_vec();
        let colour = self.colour.as_mut();
        let out = self.depth.as_mut();
        for y in 0..height {
            for x in 0..width {
                let at = y * width + x;
                let joins = |a: usize, b: usize| {
                    let near = depth[a].max(depth[b]);
                    near < 1e6 && (depth[a] - depth[b]).abs() < 0.02 && depth[at] > near + 0.03
                };
                let from = if x > 0 && x + 1 < width && joins(at - 1, at + 1) {
                    at - 1
                } else if y > 0 && y + 1 < height && joins(at - width, at + width) {
                    at - width
                } else {
                    continue;
                };
                colour[at] = colour[from];
                out[at] = depth[from];
            }
        }
    }

    /// Premultiplied colour and coverage of a sample.
    pub(crate) fn get(&self, x: usize, y: usize) -> [f32; 4] {
        let at = y * self.window.size[0] + x;
        let base = self.colour.as_ref()[at];
        let veil = self.veil.as_ref()[at];
        let under = 1.0 - veil[3];
        [0, 1, 2, 3].map(|k| base[k] * under + if k == 3 { veil[3] } else { veil[k] * veil[3] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::figure::tests::sphere;

    #[test]
    fn a_sphere_covers_its_disc_without_holes() {
        let part = sphere(Vec3::new(100.0, 100.0, 0.0), 80.0, 48);
        let varyings = vec![Varying::default(); part.positions.len()];
        let window = Window { origin: [0.0, 0.0], size: [200, 200] };
        let mut samples = Samples::new(window);
        let mesh = Mesh { projected: &part.positions, varyings: &varyings, triangles: &part.triangles };
        samples.draw(&mesh, |_| [1.0; 4]);
        samples.close_cracks();
        let mut covered = 0;
        for y in 0..200 {
            for x in 0..200 {
                let r = libm::hypotf(x as f32 + 0.5 - 100.0, y as f32 + 0.5 - 100.0);
                let hit = samples.get(x, y)[3] > 0.5;
                covered += i32::from(hit);
                // The polygon's chord lies at most 80 (1 - cos(pi / 96)) = 0.04 px inside the circle.
                assert!(r > 79.5 || hit, "hole at {x}, {y}");
                assert!(r < 80.5 || !hit, "spill at {x}, {y}");
            }
        }
        let disc = std::f64::consts::PI * 80.0 * 80.0;
        assert!((f64::from(covered) / disc - 1.0).abs() < 0.005, "{covered} of {disc}");
    }

    #[test]
    fn windows_tile_a_picture() {
        let part = sphere(Vec3::new(40.0, 40.0, 0.0), 30.0, 16);
        let whole = depth_map(Window { origin: [0.0; 2], size: [80, 80] }, &part.positions, &part.triangles);
        let band =
            depth_map(Window { origin: [0.0, 32.0], size: [80, 16] }, &part.positions, &part.triangles);
        let different = band.iter().zip(&whole[32 * 80..48 * 80]).filter(|(a, b)| (*a - *b).abs() > 0.5);
        // Rounding may move single samples on the outline.
        assert!(different.count() < 6);
    }

    #[test]
    fn degenerate_triangles_draw_nothing() {
        let p = vec![Vec3::new(1.0, 1.0, 0.0); 3];
        let map = depth_map(Window { origin: [0.0; 2], size: [4, 4] }, &p, &[[0, 1, 2]]);
        assert!(map.iter().all(|d| *d == NOTHING));
    }
}
