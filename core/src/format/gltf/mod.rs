//! glTF 2.0, binary and JSON, plain or with EXT_meshopt_compression.

mod animation;
mod character;
pub(crate) mod document;
mod humanoid;
mod meshes;
mod motion;
mod weights;
pub(crate) mod write;

use std::path::{Path, PathBuf};

use self::document::{Content, Document};
use super::kind::{Description, Holds, Write};
use crate::Error;
use crate::error::GltfError;

pub use write::{GltfFiles, GltfOptions, to_glb, to_glb_with, to_gltf, to_gltf_with};

type Result<T> = std::result::Result<T, GltfError>;

pub(super) const GLB: Description = Description {
    extension: "glb",
    title: "glTF 2.0, binary",
    holds: Holds { meshes: true, skeleton: true, clips: true },
    read_motion: Some(|bytes, path, options| {
        opened(bytes, path, Content::Motion, |document| motion::read(document, options))
    }),
    read_scene: Some(|bytes, path| opened(bytes, path, Content::Everything, character::scene)),
    read_meshes: Some(|bytes, path| opened(bytes, path, Content::Everything, meshes::scene)),
    write: Some(Write::Alone(|scene, options| to_glb_with(scene, &options.gltf))),
};

pub(super) const GLTF: Description = Description {
    extension: "gltf",
    title: "glTF 2.0, JSON",
    write: Some(Write::WithBuffer(|scene, bin_name, options| to_gltf_with(scene, bin_name, &options.gltf))),
    ..GLB
};

/// Parses a file, whose buffers may be files beside it, and passes the document to `read`.
fn opened<T>(
    bytes: &[u8],
    path: &Path,
    content: Content,
    read: impl FnOnce(&Document) -> Result<T>,
) -> crate::Result<T> {
    let document = Document::open(bytes, path, content)?;
    read(&document).map_err(|error| Error::file(path, error))
}

/// The files that a document refers to.
pub(super) fn files_beside(bytes: &[u8], path: &Path) -> Vec<PathBuf> {
    document::uris(bytes).iter().filter_map(|uri| document::uri::file(uri, path)).collect()
}
