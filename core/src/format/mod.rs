//! Files: one room per format, each with its document, the motion and the character that are read of it, and what is
//! written.

pub(crate) mod bvh;
pub(crate) mod fbx;
pub mod file;
pub mod gltf;
pub(crate) mod input;
mod measured;
pub mod meshes;
pub mod motion;
pub(crate) mod npz;
pub mod obj;
mod proportions;
pub(crate) mod raw;
pub mod scene;
mod settle;
pub mod usd;
pub mod vrm;

pub use file::{WriteOptions, scene_to_bytes, write_atomic, write_scene, write_scene_with};
pub use gltf::GltfOptions;
pub use measured::measure_file;
pub use motion::{Found, Motion, ReadOptions, ReadReport};
pub use scene::{open_scene, scene_from_bytes};
pub use vrm::VrmMeta;
