//! glTF 2.0, binary and JSON.

pub(crate) mod document;
pub(crate) mod motion;
pub(crate) mod read;
pub(crate) mod track;
pub(crate) mod write;

pub use read::{from_bytes, scene_from_bytes};
pub use write::{GltfFiles, GltfOptions, to_glb, to_glb_with, to_gltf, to_gltf_with};
