//! Static poses: the options, shared by the commands that take one.

use std::path::Path;
use std::sync::Arc;

use anthronet::clip::{BUILTIN, Clip, Sampler, Wrap};
use anthronet::pose::POSES;
use anthronet::scene::Scene;
use anthronet::skeleton::Pose;
use anthronet::skeleton::humanoid::native_name;
use clap::Args;

use crate::failure::{Failure, Result};
use crate::file_set::FileSet;
use crate::files::extension;
use crate::motion::{MotionArguments, load};

/// Options of static poses.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Pose")]
pub(crate) struct PoseArguments {
    /// The pose to stand in: t-pose, a-pose, standing, sitting; a moment of a built-in clip or motion file, such as
    /// walk@0.4 (seconds) or dance.bvh#30 (frame, from 0); or a file of a single pose, also the numbers of an SMPL pose (.npz
    /// .npy .json). Files with joints keep the T-pose as their bind pose; an .obj gets the posed surface; a .vrm cannot be
    /// posed.
    #[arg(long, value_name = "POSE")]
    pub(crate) pose: Option<String>,

    /// Move the pose up or down until its lowest point is on the floor.
    #[arg(long, requires = "pose")]
    pub(crate) ground: bool,
}

/// What `--pose` names.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source<'a> {
    /// A pose of the library.
    Named(&'a str),
    /// A moment of a clip or file.
    Moving(&'a str, Moment),
}

/// A moment of a clip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Moment {
    /// That of a clip of a single frame.
    Only,
    /// Seconds from its start.
    Time(f64),
    /// A frame, from 0.
    Frame(usize),
}

impl PoseArguments {
    /// The clip or file that the pose is a moment of.
    pub(crate) fn moving_source(&self) -> Option<&str> {
        match source(self.pose.as_deref()?) {
            Source::Named(_) => None,
            Source::Moving(source, _) => Some(source),
        }
    }

    /// Adds the file that `--pose` names to those of the call.
    pub(crate) fn add_files(&self, files: FileSet) -> FileSet {
        let file = self.moving_source().filter(|source| !BUILTIN.contains(source));
        files.reads("--pose", file.map(Path::new))
    }

    /// Refuses formats that cannot hold a pose, and clips without a moment, before any work is done.
    pub(crate) fn check(&self, output: &Path) -> Result<()> {
        let Some(pose) = self.pose.as_deref() else { return Ok(()) };
        let extension = extension(output);
        if ["vrm", "vrma"].contains(&extension.as_str()) && pose != POSES[0] {
            return Err(Failure::usage(format!(
                "--pose {pose}: a .{extension} must rest in the T-pose, expected .glb .gltf .usda .usdc .usdz or .obj"
            )));
        }
        self.check_source()
    }

    /// Refuses a pose that is no name, no moment and no file.
    pub(crate) fn check_source(&self) -> Result<()> {
        let Some(pose) = self.pose.as_deref() else { return Ok(()) };
        let Source::Moving(clip, moment) = source(pose) else { return Ok(()) };
        let clips = BUILTIN.join(", ");
        if BUILTIN.contains(&clip) {
            return match moment {
                Moment::Only => Err(Failure::usage(format!(
                    "--pose {pose}: expected a moment of the clip, such as {clip}@0.5 (seconds) or {clip}#15 (frame)"
                ))),
                _ => Ok(()),
            };
        }
        let path = Path::new(clip);
        if path.extension().is_none() && !path.exists() {
            let names = POSES.join(", ");
            return Err(Failure::usage(format!(
                "--pose {pose}: no such file, expected one of {names}, a moment of {clips}, or a file"
            )));
        }
        Ok(())
    }

    /// The pose of a scene's skeleton; `None` for the bind pose.
    pub(crate) fn of(&self, scene: &Scene, motion: &MotionArguments) -> Result<Option<Pose>> {
        let Some(text) = self.pose.as_deref() else { return Ok(None) };
        let pose = match source(text) {
            Source::Named(name) if name == POSES[0] => return Ok(None),
            Source::Named(name) => scene.named_pose(name)?,
            Source::Moving(clip, moment) => {
                let skeleton = Arc::new(scene.skeleton_with_ends(|name| native_name(name).into_owned())?);
                let still = MotionArguments { fps: None, in_place: false, looped: false, ..motion.clone() };
                let loaded = load("--pose", clip, &skeleton, &still)?;
                loaded.accepted?;
                let clips = loaded.clips;
                let Some(first) = clips.first() else {
                    return Err(Failure::failed(format!("--pose {clip}: the file has no clip")));
                };
                if clips.len() > 1 {
                    eprintln!(
                        "note: {clip}: of {} clips the first, `{}`, is taken",
                        clips.len(),
                        first.name()
                    );
                }
                let pose = moment.of(first).map_err(|why| Failure::usage(format!("--pose {text}: {why}")))?;
                scene.centred(&pose)?
            }
        };
        Ok(Some(if self.ground { scene.grounded(&pose)? } else { pose }))
    }
}

impl Moment {
    /// The pose of a clip at this moment; otherwise what was expected.
    pub(crate) fn of(self, clip: &Clip) -> std::result::Result<Pose, String> {
        Ok(Sampler::new(clip, Wrap::Once).sample(self.seconds(clip)?))
    }

    /// Its time from the start of a clip, seconds.
    pub(crate) fn seconds(self, clip: &Clip) -> std::result::Result<f64, String> {
        let (name, last, duration) = (clip.name(), clip.frame_count() - 1, clip.duration());
        match self {
            Self::Only if last > 0 => Err(format!(
                "expected a moment of its {} frames, such as @0.5 (seconds) or #15 (frame)",
                last + 1
            )),
            Self::Only => Ok(0.0),
            Self::Time(seconds) if (0.0..=duration + 1e-6).contains(&seconds) => Ok(seconds),
            Self::Time(seconds) => {
                Err(format!("expected 0 to {duration:.3} seconds of `{name}`, got {seconds}"))
            }
            Self::Frame(frame) if frame <= last => Ok(frame as f64 / clip.frames_per_second()),
            Self::Frame(frame) => Err(format!("expected frame 0 to {last} of `{name}`, got {frame}")),
        }
    }
}

/// Reads a pose: a name, or a clip or file with or without a moment. The last `@` or `#` that a number follows is the moment,
/// unless all of it is the name of a file.
fn source(text: &str) -> Source<'_> {
    if POSES.contains(&text) {
        return Source::Named(text);
    }
    if let Some(at) = text.rfind(['@', '#']).filter(|_| !Path::new(text).exists()) {
        let (clip, number) = (&text[..at], &text[at + 1..]);
        let moment = match text.as_bytes()[at] {
            b'@' => number.parse().ok().filter(|seconds: &f64| seconds.is_finite()).map(Moment::Time),
            _ => number.parse().ok().map(Moment::Frame),
        };
        if let Some(moment) = moment.filter(|_| !clip.is_empty()) {
            return Source::Moving(clip, moment);
        }
    }
    Source::Moving(text, Moment::Only)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_is_a_name_a_moment_or_a_file() {
        for (text, expected) in [
            ("sitting", Source::Named("sitting")),
            ("walk@0.5", Source::Moving("walk", Moment::Time(0.5))),
            ("walk@-1", Source::Moving("walk", Moment::Time(-1.0))),
            ("a@b/dance.bvh#30", Source::Moving("a@b/dance.bvh", Moment::Frame(30))),
            ("take#3.bvh@2", Source::Moving("take#3.bvh", Moment::Time(2.0))),
            ("take@3.bvh", Source::Moving("take@3.bvh", Moment::Only)),
            ("kneel.npy", Source::Moving("kneel.npy", Moment::Only)),
            ("walk#1.5", Source::Moving("walk#1.5", Moment::Only)),
            ("walk@inf", Source::Moving("walk@inf", Moment::Only)),
            ("@3", Source::Moving("@3", Moment::Only)),
        ] {
            assert_eq!(source(text), expected, "{text}");
        }
    }
}
