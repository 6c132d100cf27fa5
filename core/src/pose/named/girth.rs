//! How far the skin is from the bones where arms and hands pass it.

use glam::Vec3;

use crate::math::RigidTransform;
use crate::skeleton::{RigJoint, SidedJoint, Skeleton};
use crate::{Result, Side};

/// Angles of hanging arms from the vertical, radians: what suits slender people, and the most (11° and 34°).
const ARMS_OUT: [f32; 2] = [0.192, 0.593];
/// Space between a hanging arm and the hip, metres.
const GAP: f32 = 0.012;
/// Where the hips are that hanging arms pass, as shares of the arm's length below the shoulder: from the elbow to the
/// fingers.
const PASSED: [f32; 2] = [0.5, 1.3];
/// How far in front of or behind the arm a point of the hip still is beside it, as a share of the arm's length.
const BESIDE: f32 = 0.12;
/// Where the thigh's height is taken, as shares of the way from hip to knee: under wrist and finger tips.
pub(super) const PLACES: [f32; 2] = [0.45, 0.9];

/// How far the skin is from the bones where arms and hands pass it, so that neither hanging arms enter the hips nor hands the
/// thighs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Girth {
    /// Angle of hanging arms from the vertical at which they clear the hips, radians.
    pub arms_out: f32,
    /// From the line between hip and knee to the skin on the front of the thigh, under the wrist and under the finger tips of
    /// somebody sitting, metres.
    pub thighs: [f32; 2],
    /// From the wrist down to the skin of the palm, metres.
    pub palms: f32,
}

impl Girth {
    /// That of a slender person with this skeleton, for characters without a skin.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) naming a joint of the rig that is missing.
    pub fn slender(rest: &Skeleton) -> Result<Self> {
        let thigh = Line::of(rest, SidedJoint::Thigh, SidedJoint::Calf, Side::Left)?.length;
        Ok(Self { arms_out: ARMS_OUT[0], thighs: [0.2 * thigh, 0.15 * thigh], palms: 0.06 * thigh })
    }

    /// That of a skinned body: for every vertex its position in the rest pose, model space, metres, and the joint of `rest`
    /// that moves it most.
    ///
    /// # Errors
    /// As [`slender`](Self::slender).
    pub fn of(rest: &Skeleton, vertices: impl Iterator<Item = (Vec3, usize)>) -> Result<Self> {
        let joints: Vec<Option<RigJoint>> = rest.rig_joints().collect();
        let mut limbs = Vec::new();
        for side in Side::ALL {
            limbs.push((
                side,
                Line::of(rest, SidedJoint::Upperarm, SidedJoint::Hand, side)?,
                Line::of(rest, SidedJoint::Thigh, SidedJoint::Calf, side)?,
            ));
        }
        let mut forearm: f32 = 0.0;
        let mut hips = Vec::new();
        let mut found = Self { thighs: [0.0; 2], palms: 0.0, ..Self::slender(rest)? };
        for (at, joint) in vertices {
            let Some(joint) = joints.get(joint).copied().flatten() else { continue };
            let side = joint.side().unwrap_or(if at.x > 0.0 { Side::Left } else { Side::Right });
            let Some((_, arm, thigh)) = limbs.iter().find(|(of, ..)| *of == side) else { continue };
            match joint.sided().map(SidedJoint::main_joint) {
                Some(SidedJoint::Lowerarm) => forearm = forearm.max(arm.distance(at)),
                Some(SidedJoint::Hand) => found.palms = found.palms.max(arm.start.y - at.y),
                Some(SidedJoint::Thigh) => {
                    thigh.add_front(at, &mut found.thighs);
                    hips.push((at, *arm));
                }
                None if joint != RigJoint::Head => hips.push((at, *arm)),
                _ => {}
            }
        }
        let slope = hips.iter().filter_map(|(at, arm)| arm.slope_beside(*at, forearm)).fold(0.0, f32::max);
        found.arms_out = libm::atanf(slope).clamp(ARMS_OUT[0], ARMS_OUT[1]);
        Ok(found)
    }
}

/// A line from joint to joint at rest.
#[derive(Clone, Copy)]
struct Line {
    start: Vec3,
    along: Vec3,
    length: f32,
}

impl Line {
    fn of(rest: &Skeleton, from: SidedJoint, to: SidedJoint, side: Side) -> Result<Self> {
        let model: Vec<RigidTransform> = rest.model_from_joints();
        let [from, to] = [from, to].map(|joint| rest.require_rig_joint(joint.on(side)));
        let (start, end) = (model[from?].translation, model[to?].translation);
        Ok(Self { start, along: (end - start).normalize_or_zero(), length: start.distance(end) })
    }

    fn distance(&self, at: Vec3) -> f32 {
        let from = at - self.start;
        (from - self.along * from.dot(self.along)).length()
    }

    /// Raises the heights of the thigh's front at [`PLACES`] to that of a point near them.
    fn add_front(&self, at: Vec3, heights: &mut [f32; 2]) {
        let from = at - self.start;
        let along = from.dot(self.along);
        let front = (Vec3::Z - self.along * self.along.z).normalize_or_zero();
        for (height, place) in heights.iter_mut().zip(PLACES) {
            if (along / self.length.max(1e-6) - place).abs() < 0.08 {
                *height = height.max(from.dot(front));
            }
        }
    }

    /// Tangent of the angle from the vertical at which an arm of this thickness that hangs from the start clears a point;
    /// `None` for a point that it does not pass.
    fn slope_beside(&self, at: Vec3, thickness: f32) -> Option<f32> {
        let below = self.start.y - at.y;
        let passed = (PASSED[0] * self.length..PASSED[1] * self.length).contains(&below);
        // The arm hangs a little forwards.
        let beside = (at.z - self.start.z - 0.1 * below).abs() < BESIDE * self.length;
        (passed && beside).then(|| (at.x.abs() + thickness + GAP - self.start.x.abs()) / below)
    }
}
