//! Options that say how a character moves, shared by the commands that write motion.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::backend::motion::BUILTIN;
use crate::failure::Failure;
use crate::request::{dotted, ending};

/// Length of one unit of a motion file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum UnitChoice {
    /// Metres.
    M,
    /// Centimetres.
    Cm,
    /// Millimetres.
    Mm,
    /// Inches.
    In,
}

/// The axis that points up in a motion file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum UpChoice {
    Y,
    Z,
}

/// Where the fingers' pose comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FingersChoice {
    /// From the motion where it moves fingers, else relaxed.
    Source,
    /// Hanging, slightly curled.
    Relaxed,
    /// Straight, as in the bind pose.
    Rest,
}

/// Options of motion.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Motion")]
pub(crate) struct MotionArguments {
    /// A motion: a file (.bvh .fbx .npz .glb .gltf .usda .usdc .usdz) or one of the built-in idle, walk, wave, squat,
    /// range_of_motion. May be repeated; glTF and USD keep several.
    #[arg(long = "clip", value_name = "FILE|NAME")]
    pub(crate) clips: Vec<String>,

    /// Length of one unit of the motion file; left out, the file says or the size of its skeleton.
    #[arg(long, value_name = "UNIT")]
    pub(crate) clip_unit: Option<UnitChoice>,

    /// The axis that points up in the motion file; left out, the file says or the skeleton.
    #[arg(long, value_name = "AXIS")]
    pub(crate) clip_up: Option<UpChoice>,

    /// Frames per second of the motion file, instead of what it says.
    #[arg(long, value_name = "RATE", value_parser = parse_rate)]
    pub(crate) clip_fps: Option<f64>,

    /// A JSON object {"joint of the motion": "joint of ours" or null} that goes before what is found by itself.
    #[arg(long, value_name = "FILE")]
    pub(crate) mapping: Option<PathBuf>,

    /// Frames per second of the written motion; left out, those of the motion file, 30 for built-in ones.
    #[arg(long, value_name = "RATE", value_parser = parse_rate)]
    pub(crate) fps: Option<f64>,

    /// Where the fingers' pose comes from, for motion files [default: source].
    #[arg(long)]
    pub(crate) fingers: Option<FingersChoice>,

    /// Stay in place: no motion over the ground.
    #[arg(long)]
    pub(crate) in_place: bool,

    /// Make the end meet the beginning; built-in motions do already.
    #[arg(long = "loop")]
    pub(crate) looped: bool,

    /// Leave feet where the motion file puts them: they may slide and sink.
    #[arg(long)]
    pub(crate) no_feet: bool,

    /// Let joints turn further than people's do where the motion file does.
    #[arg(long)]
    pub(crate) no_limits: bool,

    /// Write how the motion was read and brought onto the body as JSON, to a file or with `-` to standard output.
    #[arg(long, value_name = "FILE")]
    pub(crate) motion_report: Option<PathBuf>,
}

impl MotionArguments {
    /// Refuses, before any work is done, what cannot be written.
    pub(crate) fn check(&self, output: &Path) -> crate::failure::Result<()> {
        let ending = ending(output);
        let moving = crate::backend::moving_endings();
        if !self.clips.is_empty() && !moving.contains(&ending.as_str()) {
            let (last, others) = moving.split_last().unwrap_or((&"", &[]));
            let expected = format!("{} or .{last}", dotted(others));
            return Err(Failure::usage(format!("--clip: a .{ending} holds no motion, expected {expected}")));
        }
        if self.clips.is_empty() {
            let given = self.of_files().into_iter().chain(self.of_all()).find(|(_, given)| *given);
            return match given {
                Some((option, _)) => Err(Failure::usage(format!("{option}: expected together with --clip"))),
                None => Ok(()),
            };
        }
        if self.clips.iter().all(|clip| BUILTIN.contains(&clip.as_str())) {
            let given = self.of_files().into_iter().find(|(_, given)| *given);
            if let Some((option, _)) = given {
                let clips = self.clips.join(", ");
                let message = format!(
                    "{option}: says how a motion file comes onto a body, expected one of those with --clip, got the built-in \
                     {clips}"
                );
                return Err(Failure::usage(message));
            }
        }
        Ok(())
    }

    /// Options that mean something for motion files alone, and whether they were given. Built-in clips are made for the
    /// body, with feet on the floor, joints within their limits and hands relaxed.
    fn of_files(&self) -> [(&'static str, bool); 7] {
        [
            ("--clip-unit", self.clip_unit.is_some()),
            ("--clip-up", self.clip_up.is_some()),
            ("--clip-fps", self.clip_fps.is_some()),
            ("--mapping", self.mapping.is_some()),
            ("--fingers", self.fingers.is_some()),
            ("--no-feet", self.no_feet),
            ("--no-limits", self.no_limits),
        ]
    }

    /// Options that mean something for every motion; built-in clips loop already.
    fn of_all(&self) -> [(&'static str, bool); 4] {
        [
            ("--fps", self.fps.is_some()),
            ("--in-place", self.in_place),
            ("--loop", self.looped),
            ("--motion-report", self.motion_report.is_some()),
        ]
    }
}

fn parse_rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(rate) if (1.0..=240.0).contains(&rate) => Ok(rate),
        _ => Err(format!("expected 1 to 240 frames a second, got `{text}`")),
    }
}
