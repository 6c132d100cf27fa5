//! How sure it is that a motion is a person's: what a person has, what no person has, and proportions.
//!
//! Animals and halves of people can be matched, too, and their motion then goes to the wrong limbs in silence.

use glam::Vec3;
use serde::Serialize;

use super::joint_map::JointMap;
use super::reference_pose::ReferencePose;
use super::solve::{BoneError, DirectionError};
use crate::Side;
use crate::math::RigidTransform;
use crate::skeleton::{RigJoint, SidedJoint, Skeleton};

/// A motion with less confidence is more likely than not no person's.
pub const LEAST_CONFIDENCE: f32 = 0.5;

/// Factors on the confidence.
const WITHOUT_ARM: f32 = 0.75;
const WITHOUT_HEAD: f32 = 0.8;
const WITHOUT_TRUNK: f32 = 0.5;
const MORE_LEGS: f32 = 0.4;
const DISPROPORTIONATE: f32 = 0.6;
const NOBODY_STANDS: f32 = 0.4;
const OFF: f32 = 0.6;
const BONE_OFF: f32 = 0.8;

/// Lengths of arms and trunk as parts of that of the legs. People have 0.6 to 0.8 and 0.5 to 0.7, figures of cartoons anything between
/// these.
const ARMS: std::ops::RangeInclusive<f32> = 0.3..=1.8;
const TRUNK: std::ops::RangeInclusive<f32> = 0.25..=2.0;
/// A chain of joints is a leg if it is at least so long as a part of the legs and ends as near to the lowest foot.
const LEG: f32 = 0.6;
const NEAR_FLOOR: f32 = 0.3;
/// Two legs of an animal differ by less than this part of their length.
const ALIKE: f32 = 0.1;
/// Mean angle between the bones of motion and result above which these are different movements, degrees.
const MOST_OFF: f64 = 20.0;
/// The same for a single bone.
pub(super) const MOST_BONE_OFF: f64 = 30.0;
/// An animal's legs are farther from its middle than this part of their length; its tail is nearer.
const ASIDE: f32 = 0.05;

/// How sure it is that a motion is a person's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Confidence {
    /// From 0 to 1. It is a product of factors that were chosen by hand, not a probability.
    pub value: f32,
    /// What speaks against it, such as `it lacks the left arm`.
    pub doubts: Vec<String>,
}

impl Confidence {
    /// Judges a skeleton in the pose that motion is compared with.
    pub(super) fn of(map: &JointMap, skeleton: &Skeleton, reference: &ReferencePose) -> Self {
        let mut confidence = Self { value: 1.0, doubts: Vec::new() };
        let model = &reference.model;
        if !reference.stands {
            confidence.doubt(NOBODY_STANDS, "no person stands in it".into());
        }
        let lacks = lacks(map);
        if !lacks.is_empty() {
            let parts: Vec<&str> = lacks.iter().map(|(part, _)| *part).collect();
            let factor = lacks.iter().map(|(_, factor)| factor).product();
            confidence.doubt(factor, format!("it lacks {}", parts.join(", ")));
        }
        let Some(leg) = chain(map, model, [SidedJoint::Thigh, SidedJoint::Calf, SidedJoint::Foot]) else {
            return confidence;
        };
        if let Some([a, b]) = more_legs(map, skeleton, model, leg) {
            let names = skeleton.names();
            let legs = format!("it has two more legs, `{}` and `{}`", names[a], names[b]);
            confidence.doubt(MORE_LEGS, legs);
        }
        let arm = chain(map, model, [SidedJoint::Upperarm, SidedJoint::Lowerarm, SidedJoint::Hand]);
        for (part, length, usual) in [("arms are", arm, ARMS), ("trunk is", trunk(map, model), TRUNK)] {
            if let Some(share) = length.map(|length| length / leg).filter(|share| !usual.contains(share)) {
                let long = format!("its {part} {share:.2} times as long as its legs");
                confidence.doubt(DISPROPORTIONATE, long);
            }
        }
        confidence
    }

    /// What to tell a user in one sentence; `None` without doubts.
    pub fn warning(&self) -> Option<String> {
        let doubts = self.doubts.join("; ");
        (!self.doubts.is_empty()).then(|| {
            format!("this may be no person, or not a whole one (confidence {:.2} of 1): {doubts}", self.value)
        })
    }

    /// Takes into account the angles between the bones of a clip and of its result.
    pub(super) fn compare(&mut self, clip: &str, direction: &DirectionError) {
        let degrees = direction.mean();
        if degrees > MOST_OFF {
            return self.doubt(OFF, format!("bones of `{clip}` are {degrees:.0}° off on average"));
        }
        let worst = direction.limbs.iter().chain(&direction.trunk).max_by(|a, b| a.mean.total_cmp(&b.mean));
        if let Some(BoneError { bone, mean, .. }) = worst.filter(|worst| worst.mean > MOST_BONE_OFF) {
            self.doubt(BONE_OFF, format!("`{bone}` of `{clip}` is {mean:.0}° off on average"));
        }
    }

    fn doubt(&mut self, factor: f32, why: String) {
        self.value *= factor;
        self.doubts.push(why);
    }
}

/// What a person has and the skeleton has not.
pub(super) fn lacks(map: &JointMap) -> Vec<(&'static str, f32)> {
    let has = |joint: RigJoint| map.source_of(joint).is_some();
    let trunk = !map.spine().is_empty() || !map.neck().is_empty();
    let head = has(RigJoint::Head) || !map.neck().is_empty();
    let parts = [("the trunk", trunk, WITHOUT_TRUNK), ("the head", head, WITHOUT_HEAD)];
    let mut lacks: Vec<_> =
        parts.into_iter().filter(|(_, has, _)| !has).map(|(part, _, factor)| (part, factor)).collect();
    for (side, arm, forearm) in [
        (Side::Left, "the left arm", "the left forearm"),
        (Side::Right, "the right arm", "the right forearm"),
    ] {
        if !has(SidedJoint::Upperarm.on(side)) {
            lacks.push((arm, WITHOUT_ARM));
        } else if !has(SidedJoint::Lowerarm.on(side)) {
            lacks.push((forearm, WITHOUT_ARM));
        }
    }
    lacks
}

/// Length of a limb through its three joints, the mean of the sides that have it; `None` for none or without length.
fn chain(map: &JointMap, model: &[RigidTransform], joints: [SidedJoint; 3]) -> Option<f32> {
    let lengths = Side::ALL.into_iter().filter_map(|side| {
        let [a, b, c] = joints.map(|joint| map.source_of(joint.on(side)).map(|at| model[at].translation));
        let (a, b) = (a?, b?);
        let first = a.distance(b);
        Some(first + c.map_or(first, |c| b.distance(c)))
    });
    let lengths: Vec<f32> = lengths.collect();
    let mean = lengths.iter().sum::<f32>() / lengths.len() as f32;
    (mean > 0.0).then_some(mean)
}

/// Distance of the middles of hips and shoulders.
fn trunk(map: &JointMap, model: &[RigidTransform]) -> Option<f32> {
    let middle = |joint: SidedJoint| {
        let [left, right] = joint.both().map(|joint| map.source_of(joint).map(|at| model[at].translation));
        Some((left? + right?) / 2.0)
    };
    Some(middle(SidedJoint::Thigh)?.distance(middle(SidedJoint::Upperarm)?))
}

/// The first joints of two chains, one on each side, that hang from the trunk, drive nothing, and are as long as legs and reach as
/// low. A dress has more of them, and what names call hair or cloth is none.
fn more_legs(map: &JointMap, skeleton: &Skeleton, model: &[RigidTransform], leg: f32) -> Option<[usize; 2]> {
    let place = |joint: RigJoint| map.source_of(joint).map(|at| model[at].translation);
    let floor =
        SidedJoint::Foot.both().into_iter().filter_map(|foot| Some(place(foot)?.y)).reduce(f32::min)?;
    let [left, right] = SidedJoint::Thigh.both().map(place);
    let (middle, across) = ((left? + right?) / 2.0, (left? - right?).try_normalize()?);
    let mut legs: Vec<(usize, Way)> = hanging_legs(map, skeleton, model, |way| {
        way.length > LEG * leg && (way.end.y - floor).abs() < NEAR_FLOOR * leg
    });
    let aside = |way: &Way| (way.end - middle).dot(across);
    legs.retain(|(_, way)| aside(way).abs() > ASIDE * leg);
    match &legs[..] {
        [(a, one), (b, other)] => {
            let alike = (one.length / other.length - 1.0).abs() < ALIKE && aside(one) * aside(other) < 0.0;
            alike.then_some([*a, *b])
        }
        _ => None,
    }
}

/// The farthest way down a chain of joints.
#[derive(Clone, Copy)]
struct Way {
    length: f32,
    end: Vec3,
}

/// The first joints of all legs that drive nothing and hang from the trunk, or from other joints that do. A leg of several toes is
/// one leg.
fn hanging_legs(
    map: &JointMap,
    skeleton: &Skeleton,
    model: &[RigidTransform],
    is_leg: impl Fn(&Way) -> bool,
) -> Vec<(usize, Way)> {
    let driving: Vec<usize> = map.joints().collect();
    let hanging = map.hanging(skeleton);
    let unmatched = &map.report().unmatched;
    let is_free = |joint: usize| unmatched.contains(&skeleton.names()[joint]) && !hanging[joint];
    let is_trunk = |joint: usize| {
        Some(joint) == map.source_of(RigJoint::Pelvis)
            || map.spine().contains(&joint)
            || !driving.contains(&joint)
    };
    let mut ways: Vec<Way> = model.iter().map(|joint| Way { length: 0.0, end: joint.translation }).collect();
    let mut legs: Vec<Vec<(usize, Way)>> = vec![Vec::new(); model.len()];
    let mut found = Vec::new();
    for joint in (0..model.len()).rev().filter(|joint| is_free(*joint)) {
        let way = ways[joint];
        let mut below = std::mem::take(&mut legs[joint]);
        if below.len() < 2 && is_leg(&way) {
            below = vec![(joint, way)];
        }
        let Some(parent) = skeleton.parents()[joint].map(|parent| parent as usize) else { continue };
        if is_free(parent) {
            legs[parent].extend(below);
            let length = way.length + model[joint].translation.distance(model[parent].translation);
            if length > ways[parent].length {
                ways[parent] = Way { length, ..way };
            }
        } else if is_trunk(parent) {
            found.extend(below);
        }
    }
    found.sort_by_key(|(joint, _)| *joint);
    found
}

#[cfg(test)]
mod tests;
