//! The whole way of a motion onto a body of ours: matched, retargeted, limited, feet on the floor; and how well it went.

use std::path::Path;
use std::sync::Arc;

use serde::Serialize;

use super::feet::{FeetOptions, FeetReport, plant, plant_loop};
use super::joint_map::{JointMap, JointMapReport, Overrides, read_overrides};
use super::solve::{
    DirectionError, FingerMode, Jump, Retargeter, RootMotion, TransferOptions, direction_error, worst_jump,
};
use crate::clip::{Clip, in_place, looped, resample};
use crate::pose::limits::{JointLimits, TwistHistory};
use crate::skeleton::Skeleton;
use crate::{Error, Result};

/// Over how long the end of a looped clip goes over into its beginning, seconds; at most a third of the clip.
const LOOP_BLEND: f64 = 0.3;

/// How a motion comes onto a body.
#[derive(Clone, Debug)]
pub struct RetargetOptions {
    /// The user's own word about joints.
    pub mapping: Overrides,
    /// How poses are carried over.
    pub transfer: TransferOptions,
    /// Whether joints are kept within what people's joints do.
    pub limits: bool,
    /// How feet are held on the floor; `None` leaves them where the motion puts them.
    pub feet: Option<FeetOptions>,
    /// Frames per second of the result; `None`, those of the motion.
    pub frames_per_second: Option<f64>,
    /// Whether motion over the ground is left out.
    pub in_place: bool,
    /// Whether the end is made to meet the beginning.
    pub looped: bool,
}

impl Default for RetargetOptions {
    fn default() -> Self {
        Self {
            mapping: Overrides::new(),
            transfer: TransferOptions::default(),
            limits: true,
            feet: Some(FeetOptions::default()),
            frames_per_second: None,
            in_place: false,
            looped: false,
        }
    }
}

/// [`RetargetOptions`] as plain values, as hosts pass them: the default of each is the default.
#[derive(Clone, Copy, Debug, Default)]
pub struct RetargetSwitches<'a> {
    /// What fingers do.
    pub fingers: FingerMode,
    /// Leaves joints beyond what people's joints do.
    pub no_limits: bool,
    /// Leaves feet where the motion puts them.
    pub no_feet: bool,
    /// Leaves out motion over the ground.
    pub in_place: bool,
    /// Makes the end meet the beginning.
    pub looped: bool,
    /// Gives the way over the ground to the root instead of the pelvis.
    pub root_motion: bool,
    /// What [`read_overrides`] reads; empty to find all joints.
    pub mapping_json: &'a str,
    /// Frames per second of the result; 0 keeps those of the motion.
    pub frames_per_second: f64,
}

impl TryFrom<RetargetSwitches<'_>> for RetargetOptions {
    type Error = Error;

    fn try_from(asked: RetargetSwitches<'_>) -> Result<Self> {
        let mapping = match asked.mapping_json {
            "" => Overrides::new(),
            json => read_overrides(json, Path::new("mapping_json"))?,
        };
        let root = if asked.root_motion { RootMotion::Root } else { RootMotion::Pelvis };
        Ok(Self {
            mapping,
            transfer: TransferOptions { fingers: asked.fingers, root, ..TransferOptions::default() },
            limits: !asked.no_limits,
            feet: (!asked.no_feet).then(FeetOptions::default),
            frames_per_second: (asked.frames_per_second != 0.0).then_some(asked.frames_per_second),
            in_place: asked.in_place,
            looped: asked.looped,
        })
    }
}

/// How well one clip came onto the body.
#[derive(Clone, Debug, Serialize)]
pub struct ClipReport {
    /// Name of the clip.
    pub name: String,
    /// Number of frames.
    pub frames: usize,
    /// Frames per second.
    pub frames_per_second: f64,
    /// Between bones of the motion and of the body, degrees.
    pub direction: DirectionError,
    /// How far a joint turns beyond its limits at most, degrees.
    pub beyond_limits: f64,
    /// The joint that does.
    pub beyond_limits_joint: Option<String>,
    /// The farthest that a limb turns in one frame beyond the motion.
    pub jump: Jump,
    /// What was done about the feet, before motion over the ground was left out; `None` where nothing was asked for.
    pub feet: Option<FeetReport>,
}

/// How a motion came onto a body.
#[derive(Clone, Debug, Serialize)]
pub struct RetargetReport {
    /// Which joint drives which.
    pub joints: JointMapReport,
    /// The ratio of leg lengths, by which ways and heights are scaled.
    pub scale: f32,
    /// One per clip.
    pub clips: Vec<ClipReport>,
}

/// Retargets every clip of a motion, which share a rest pose, to a body; `target` is the body's
/// own skeleton, see [`Body::skeleton`](crate::Body::skeleton).
///
/// # Errors
/// As [`JointMap::find`], [`Retargeter::new`] and [`plant`].
pub fn retarget(
    sources: &[Clip],
    target: &Arc<Skeleton>,
    options: &RetargetOptions,
) -> Result<(Vec<Clip>, RetargetReport)> {
    let Some(first) = sources.first() else {
        return Err(Error::invalid("motion", "expected at least one clip, got none"));
    };
    let mut way = Way::new(first.skeleton(), target, options)?;
    let clips = sources.iter().map(|source| way.bring(source)).collect::<Result<_>>()?;
    Ok((clips, way.report))
}

/// Brings one clip onto a body, as [`retarget`] does with every clip of a motion.
///
/// # Errors
/// As [`retarget`].
pub fn retarget_clip(
    source: &Clip,
    target: &Arc<Skeleton>,
    options: &RetargetOptions,
) -> Result<(Clip, RetargetReport)> {
    let mut way = Way::new(source.skeleton(), target, options)?;
    let clip = way.bring(source)?;
    Ok((clip, way.report))
}

/// The way from one skeleton to a body.
struct Way<'a> {
    target: &'a Arc<Skeleton>,
    options: &'a RetargetOptions,
    map: JointMap,
    retargeter: Retargeter,
    limits: JointLimits,
    /// Of the clips that went it.
    report: RetargetReport,
}

impl<'a> Way<'a> {
    fn new(source: &Skeleton, target: &'a Arc<Skeleton>, options: &'a RetargetOptions) -> Result<Self> {
        let map = JointMap::find(source, &options.mapping)?;
        let retargeter = Retargeter::new(source, target.clone(), &map, &options.transfer)?;
        let limits = JointLimits::of_rig(target);
        let report =
            RetargetReport { joints: map.report().clone(), scale: retargeter.scale(), clips: Vec::new() };
        Ok(Self { target, options, map, retargeter, limits, report })
    }

    fn bring(&mut self, source: &Clip) -> Result<Clip> {
        let Self { target, options, map, retargeter, limits, report } = self;
        let resampled = options.frames_per_second.map(|rate| resample(source, rate)).transpose()?;
        let source = resampled.as_ref().unwrap_or(source);
        let mut twists = TwistHistory::new(limits, source.frames_per_second());
        let mut clip = retargeter.retarget_with(source, |_, pose| {
            if options.limits {
                limits.clamp_next(target, pose, &mut twists);
            }
        })?;
        let as_it_came = options.looped.then(|| clip.clone());
        let mut feet = None;
        if let Some(options) = &options.feet {
            let (planted, found) = plant(&clip, options)?;
            (clip, feet) = (planted, Some(found));
        }
        // Both compare with the motion as it was, so before its end is bent to its beginning.
        let direction = direction_error(source, &clip, map);
        let jump = worst_jump(source, &clip, map);
        if let Some(came) = as_it_came {
            // Feet are held after the bend, or they would slide in it.
            clip = looped(&came, LOOP_BLEND.min(came.duration() / 3.0))?;
            if let Some(options) = &options.feet {
                let (planted, found) = plant_loop(&clip, options)?;
                (clip, feet) = (planted, Some(found));
            }
        }
        if options.in_place {
            clip = in_place(&clip)?;
        }
        let (beyond, joint) = worst_limit_excess(limits, &clip);
        report.clips.push(ClipReport {
            name: clip.name().to_owned(),
            frames: clip.frame_count(),
            frames_per_second: clip.frames_per_second(),
            direction,
            beyond_limits: f64::from(beyond).to_degrees(),
            beyond_limits_joint: joint.and_then(|j| target.names().get(j).cloned()),
            jump,
            feet,
        });
        Ok(clip)
    }
}

/// The farthest beyond its limits that a joint turns in any frame of a clip of our rig, radians, and which joint; 0 and
/// none when all stay within.
pub fn worst_limit_excess(limits: &JointLimits, clip: &Clip) -> (f32, Option<usize>) {
    let mut worst = (0.0, None);
    for frame in 0..clip.frame_count() {
        for (joint, excess) in limits.excess(clip.skeleton(), &clip.pose(frame)).into_iter().enumerate() {
            if excess > worst.0 {
                worst = (excess, Some(joint));
            }
        }
    }
    worst
}

#[cfg(test)]
mod tests;
