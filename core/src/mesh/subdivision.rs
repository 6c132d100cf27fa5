//! One level of Catmull-Clark subdivision of a closed quad mesh (Catmull and Clark 1978), as a sparse stencil.
//!
//! The order of the refined vertices: one vertex point per cage vertex, then one edge point per edge, then one
//! face point per face. The first vertices of the refined mesh are therefore the cage's own, moved to the refined
//! surface; LOD 1 consists of them.

use glam::{DVec3, Vec3};

use super::topology::{Topology, edges_of};
use crate::{Error, Result};

/// The stencil of one Catmull-Clark level and the refined topology.
#[derive(Clone, Debug)]
pub struct Subdivision {
    refined: Topology,
    edges: Vec<[u32; 2]>,
    /// Compressed sparse rows: refined vertex r is the sum of `weights[i]` · cage vertex `indices[i]` over i in
    /// `offsets[r]..offsets[r + 1]`.
    offsets: Vec<u32>,
    indices: Vec<u32>,
    weights: Vec<f32>,
}

impl Subdivision {
    /// Builds the stencil of a closed manifold cage.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the cage is inconsistent or has a border edge.
    pub fn new(cage: &Topology) -> Result<Self> {
        cage.validate()?;
        let (edges, face_edges) = edges_of(&cage.quads);
        let rows = stencil_rows(cage, &edges, &Neighbours::of(cage, &edges, &face_edges)?)?;
        let (v_count, e_count) = (cage.vertex_count, edges.len());
        let edge_point = |e: u32| v_count as u32 + e;
        let face_point = |f: usize| (v_count + e_count + f) as u32;
        let mut quads = Vec::with_capacity(4 * cage.quads.len());
        for (f, (quad, of_face)) in cage.quads.iter().zip(&face_edges).enumerate() {
            for k in 0..4 {
                quads.push([
                    quad[k],
                    edge_point(of_face[k]),
                    face_point(f),
                    edge_point(of_face[(k + 3) % 4]),
                ]);
            }
        }
        let (uvs, quad_uvs) = refine_uvs(cage);
        let refined = Topology { vertex_count: v_count + e_count + cage.quads.len(), quads, uvs, quad_uvs };
        Ok(Self { refined, edges, offsets: rows.offsets, indices: rows.indices, weights: rows.weights })
    }

    /// The refined mesh's topology.
    pub fn refined(&self) -> &Topology {
        &self.refined
    }

    /// The cage's edges, in the order of the edge points.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The cage vertices and weights that make one refined vertex; the weights sum to one.
    pub fn stencil(&self, refined_vertex: usize) -> impl Iterator<Item = (u32, f32)> + '_ {
        let range = self.offsets[refined_vertex] as usize..self.offsets[refined_vertex + 1] as usize;
        self.indices[range.clone()].iter().copied().zip(self.weights[range].iter().copied())
    }

    /// Refines positions, in any unit and space: `cage` has one point per cage vertex, the result one per refined vertex.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the number of points is not the cage's.
    pub fn refine(&self, cage: &[Vec3]) -> Result<Vec<Vec3>> {
        self.check(cage.len())?;
        let mut out = Vec::with_capacity(self.refined.vertex_count);
        for r in 0..self.refined.vertex_count {
            let range = self.offsets[r] as usize..self.offsets[r + 1] as usize;
            let mut sum = Vec3::ZERO;
            for (&i, &w) in self.indices[range.clone()].iter().zip(&self.weights[range]) {
                sum += cage[i as usize] * w;
            }
            out.push(sum);
        }
        Ok(out)
    }

    /// As [`refine`](Self::refine), in double precision, for measuring.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the number of points is not the cage's.
    pub fn refine_f64(&self, cage: &[DVec3]) -> Result<Vec<DVec3>> {
        self.check(cage.len())?;
        Ok((0..self.refined.vertex_count)
            .map(|r| self.stencil(r).map(|(i, w)| cage[i as usize] * f64::from(w)).sum())
            .collect())
    }

    /// Number of the cage's vertices.
    pub fn cage_len(&self) -> usize {
        // One vertex point per cage vertex, one edge point per edge, one face point per face; each face became four quads.
        self.refined.vertex_count - self.edges.len() - self.refined.quads.len() / 4
    }

    fn check(&self, points: usize) -> Result<()> {
        let cage = self.cage_len();
        if points == cage {
            Ok(())
        } else {
            Err(Error::invalid("cage", format!("expected {cage} vertices, got {points}")))
        }
    }
}

/// The faces at each edge, and the faces and edges at each vertex, of the cage.
struct Neighbours {
    edge_faces: Vec<[u32; 2]>,
    vertex_faces: Vec<Vec<u32>>,
    vertex_edges: Vec<Vec<u32>>,
}

impl Neighbours {
    fn of(cage: &Topology, edges: &[[u32; 2]], face_edges: &[[u32; 4]]) -> Result<Self> {
        let mut edge_faces = vec![[u32::MAX; 2]; edges.len()];
        let mut vertex_faces = vec![Vec::new(); cage.vertex_count];
        let mut vertex_edges = vec![Vec::new(); cage.vertex_count];
        for (f, (quad, of_face)) in cage.quads.iter().zip(face_edges).enumerate() {
            for &v in quad {
                vertex_faces[v as usize].push(f as u32);
            }
            for &e in of_face {
                let slots = &mut edge_faces[e as usize];
                let free = slots.iter_mut().find(|slot| **slot == u32::MAX).ok_or_else(|| {
                    Error::invalid(
                        "topology",
                        format!("edge {:?} has more than two faces", edges[e as usize]),
                    )
                })?;
                *free = f as u32;
            }
        }
        if let Some(e) = edge_faces.iter().position(|f| f[1] == u32::MAX) {
            return Err(Error::invalid("topology", format!("edge {:?} is on a border", edges[e])));
        }
        for (e, edge) in edges.iter().enumerate() {
            for &v in edge {
                vertex_edges[v as usize].push(e as u32);
            }
        }
        Ok(Self { edge_faces, vertex_faces, vertex_edges })
    }
}

/// The rows of the stencil: vertex points, edge points, face points.
fn stencil_rows(cage: &Topology, edges: &[[u32; 2]], neighbours: &Neighbours) -> Result<Rows> {
    let Neighbours { edge_faces, vertex_faces, vertex_edges } = neighbours;
    let mut rows = Rows::default();
    for v in 0..cage.vertex_count {
        // (Q + 2R + (n − 3) S) / n: Q is the mean of the face points around, R that of the edge midpoints, S the vertex.
        let n = vertex_faces[v].len() as f64;
        if n < 3.0 || vertex_edges[v].len() != vertex_faces[v].len() {
            return Err(Error::invalid("topology", format!("vertex {v} is not inside a closed surface")));
        }
        rows.add(v as u32, (n - 3.0) / n);
        for &f in &vertex_faces[v] {
            for &q in &cage.quads[f as usize] {
                rows.add(q, 0.25 / (n * n));
            }
        }
        for &e in &vertex_edges[v] {
            for &q in &edges[e as usize] {
                rows.add(q, 1.0 / (n * n));
            }
        }
        rows.finish();
    }
    for (edge, faces) in edges.iter().zip(edge_faces) {
        for &q in edge {
            rows.add(q, 0.25);
        }
        for &f in faces {
            for &q in &cage.quads[f as usize] {
                rows.add(q, 0.0625);
            }
        }
        rows.finish();
    }
    for quad in &cage.quads {
        for &q in quad {
            rows.add(q, 0.25);
        }
        rows.finish();
    }
    Ok(rows)
}

/// Texture coordinates and faces over them, refined linearly per chart: corners stay, then midpoints of edges, then
/// centres of faces.
fn refine_uvs(cage: &Topology) -> (Vec<[f32; 2]>, Vec<[u32; 4]>) {
    let (edges, face_edges) = edges_of(&cage.quad_uvs);
    let at = |i: u32| cage.uvs[i as usize];
    let mut uvs = cage.uvs.clone();
    for &[a, b] in &edges {
        uvs.push([(at(a)[0] + at(b)[0]) * 0.5, (at(a)[1] + at(b)[1]) * 0.5]);
    }
    for quad in &cage.quad_uvs {
        let sum = quad.iter().fold([0.0, 0.0], |s, &i| [s[0] + at(i)[0], s[1] + at(i)[1]]);
        uvs.push([sum[0] * 0.25, sum[1] * 0.25]);
    }
    let edge_uv = |e: u32| cage.uvs.len() as u32 + e;
    let face_uv = |f: usize| (cage.uvs.len() + edges.len() + f) as u32;
    let mut quad_uvs = Vec::with_capacity(4 * cage.quads.len());
    for (f, (quad, of_face)) in cage.quad_uvs.iter().zip(&face_edges).enumerate() {
        for k in 0..4 {
            quad_uvs.push([quad[k], edge_uv(of_face[k]), face_uv(f), edge_uv(of_face[(k + 3) % 4])]);
        }
    }
    (uvs, quad_uvs)
}

/// Builds compressed sparse rows; entries of one row in the same column are added up.
#[derive(Default)]
struct Rows {
    row: std::collections::BTreeMap<u32, f64>,
    offsets: Vec<u32>,
    indices: Vec<u32>,
    weights: Vec<f32>,
}

impl Rows {
    fn add(&mut self, column: u32, weight: f64) {
        *self.row.entry(column).or_insert(0.0) += weight;
    }

    fn finish(&mut self) {
        if self.offsets.is_empty() {
            self.offsets.push(0);
        }
        for (column, weight) in std::mem::take(&mut self.row) {
            if weight != 0.0 {
                self.indices.push(column);
                self.weights.push(weight as f32);
            }
        }
        self.offsets.push(self.indices.len() as u32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> (Topology, Vec<Vec3>) {
        let points = (0..8)
            .map(|i| Vec3::new((i & 1) as f32, ((i >> 1) & 1) as f32, ((i >> 2) & 1) as f32) * 2.0 - 1.0)
            .collect();
        let quads = vec![[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let quad_uvs = vec![[0, 1, 2, 3]; 6];
        (Topology { vertex_count: 8, quads, uvs, quad_uvs }, points)
    }

    #[test]
    fn a_cube_is_refined_as_in_the_paper_of_1978() {
        let (cage, points) = cube();
        let cc = Subdivision::new(&cage).unwrap();
        assert_eq!((cc.refined().vertex_count, cc.refined().quads.len()), (8 + 12 + 6, 24));
        cc.refined().validate().unwrap();
        let fine = cc.refine(&points).unwrap();
        // Corner of a cube: 5/9 of the way out; edge point 3/4; face point stays. Tolerance: rounding of f32.
        assert!((fine[7] - Vec3::splat(5.0 / 9.0)).length() < 1e-6, "{}", fine[7]);
        let edge = cc.edges().iter().position(|e| *e == [6, 7]).unwrap();
        assert!((fine[8 + edge] - Vec3::new(0.0, 0.75, 0.75)).length() < 1e-6, "{}", fine[8 + edge]);
        assert!((fine[20 + 1] - Vec3::new(0.0, 0.0, 1.0)).length() < 1e-6);
        for r in 0..26 {
            // Tolerance: eight weights rounded to f32.
            assert!((cc.stencil(r).map(|(_, w)| w).sum::<f32>() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn an_open_cage_is_refused() {
        let (mut cage, _) = cube();
        cage.quads.pop();
        cage.quad_uvs.pop();
        assert!(Subdivision::new(&cage).unwrap_err().to_string().contains("border"));
        let (cage, points) = cube();
        assert!(Subdivision::new(&cage).unwrap().refine(&points[1..]).is_err());
    }
}
