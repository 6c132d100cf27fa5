//! The trained model: its file, character, shape space and networks, and the path from a request to shape coefficients.

mod character;
mod file;
mod generator;
mod info;
mod measured_mesh;
mod measured_space;
mod placement;
mod shape_space;

pub use character::{Accessory, Character, ReducedMesh};
pub use file::{FORMAT_VERSION, ModelParts, Provenance, topology_hash};
pub use generator::{MODEL_VARIABLE, Model, Solved};
pub use measured_mesh::MeasuredMesh;
pub use measured_space::MeasuredSpace;
pub use shape_space::ShapeSpace;
