//! Shared by the motion readers: options, result ([`raw`]), its [`bounds`], the pose that a skin was bound in as the rest pose
//! ([`bind`]), and detection of units and axes ([`units_and_axes`], from the body's [`proportions`], the person's [`figure`] and
//! its [`stride`]).

pub(crate) mod bind;
pub(crate) mod bounds;
mod figure;
mod floor;
mod proportions;
pub(crate) mod raw;
mod stride;
pub(crate) mod units_and_axes;

use std::path::Path;

pub(crate) use floor::stand_on_floor;
use serde::Serialize;

use crate::clip::Clip;
use crate::error::Fault;
use crate::space::{Axis, Unit};
use crate::{Error, Result};

/// What the caller knows about a file; overrides what the file states.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReadOptions {
    /// The unit of lengths.
    pub unit: Option<Unit>,
    /// The axis that points up.
    pub up: Option<Axis>,
    /// Which of several people in an archive of arrays, from 0; by default the first, and a warning says how many there are.
    pub person: Option<usize>,
    /// Frames per second. Frame-based formats (BVH, npz) are taken to be recorded at this rate; curve-based formats (FBX, glTF)
    /// are sampled at it.
    pub frames_per_second: Option<f64>,
}

impl ReadOptions {
    /// The same options with a unit of this many metres.
    ///
    /// # Errors
    /// [`Error::Request`] when the number is not finite and positive.
    pub fn with_metres_per_unit(self, metres: f64) -> Result<Self> {
        let unit = Unit::from_metres(metres).ok_or_else(|| {
            Error::request("metres_per_unit", format!("expected a positive number, got {metres}"))
        })?;
        Ok(Self { unit: Some(unit), ..self })
    }

    /// Refuses a frame rate outside 0.1 to 1000.
    pub(super) fn check(&self) -> Result<()> {
        match self.frames_per_second {
            Some(rate) if !(0.1..=1000.0).contains(&rate) => {
                Err(Error::request("frames_per_second", format!("expected 0.1 to 1000, got {rate}")))
            }
            _ => Ok(()),
        }
    }
}

/// Source of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Found {
    /// Stated by the file or its format.
    File,
    /// Detected from the proportions and stance of the body, or the times of keys.
    Detected,
    /// Requested by [`ReadOptions`].
    Asked,
    /// Not stated: the format's usual value.
    Assumed,
}

/// How a file was interpreted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReadReport {
    /// The format's name.
    pub format: &'static str,
    /// The unit in which its lengths were read.
    pub unit: Unit,
    /// How the unit was found.
    pub unit_found: Found,
    /// The axis read as up.
    pub up: Axis,
    /// How the axis was found.
    pub up_found: Found,
    /// Frames per second of the first clip.
    pub frames_per_second: f64,
    /// How the rate was found.
    pub rate_found: Found,
    /// Approximate stature of the body, metres, from the lengths of its bones; 0 without bones.
    pub stature: f64,
    /// Corrections, assumptions and suspicious values.
    pub warnings: Vec<String>,
}

/// The content of a motion file: at least one clip; metres, +Y up, facing as in the file.
#[derive(Clone, Debug)]
pub struct Motion {
    /// The clips, which share a rest pose.
    pub clips: Vec<Clip>,
    /// How the file was interpreted.
    pub report: ReadReport,
}

impl Motion {
    /// Wraps a clip that was generated instead of read from a file: metres, +Y up.
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

/// The file name without its extension, for clips without a name.
pub(crate) fn clip_name(path: &Path) -> String {
    path.file_stem().map_or_else(|| "clip".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// Refuses bytes that do not start with one of a format's magic numbers.
pub(crate) fn check_start(bytes: &[u8], magics: &[&[u8]], expected: &str) -> std::result::Result<(), Fault> {
    if magics.iter().any(|magic| bytes.starts_with(magic)) {
        return Ok(());
    }
    let came = bytes[..bytes.len().min(8)].escape_ascii();
    Err(Fault::unexpected(expected, format_args!("one that starts with `{came}`")))
}
