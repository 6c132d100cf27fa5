//! The files that a file refers to.

use std::path::{Path, PathBuf};

use super::kind::Format;
use super::{disk, gltf, obj, usd};

/// The files that a file refers to, whether or not they exist: buffers and images of a glTF, layers and assets of a USD
/// file, material libraries of an OBJ. A program that writes beside its inputs asks, so as not to overwrite one of them.
///
/// None for a file of another format, or one that cannot be read: reading it says why.
pub fn files_beside(path: impl AsRef<Path>) -> Vec<PathBuf> {
    let path = path.as_ref();
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let beside = match Format::of_extension(extension) {
        Some(Format::Glb | Format::Gltf | Format::Vrm) => gltf::files_beside,
        Some(Format::Usd | Format::Usda | Format::Usdc | Format::Usdz) => usd::files_beside,
        Some(Format::Obj) => obj::files_beside,
        _ => return Vec::new(),
    };
    disk::read(path).map(|bytes| beside(&bytes, path)).unwrap_or_default()
}
