//! From the words of motion on the command line to the library's types.

use std::path::Path;
use std::sync::Arc;

use anthronet::clip;
pub(crate) use anthronet::clip::BUILTIN;
use anthronet::clip::Clip;
use anthronet::format::{self, ReadOptions};
use anthronet::retarget::feet::FeetOptions;
use anthronet::retarget::{self, FingerMode, RetargetOptions};
use anthronet::scene::Scene;
use anthronet::skeleton::RestPose;
use anthronet::skeleton::humanoid::{native_name, renamed};
use anthronet::space::{Axis, Unit};
use serde_json::json;

use super::core_joint_names;
use crate::failure::{Failure, Result};
use crate::generate::JointNamesChoice;
use crate::motion::{FingersChoice, MotionArguments, UnitChoice, UpChoice};
use crate::request::read_text;

/// A character file, whole: skin, joints, materials, motions.
pub(crate) fn open(path: &Path) -> Result<Scene> {
    Ok(format::read_scene(path)?)
}

/// Names the joints in another vocabulary.
pub(crate) fn rename_joints(scene: &mut Scene, names: JointNamesChoice) {
    for joint in &mut scene.joints {
        joint.name = renamed(&native_name(&joint.name), core_joint_names(names)).into_owned();
    }
}

/// Adds the motions that the options ask for to the scene, and writes the report.
pub(crate) fn animate(scene: &mut Scene, arguments: &MotionArguments) -> Result<()> {
    if arguments.clips.is_empty() {
        return Ok(());
    }
    let rest = Arc::new(scene.rest_pose(|name| native_name(name).into_owned())?);
    let mut reports = Vec::new();
    for source in &arguments.clips {
        let (clips, report) = load(source, &rest, arguments)?;
        clips.into_iter().for_each(|clip| scene.add_clip(clip));
        reports.push(report);
    }
    let Some(path) = &arguments.motion_report else { return Ok(()) };
    let text = serde_json::to_string_pretty(&json!({ "motions": reports }))
        .map_err(|e| Failure::failed(format!("--motion-report: {e}")))?;
    super::write_or_print(path, &(text + "\n"))
}

/// The clips of one `--clip`, on the body, with their report.
fn load(
    source: &str,
    rest: &Arc<RestPose>,
    arguments: &MotionArguments,
) -> Result<(Vec<Clip>, serde_json::Value)> {
    if BUILTIN.contains(&source) {
        let clip = clip::builtin(source, rest)?;
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
        return Ok((vec![clip], report));
    }
    let path = Path::new(source);
    if path.extension().is_none() && !path.exists() {
        let known = BUILTIN.join(", ");
        return Err(Failure::usage(format!("--clip {source}: no such file, and not one of {known}")));
    }
    let motion = format::read_motion(path, &read_options(arguments))?;
    for warning in &motion.report.warnings {
        eprintln!("warning: {source}: {warning}");
    }
    let in_file = |error| Failure::failed(format!("{source}: {error}"));
    let (clips, report) =
        retarget::retarget(&motion.clips, rest, &retarget_options(arguments)?).map_err(in_file)?;
    if !report.joints.unmatched.is_empty() {
        let joints = report.joints.unmatched.join(", ");
        eprintln!("note: {source}: joints that drive nothing: {joints}");
    }
    Ok((clips, json!({ "source": source, "file": motion.report, "onto": report })))
}

fn read_options(arguments: &MotionArguments) -> ReadOptions {
    ReadOptions {
        unit: arguments.clip_unit.map(|unit| match unit {
            UnitChoice::M => Unit::Metre,
            UnitChoice::Cm => Unit::Centimetre,
            UnitChoice::Mm => Unit::Millimetre,
            UnitChoice::In => Unit::Inch,
        }),
        up: arguments.clip_up.map(|up| match up {
            UpChoice::Y => Axis::Y,
            UpChoice::Z => Axis::Z,
        }),
        frames_per_second: arguments.clip_fps,
    }
}

fn retarget_options(arguments: &MotionArguments) -> Result<RetargetOptions> {
    let mut options = RetargetOptions {
        limits: !arguments.no_limits,
        feet: (!arguments.no_feet).then(FeetOptions::default),
        frames_per_second: arguments.fps,
        in_place: arguments.in_place,
        looped: arguments.looped,
        ..RetargetOptions::default()
    };
    if let Some(path) = &arguments.mapping {
        options.mapping = retarget::read_overrides(&read_text(path)?, path)?;
    }
    options.transfer.fingers = match arguments.fingers.unwrap_or(FingersChoice::Source) {
        FingersChoice::Source => FingerMode::Source,
        FingersChoice::Relaxed => FingerMode::Relaxed,
        FingersChoice::Rest => FingerMode::Rest,
    };
    Ok(options)
}
