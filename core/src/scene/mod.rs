//! The neutral [`Scene`], which every file format is read into and written from; and buffers of its meshes for hosts.

mod buffers;
mod character;
mod morph;
mod posing;
#[expect(clippy::module_inception, reason = "the file of the type of that name")]
mod scene;
pub mod skin_tone;
mod split;
pub(crate) mod titles;

pub use buffers::{Layout, MeshBuffers};
pub use character::SceneOptions;
pub use morph::{MorphTarget, MorphTrack};
pub(crate) use posing::POSED_SURFACE;
pub use posing::SceneSkinner;
pub use scene::{AlphaMode, Corners, Scene, SceneMaterial, SceneMesh, flip_v};
pub use skin_tone::SkinTone;
pub use split::SplitMesh;
