//! Quad meshes: topology, Catmull-Clark subdivision, vertex normals and levels of detail.

mod lod;
mod normals;
mod subdivision;
mod topology;

pub use lod::Lod;
pub use normals::{VertexFaces, vertex_normals};
pub use subdivision::Subdivision;
pub use topology::{Topology, edges_of};
