//! Reading: the file extension chooses the format, whose folder has the reader.

use std::path::Path;

use super::disk;
use super::kind::{Format, able};
use super::motion::{Motion, ReadOptions, units_and_axes};
use super::npz;
use crate::scene::Scene;
use crate::{Error, Result};

/// Reads a character: joints and bind pose, meshes with texture coordinates and weights, materials, extras, clips. From
/// `.glb`, `.gltf` with the buffers beside it, `.vrm`, `.usd`, `.usda`, `.usdc`, `.usdz`. Metres, +Y up. The scene validates.
///
/// Ignored is what a scene cannot represent: images, cameras, lights, animation of anything but the skeleton and the morph
/// targets. glTF faces are triangles; USD faces are kept. Files written by this library come back in the model's vertex
/// order with UV seams merged; other files keep their vertices. A skeleton must have one root and no scale; nodes above
/// and between its joints are folded into the joints. Where the rest pose differs from the bind pose, the scene is in the
/// bind pose. In a character without a skin, every mesh must be below a joint and is bound to it.
///
/// # Errors
/// [`Error::File`] says what is wrong and where: an unsupported extension, damage, several roots, scale in the skeleton, a
/// mesh that is below no joint; [`Error::Io`] when reading fails.
pub fn read_scene(path: impl AsRef<Path>) -> Result<Scene> {
    let path = path.as_ref();
    let (_, read) = able(path, |format| format.read_scene)?;
    read(&disk::read(path)?, path)
}

/// [`read_scene`] for a file already in memory; `path` chooses the format and locates the buffers of a `.gltf`.
///
/// # Errors
/// As [`read_scene`].
pub fn read_scene_from_bytes(bytes: &[u8], path: impl AsRef<Path>) -> Result<Scene> {
    let path = path.as_ref();
    let (_, read) = able(path, |format| format.read_scene)?;
    read(bytes, path)
}

/// Reads only the meshes, to measure or draw them: from all formats of [`read_scene`], and `.obj`. Metres, +Y up, with the
/// positions of the file.
///
/// The scene has meshes, materials and extras, but neither joints nor clips. Skinned meshes come first, so that the body
/// of our own files is the first mesh, and are in the bind pose; the others are where the file places them. Files written
/// by this library come back in the model's vertex order with UV seams merged. The scene need not
/// [validate](Scene::validate): a mesh may consist of points only.
///
/// # Errors
/// [`Error::File`] for an unsupported extension or invalid content, [`Error::Io`] when reading fails.
pub fn read_meshes(path: impl AsRef<Path>) -> Result<Scene> {
    let path = path.as_ref();
    let (_, read) = able(path, |format| format.read_meshes)?;
    read(&disk::read(path)?, path)
}

/// [`read_meshes`] for a file already in memory; `path` chooses the format and locates the buffers of a `.gltf`.
///
/// # Errors
/// As [`read_meshes`].
pub fn read_meshes_from_bytes(bytes: &[u8], path: impl AsRef<Path>) -> Result<Scene> {
    let path = path.as_ref();
    let (_, read) = able(path, |format| format.read_meshes)?;
    read(bytes, path)
}

/// Reads the motion of any skeleton: `.bvh`, `.npz` (AMASS, SMPL-X), `.fbx`, `.glb`, `.gltf` with the buffers beside it, `.vrm`,
/// `.vrma`, `.usd`, `.usda`, `.usdc`, `.usdz`, these with the layers in their folder. The extension chooses the format, the
/// first bytes confirm it.
///
/// # Errors
/// [`Error::File`] for an unsupported extension or invalid content, [`Error::Io`] when reading fails, [`Error::Request`]
/// for an invalid frame rate.
pub fn read_motion(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Motion> {
    let path = path.as_ref();
    able(path, |format| format.read_motion)?;
    read_motion_from_bytes(&disk::read(path)?, path, options)
}

/// [`read_motion`] for a file already in memory; `path` chooses the format, locates the buffers of a `.gltf`, and names a
/// clip that has no name.
///
/// # Errors
/// As [`read_motion`].
pub fn read_motion_from_bytes(bytes: &[u8], path: impl AsRef<Path>, options: &ReadOptions) -> Result<Motion> {
    let path = path.as_ref();
    options.check()?;
    let (format, read) = able(path, |format| format.read_motion)?;
    if let Some(person) = options.person.filter(|person| *person > 0 && format != Format::Npz) {
        let message = format!("a .{} has one person: expected index 0, got {person}", format.extension());
        return Err(Error::request("person", message));
    }
    let raw = read(bytes, path, options)?;
    units_and_axes::resolve(raw, options).map_err(|error| Error::file(path, Box::new(error)))
}

/// Reads the motion that a static pose is a frame of: every file of [`read_motion`], and poses of the SMPL body models alone, as
/// a `.npy` array, a `.json` of numbers, or an `.npz` of arrays without an axis of frames and a rate: 66, 72, 156, 159 or 165
/// numbers, or a root of 3 and a body of 63 or 69.
///
/// # Errors
/// As [`read_motion`].
pub fn read_pose(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Motion> {
    let path = path.as_ref();
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    if !["npy", "json", "npz"].iter().any(|known| extension.eq_ignore_ascii_case(known)) {
        return read_motion(path, options);
    }
    options.check()?;
    let raw = npz::read_pose(&disk::read(path)?, path, options)?;
    units_and_axes::resolve(raw, options).map_err(|error| Error::file(path, Box::new(error)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Fault;

    #[test]
    fn the_extension_tells_the_format_and_the_first_bytes_confirm_it() {
        let error = |path: &str, bytes: &[u8]| {
            read_motion_from_bytes(bytes, path, &ReadOptions::default()).unwrap_err().to_string()
        };
        let unknown = error("walk.mov", b"");
        assert!(unknown.contains("walk.mov") && unknown.contains(".bvh .npz .fbx .glb"), "{unknown}");
        assert!(error("walk", b"").contains("unknown file extension"));
        for (path, expected) in [
            ("a.BVH", "expected HIERARCHY"),
            ("a.npz", "expected a zip archive"),
            ("a.fbx", "expected an FBX file, got one that starts with `\\x7fELF`"),
            ("a.glb", "glTF"),
        ] {
            let error = error(path, b"\x7fELF");
            assert!(error.contains(expected), "{error}");
        }
        assert!(matches!(read_motion("missing.bvh", &ReadOptions::default()), Err(Error::Io { .. })));
        let person = ReadOptions { person: Some(1), ..Default::default() };
        let error = read_motion_from_bytes(b"", "a.bvh", &person).unwrap_err().to_string();
        assert_eq!(error, "person: a .bvh has one person: expected index 0, got 1");
        let rate = ReadOptions { frames_per_second: Some(f64::NAN), ..Default::default() };
        assert!(matches!(read_motion_from_bytes(b"", "a.bvh", &rate), Err(Error::Request { .. })));
    }

    #[test]
    fn the_kind_of_a_fault_is_known_whatever_the_format_and_the_place() {
        let fault = |path: &str, text: &str| match read_meshes_from_bytes(text.as_bytes(), path) {
            Err(Error::File { source, .. }) => source.fault().cloned(),
            _ => None,
        };
        let dangling = |what: &str| Fault::Dangling { what: what.into(), index: 5, count: 1 };
        assert_eq!(fault("a.obj", "v 1 2 3\nf 1 1 5"), Some(dangling("vertex")));
        let nodes = r#"{"asset": {"version": "2.0"}, "nodes": [{"children": [5]}]}"#;
        assert_eq!(fault("a.gltf", nodes), Some(dangling("node")));
        let units = "#usda 1.0\n(\n    metersPerUnit = 0\n)\n";
        assert_eq!(fault("a.usda", units), Some(Fault::unexpected("a positive number", 0)));
        assert_eq!(fault("a.glb", "{"), None, "the words of the parser of JSON");
    }

    #[test]
    fn an_extension_is_looked_at_before_the_disk() {
        for message in [
            read_scene("missing.obj").unwrap_err().to_string(),
            read_meshes("missing.bvh").unwrap_err().to_string(),
            read_motion("missing.obj", &ReadOptions::default()).unwrap_err().to_string(),
        ] {
            assert!(message.contains("unknown file extension, expected one of ."), "{message}");
        }
    }
}
