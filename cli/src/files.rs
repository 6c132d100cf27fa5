//! Reading and writing of files; formats are chosen by the ending of the path.

use std::fs;
use std::path::Path;

use anthronet::format::{self, Format, GltfOptions, Purpose, WriteOptions, write_atomic};
use anthronet::scene::Scene;

use crate::failure::{Failure, Result};
use crate::terminal;

/// Endings, without the dot, of the files that serve a purpose.
pub(crate) fn endings(purpose: Purpose) -> Vec<&'static str> {
    Format::serving(purpose).map(Format::ending).collect()
}

/// Whether a file of this path's ending holds motion when it is written.
pub(crate) fn holds_motion(path: &Path) -> bool {
    Format::of_path(path, Purpose::WriteScene).is_ok_and(|format| format.holds().clips)
}

/// Whether a file of this path's ending holds meshes when it is written.
pub(crate) fn holds_meshes(path: &Path) -> bool {
    Format::of_path(path, Purpose::WriteScene).is_ok_and(|format| format.holds().meshes)
}

/// The ending of a path in lower case, without its dot; empty for none.
pub(crate) fn ending(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Refuses a path whose ending is not one of these; the message names the `option` it was given for, if any.
pub(crate) fn check_ending(option: &str, path: &Path, known: &[&str]) -> Result<()> {
    if known.contains(&ending(path).as_str()) {
        return Ok(());
    }
    let known: Vec<_> = known.iter().map(|k| format!(".{k}")).collect();
    let argument = format!("{option} {}", path.display());
    let message = format!("{}: unknown ending, expected one of {}", argument.trim_start(), known.join(" "));
    Err(Failure::usage(message))
}

/// Reads a text file of at most 16 MB.
pub(crate) fn read_text(path: &Path) -> Result<String> {
    let size = fs::metadata(path).map_err(|e| Failure::io("read", path, e))?.len();
    if size > 16 << 20 {
        return Err(Failure::failed(format!("{}: expected at most 16 MB, got {size} bytes", path.display())));
    }
    fs::read_to_string(path).map_err(|e| Failure::io("read", path, e))
}

/// Writes text to a file, or with `-` to standard output.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<()> {
    if path == Path::new("-") { terminal::print(text) } else { Ok(write_atomic(path, text.as_bytes())?) }
}

/// Writes the scene; the path's ending chooses the format.
pub(crate) fn write_scene(scene: &Scene, path: &Path, compress: bool) -> Result<()> {
    let ending = ending(path);
    if compress && !matches!(Format::of_ending(&ending), Some(Format::Glb | Format::Gltf)) {
        return Err(Failure::usage(format!("--compress: expected with .glb or .gltf, got .{ending}")));
    }
    let options = WriteOptions { gltf: GltfOptions { compress }, ..WriteOptions::default() };
    Ok(format::write_scene(scene, path, &options)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings() {
        assert!(check_ending("-o", Path::new("a/b.GLB"), &["glb"]).is_ok());
        for path in ["b", "b.", "glb", "b.glb.txt"] {
            assert!(check_ending("-o", Path::new(path), &["glb"]).is_err(), "{path}");
        }
        let message = check_ending("", Path::new("b.stl"), &["glb", "obj"]).unwrap_err().to_string();
        assert_eq!(message, "b.stl: unknown ending, expected one of .glb .obj");
    }
}
