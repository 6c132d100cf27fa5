//! Writing: the file extension chooses the format, whose folder has the writer.

use std::{ffi::OsStr, path::Path};

use super::disk::{write_atomic, write_pair};
use super::gltf::GltfOptions;
use super::kind::{Format, Write, able};
use super::vrm::VrmMeta;
use crate::error::Fault;
use crate::scene::Scene;
use crate::{Error, Result};

/// Options of the formats that have any.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WriteOptions {
    /// For `.glb` and `.gltf`.
    pub gltf: GltfOptions,
    /// For `.vrm`.
    pub vrm: VrmMeta,
}

/// Writes a scene in the format of the path's extension: `.glb`, `.gltf` with a `.bin` beside it, `.vrm`, `.vrma`, which
/// gets the skeleton and the clips only, `.usda`, `.usdc`, `.usdz`, or `.obj`, which gets the meshes only.
///
/// # Errors
/// [`Error::File`] for an unsupported extension, [`Error::Invalid`] for a scene that does not [validate](Scene::validate)
/// or that the format cannot store, [`Error::Io`] when the system refuses; an existing file is then left unchanged.
pub fn write_scene(scene: &Scene, path: impl AsRef<Path>, options: &WriteOptions) -> Result<()> {
    let path = path.as_ref();
    match able(path, |format| format.write)?.1 {
        Write::Alone(write) => write_atomic(path, &write(scene, options)?),
        Write::WithBuffer(write) => {
            let bin_path = path.with_extension("bin");
            let Some(bin_name) = bin_path.file_name().and_then(OsStr::to_str) else {
                return Err(Error::file(path, Fault::unexpected("a name in Unicode", "one that is not")));
            };
            let files = write(scene, bin_name, options)?;
            write_pair((path, &files.json), (&bin_path, &files.bin))
        }
    }
}

/// [`write_scene`] to memory, in a single-file format: see [`Format::of_one_file`].
///
/// # Errors
/// [`Error::Request`] for a format of several files or without a writer, [`Error::Invalid`] as [`write_scene`].
pub fn write_scene_to_bytes(scene: &Scene, format: Format, options: &WriteOptions) -> Result<Vec<u8>> {
    match format.writer() {
        Some(Write::Alone(write)) => write(scene, options),
        _ => Err(Format::one_file_fault(format.extension())),
    }
}
