//! Measuring a mesh at any level of detail: from its vertices back to the surface that measures are defined on.
//!
//! Level 0 is that surface. Level 1 is its first vertices, the cage's vertices after one Catmull-Clark step: that step
//! is undone exactly, then taken again. Levels 2 and 3 are some of those vertices: the body of the shape space nearest
//! to them is fitted, which for bodies of this model is the body itself.

use glam::{DVec3, Vec3};

use super::generator::Model;
use super::shape_space::ShapeSpace;
use crate::math::cholesky::Cholesky;
use crate::measure::{Mass, MeasureId, Measurements, enclosed_volume};
use crate::mesh::{Lod, Subdivision};
use crate::{Error, Result};

/// What the tape and the scales say of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredMesh {
    /// The level of detail that the mesh was recognised as, by its number of vertices.
    pub lod: Lod,
    /// All measures, metres.
    pub measurements: Measurements,
    /// Volume, mass and body mass index.
    pub mass: Mass,
}

impl Model {
    /// Measures a body in its bind pose at any level of detail: `vertices` are those of the body alone, in model order,
    /// metres, +Y up; where it stands does not matter.
    ///
    /// Levels 0 and 1 are measured exactly, whatever their shape. Of levels 2 and 3 the nearest body of the model is
    /// measured: exact to 0.05 mm for bodies of this model, an estimate for others.
    ///
    /// # Errors
    /// As [`Model::surface_of_mesh`].
    pub fn measure_mesh(&self, vertices: &[Vec3]) -> Result<MeasuredMesh> {
        let (lod, surface) = self.surface_of_mesh(vertices)?;
        let at = |v: u32| surface[v as usize];
        let measurements = self.definitions().read_all(at);
        let volume = enclosed_volume(at, &self.character().subdivision().refined().quads);
        let mass = Mass::new(volume, measurements[MeasureId::HEIGHT.index()]);
        Ok(MeasuredMesh { lod, measurements, mass })
    }

    /// The vertices of level 0 of a body whose vertices of any level are given, as [`Model::measure_mesh`] takes them:
    /// metres, in model order, with the level that their number tells.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a number of vertices that is no level's, for one that is not finite or further than a
    /// kilometre from the origin, and for vertices that do not determine a body.
    pub fn surface_of_mesh(&self, vertices: &[Vec3]) -> Result<(Lod, Vec<DVec3>)> {
        /// Metres: beyond any character, and far from where numbers lose what a tape needs.
        const FAR: f32 = 1_000.0;
        let character = self.character();
        let Some(lod) = Lod::ALL.into_iter().find(|lod| character.vertex_count(*lod) == vertices.len())
        else {
            let known = Lod::ALL.map(|lod| character.vertex_count(lod).to_string()).join(", ");
            let message = format!("expected {known} vertices in the model's order, got {}", vertices.len());
            return Err(Error::invalid("body", message));
        };
        if let Some(i) = vertices.iter().position(|p| !(p.abs().max_element() <= FAR && p.is_finite())) {
            let message = format!("vertex {i}: expected metres below {FAR}, got {}", vertices[i]);
            return Err(Error::invalid("body", message));
        }
        let points: Vec<DVec3> = vertices.iter().map(|p| p.as_dvec3()).collect();
        let subdivision = character.subdivision();
        let cage = match character.reduced(lod) {
            None if lod == Lod::Lod0 => return Ok((lod, points)),
            None => undo_subdivision(subdivision, &points),
            Some(mesh) => fit(self.shape_space(), subdivision, &mesh.vertices, &points),
        };
        let cage =
            cage.ok_or_else(|| Error::invalid("body", "its vertices determine no body of this model"))?;
        Ok((lod, subdivision.refine_f64(&cage)?))
    }
}

/// The cage whose Catmull-Clark vertex points are these. The step's matrix has eigenvalues between 0 and 1, so that
/// Richardson's iteration converges; `None` if it does not.
fn undo_subdivision(subdivision: &Subdivision, points: &[DVec3]) -> Option<Vec<DVec3>> {
    /// Metres; far below what a file's single precision resolves.
    const TOLERANCE: f64 = 1e-11;
    const STEP: f64 = 1.5;
    let mut cage = points.to_vec();
    for _ in 0..20_000 {
        let mut worst = 0.0_f64;
        let residuals: Vec<DVec3> = (0..points.len())
            .map(|v| {
                let moved: DVec3 = subdivision.stencil(v).map(|(i, w)| cage[i as usize] * f64::from(w)).sum();
                points[v] - moved
            })
            .collect();
        for (vertex, residual) in cage.iter_mut().zip(residuals) {
            worst = worst.max(residual.abs().max_element());
            *vertex += residual * STEP;
        }
        if worst < TOLERANCE {
            return Some(cage);
        }
    }
    None
}

/// The cage of the body of the shape space nearest to some level-1 vertices, up to a shift: files stand on the ground.
fn fit(
    space: &ShapeSpace,
    subdivision: &Subdivision,
    vertices: &[u32],
    points: &[DVec3],
) -> Option<Vec<DVec3>> {
    let count = space.components();
    // Unknowns: coefficients in standard deviations, then the shift in metres.
    let unknowns = count + 3;
    let mut rows = Vec::with_capacity(points.len() * 3);
    let mut right = Vec::with_capacity(points.len() * 3);
    for (vertex, point) in vertices.iter().zip(points) {
        let mut mean = DVec3::ZERO;
        let mut row = vec![[0.0; 3]; unknowns];
        for (cage, weight) in subdivision.stencil(*vertex as usize) {
            let weight = f64::from(weight);
            mean += space.mean_point(cage as usize).as_dvec3() * weight;
            for (k, (entry, deviation)) in row.iter_mut().zip(space.deviations()).enumerate() {
                let component = space.component(k, cage as usize);
                for axis in 0..3 {
                    entry[axis] += weight * deviation * component[axis];
                }
            }
        }
        let gap = (*point - mean).to_array();
        for axis in 0..3 {
            row[count + axis][axis] = 1.0;
            rows.push(row.iter().map(|entry| entry[axis]).collect::<Vec<f64>>());
            right.push(gap[axis]);
        }
    }
    let solution = least_squares(&rows, &right, unknowns)?;
    let coefficients: Vec<f64> =
        solution.iter().zip(space.deviations()).map(|(u, deviation)| u * deviation).collect();
    Some(space.body(&coefficients).iter().take(subdivision.cage_len()).map(|p| p.as_dvec3()).collect())
}

/// Smallest `|A x - b|² + (10 µm)² |x|²` by Cholesky, refined twice. `None` for numbers that are not finite.
fn least_squares(rows: &[Vec<f64>], right: &[f64], n: usize) -> Option<Vec<f64>> {
    const RIDGE: f64 = 1e-10;
    let mut normal = vec![0.0; n * n];
    for row in rows {
        for i in (0..n).filter(|i| row[*i] != 0.0) {
            for (sum, x) in normal[i * n..=i * n + i].iter_mut().zip(row) {
                *sum += row[i] * x;
            }
        }
    }
    for i in 0..n {
        normal[i * n + i] += RIDGE;
    }
    let factor = Cholesky::new(&normal, n)?;
    let mut x = vec![0.0; n];
    for _ in 0..3 {
        let mut step: Vec<f64> = x.iter().map(|x| -RIDGE * x).collect();
        for (row, b) in rows.iter().zip(right) {
            let gap = b - row.iter().zip(&x).map(|(a, x)| a * x).sum::<f64>();
            for (s, a) in step.iter_mut().zip(row) {
                *s += a * gap;
            }
        }
        factor.solve(&mut step);
        x.iter_mut().zip(&step).for_each(|(x, s)| *x += s);
    }
    x.iter().all(|v| v.is_finite()).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Topology;

    #[test]
    fn subdivision_is_undone() {
        // A torus of 6 by 5 quads.
        let at = |i: u32, j: u32| (i % 6) * 5 + j % 5;
        let quads: Vec<[u32; 4]> = (0..30)
            .map(|k| (k / 5, k % 5))
            .map(|(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
            .collect();
        let quad_uvs = vec![[0; 4]; 30];
        let torus = Topology { vertex_count: 30, quads, uvs: vec![[0.0; 2]], quad_uvs };
        let subdivision = Subdivision::new(&torus).unwrap();
        let cage: Vec<DVec3> = (0..30_u32)
            .map(|v| DVec3::new(f64::from(v * 7 % 11), f64::from(v * 5 % 13), f64::from(v * 3 % 17)))
            .collect();
        let refined = subdivision.refine_f64(&cage).unwrap();
        let back = undo_subdivision(&subdivision, &refined[..30]).unwrap();
        for (a, b) in back.iter().zip(&cage) {
            assert!(a.distance(*b) < 1e-9, "{a} for {b}");
        }
    }

    #[test]
    fn least_squares_finds_an_exact_solution() {
        let truth = [0.5, -2.0, 3.0];
        let rows: Vec<Vec<f64>> = (0..9_u32)
            .map(|i| (0..3_u32).map(|k| f64::from((i * 7 + k * 5 + i * k * 3) % 11) - 4.0).collect())
            .collect();
        let right: Vec<f64> = rows.iter().map(|r| r.iter().zip(&truth).map(|(a, x)| a * x).sum()).collect();
        let x = least_squares(&rows, &right, 3).unwrap();
        assert!(x.iter().zip(&truth).all(|(a, b)| (a - b).abs() < 1e-9), "{x:?}");
        assert!(least_squares(&[vec![f64::NAN; 3]], &[1.0], 3).is_none());
    }
}
