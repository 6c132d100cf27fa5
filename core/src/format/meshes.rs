//! Reading characters back: the positions to measure, and what a picture needs, from `.glb`, `.gltf`, `.obj` and
//! USD.
//!
//! Nothing in a file is trusted: sizes are checked against the bytes that are there before anything is allocated, and
//! whatever is wrong is an [`Error::File`] that says what and where.

use std::{ffi::OsStr, path::Path};

use glam::Vec3;

use super::input::read;
use super::{gltf, obj, usd};
use crate::{Error, Result};

/// Most meshes of one file.
pub(crate) const MAX_MESHES: usize = 1 << 16;

/// What was read of a file: metres, +Y up, as the file has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportedScene {
    /// Meshes in the file's order; those with a skin first, so that the body of our own files is the first.
    pub meshes: Vec<ImportedMesh>,
    /// The document's `extras`; `null` for none.
    pub extras: serde_json::Value,
    /// Names of the joints of the first skin, in its order; empty for none.
    pub joint_names: Vec<String>,
}

/// One mesh, its faces split into triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedMesh {
    /// The object's name; may be empty.
    pub name: String,
    /// Vertices `(V, 3)`. Of a skinned mesh they are in the bind pose, of others in the space of the scene.
    pub positions: Vec<Vec3>,
    /// How many of the first positions are the vertices of the model; those after them are copies that texture seams
    /// needed. All of them where the file does not say.
    pub model_vertices: usize,
    /// Corners of every triangle, places in `positions`.
    pub triangles: Vec<[u32; 3]>,
    /// One unit normal per position, or none at all.
    pub normals: Vec<Vec3>,
    /// Linear RGBA; opaque white where the file has no colour.
    pub base_color: [f32; 4],
    /// Whether the mesh hangs on joints.
    pub skinned: bool,
}

/// Reads a file in the format of its ending: `.glb`, `.gltf` with the buffers beside it, `.vrm`,
/// `.usda`, `.usdc`, `.usdz` or `.obj`.
///
/// # Errors
/// [`Error::File`] for another ending or content that is not what it should be, [`Error::Io`] when reading fails.
pub fn open(path: impl AsRef<Path>) -> Result<ImportedScene> {
    let path = path.as_ref();
    let ending = path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase);
    match ending.as_deref() {
        Some("glb" | "gltf" | "vrm") => gltf::from_bytes(&read(path)?, path),
        Some("obj") => obj::from_bytes(&read(path)?, path),
        Some("usda" | "usdc" | "usdz") => usd::from_bytes(&read(path)?, path),
        _ => Err(Error::file(path, "unknown ending, expected one of .glb .gltf .vrm .usda .usdc .usdz .obj")),
    }
}
