//! Splitting of vertices at texture seams, for graphics hardware, which takes one texture coordinate per vertex.

use super::scene::SceneMesh;

/// A mesh whose vertices have one texture coordinate each.
#[derive(Clone, Debug)]
pub struct SplitMesh {
    /// The mesh's vertex that each vertex is a copy of: `0..V`, then the duplicates.
    pub source: Vec<u32>,
    /// Vertices of every triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Index of each vertex's texture coordinate in the mesh's, or [`UNSET`].
    uvs: Vec<u32>,
}

const UNSET: u32 = u32::MAX;

impl SplitMesh {
    /// The triangles of a mesh in order, with vertices duplicated where adjacent faces have different texture coordinates.
    pub fn new(mesh: &SceneMesh) -> Self {
        let vertices = mesh.positions.len();
        let mut source: Vec<u32> = (0..vertices as u32).collect();
        let mut uvs = vec![UNSET; vertices];
        // The copies of one vertex form a linked list; they are few.
        let mut next_copy = vec![UNSET; vertices];
        let mut copy_with_uv = |(vertex, uv): (u32, u32)| {
            let mut copy = vertex as usize;
            loop {
                if uvs[copy] == UNSET {
                    uvs[copy] = uv;
                }
                let same = uvs[copy] == uv || mesh.uvs.get(uvs[copy] as usize) == mesh.uvs.get(uv as usize);
                if same {
                    return copy as u32;
                }
                if next_copy[copy] == UNSET {
                    let new = source.len() as u32;
                    next_copy[copy] = new;
                    source.push(vertex);
                    uvs.push(uv);
                    next_copy.push(UNSET);
                    return new;
                }
                copy = next_copy[copy] as usize;
            }
        };
        let triangles =
            mesh.triangulated().into_iter().map(|triangle| triangle.map(&mut copy_with_uv)).collect();
        Self { source, triangles, uvs }
    }

    /// The texture coordinate of each vertex, `(V, 2)`, given the mesh that was split; empty where that has none.
    pub fn uvs(&self, mesh: &SceneMesh) -> Vec<[f32; 2]> {
        if mesh.uvs.is_empty() {
            return Vec::new();
        }
        // A vertex that no face uses has no texture coordinate of its own.
        self.uvs.iter().map(|uv| mesh.uvs.get(*uv as usize).copied().unwrap_or_default()).collect()
    }
}
