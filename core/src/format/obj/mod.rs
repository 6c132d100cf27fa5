//! Wavefront OBJ: meshes in the bind pose. Skeleton, motion, morph targets and materials are not stored.

mod read;
mod write;

use std::path::{Path, PathBuf};

use super::kind::{Description, Holds, Write};

pub use write::to_obj;

pub(super) const OBJ: Description = Description {
    extension: "obj",
    title: "Wavefront OBJ",
    holds: Holds { meshes: true, skeleton: false, clips: false },
    read_motion: None,
    read_scene: None,
    read_meshes: Some(read::read),
    write: Some(Write::Alone(|scene, _| to_obj(scene))),
};

/// The material libraries that a file refers to.
pub(super) fn files_beside(bytes: &[u8], path: &Path) -> Vec<PathBuf> {
    let text = String::from_utf8_lossy(bytes);
    let names = text.lines().filter_map(|line| line.trim().strip_prefix("mtllib "));
    names.map(|name| path.with_file_name("").join(name.trim())).collect()
}
