//! Measuring a mesh at any level of detail: reconstruction of the surface that measures are defined on.
//!
//! LOD 0 is that surface. LOD 1 consists of its first vertices, the vertex points of the Catmull-Clark step: the step is
//! inverted to get the cage, which is then subdivided again. LODs 2 and 3 are subsets of those vertices: the nearest body of
//! the shape space is fitted to them, which for bodies of this model is the body itself.

use glam::{DVec3, Vec3};

use super::generator::Model;
use super::placement::Placement;
use super::shape_space::ShapeSpace;
use crate::math::least_squares;
use crate::measure::{Mass, MeasureId, Measurements, enclosed_volume};
use crate::mesh::{Lod, Subdivision};
use crate::{Error, Result};

/// Ridge of the fit to few vertices, (10 µm)²: a coefficient one standard deviation off costs as much as a coordinate 10 µm
/// off.
const RIDGE: f64 = 1e-10;

/// Relaxation of the Richardson iteration, below its limit of 2 for eigenvalues up to 1.
const RELAXATION: f64 = 1.5;

/// The measures and mass of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredMesh {
    /// The mesh's level of detail, inferred from its number of vertices.
    pub lod: Lod,
    /// All measures, metres.
    pub measurements: Measurements,
    /// Volume, mass and body mass index.
    pub mass: Mass,
    /// Positions of the landmarks, in the order of [`Model::landmarks`], metres; model space, standing where the vertices
    /// stand.
    pub landmarks: Vec<DVec3>,
    /// How the vertices were read where they are not in metres, +Y up and +Z forward; one sentence each.
    pub warnings: Vec<String>,
}

impl Model {
    /// Measures a body in its bind pose at any level of detail: `vertices` are those of the body without accessories, in
    /// model order, metres, +Y up, +Z forward; where it stands does not matter.
    ///
    /// LODs 0 and 1 are measured exactly, whatever their shape. For LODs 2 and 3 the nearest body of the model is measured:
    /// exact to 0.05 mm for bodies of this model, an estimate for others.
    ///
    /// # Errors
    /// As [`Model::surface_of_mesh`].
    pub fn measure_mesh(&self, vertices: &[Vec3]) -> Result<MeasuredMesh> {
        let (lod, surface) = self.surface_of_mesh(vertices)?;
        let at = |v: u32| surface[v as usize];
        let measurements = self.definitions().read_all(at);
        let volume = enclosed_volume(at, &self.character().subdivision().refined().quads);
        let mass = Mass::new(volume, measurements[MeasureId::HEIGHT.index()]);
        let landmarks = self.landmarks().positions(at);
        Ok(MeasuredMesh { lod, measurements, mass, landmarks, warnings: Vec::new() })
    }

    /// [`measure_mesh`](Self::measure_mesh) for vertices that come back from elsewhere: in another unit or other axes, which
    /// the body itself tells, and [`MeasuredMesh::warnings`] then says.
    ///
    /// # Errors
    /// As [`measure_mesh`](Self::measure_mesh), but for unit and axes only where they cannot be told.
    pub(crate) fn measure_foreign_mesh(&self, vertices: &[Vec3]) -> Result<MeasuredMesh> {
        let lod = self.level_of(vertices)?;
        if let Some(i) = vertices.iter().position(|p| !p.is_finite()) {
            let message = format!("vertex {i}: expected finite numbers, got {}", vertices[i]);
            return Err(Error::invalid("body", message));
        }
        let placement = self.placement(lod, vertices)?;
        if placement == Placement::OURS {
            return self.measure_mesh(vertices);
        }
        let measured = self.measure_mesh(&placement.apply(vertices))?;
        Ok(MeasuredMesh { warnings: vec![format!("read with {placement}")], ..measured })
    }

    /// Reconstructs the vertices of LOD 0 (metres, model order) from those of any level of detail, which are as for
    /// [`Model::measure_mesh`]; with the level, inferred from their number.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a number of vertices that no level has, for a coordinate that is not finite or beyond a
    /// kilometre, for vertices in another order, mirrored, or in another unit or other axes, and for vertices that do not
    /// determine a body.
    pub fn surface_of_mesh(&self, vertices: &[Vec3]) -> Result<(Lod, Vec<DVec3>)> {
        /// Largest coordinate, metres: far beyond any character, and still precise enough to be measured.
        const MAX_COORDINATE: f32 = 1_000.0;
        let character = self.character();
        let lod = self.level_of(vertices)?;
        if let Some(i) =
            vertices.iter().position(|p| !(p.abs().max_element() <= MAX_COORDINATE && p.is_finite()))
        {
            let message = format!("vertex {i}: expected metres below {MAX_COORDINATE}, got {}", vertices[i]);
            return Err(Error::invalid("body", message));
        }
        let placement = self.placement(lod, vertices)?;
        if placement != Placement::OURS {
            let message = format!("expected metres, +Y up and +Z forward, got {placement}");
            return Err(Error::invalid("body", message));
        }
        let points: Vec<DVec3> = vertices.iter().map(|p| p.as_dvec3()).collect();
        let subdivision = character.subdivision();
        let cage = match character.reduced(lod) {
            None if lod == Lod::Lod0 => return Ok((lod, points)),
            None => invert_subdivision(subdivision, &points),
            Some(mesh) => fit_cage(self.shape_space(), subdivision, &mesh.vertices, &points),
        };
        let cage =
            cage.ok_or_else(|| Error::invalid("body", "its vertices determine no body of this model"))?;
        Ok((lod, subdivision.refine_f64(&cage)?))
    }

    /// The level of detail that has so many vertices.
    fn level_of(&self, vertices: &[Vec3]) -> Result<Lod> {
        let count = |lod| self.character().vertex_count(lod);
        Lod::ALL.into_iter().find(|lod| count(*lod) == vertices.len()).ok_or_else(|| {
            let known = Lod::ALL.map(|lod| count(lod).to_string()).join(", ");
            let message = format!("expected {known} vertices in the model's order, got {}", vertices.len());
            Error::invalid("body", message)
        })
    }
}

/// The cage that has these Catmull-Clark vertex points, by Richardson iteration with relaxation [`RELAXATION`]. It converges,
/// as the matrix from cage to vertex points has eigenvalues in (0, 1]; `None` if it does not.
fn invert_subdivision(subdivision: &Subdivision, points: &[DVec3]) -> Option<Vec<DVec3>> {
    /// Metres; far below the resolution of single precision.
    const TOLERANCE: f64 = 1e-11;
    let mut cage = points.to_vec();
    for _ in 0..20_000 {
        let mut worst = 0.0_f64;
        let residuals: Vec<DVec3> = (0..points.len())
            .map(|v| {
                let vertex_point: DVec3 =
                    subdivision.stencil(v).map(|(i, w)| cage[i as usize] * f64::from(w)).sum();
                points[v] - vertex_point
            })
            .collect();
        for (vertex, residual) in cage.iter_mut().zip(residuals) {
            worst = worst.max(residual.abs().max_element());
            *vertex += residual * RELAXATION;
        }
        if worst < TOLERANCE {
            return Some(cage);
        }
    }
    None
}

/// The cage of the body of the shape space that is nearest to a subset of the vertices of LOD 1, up to a translation, as
/// bodies in files stand on the ground.
fn fit_cage(
    space: &ShapeSpace,
    subdivision: &Subdivision,
    vertices: &[u32],
    points: &[DVec3],
) -> Option<Vec<DVec3>> {
    let count = space.components();
    // Unknowns: coefficients in standard deviations, then the translation in metres.
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
    let solution = least_squares(&rows, &right, unknowns, RIDGE)?;
    let coefficients: Vec<f64> =
        solution.iter().zip(space.deviations()).map(|(u, deviation)| u * deviation).collect();
    Some(space.body(&coefficients).iter().take(subdivision.cage_len()).map(|p| p.as_dvec3()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Topology;

    #[test]
    fn subdivision_is_inverted() {
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
        let back = invert_subdivision(&subdivision, &refined[..30]).unwrap();
        for (a, b) in back.iter().zip(&cage) {
            assert!(a.distance(*b) < 1e-9, "{a} for {b}");
        }
    }
}
