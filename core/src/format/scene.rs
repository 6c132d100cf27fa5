//! Files back as a [`Scene`], to be written again: joints and bind pose, meshes with texture coordinates and weights,
//! materials, extras, clips.
//!
//! What a scene has no place for is not read: pictures, morph targets, cameras, lights, motion of anything but the
//! skeleton. Faces of glTF come back as triangles, those of USD as they are. Files of ours come back in model order,
//! with texture seams merged; those of others as they are. A skeleton must have one root and no scale; nodes above and
//! between its joints are folded into the joints. Where the rest pose is not the bind pose, the scene is in the bind
//! pose. Meshes of a character without a skin have to hang on a joint and are bound to it.

use std::{ffi::OsStr, path::Path};

use super::input::read;
use super::{gltf, usd};
use crate::scene::Scene;
use crate::{Error, Result};

/// The endings that [`open_scene`] knows.
pub const ENDINGS: [&str; 6] = [".glb", ".gltf", ".vrm", ".usda", ".usdc", ".usdz"];

/// Reads a file in the format of its ending: one of [`ENDINGS`], in any case. The buffers of a `.gltf` are looked for
/// beside it.
///
/// # Errors
/// [`Error::File`] says what is wrong and where: another ending, damage, several roots, scale in the skeleton, a mesh
/// that hangs on nothing; [`Error::Io`] when reading fails.
pub fn open_scene(path: impl AsRef<Path>) -> Result<Scene> {
    let path = path.as_ref();
    known(path)?;
    scene_from_bytes(&read(path)?, path)
}

/// Reads a file that is already in memory, in the format of its path's ending.
///
/// # Errors
/// As [`open_scene`].
pub fn scene_from_bytes(bytes: &[u8], path: &Path) -> Result<Scene> {
    match known(path)? {
        ".usda" | ".usdc" | ".usdz" => usd::scene_from_bytes(bytes, path),
        _ => gltf::scene_from_bytes(bytes, path),
    }
}

/// The path's ending, if it is one of [`ENDINGS`].
fn known(path: &Path) -> Result<&'static str> {
    let ending = path.extension().and_then(OsStr::to_str).unwrap_or_default();
    let known = ENDINGS.into_iter().find(|known| known[1..].eq_ignore_ascii_case(ending));
    known.ok_or_else(|| Error::file(path, format!("unknown ending, expected one of {}", ENDINGS.join(" "))))
}
