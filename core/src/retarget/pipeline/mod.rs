//! The retargeting pipeline: matching joints, transferring poses, clamping to joint limits, planting feet, and a report.

use std::sync::Arc;

use serde::Serialize;

use super::confidence::{Confidence, LEAST_CONFIDENCE, MOST_BONE_OFF};
use super::feet::{FeetOptions, FeetReport, plant, plant_loop};
use super::joint_map::{JointMap, JointMapReport, Overrides};
use super::reference_pose::{self, ReferenceFrame};
use super::solve::{
    BoneError, DirectionError, Jump, Retargeter, TransferOptions, direction_error_from, worst_jump,
};
use crate::clip::{Clip, in_place, looped, resample};
use crate::math::RigidTransform;
use crate::pose::limits::{JointLimits, TwistHistory};
use crate::skeleton::Skeleton;
use crate::{Error, Result};

/// How long the end of a looped clip blends into its beginning, seconds; at most a third of the clip.
const LOOP_BLEND: f64 = 0.3;

/// How to retarget a motion to a body.
#[derive(Clone, Debug)]
pub struct RetargetOptions {
    /// The user's joint mapping, which overrides what is found.
    pub mapping: Overrides,
    /// How poses are transferred.
    pub transfer: TransferOptions,
    /// Whether joints are clamped to anatomical limits.
    pub limits: bool,
    /// How feet are planted on the floor; `None` leaves them where the motion puts them.
    pub feet: Option<FeetOptions>,
    /// Frames per second of the result; `None` keeps those of the motion.
    pub frames_per_second: Option<f64>,
    /// Whether root motion is removed.
    pub in_place: bool,
    /// Whether the clip is made to loop.
    pub looped: bool,
    /// Whether a motion is accepted that seems to be no person's; where nobody stands in it, it is compared with its rest pose.
    pub force: bool,
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
            force: false,
        }
    }
}

/// Quality of one retargeted clip.
#[derive(Clone, Debug, Serialize)]
pub struct ClipReport {
    /// Name of the clip.
    pub name: String,
    /// Number of frames.
    pub frames: usize,
    /// Frames per second.
    pub frames_per_second: f64,
    /// Angles between parts of the body in the motion and on the body.
    pub direction: DirectionError,
    /// Largest excess of a joint beyond its limits, degrees.
    pub beyond_limits: f64,
    /// The joint with that excess; `None` when there is none.
    pub beyond_limits_joint: Option<String>,
    /// The largest rotation of a limb in one frame beyond that in the motion.
    pub jump: Jump,
    /// How feet were planted, measured before root motion was removed; `None` when they were not planted.
    pub feet: Option<FeetReport>,
}

/// What retargeting a motion found and did.
#[derive(Clone, Debug, Serialize)]
pub struct RetargetReport {
    /// Which source joint drives which joint of the rig.
    pub joints: JointMapReport,
    /// Scale of root motion and heights: the ratio of leg lengths, unless given.
    pub scale: f32,
    /// How sure it is that the motion is a person's.
    pub confidence: Confidence,
    /// The frame that was taken for the rest pose, as that is no standing person; `None` for the file's rest pose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference: Option<ReferenceFrame>,
    /// One per clip.
    pub clips: Vec<ClipReport>,
}

impl RetargetReport {
    /// What a user may want to know of a motion that was accepted, one sentence each.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if !self.joints.unmatched.is_empty() {
            notes.push(format!("unmatched joints: {}", self.joints.unmatched.join(", ")));
        }
        for clip in &self.clips {
            // Hands and feet say nothing of whose motion it is, as joint limits and the floor hold them back.
            let parts = clip.direction.ends.iter().chain(&clip.direction.rolls);
            for BoneError { bone, mean, .. } in parts.filter(|part| part.mean > MOST_BONE_OFF) {
                notes.push(format!("`{bone}` of `{}` is {mean:.0}° off on average", clip.name));
            }
        }
        notes
    }

    /// Refuses a motion that is more likely no person's, unless these options force it or name joints. Retargeting does not do so
    /// by itself, as the report says what was found.
    ///
    /// # Errors
    /// [`Error::Invalid`] with what speaks against a person.
    pub fn check(&self, options: &RetargetOptions) -> Result<()> {
        match self.confidence.warning() {
            Some(why)
                if self.confidence.value < LEAST_CONFIDENCE
                    && !options.force
                    && options.mapping.is_empty() =>
            {
                let expected = format!("expected a confidence of {LEAST_CONFIDENCE} or more");
                Err(Error::invalid(
                    "motion",
                    format!(
                        "{why}; {expected}, unless its joints are mapped (`mapping`) or it is forced (`force`)"
                    ),
                ))
            }
            _ => Ok(()),
        }
    }
}

/// Retargets all clips of a motion, which share one skeleton, to a body; `target` is the body's own skeleton, see
/// [`Body::skeleton`](crate::Body::skeleton).
///
/// # Errors
/// [`Error::Invalid`] without clips, when neither the rest pose nor a frame is a person that stands and nothing is forced, or when
/// names of left and right contradict the shape of the body; as [`JointMap::find`], [`Retargeter::new`], [`resample`] and [`plant`].
pub fn retarget(
    sources: &[Clip],
    target: &Arc<Skeleton>,
    options: &RetargetOptions,
) -> Result<(Vec<Clip>, RetargetReport)> {
    if sources.is_empty() {
        return Err(Error::invalid("motion", "expected at least one clip, got none"));
    }
    let mut pipeline = Pipeline::new(&sources.iter().collect::<Vec<_>>(), target, options)?;
    let clips = sources.iter().map(|source| pipeline.run(source)).collect::<Result<_>>()?;
    Ok((clips, pipeline.report))
}

/// Retargets one clip to a body, as [`retarget`] does with every clip of a motion.
///
/// # Errors
/// As [`retarget`].
pub fn retarget_clip(
    source: &Clip,
    target: &Arc<Skeleton>,
    options: &RetargetOptions,
) -> Result<(Clip, RetargetReport)> {
    let mut pipeline = Pipeline::new(&[source], target, options)?;
    let clip = pipeline.run(source)?;
    Ok((clip, pipeline.report))
}

/// Everything that is the same for all clips, and the report.
struct Pipeline<'a> {
    target: &'a Arc<Skeleton>,
    options: &'a RetargetOptions,
    map: JointMap,
    /// The pose in which the motion's skeleton stands, `model_from_joint`.
    standing: Vec<RigidTransform>,
    retargeter: Retargeter,
    limits: JointLimits,
    /// Of the clips so far.
    report: RetargetReport,
}

impl<'a> Pipeline<'a> {
    /// For clips that share a skeleton, at least one.
    fn new(sources: &[&Clip], target: &'a Arc<Skeleton>, options: &'a RetargetOptions) -> Result<Self> {
        let map = reference_pose::find_map(sources, &options.mapping)?;
        let reference = reference_pose::find(&map, sources, options.force)?;
        let (source, target_rest) = (sources[0].skeleton(), target.clone());
        let confidence = Confidence::of(&map, source, &reference);
        let standing = reference.model.clone();
        let retargeter =
            Retargeter::with_reference(source, reference.model, target_rest, &map, &options.transfer)?;
        let limits = JointLimits::of_rig(target);
        let report = RetargetReport {
            joints: map.report().clone(),
            scale: retargeter.scale(),
            confidence,
            reference: reference.frame,
            clips: Vec::new(),
        };
        Ok(Self { target, options, map, standing, retargeter, limits, report })
    }

    fn run(&mut self, source: &Clip) -> Result<Clip> {
        let Self { target, options, map, standing, retargeter, limits, report } = self;
        let resampled = options.frames_per_second.map(|rate| resample(source, rate)).transpose()?;
        let source = resampled.as_ref().unwrap_or(source);
        let mut twists = TwistHistory::new(limits, source.frames_per_second());
        let mut clip = retargeter.retarget_with(source, |_, pose| {
            if options.limits {
                limits.clamp_next(target, pose, &mut twists);
            }
        })?;
        let unplanted = options.looped.then(|| clip.clone());
        let mut feet = None;
        if let Some(options) = &options.feet {
            let (planted, found) = plant(&clip, options)?;
            (clip, feet) = (planted, Some(found));
        }
        // Both compare with the source, so they are measured before looping changes the clip.
        let direction = direction_error_from(source, standing.clone(), &clip, map);
        report.confidence.compare(source.name(), &direction);
        let jump = worst_jump(source, &clip, map);
        if let Some(unplanted) = unplanted {
            // Feet are planted after the blend, as it would make them slide.
            clip = looped(&unplanted, LOOP_BLEND.min(unplanted.duration() / 3.0))?;
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

/// The largest excess of a joint beyond its limits in any frame of a clip of the rig, radians, and the index of the joint; 0
/// and `None` when all stay within them.
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
