//! Clips for a character: the options, reading, retargeting and the report, shared by the commands that write motion.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anthronet::clip::{self, BUILTIN, Clip};
use anthronet::format::{self, Format, Purpose, ReadOptions};
use anthronet::retarget::feet::FeetOptions;
use anthronet::retarget::{self, FingerMode, RetargetOptions, RetargetReport};
use anthronet::scene::Scene;
use anthronet::skeleton::Skeleton;
use anthronet::skeleton::humanoid::{JointNames, native_name, renamed};
use anthronet::space::{Axis, Unit};
use clap::Args;
use serde_json::json;

use crate::choice;
use crate::failure::{Failure, InvalidValue, Result};
use crate::file_set::FileSet;
use crate::files::{self, extension, read_text};

/// Options of motion.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Motion")]
pub(crate) struct MotionArguments {
    /// A motion file (.bvh .fbx .npz .glb .gltf .vrm .vrma .usd .usda .usdc .usdz) or a built-in clip: idle, walk, wave, squat,
    /// range_of_motion. May be repeated; glTF and USD store several clips.
    #[arg(long = "clip", value_name = "FILE|NAME")]
    pub(crate) clips: Vec<String>,

    /// Unit of length of the motion file; by default read from the file or estimated from the size of its skeleton.
    #[arg(long, value_name = "UNIT", value_parser = choice::unit())]
    pub(crate) clip_unit: Option<Unit>,

    /// Axis of the motion file that points up, such as -y where Y points down; by default read from the file or found
    /// from how the person stands.
    #[arg(long, value_name = "AXIS", value_parser = choice::up_axis(), allow_hyphen_values = true)]
    pub(crate) clip_up: Option<Axis>,

    /// Frames per second of the motion file; overrides the rate in the file.
    #[arg(long, value_name = "RATE", value_parser = parse_rate)]
    pub(crate) clip_fps: Option<f64>,

    /// Which person of a motion file with several, from 0; by default the first.
    #[arg(long, value_name = "N")]
    pub(crate) clip_person: Option<usize>,

    /// A JSON object {"source joint": "target joint" or null} that overrides the automatic joint mapping; null leaves
    /// the source joint unmapped.
    #[arg(long, value_name = "FILE")]
    pub(crate) mapping: Option<PathBuf>,

    /// Retarget a motion even if it seems to be no person's, an animal's for example, or nobody stands in it.
    #[arg(long)]
    pub(crate) force: bool,

    /// Frames per second of the written clips; by default those of the motion file, 30 for built-in clips.
    #[arg(long, value_name = "RATE", value_parser = parse_rate)]
    pub(crate) fps: Option<f64>,

    /// Pose of the fingers, for motion files [default: source].
    #[arg(long, value_parser = choice::fingers())]
    pub(crate) fingers: Option<FingerMode>,

    /// Remove the horizontal root motion.
    #[arg(long)]
    pub(crate) in_place: bool,

    /// Blend the end of the clip into its beginning, so that it loops; built-in clips already do.
    #[arg(long = "loop")]
    pub(crate) looped: bool,

    /// Turn off foot planting: feet may slide and sink into the floor.
    #[arg(long)]
    pub(crate) no_feet: bool,

    /// Turn off joint limits: joints may turn beyond the human range.
    #[arg(long)]
    pub(crate) no_limits: bool,

    /// Write a JSON report of how the motion was read and retargeted, to a file or with `-` to standard output.
    #[arg(long, value_name = "FILE")]
    pub(crate) motion_report: Option<PathBuf>,
}

impl MotionArguments {
    /// Refuses contradictory options before any work is done. `posed_by` is the clip or file that a static pose is a frame of,
    /// which options of motion files apply to as well.
    pub(crate) fn check(&self, output: &Path, posed_by: Option<&str>) -> Result<()> {
        let extension = extension(output);
        if !self.clips.is_empty() && !files::holds_motion(output) {
            let moving: Vec<_> = Format::serving(Purpose::WriteScene).filter(|f| f.holds().clips).collect();
            let dotted: Vec<_> = moving.iter().map(|format| format!(".{}", format.extension())).collect();
            let (last, others) = dotted.split_last().map_or(("", &[][..]), |(l, o)| (l.as_str(), o));
            let expected = format!("{} or {last}", others.join(" "));
            return Err(Failure::usage(format!(
                "--clip: a .{extension} holds no motion, expected {expected}"
            )));
        }
        self.check_sources(posed_by)
    }

    /// Refuses options that apply to none of the clips.
    pub(crate) fn check_sources(&self, posed_by: Option<&str>) -> Result<()> {
        let of_files = posed_by.is_none().then(|| self.of_files()).into_iter().flatten();
        if self.clips.is_empty()
            && let Some((option, _)) = of_files.chain(self.of_all()).find(|(_, given)| *given)
        {
            return Err(Failure::usage(format!("{option}: expected together with --clip")));
        }
        let sources: Vec<&str> = self.clips.iter().map(String::as_str).chain(posed_by).collect();
        if sources.iter().all(|source| BUILTIN.contains(source)) {
            let given = self.of_files().into_iter().find(|(_, given)| *given);
            if let Some((option, _)) = given {
                let clips = sources.join(", ");
                let message = format!(
                    "{option}: applies to motion files only, expected one with --clip, got the built-in {clips}"
                );
                return Err(Failure::usage(message));
            }
        }
        Ok(())
    }

    /// Adds the files that these options name to those of the call.
    pub(crate) fn add_files(&self, files: FileSet) -> FileSet {
        let clips = self.clips.iter().filter(|clip| !BUILTIN.contains(&clip.as_str()));
        clips
            .fold(files, |files, clip| files.reads("--clip", Some(Path::new(clip))))
            .reads("--mapping", self.mapping.as_deref())
            .writes("--motion-report", self.motion_report.as_deref())
    }

    /// Options that apply to motion files only, and whether they were given. Built-in clips are made for the body, with
    /// feet on the floor, joints within their limits and relaxed hands.
    fn of_files(&self) -> [(&'static str, bool); 9] {
        [
            ("--force", self.force),
            ("--clip-unit", self.clip_unit.is_some()),
            ("--clip-up", self.clip_up.is_some()),
            ("--clip-fps", self.clip_fps.is_some()),
            ("--clip-person", self.clip_person.is_some()),
            ("--mapping", self.mapping.is_some()),
            ("--fingers", self.fingers.is_some()),
            ("--no-feet", self.no_feet),
            ("--no-limits", self.no_limits),
        ]
    }

    /// Options that apply to every clip; built-in clips already loop.
    fn of_all(&self) -> [(&'static str, bool); 4] {
        [
            ("--fps", self.fps.is_some()),
            ("--in-place", self.in_place),
            ("--loop", self.looped),
            ("--motion-report", self.motion_report.is_some()),
        ]
    }
}

fn parse_rate(text: &str) -> std::result::Result<f64, InvalidValue> {
    match text.parse::<f64>() {
        Ok(rate) if (1.0..=240.0).contains(&rate) => Ok(rate),
        _ => Err(InvalidValue::form("1 to 240 frames a second", text)),
    }
}

/// Renames the joints to another naming scheme.
pub(crate) fn rename_joints(scene: &mut Scene, names: JointNames) -> Result<()> {
    if let Some(skeleton) = &mut scene.skeleton {
        *skeleton = Arc::new(skeleton.renamed(|name| renamed(&native_name(name), names).into_owned())?);
    }
    Ok(())
}

/// Adds the requested clips to the scene and writes the report.
pub(crate) fn add_clips(scene: &mut Scene, arguments: &MotionArguments) -> Result<()> {
    if arguments.clips.is_empty() {
        return Ok(());
    }
    let skeleton = Arc::new(scene.skeleton_with_ends(|name| native_name(name).into_owned())?);
    let (mut reports, mut accepted) = (Vec::new(), Ok(()));
    for source in &arguments.clips {
        let loaded = load("--clip", source, &skeleton, arguments)?;
        loaded.clips.into_iter().for_each(|clip| scene.add_clip(clip));
        reports.push(loaded.report);
        accepted = loaded.accepted;
        if accepted.is_err() {
            break;
        }
    }
    if let Some(path) = &arguments.motion_report {
        let text = serde_json::to_string_pretty(&json!({ "motions": reports }))?;
        files::write_text(path, &(text + "\n"))?;
    }
    accepted
}

/// The clips of one source, retargeted to the skeleton.
pub(crate) struct Loaded {
    pub(crate) clips: Vec<Clip>,
    report: serde_json::Value,
    /// An error for a motion that seems to be no person's: its report helps to name the joints.
    pub(crate) accepted: Result<()>,
}

/// The clips of a motion file or the built-in clip that an option names, or a pose file's, retargeted to the skeleton.
pub(crate) fn load(
    option: &str,
    source: &str,
    skeleton: &Arc<Skeleton>,
    arguments: &MotionArguments,
) -> Result<Loaded> {
    if BUILTIN.contains(&source) {
        let clip = clip::builtin(source, skeleton)?;
        let clip = match arguments.fps {
            Some(rate) => clip::resample(&clip, rate)?,
            None => clip,
        };
        let clip = if arguments.in_place { clip::in_place(&clip)? } else { clip };
        let report = json!({
            "source": source,
            "clips": [{
                "name": clip.name(),
                "frames": clip.frame_count(),
                "frames_per_second": clip.frames_per_second(),
            }],
        });
        return Ok(Loaded { clips: vec![clip], report, accepted: Ok(()) });
    }
    let path = Path::new(source);
    if path.extension().is_none() && !path.exists() {
        let known = BUILTIN.join(", ");
        return Err(Failure::usage(format!("{option} {source}: no such file, and not one of {known}")));
    }
    let read = if option == "--pose" { format::read_pose } else { format::read_motion };
    let motion = read(path, &read_options(arguments))?;
    for warning in &motion.report.warnings {
        eprintln!("warning: {source}: {warning}");
    }
    let options = retarget_options(arguments)?;
    let (clips, report) = retarget::retarget(&motion.clips, skeleton, &options)
        .map_err(|error| Failure::in_file(path, error))?;
    let accepted = report.check(&options).map_err(|error| Failure::in_file(path, error));
    if accepted.is_ok() {
        tell(source, &report);
    }
    let report = json!({ "source": source, "file": motion.report, "retarget": report });
    Ok(Loaded { clips, report, accepted })
}

/// Tells what a user should know of a motion that was retargeted.
fn tell(source: &str, report: &RetargetReport) {
    if let Some(warning) = report.confidence.warning() {
        eprintln!("warning: {source}: {warning}");
    }
    if let Some(retarget::ReferenceFrame { clip, frame }) = &report.reference {
        eprintln!(
            "warning: {source}: the rest pose is no standing person: frame {frame} of `{clip}`, which stands, was taken for it"
        );
    }
    for note in report.notes() {
        eprintln!("note: {source}: {note}");
    }
}

fn read_options(arguments: &MotionArguments) -> ReadOptions {
    ReadOptions {
        unit: arguments.clip_unit,
        up: arguments.clip_up,
        frames_per_second: arguments.clip_fps,
        person: arguments.clip_person,
    }
}

fn retarget_options(arguments: &MotionArguments) -> Result<RetargetOptions> {
    let mut options = RetargetOptions {
        limits: !arguments.no_limits,
        feet: (!arguments.no_feet).then(FeetOptions::default),
        frames_per_second: arguments.fps,
        in_place: arguments.in_place,
        looped: arguments.looped,
        force: arguments.force,
        ..RetargetOptions::default()
    };
    if let Some(path) = &arguments.mapping {
        options.mapping = retarget::read_overrides(&read_text(path)?, path)?;
    }
    if let Some(fingers) = arguments.fingers {
        options.transfer.fingers = fingers;
    }
    Ok(options)
}
