//! Levels of detail 2 and 3: the cage with fewer faces, over the cage's own vertices.
//!
//! meshoptimizer collapses edges of the mean body towards existing vertices, so that a level is an index list that
//! fits every body. Texture seams are kept: vertices are split at seams first, as files split them.

use std::collections::HashMap;

use anthronet::mesh::Topology;
use anthronet::model::ReducedMesh;
use glam::Vec3;
use meshopt::{SimplifyOptions, VertexDataAdapter, simplify};

use crate::{Error, Result};

/// Share of the cage's triangles that levels 2 and 3 keep.
pub const SHARES: [f64; 2] = [0.25, 0.0625];

/// Reduces the mean body to a share of its triangles.
///
/// # Errors
/// [`Error::Invalid`] when the mesh cannot be reduced that far.
pub fn reduce(cage: &Topology, mean: &[Vec3], share: f64) -> Result<ReducedMesh> {
    let mut split: HashMap<(u32, u32), u32> = HashMap::new();
    let mut corners: Vec<(u32, u32)> = Vec::new();
    let mut indices = Vec::new();
    for (quad, uvs) in cage.quads.iter().zip(&cage.quad_uvs) {
        for k in [0, 1, 2, 0, 2, 3] {
            let corner = (quad[k], uvs[k]);
            indices.push(*split.entry(corner).or_insert_with(|| {
                corners.push(corner);
                (corners.len() - 1) as u32
            }));
        }
    }
    let positions: Vec<[f32; 3]> = corners.iter().map(|c| mean[c.0 as usize].to_array()).collect();
    let adapter = VertexDataAdapter::new(bytemuck::cast_slice(&positions), 12, 0)
        .map_err(|e| Error::Invalid(format!("levels of detail: {e:?}")))?;
    let target = (indices.len() as f64 * share) as usize / 3 * 3;
    let options = SimplifyOptions::Permissive | SimplifyOptions::RegularizeLight;
    let kept = simplify(&indices, &adapter, target, 1.0, options, None);
    if kept.is_empty() || kept.len() > target * 3 / 2 {
        return Err(Error::Invalid(format!(
            "levels of detail: {} of {} triangles are left, wanted {}",
            kept.len() / 3,
            indices.len() / 3,
            target / 3
        )));
    }
    let mut vertices: Vec<u32> = kept.iter().map(|&i| corners[i as usize].0).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let place: HashMap<u32, u32> = vertices.iter().enumerate().map(|(new, &old)| (old, new as u32)).collect();
    let corner = |i: u32| corners[i as usize];
    let triangles: Vec<&[u32]> = kept
        .chunks_exact(3)
        .filter(|t| {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| corner(i).0);
            a != b && b != c && c != a
        })
        .collect();
    Ok(ReducedMesh {
        triangles: triangles.iter().map(|t| [t[0], t[1], t[2]].map(|i| place[&corner(i).0])).collect(),
        triangle_uvs: triangles.iter().map(|t| [t[0], t[1], t[2]].map(|i| corner(i).1)).collect(),
        vertices,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bent sheet of n × n quads.
    fn sheet(n: u32) -> (Topology, Vec<Vec3>) {
        let at = |i: u32, j: u32| i * (n + 1) + j;
        let quads: Vec<[u32; 4]> = (0..n * n)
            .map(|q| (q / n, q % n))
            .map(|(i, j)| [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)])
            .collect();
        let points = |scale: f32| {
            (0..(n + 1) * (n + 1)).map(move |v| [(v / (n + 1)) as f32 * scale, (v % (n + 1)) as f32 * scale])
        };
        let topology = Topology {
            vertex_count: points(1.0).count(),
            quad_uvs: quads.clone(),
            quads,
            uvs: points(1.0 / n as f32).collect(),
        };
        (topology, points(0.01).map(|[x, y]| Vec3::new(x, y, 4.0 * x * y)).collect())
    }

    #[test]
    fn a_level_is_a_list_over_the_vertices_that_are_there() {
        let (cage, mean) = sheet(24);
        let level = reduce(&cage, &mean, 0.25).unwrap();
        let triangles = 2 * cage.quads.len();
        let share = level.triangles.len() as f64 / triangles as f64;
        assert!((0.15..0.3).contains(&share), "{share}");
        assert!(level.vertices.is_sorted() && level.vertices.len() < cage.vertex_count / 2);
        for (triangle, uvs) in level.triangles.iter().zip(&level.triangle_uvs) {
            let [a, b, c] = triangle.map(|v| level.vertices[v as usize]);
            assert!(a != b && b != c && c != a);
            // Without seams a corner's texture coordinate has its vertex's number.
            assert_eq!(*uvs, [a, b, c]);
        }
        assert_eq!(level, reduce(&cage, &mean, 0.25).unwrap());
    }

    #[test]
    fn what_cannot_be_reduced_is_refused() {
        let (cage, mean) = sheet(1);
        let message = reduce(&cage, &mean, 0.1).unwrap_err().to_string();
        assert!(message.contains("levels of detail"), "{message}");
    }
}
