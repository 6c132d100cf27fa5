//! Merges vertices that were duplicated at texture seams.

use crate::scene::SceneMesh;

/// For every vertex, the index of its original among the first `vertices`: the first at the same position for which
/// `same` holds. `Err` holds a vertex that has no original.
pub(super) fn originals(
    mesh: &SceneMesh,
    vertices: usize,
    same: impl Fn(usize, usize) -> bool,
) -> Result<Vec<u32>, usize> {
    let mut originals: Vec<u32> = (0..vertices as u32).collect();
    let written = mesh.positions.len();
    if vertices == written {
        return Ok(originals);
    }
    let bits = |v: usize| mesh.positions[v].map(f32::to_bits);
    let mut sorted: Vec<usize> = (0..vertices).collect();
    sorted.sort_by_key(|v| (bits(*v), *v));
    for copy in vertices..written {
        let first = sorted.partition_point(|v| bits(*v) < bits(copy));
        let candidates = sorted.get(first..).unwrap_or_default();
        let mut candidates = candidates.iter().take_while(|v| bits(**v) == bits(copy));
        let found = candidates.find(|v| same(**v, copy)).ok_or(copy)?;
        originals.push(*found as u32);
    }
    Ok(originals)
}

/// Keeps the first `vertices` vertices. Texture coordinates are kept, as every copy has its own.
pub(super) fn merge(mesh: &mut SceneMesh, vertices: usize, originals: &[u32]) {
    let corners = mesh.triangles.positions.iter_mut().flatten();
    corners.for_each(|corner| *corner = originals.get(*corner as usize).copied().unwrap_or(*corner));
    mesh.positions.truncate(vertices);
    mesh.normals.truncate(vertices);
    for target in &mut mesh.morph_targets {
        target.positions.truncate(vertices);
        target.normals.truncate(vertices);
    }
    mesh.joint_indices.truncate(vertices * mesh.influences_per_vertex);
    mesh.joint_weights.truncate(vertices * mesh.influences_per_vertex);
}
