//! The pose of a source that is compared with the rest pose of the rig.
//!
//! It is the rest pose of the file if a person stands in it. That is a guess: in many files joints have axes of their own and the
//! zero pose is a heap of bones, or nodes hold a frame of the motion. Then the frame of the motion in which the body stands
//! straightest takes its place. Which it is follows from positions of joints alone, so that it does not depend on joints' axes.
//!
//! Positions also tell whether left and right are where the names say: feet and knees point to the front.

mod stance;
#[cfg(test)]
mod tests;

use serde::Serialize;

use self::stance::{Stance, Upright};
use super::confidence::lacks;
use super::joint_map::{JointMap, MatchedBy, NECK, Overrides, SPINE};
use crate::clip::Clip;
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::{Pose, RigJoint, SidedJoint, Skeleton};
use crate::{Error, Result, Side};

/// The most frames of a motion that are looked at.
const FRAMES: usize = 1000;
/// The most frames in which joints without known names are looked for.
const FRAMES_TO_MATCH: usize = 12;
/// The largest turn of trunk, head or feet against an upright body in a frame that stands, radians (60°): beyond it the rest pose
/// has these joints turned.
const ASKEW: f32 = 1.05;
/// How near a rest pose is to a frame that it was saved from, per joint, radians (1°).
const SAVED: f32 = 0.0175;
/// From where on a foot that is turned against such a frame is lifted or lowered, radians (10°).
const LIFTED: f32 = 0.175;
/// How much straighter a frame must stand to take the place of a rest pose that is a frame itself, radians (5°); twice as much
/// in trunk and head where somebody stands in that.
const STRAIGHTER: f32 = 0.087;
/// Mean cosine between the front that names tell and where feet or knees point, from which these contradict each other.
const BACKWARDS: f32 = -0.4;

/// A frame that serves as the rest pose.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReferenceFrame {
    /// Name of the clip.
    pub clip: String,
    /// Index of the frame.
    pub frame: usize,
}

/// What the motion was found to rest in, in model space.
pub(super) struct ReferencePose {
    pub(super) model: Vec<RigidTransform>,
    /// `None` for the rest pose of the file.
    pub(super) frame: Option<ReferenceFrame>,
    /// Whether a person stands in it.
    pub(super) stands: bool,
}

/// Matches the joints of a motion in its rest pose. Where that is no person and the names are unknown, frames are tried.
pub(super) fn find_map(sources: &[&Clip], overrides: &Overrides) -> Result<JointMap> {
    let Some(first) = sources.first() else { return Err(Error::invalid("motion", "has no clip")) };
    let rest = first.skeleton();
    let found = JointMap::find(rest, overrides);
    let by_shape = |map: &JointMap| map.matched_by(RigJoint::Pelvis) == Some(MatchedBy::Geometry);
    let stands = |map: &JointMap, model: &[RigidTransform]| stance::is_person(map, rest, model);
    if let Ok(map) = &found
        && (!by_shape(map) || stands(map, &rest.model_from_joints()))
    {
        if by_shape(map) && Motion::of(map, sources).is_backwards() {
            return turned_map(rest, overrides).or(found);
        }
        return found;
    }
    let step = first.frame_count().div_ceil(FRAMES_TO_MATCH).max(1);
    for frame in (0..first.frame_count()).step_by(step) {
        let locals = first.pose(frame).locals;
        let posed = Skeleton::from_rest_pose(rest.tree().clone(), locals, rest.ends().to_vec())?;
        if let Ok(map) = JointMap::find(&posed, overrides)
            && stands(&map, &posed.model_from_joints())
        {
            return Ok(map);
        }
    }
    found
}

/// The map of a body that faces the other way than its shape was taken to.
fn turned_map(rest: &Skeleton, overrides: &Overrides) -> Result<JointMap> {
    let turn = RigidTransform {
        rotation: Rotation::from_rotation_y(std::f32::consts::PI),
        ..RigidTransform::IDENTITY
    };
    let locals = rest.rest_pose().locals.iter().zip(rest.parents());
    let locals = locals.map(|(local, parent)| if parent.is_none() { turn.then(*local) } else { *local });
    let turned = Skeleton::from_rest_pose(rest.tree().clone(), locals.collect(), rest.ends().to_vec())?;
    JointMap::find(&turned, overrides)
}

/// The pose to compare with the rig's rest pose.
///
/// # Errors
/// [`Error::Invalid`] when neither the rest pose nor a frame is a person that stands, unless it is forced, or when left and right
/// are exchanged.
pub(super) fn find(map: &JointMap, sources: &[&Clip], force: bool) -> Result<ReferencePose> {
    let Some(first) = sources.first() else { return Err(Error::invalid("motion", "has no clip")) };
    let rest = first.skeleton();
    let model = rest.model_from_joints();
    let motion = Motion::of(map, sources);
    motion.check_sides(map)?;
    let at_rest = Stance::of(map, rest, &model);
    let is_person = stance::is_person(map, rest, &model);
    let own = ReferencePose { model, frame: None, stands: is_person };
    let Some(best) = motion.straightest else {
        return if is_person || force { Ok(own) } else { Err(no_person(map)) };
    };
    let askew = || is_askew(map, (&own.model, &best.model), at_rest.as_ref());
    // A motion may well begin in its rest pose: that is doubtful if nobody stands so, or only somebody who moves.
    let bent = |stance: &Stance| match stance.upright() {
        Upright::Straight => {
            stance.upper_strain() > best.upper_strain + 2.0 * STRAIGHTER
                && !stance::is_symmetric(map, &own.model)
        }
        _ => stance.strain() > best.strain + STRAIGHTER,
    };
    let saved = || motion.holds_rest && at_rest.as_ref().is_none_or(bent);
    let lifted = motion.lifts_feet && !motion.holds_rest;
    if is_person && !askew() && !saved() && !lifted {
        return Ok(own);
    }
    Ok(ReferencePose { frame: Some(best.frame), model: best.model, stands: true })
}

fn no_person(map: &JointMap) -> Error {
    let lacks: Vec<&str> = lacks(map).into_iter().map(|(part, _)| part).collect();
    let lacks = if lacks.is_empty() { String::new() } else { format!("; it lacks {}", lacks.join(", ")) };
    let expected = "expected a rest pose with legs down and trunk up, or a frame that stands so, unless it is forced (`force`)";
    let message =
        format!("no person stands in its zero pose (rest pose), nor in any of its frames{lacks}: {expected}");
    Error::invalid("motion", message)
}

/// Whether trunk, head or feet, which say little by positions, would be turned far in a frame that stands upright.
fn is_askew(
    map: &JointMap,
    (rest, stands): (&[RigidTransform], &[RigidTransform]),
    at_rest: Option<&Stance>,
) -> bool {
    let axes = |model: &[RigidTransform]| stance::axes(map, model).unwrap_or(Rotation::IDENTITY);
    let turn = axes(stands) * axes(rest).conjugate();
    let feet = SidedJoint::Foot.both();
    let trunk = [RigJoint::Pelvis, RigJoint::Head].into_iter().chain(SPINE).chain(NECK);
    at_rest.is_some()
        && trunk.chain(feet).filter_map(|ours| map.source_of(ours)).any(|joint| {
            let moved = stands[joint].rotation * rest[joint].rotation.conjugate();
            (turn.conjugate() * moved).angle_between(Rotation::IDENTITY) > ASKEW
        })
}

/// A frame that stands.
struct Standing {
    frame: ReferenceFrame,
    strain: f32,
    upper_strain: f32,
    model: Vec<RigidTransform>,
}

/// What the frames of a motion tell.
#[derive(Default)]
struct Motion {
    straightest: Option<Standing>,
    /// Whether a frame is the rest pose.
    holds_rest: bool,
    /// Whether a frame is the rest pose but for the feet, which that has lifted or lowered.
    lifts_feet: bool,
    /// Sums over frames, and their numbers, of the cosine between the front that the names tell and where toes and knees point.
    toes: (f32, f32),
    knees: (f32, f32),
}

impl Motion {
    fn of(map: &JointMap, sources: &[&Clip]) -> Self {
        let mut motion = Self::default();
        let all: usize = sources.iter().map(|clip| clip.frame_count()).sum();
        let step = all.div_ceil(FRAMES).max(1);
        let (mut pose, mut model) = (Pose::default(), Vec::new());
        for clip in sources {
            for frame in (0..clip.frame_count()).step_by(step) {
                clip.pose_into(frame, &mut pose);
                crate::skeleton::model_from_joints(clip.skeleton().parents(), &pose.locals, &mut model);
                let [feet, others] = away_from_rest(map, clip, &pose);
                motion.holds_rest |= feet.max(others) < SAVED;
                motion.lifts_feet |= others < SAVED && feet > LIFTED;
                let Some(stance) = Stance::of(map, clip.skeleton(), &model) else { continue };
                for (sum, cosine) in [(&mut motion.toes, stance.toes()), (&mut motion.knees, stance.knees())]
                {
                    if let Some(cosine) = cosine {
                        *sum = (sum.0 + cosine, sum.1 + 1.0);
                    }
                }
                let strain = stance.strain();
                let better = motion.straightest.as_ref().is_none_or(|best| strain < best.strain - 1e-4);
                if better && stance.upright() == Upright::Straight {
                    let frame = ReferenceFrame { clip: clip.name().to_owned(), frame };
                    let upper_strain = stance.upper_strain();
                    motion.straightest = Some(Standing { frame, strain, upper_strain, model: model.clone() });
                }
            }
        }
        motion
    }

    /// Whether feet and knees point to the back.
    fn is_backwards(&self) -> bool {
        let mean = |(sum, count): (f32, f32)| (count > 0.0).then_some(sum / count);
        let (toes, knees) = (mean(self.toes), mean(self.knees));
        match (toes, knees) {
            (Some(toes), knees) => toes < BACKWARDS && knees.is_none_or(|knees| knees < -BACKWARDS / 2.0),
            (None, Some(knees)) => knees < BACKWARDS,
            (None, None) => false,
        }
    }

    /// Refuses a motion whose left is where its right should be, unless the user has named the legs.
    fn check_sides(&self, map: &JointMap) -> Result<()> {
        let [left, right] = SidedJoint::Thigh.both().map(|thigh| map.matched_by(thigh));
        if !self.is_backwards() || left == Some(MatchedBy::Mapping) || right == Some(MatchedBy::Mapping) {
            return Ok(());
        }
        let name = |side: Side| map.name_of(SidedJoint::Thigh.on(side)).unwrap_or_default();
        let (left, right) = (name(Side::Left), name(Side::Right));
        Err(Error::invalid(
            "joint mapping",
            format!(
                "left and right contradict each other: by its feet and knees the body faces so that `{left}` is on its right. \
                 Either the file is mirrored, as a left-handed program writes it, or its names of left and right are \
                 exchanged: then map `{right}` to thigh_l, `{left}` to thigh_r, and the other joints, in a mapping file"
            ),
        ))
    }
}

/// The largest turn of the feet, and of the other joints that drive something, from the clip's rest pose, radians.
fn away_from_rest(map: &JointMap, clip: &Clip, pose: &Pose) -> [f32; 2] {
    let rest = &clip.skeleton().rest_pose().locals;
    let feet = [SidedJoint::Foot, SidedJoint::Ball].into_iter().flat_map(SidedJoint::both);
    let feet: Vec<usize> = feet.filter_map(|foot| map.source_of(foot)).collect();
    let mut away = [0.0_f32; 2];
    for joint in map.joints() {
        let part = usize::from(!feet.contains(&joint));
        away[part] = away[part].max(rest[joint].rotation.angle_between(pose.locals[joint].rotation));
    }
    away
}
