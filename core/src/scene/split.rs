//! Vertices as graphics hardware wants them: one texture coordinate each.

use super::scene::SceneMesh;

/// A mesh whose vertices have one texture coordinate each.
#[derive(Clone, Debug)]
pub struct SplitMesh {
    /// Scene vertex of every vertex: `0..V`, then the doubles.
    pub source: Vec<u32>,
    /// Vertices of every triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Place in the scene's texture coordinates of every vertex, or [`UNSEEN`].
    uvs: Vec<u32>,
}

const UNSEEN: u32 = u32::MAX;

impl SplitMesh {
    /// The triangles of a mesh in order, vertices doubled where faces beside each other have other texture coordinates.
    pub fn new(mesh: &SceneMesh) -> Self {
        let vertices = mesh.positions.len();
        let mut source: Vec<u32> = (0..vertices as u32).collect();
        let mut uvs = vec![UNSEEN; vertices];
        // The written copies of one scene vertex form a chain; they are few.
        let mut next_copy = vec![UNSEEN; vertices];
        let mut written = |(vertex, uv): (u32, u32)| {
            let mut copy = vertex as usize;
            loop {
                if uvs[copy] == UNSEEN {
                    uvs[copy] = uv;
                }
                let same = uvs[copy] == uv || mesh.uvs.get(uvs[copy] as usize) == mesh.uvs.get(uv as usize);
                if same {
                    return copy as u32;
                }
                if next_copy[copy] == UNSEEN {
                    let new = source.len() as u32;
                    next_copy[copy] = new;
                    source.push(vertex);
                    uvs.push(uv);
                    next_copy.push(UNSEEN);
                    return new;
                }
                copy = next_copy[copy] as usize;
            }
        };
        let triangles = mesh.triangulated().into_iter().map(|triangle| triangle.map(&mut written)).collect();
        Self { source, triangles, uvs }
    }

    /// The texture coordinate of every vertex, from the mesh that was split; empty where it has none.
    pub fn uvs(&self, mesh: &SceneMesh) -> Vec<[f32; 2]> {
        if mesh.uvs.is_empty() {
            return Vec::new();
        }
        // A vertex that no face uses has no texture coordinate of its own.
        self.uvs.iter().map(|uv| mesh.uvs.get(*uv as usize).copied().unwrap_or_default()).collect()
    }
}
