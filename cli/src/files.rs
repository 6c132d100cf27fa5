//! Reading and writing of files; the file extension chooses the format.

use std::fs;
use std::path::Path;

use anthronet::format::{self, Format, GltfOptions, Purpose, WriteOptions, write_atomic};
use anthronet::scene::Scene;
use anthronet::text;

use crate::failure::{Failure, Result};
use crate::terminal;

/// File extensions, without the dot, that serve a purpose.
pub(crate) fn extensions(purpose: Purpose) -> Vec<&'static str> {
    Format::serving(purpose).map(Format::extension).collect()
}

/// Whether a file of this path's extension holds motion when it is written.
pub(crate) fn holds_motion(path: &Path) -> bool {
    Format::of_path(path, Purpose::WriteScene).is_ok_and(|format| format.holds().clips)
}

/// Whether a file of this path's extension holds meshes when it is written.
pub(crate) fn holds_meshes(path: &Path) -> bool {
    Format::of_path(path, Purpose::WriteScene).is_ok_and(|format| format.holds().meshes)
}

/// The file extension of a path in lower case, without its dot; empty for none.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Refuses a path whose extension is not one of these; the message names the `option` it was given for, if any.
pub(crate) fn check_extension(option: &str, path: &Path, known: &[&str]) -> Result<()> {
    if known.contains(&extension(path).as_str()) {
        return Ok(());
    }
    let known: Vec<_> = known.iter().map(|k| format!(".{k}")).collect();
    let argument = format!("{option} {}", path.display());
    let message =
        format!("{}: unknown file extension, expected one of {}", argument.trim_start(), known.join(" "));
    Err(Failure::usage(message))
}

/// Reads a text file of at most 16 MB, in UTF-8 or UTF-16.
pub(crate) fn read_text(path: &Path) -> Result<String> {
    let size = fs::metadata(path).map_err(|e| Failure::io("read", path, e))?.len();
    if size > 16 << 20 {
        return Err(Failure::failed(format!("{}: expected at most 16 MB, got {size} bytes", path.display())));
    }
    let bytes = fs::read(path).map_err(|e| Failure::io("read", path, e))?;
    text::decode_str(&bytes).map_err(|fault| Failure::in_file(path, fault))
}

/// Writes text to a file, or with `-` to standard output.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<()> {
    if path == Path::new("-") { terminal::print(text) } else { Ok(write_atomic(path, text.as_bytes())?) }
}

/// Writes the scene; the path's extension chooses the format.
pub(crate) fn write_scene(scene: &Scene, path: &Path, compress: bool) -> Result<()> {
    let extension = extension(path);
    if compress && !matches!(Format::of_extension(&extension), Some(Format::Glb | Format::Gltf)) {
        return Err(Failure::usage(format!("--compress: expected with .glb or .gltf, got .{extension}")));
    }
    let options = WriteOptions { gltf: GltfOptions { compress }, ..WriteOptions::default() };
    Ok(format::write_scene(scene, path, &options)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions() {
        assert!(check_extension("-o", Path::new("a/b.GLB"), &["glb"]).is_ok());
        for path in ["b", "b.", "glb", "b.glb.txt"] {
            assert!(check_extension("-o", Path::new(path), &["glb"]).is_err(), "{path}");
        }
        let message = check_extension("", Path::new("b.stl"), &["glb", "obj"]).unwrap_err().to_string();
        assert_eq!(message, "b.stl: unknown file extension, expected one of .glb .obj");
    }
}
