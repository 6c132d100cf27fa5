//! From a finished character to a file: the neutral [`Scene`], one writer per format, and the door to the disk.
//!
//! Every writer takes a [`Scene`] that it validates first and returns bytes; [`write_scene`] chooses the writer by
//! the ending of the path and puts the bytes on the disk whole or not at all.

pub(crate) mod accessor;
mod buffers;
mod character;
pub mod file;
pub mod gltf;
pub mod obj;
pub mod scene;
pub mod skin_tone;
mod split;
#[cfg(test)]
pub(crate) mod synthetic;
pub(crate) mod titles;
pub mod usd;

pub use buffers::{BlendShape, Layout, MeshBuffers};
pub use character::SceneOptions;
pub use file::{WriteOptions, scene_to_bytes, write_atomic, write_scene, write_scene_with};
pub use gltf::{GltfOptions, VrmMeta, vrm};
pub use scene::{AlphaMode, Corners, Scene, SceneJoint, SceneMaterial, SceneMesh, flip_v};
pub use skin_tone::SkinTone;
pub use split::SplitMesh;
