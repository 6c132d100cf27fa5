//! Connectivity of a quad mesh with one texture coordinate per face corner.

use crate::{Error, Result};

/// Quads over vertices and, separately, over texture coordinates.
///
/// A vertex on a texture seam has several texture coordinates, so the two index spaces differ.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Topology {
    /// Number of vertices that the quads index into.
    pub vertex_count: usize,
    /// Four vertices per face, counter-clockwise as seen from outside.
    pub quads: Vec<[u32; 4]>,
    /// Texture coordinates, v pointing up as in OBJ.
    pub uvs: Vec<[f32; 2]>,
    /// Four texture coordinates per face, corner by corner as in `quads`.
    pub quad_uvs: Vec<[u32; 4]>,
}

impl Topology {
    /// Checks that every index is in range and that both lists of faces are equally long.
    ///
    /// # Errors
    /// [`Error::Invalid`] with both numbers of faces, or with the first face that has an index out of range.
    pub fn validate(&self) -> Result<()> {
        if self.quads.len() != self.quad_uvs.len() {
            return Err(Error::invalid(
                "topology",
                format!(
                    "{} faces but {} faces of texture coordinates",
                    self.quads.len(),
                    self.quad_uvs.len()
                ),
            ));
        }
        for (f, (quad, uvs)) in self.quads.iter().zip(&self.quad_uvs).enumerate() {
            if quad.iter().any(|&v| v as usize >= self.vertex_count) {
                return Err(Error::invalid(
                    "topology",
                    format!("face {f} uses vertices {quad:?} of {}", self.vertex_count),
                ));
            }
            if uvs.iter().any(|&v| v as usize >= self.uvs.len()) {
                return Err(Error::invalid(
                    "topology",
                    format!("face {f} uses texture coordinates {uvs:?} of {}", self.uvs.len()),
                ));
            }
        }
        Ok(())
    }
}

/// The edges of a quad mesh, lower vertex first, in the order in which they first occur corner by corner over the faces;
/// and per face the number of the edge from each corner to the next.
pub fn edges_of(quads: &[[u32; 4]]) -> (Vec<[u32; 2]>, Vec<[u32; 4]>) {
    let mut numbers = std::collections::HashMap::with_capacity(quads.len() * 2);
    let mut edges = Vec::with_capacity(quads.len() * 2);
    let mut face_edges = Vec::with_capacity(quads.len());
    for quad in quads {
        let mut of_face = [0; 4];
        for k in 0..4 {
            let (a, b) = (quad[k], quad[(k + 1) % 4]);
            let key = (a.min(b), a.max(b));
            of_face[k] = *numbers.entry(key).or_insert_with(|| {
                edges.push([key.0, key.1]);
                (edges.len() - 1) as u32
            });
        }
        face_edges.push(of_face);
    }
    (edges, face_edges)
}
