//! Reading and writing files.
//!
//! | To | Call | Returns |
//! |---|---|---|
//! | read a character | [`read_scene`] | a [`Scene`](crate::scene::Scene) with skeleton, skin, materials and clips |
//! | read meshes only | [`read_meshes`] | a scene of meshes, in the bind pose, without a skeleton |
//! | read the motion of any skeleton | [`read_motion`] | [`Motion`]: clips, and how the file was interpreted |
//! | write a character | [`write_scene`] | a file, written completely or not at all |
//!
//! Each has a variant for bytes in memory: [`read_scene_from_bytes`], [`read_meshes_from_bytes`],
//! [`read_motion_from_bytes`], [`write_scene_to_bytes`]. The file extension chooses the [`Format`].
//!
//! # One folder per format
//!
//! A folder has those of these modules that apply: `document` (bytes to a parsed document, every size checked), `motion`
//! (document to `motion::raw::RawMotion`), `character` and `meshes` (document to scene), `write` (scene to bytes). One
//! `kind::Description` lists what the folder supports, and [`Format`] lists the descriptions: a new format is a folder
//! and a line there.

mod beside;
mod bvh;
mod disk;
mod fbx;
#[cfg(test)]
mod fuzz;
pub mod gltf;
mod guard;
mod kind;
mod limits;
mod measure;
mod motion;
mod npz;
pub mod obj;
mod read;
pub mod usd;
pub mod vrm;
mod write;

pub use crate::error::{
    BvhError, Fault, FbxError, FormatError, GltfError, NpzError, ObjError, ParserError, UsdError,
};
pub use beside::files_beside;
pub use disk::write_atomic;
pub use gltf::GltfOptions;
pub use guard::panic_becomes_error;
pub use kind::{Format, Holds, Purpose};
pub use measure::measure_file;
pub use motion::{Found, Motion, ReadOptions, ReadReport};
pub use read::{
    read_meshes, read_meshes_from_bytes, read_motion, read_motion_from_bytes, read_pose, read_scene,
    read_scene_from_bytes,
};
pub use vrm::VrmMeta;
pub use write::{WriteOptions, write_scene, write_scene_to_bytes};
