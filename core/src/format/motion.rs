//! Reading motion files: the format by the ending, confirmed by the first bytes.

use std::{ffi::OsStr, path::Path};

use serde::Serialize;

use super::raw::Raw;
use super::{bvh, fbx, gltf, input, npz, settle, usd};
use crate::clip::Clip;
use crate::error::Outcome;
use crate::space::{Axis, Unit};
use crate::{Error, Result};

const ENDINGS: &str = ".bvh .npz .fbx .glb .gltf .usda .usdc .usdz";

/// What is said of a file beforehand; it wins over what the file says.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReadOptions {
    /// The unit of lengths.
    pub unit: Option<Unit>,
    /// The axis that points up.
    pub up: Option<Axis>,
    /// Frames per second. Formats of frames (BVH, npz) are taken to be recorded at this rate; formats of curves (FBX,
    /// glTF) are sampled at it.
    pub frames_per_second: Option<f64>,
}

impl ReadOptions {
    /// From plain numbers, as hosts pass them: 0 metres per unit and 0 frames per second leave that to the file.
    ///
    /// # Errors
    /// [`Error::Request`] for a unit that is no length.
    pub fn of_numbers(metres_per_unit: f64, up: Option<Axis>, frames_per_second: f64) -> Result<Self> {
        let unit = match metres_per_unit {
            0.0 => None,
            metres => Some(Unit::of_metres(metres).ok_or_else(|| {
                Error::request("metres_per_unit", format!("expected a positive number, got {metres}"))
            })?),
        };
        Ok(Self { unit, up, frames_per_second: (frames_per_second != 0.0).then_some(frames_per_second) })
    }
}

/// Where a value is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Found {
    /// The file, or its format, says so.
    File,
    /// From the proportions and stance of the body, or the times of keys.
    Detected,
    /// From [`ReadOptions`].
    Asked,
    /// Nothing tells: the format's habit.
    Assumed,
}

/// How a file was understood.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReadReport {
    /// The format's name.
    pub format: &'static str,
    /// The unit that its lengths were taken to be in.
    pub unit: Unit,
    /// How the unit was found.
    pub unit_found: Found,
    /// The axis that was taken to point up.
    pub up: Axis,
    /// How the axis was found.
    pub up_found: Found,
    /// Frames per second of the first clip.
    pub frames_per_second: f64,
    /// How the rate was found.
    pub rate_found: Found,
    /// About how tall the body is, metres, from the lengths of its bones; 0 where they tell nothing.
    pub stature: f64,
    /// What was mended, assumed or looks wrong.
    pub warnings: Vec<String>,
}

/// What was read of a motion file: at least one clip; metres, +Y up, facing as in the file.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The clips, which share a rest pose.
    pub clips: Vec<Clip>,
    /// How the file was understood.
    pub report: ReadReport,
}

impl Motion {
    /// A clip that was made by a program instead of read from a file: metres, +Y up.
    pub fn of_clip(clip: Clip) -> Self {
        let report = ReadReport {
            format: "poses",
            unit: Unit::Metre,
            unit_found: Found::Asked,
            up: Axis::Y,
            up_found: Found::Asked,
            frames_per_second: clip.frames_per_second(),
            rate_found: Found::Asked,
            stature: 0.0,
            warnings: Vec::new(),
        };
        Self { clips: vec![clip], report }
    }
}

/// Reads a motion file in the format of its ending: `.bvh`, `.npz` (AMASS, SMPL-X), `.fbx`, `.glb`, `.gltf` with the
/// buffers beside it, `.usda`, `.usdc`, `.usdz`.
///
/// # Errors
/// [`Error::File`] for another ending or content that is not what it should be, [`Error::Io`] when reading fails,
/// [`Error::Request`] for a rate that is none.
pub fn read(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Motion> {
    let path = path.as_ref();
    ending(path)?;
    from_bytes(&input::read(path)?, path, options)
}

/// As [`read`], from the file's bytes; `path` tells the format, and where buffers of a `.gltf` are looked for.
///
/// # Errors
/// As [`read`].
pub fn from_bytes(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Motion> {
    if let Some(rate) = options.frames_per_second
        && !(0.1..=1000.0).contains(&rate)
    {
        return Err(Error::request("frames_per_second", format!("expected 0.1 to 1000, got {rate}")));
    }
    let fault = |message: String| Error::file(path, message);
    let raw = match ending(path)? {
        Ending::Bvh => bvh::read(bytes, &stem(path), options),
        Ending::Npz => starts(bytes, &[b"PK\x03\x04", b"PK\x05\x06"], "a zip archive")
            .and_then(|()| npz::read(bytes, &stem(path), options)),
        Ending::Fbx => starts(bytes, &[b"Kaydara FBX Binary", b";"], "an FBX file")
            .and_then(|()| fbx::read(bytes, &stem(path), options)),
        Ending::Gltf => return settled(gltf::motion::read(bytes, path, options)?, options).map_err(fault),
        Ending::Usd => usd::motion::read(bytes, &stem(path), options),
    };
    raw.and_then(|raw| settled(raw, options)).map_err(fault)
}

fn settled(raw: Raw, options: &ReadOptions) -> Outcome<Motion> {
    settle::settle(raw, options).map_err(|error| match error {
        Error::Invalid { what, message } => format!("{what}: {message}"),
        other => other.to_string(),
    })
}

enum Ending {
    Bvh,
    Npz,
    Fbx,
    Gltf,
    Usd,
}

fn ending(path: &Path) -> Result<Ending> {
    let ending = path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase);
    match ending.as_deref() {
        Some("bvh") => Ok(Ending::Bvh),
        Some("npz") => Ok(Ending::Npz),
        Some("fbx") => Ok(Ending::Fbx),
        Some("glb" | "gltf") => Ok(Ending::Gltf),
        Some("usda" | "usdc" | "usdz") => Ok(Ending::Usd),
        _ => Err(Error::file(path, format!("unknown ending, expected one of {ENDINGS}"))),
    }
}

/// The file's name without its ending: what a clip is called that has no other name.
fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "clip".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

fn starts(bytes: &[u8], magics: &[&[u8]], expected: &str) -> Outcome<()> {
    if magics.iter().any(|magic| bytes.starts_with(magic)) {
        return Ok(());
    }
    let came = bytes[..bytes.len().min(8)].escape_ascii();
    Err(format!("expected {expected}, which this is not: it starts with `{came}`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_tells_the_format_and_the_first_bytes_confirm_it() {
        let error = |path: &str, bytes: &[u8]| {
            from_bytes(bytes, Path::new(path), &ReadOptions::default()).unwrap_err().to_string()
        };
        let unknown = error("walk.mov", b"");
        assert!(unknown.contains("walk.mov") && unknown.contains(".bvh .npz .fbx .glb"), "{unknown}");
        assert!(error("walk", b"").contains("unknown ending"));
        for (path, expected) in [
            ("a.BVH", "expected HIERARCHY"),
            ("a.npz", "expected a zip archive"),
            ("a.fbx", "an FBX file, which this is not: it starts with `\\x7fELF`"),
            ("a.glb", "glTF"),
        ] {
            let error = error(path, b"\x7fELF");
            assert!(error.contains(expected), "{error}");
        }
        assert!(matches!(read("missing.bvh", &ReadOptions::default()), Err(Error::Io { .. })));
        let rate = ReadOptions { frames_per_second: Some(f64::NAN), ..Default::default() };
        assert!(matches!(from_bytes(b"", Path::new("a.bvh"), &rate), Err(Error::Request { .. })));
    }
}
