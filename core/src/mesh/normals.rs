//! Smooth vertex normals: the area-weighted mean of the normals of the faces around a vertex.

use glam::Vec3;

/// The faces around each vertex, in compressed rows: normals are gathered per vertex in a fixed order of summation.
#[derive(Clone, Debug, Default)]
pub struct VertexFaces {
    /// Faces around vertex v: `faces[offsets[v]..offsets[v + 1]]`.
    offsets: Vec<u32>,
    faces: Vec<u32>,
}

impl VertexFaces {
    /// Collects the faces around each of `vertex_count` vertices; indices out of range are ignored.
    pub fn new<const N: usize>(vertex_count: usize, faces: &[[u32; N]]) -> Self {
        let mut offsets = vec![0_u32; vertex_count + 1];
        for &v in faces.iter().flatten() {
            if let Some(count) = offsets.get_mut(v as usize + 1) {
                *count += 1;
            }
        }
        for i in 1..offsets.len() {
            offsets[i] += offsets[i - 1];
        }
        let mut next = offsets.clone();
        let mut around = vec![0; offsets[vertex_count] as usize];
        for (f, face) in faces.iter().enumerate() {
            for &v in face.iter().filter(|v| (**v as usize) < vertex_count) {
                around[next[v as usize] as usize] = f as u32;
                next[v as usize] += 1;
            }
        }
        Self { offsets, faces: around }
    }
}

/// Unit normals of a quad mesh, one per vertex of `around`, in the space of `positions`; +Y where the faces around a
/// vertex have no area.
///
/// The area vector of a quad, planar or not, is half the cross product of its diagonals; the factor is left out, as the sum
/// is normalised.
pub fn vertex_normals(positions: &[Vec3], quads: &[[u32; 4]], around: &VertexFaces) -> Vec<Vec3> {
    let at = |i: u32| positions.get(i as usize).copied().unwrap_or_default();
    let area_vectors: Vec<Vec3> =
        quads.iter().map(|q| (at(q[2]) - at(q[0])).cross(at(q[3]) - at(q[1]))).collect();
    around
        .offsets
        .windows(2)
        .map(|range| {
            let mut sum = Vec3::ZERO;
            for &f in &around.faces[range[0] as usize..range[1] as usize] {
                sum += area_vectors[f as usize];
            }
            sum.try_normalize().unwrap_or(Vec3::Y)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_quad_has_one_normal_and_a_loose_vertex_gets_the_fallback() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 0.0, -1.0), Vec3::NEG_Z, Vec3::ONE];
        let quads = [[0, 1, 2, 3]];
        let normals = vertex_normals(&positions, &quads, &VertexFaces::new(5, &quads));
        assert!(normals.iter().all(|n| (*n - Vec3::Y).length() < 1e-6), "{normals:?}");
    }
}
