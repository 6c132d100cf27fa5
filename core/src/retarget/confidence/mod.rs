//! How sure it is that a motion is a person's: what a person has, what no person has, and proportions.
//!
//! Animals and halves of people can be matched, too, and their motion then goes to the wrong limbs in silence.

use glam::Vec3;
use serde::Serialize;

use super::joint_map::JointMap;
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
const OFF: f32 = 0.6;

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

/// How sure it is that a motion is a person's.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Confidence {
    /// From 0 to 1. It is a product of factors that were chosen by hand, not a probability.
    pub value: f32,
    /// What speaks against it, such as `it lacks the left arm`.
    pub doubts: Vec<String>,
}

impl Confidence {
    /// Judges a skeleton in a pose in which it stands, `model` in model space.
    pub(super) fn of(map: &JointMap, skeleton: &Skeleton, model: &[RigidTransform]) -> Self {
        let mut confidence = Self { value: 1.0, doubts: Vec::new() };
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

    /// Takes into account the mean angle between the bones of a clip and of its result, degrees.
    pub(super) fn compare(&mut self, clip: &str, degrees: f64) {
        if degrees > MOST_OFF {
            self.doubt(OFF, format!("bones of `{clip}` are {degrees:.0}° off on average"));
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
    let arm = |side| has(SidedJoint::Upperarm.on(side)) && has(SidedJoint::Lowerarm.on(side));
    let trunk = !map.spine().is_empty() || !map.neck().is_empty();
    let head = has(RigJoint::Head) || !map.neck().is_empty();
    let parts = [
        ("the trunk", trunk, WITHOUT_TRUNK),
        ("the head", head, WITHOUT_HEAD),
        ("the left arm", arm(Side::Left), WITHOUT_ARM),
        ("the right arm", arm(Side::Right), WITHOUT_ARM),
    ];
    parts.into_iter().filter(|(_, has, _)| !has).map(|(part, _, factor)| (part, factor)).collect()
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

/// The first joints of exactly two chains that hang from the trunk, drive nothing, and are as long as legs and reach as low. A
/// dress has more of them, and what names call hair or cloth is none.
fn more_legs(map: &JointMap, skeleton: &Skeleton, model: &[RigidTransform], leg: f32) -> Option<[usize; 2]> {
    let feet = SidedJoint::Foot.both().map(|foot| map.source_of(foot).map(|at| model[at].translation.y));
    let floor = feet.into_iter().flatten().reduce(f32::min)?;
    let driving: Vec<usize> = map.joints().collect();
    let hanging = map.hanging(skeleton);
    let unmatched = &map.report().unmatched;
    let is_free = |joint: usize| unmatched.contains(&skeleton.names()[joint]) && !hanging[joint];
    let trunk = |joint: usize| {
        Some(joint) == map.source_of(RigJoint::Pelvis)
            || map.spine().contains(&joint)
            || !driving.contains(&joint)
    };
    // Farthest way down each free chain, and where it ends.
    let mut ways: Vec<(f32, Vec3)> = model.iter().map(|joint| (0.0, joint.translation)).collect();
    let parents = skeleton.parents();
    let mut tops = Vec::new();
    for joint in (0..model.len()).rev() {
        let Some(parent) = parents[joint].map(|parent| parent as usize) else { continue };
        if !is_free(joint) {
            continue;
        }
        if is_free(parent) {
            let way = ways[joint].0 + model[joint].translation.distance(model[parent].translation);
            if way > ways[parent].0 {
                ways[parent] = (way, ways[joint].1);
            }
        } else if trunk(parent) {
            tops.push(joint);
        }
    }
    tops.reverse();
    tops.retain(|&top| ways[top].0 > LEG * leg && (ways[top].1.y - floor).abs() < NEAR_FLOOR * leg);
    match tops[..] {
        [a, b] if (ways[a].0 / ways[b].0 - 1.0).abs() < ALIKE => Some([a, b]),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
