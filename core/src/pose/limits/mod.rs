//! Joint limits: how far the joints of the rig may rotate.
//!
//! The ranges start from the clinical tables (American Academy of Orthopaedic Surgeons, *Joint Motion: Method of
//! Measuring and Recording*, 1965; American Medical Association, *Guides to the Evaluation of Permanent Impairment*):
//! knee 0–150° flexion, elbow 0–150°, hip 120° flexion, 30° extension, 45° abduction, 45° rotation, shoulder 180°
//! flexion, 60° extension, ankle 20° dorsiflexion, 50° plantar flexion, wrist 80° flexion, 70° extension, neck 45° lateral
//! flexion, 60–80° rotation. They are widened to passive range, for two reasons: athletes and dancers reach it, and one
//! joint of a motion file often does what several share in the body, such as the whole bend of a back. Jaw, eyes and
//! clavicles, which the tables lack, are set by eye.
//!
//! Angles count from the T-pose, about the joint's own axes at rest (see [`Skeleton::bind`](crate::skeleton::Skeleton::bind)):
//! +Y along the bone, +Z mostly to the front. A positive angle about X swings the bone towards +Z: it nods the head, flexes
//! elbow and hip and lifts the foot, and extends the knee. On the left a positive angle about Z raises the arm and abducts
//! the leg; the right is the mirror image.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::SwingTwist;
use crate::Side;
use crate::math::Rotation;
use crate::skeleton::{Pose, RigJoint, SidedJoint, Skeleton};

/// Excess that is ignored, radians: the rounding error of a clamped rotation in `f32`, so that clamping again changes
/// nothing.
const ROUNDING: f32 = 2e-5;
/// Hysteresis of the twist, radians (60°): how far beyond half a turn from the middle of its range it still clamps to the
/// end by which it left the range.
const TWIST_HYSTERESIS: f32 = 1.05;
/// How fast a clamped twist crosses to the other end of its range, radians a second (600°): the speed of a wrist.
const CROSSING_SPEED: f32 = 10.5;

/// Limits of a central or left joint, degrees, each least and most.
struct Ranges {
    /// Swing about X.
    x: [f32; 2],
    /// Swing about Z.
    z: [f32; 2],
    /// Twist about the bone.
    twist: [f32; 2],
}

const fn ranges(x: [f32; 2], z: [f32; 2], twist: [f32; 2]) -> Option<Ranges> {
    Some(Ranges { x, z, twist })
}

/// The limits of a joint; `None` for joints that rotate freely: the root, the pelvis, twist joints.
fn ranges_of(joint: RigJoint) -> Option<Ranges> {
    match joint {
        RigJoint::Root | RigJoint::Pelvis => None,
        RigJoint::Spine01 | RigJoint::Spine02 | RigJoint::Spine03 => {
            ranges([-40., 60.], [-40., 40.], [-45., 45.])
        }
        RigJoint::Neck01 => ranges([-55., 60.], [-45., 45.], [-65., 65.]),
        RigJoint::Head => ranges([-55., 60.], [-45., 45.], [-80., 80.]),
        RigJoint::Jaw => ranges([-45., 5.], [-15., 15.], [-10., 10.]),
        RigJoint::Sided(joint, _) => ranges_of_sided(joint),
    }
}

fn ranges_of_sided(joint: SidedJoint) -> Option<Ranges> {
    use SidedJoint as J;
    match joint {
        J::Eye => ranges([-50., 50.], [-55., 55.], [-15., 15.]),
        J::Clavicle => ranges([-35., 45.], [-25., 50.], [-50., 50.]),
        // From SHOULDER_CENTRE: across the chest and behind; overhead and hanging.
        J::Upperarm => ranges([-125., 120.], [-125., 125.], [-125., 125.]),
        // At rest the palm faces down, which is nearly full pronation; supination takes it to nearly facing up.
        J::Lowerarm => ranges([-15., 160.], [-15., 15.], [-170., 60.]),
        J::Hand => ranges([-55., 45.], [-95., 95.], [-170., 60.]),
        J::Thumb01 => ranges([-60., 60.], [-60., 60.], [-60., 60.]),
        J::Thumb02 => ranges([-60., 60.], [-75., 60.], [-30., 30.]),
        J::Thumb03 => ranges([-50., 50.], [-95., 60.], [-30., 30.]),
        J::Index01 | J::Middle01 | J::Ring01 => ranges(FINGER_SPREAD, KNUCKLE, FINGER_TWIST),
        J::Pinky01 => ranges([-45., 30.], KNUCKLE, FINGER_TWIST),
        J::Index02 | J::Index03 | J::Middle02 | J::Middle03 => {
            ranges(FINGER_SIDEWAYS, FINGER_CURL, FINGER_TWIST)
        }
        J::Ring02 | J::Ring03 | J::Pinky02 | J::Pinky03 => ranges(FINGER_SIDEWAYS, FINGER_CURL, FINGER_TWIST),
        J::Thigh => ranges([-40., 145.], [-50., 90.], [-70., 70.]),
        J::Calf => ranges([-160., 12.], [-15., 15.], [-45., 45.]),
        J::Foot => ranges([-70., 50.], [-45., 45.], [-45., 45.]),
        J::Ball => ranges([-50., 90.], [-25., 25.], [-25., 25.]),
        J::UpperarmTwist01 | J::UpperarmTwist02 | J::LowerarmTwist01 | J::LowerarmTwist02 => None,
        J::ThighTwist01 | J::CalfTwist01 => None,
    }
}
const FINGER_SIDEWAYS: [f32; 2] = [-20., 20.];
const FINGER_CURL: [f32; 2] = [-115., 35.];
const FINGER_SPREAD: [f32; 2] = [-30., 30.];
const KNUCKLE: [f32; 2] = [-100., 60.];
const FINGER_TWIST: [f32; 2] = [-30., 30.];

/// Middle of the left shoulder's range, swing about X and Z, degrees: half forward and a little down.
const SHOULDER_CENTRE: [f32; 2] = [45., -15.];
/// Longest swing of a shoulder from its centre and of a hip from rest, in any direction, degrees.
const SHOULDER_CONE: f32 = 128.;
const HIP_CONE: f32 = 150.;

/// How far one joint may rotate, radians, counted from [`centre`](Self::centre).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimit {
    /// The swing about X and Z, from rest, at which the ranges are zero.
    pub centre: Vec2,
    /// Least and most swing about X.
    pub swing_x: [f32; 2],
    /// Least and most swing about Z.
    pub swing_z: [f32; 2],
    /// The longest swing in any direction.
    pub cone: f32,
    /// Least and most twist about the bone.
    pub twist: [f32; 2],
}

impl JointLimit {
    /// The nearest swing and twist within the limits, and the larger of their distances to the given ones. Twist is clamped
    /// to the nearer end of its range, continuing from `history`.
    fn within(&self, given: SwingTwist, history: &mut TwistState) -> (SwingTwist, f32) {
        let inside = Vec2::new(
            given.swing.x.clamp(self.swing_x[0], self.swing_x[1]),
            given.swing.y.clamp(self.swing_z[0], self.swing_z[1]),
        )
        .clamp_length_max(self.cone);
        let middle = 0.5 * (self.twist[0] + self.twist[1]);
        let half = 0.5 * (self.twist[1] - self.twist[0]);
        let (offset, clamped) = history.clamp_next(given.twist - middle, half);
        let excess = inside.distance(given.swing).max(libm::fabsf(offset - clamped));
        (SwingTwist { swing: inside, twist: middle + clamped }, excess)
    }

    /// The nearest rotation from rest within the limits, and the excess of the given one, radians; `None` when it is within.
    fn clamped(&self, from_rest: Rotation, history: &mut TwistState) -> Option<(Rotation, f32)> {
        let centre = Rotation::from_scaled_axis(Vec3::new(self.centre.x, 0.0, self.centre.y));
        let (inside, excess) = self.within(SwingTwist::of(centre.conjugate() * from_rest), history);
        (excess > ROUNDING).then(|| (centre * inside.rotation(), excess))
    }

    /// The limit of the same joint on the other side.
    fn mirrored(self) -> Self {
        let flip = |[least, most]: [f32; 2]| [-most, -least];
        Self {
            centre: Vec2::new(self.centre.x, -self.centre.y),
            swing_z: flip(self.swing_z),
            twist: flip(self.twist),
            ..self
        }
    }

    /// The limit of a joint of the rig; `None` when it rotates freely.
    fn of(joint: RigJoint) -> Option<Self> {
        let Ranges { x, z, twist } = ranges_of(joint)?;
        let range = |r: [f32; 2]| r.map(f32::to_radians);
        let (centre, cone) = match joint.sided() {
            Some(SidedJoint::Upperarm) => {
                (Vec2::from(SHOULDER_CENTRE.map(f32::to_radians)), SHOULDER_CONE.to_radians())
            }
            Some(SidedJoint::Thigh) => (Vec2::ZERO, HIP_CONE.to_radians()),
            _ => (Vec2::ZERO, PI),
        };
        let limit = Self { centre, swing_x: range(x), swing_z: range(z), cone, twist: range(twist) };
        Some(if joint.side() == Some(Side::Right) { limit.mirrored() } else { limit })
    }
}

/// The twist of a joint in the previous frame.
#[derive(Clone, Copy, Debug, Default)]
struct TwistState {
    /// Angles from the middle of the range, radians: the input, unwound so that it is continuous over frames, and the
    /// clamped one.
    last: Option<(f32, f32)>,
    /// Largest step of the clamped twist in a frame, unless the input makes a larger one, radians.
    max_step: f32,
}

impl TwistState {
    /// Unwinds the next twist, `given` as an angle from the middle of its range, and clamps it to ±`half`.
    fn clamp_next(&mut self, given: f32, half: f32) -> (f32, f32) {
        let near = |angle: f32| given + TAU * libm::roundf((angle - given) / TAU);
        let mut offset = near(0.0);
        let mut clamped = offset.clamp(-half, half);
        if let Some((last_offset, last_clamped)) = self.last {
            let unwound = near(last_offset);
            if libm::fabsf(unwound) < PI + TWIST_HYSTERESIS {
                offset = unwound;
            }
            let step = libm::fabsf(unwound - last_offset).max(self.max_step);
            clamped = offset.clamp(-half, half).clamp(last_clamped - step, last_clamped + step);
        }
        self.last = Some((offset, clamped));
        (offset, clamped)
    }
}

/// The twists of all joints in the previous frame of a clip: see [`JointLimits::clamp_next`].
#[derive(Clone, Debug, Default)]
pub struct TwistHistory(Vec<TwistState>);

impl TwistHistory {
    /// The history before the first frame.
    pub fn new(limits: &JointLimits, frames_per_second: f64) -> Self {
        let state = TwistState { last: None, max_step: CROSSING_SPEED / frames_per_second as f32 };
        Self(vec![state; limits.limits.len()])
    }
}

/// The limits of a skeleton's joints.
#[derive(Clone, Debug, PartialEq)]
pub struct JointLimits {
    limits: Vec<Option<JointLimit>>,
}

impl JointLimits {
    /// The limits of the joints that have names of the rig; joints with other names rotate freely.
    pub fn of_rig(rest: &Skeleton) -> Self {
        Self { limits: rest.rig_joints().map(|joint| JointLimit::of(joint?)).collect() }
    }

    /// The same limits, `by` radians wider in every direction.
    pub fn widened(mut self, by: f32) -> Self {
        for limit in self.limits.iter_mut().flatten() {
            for range in [&mut limit.swing_x, &mut limit.swing_z, &mut limit.twist] {
                *range = [range[0] - by, range[1] + by];
            }
            limit.cone += by;
        }
        self
    }

    /// The limit of a joint; `None` when it rotates freely or does not exist.
    pub fn get(&self, joint: usize) -> Option<&JointLimit> {
        self.limits.get(joint)?.as_ref()
    }

    /// Clamps every joint to its limits: to the nearest swing and the nearest twist. A pose within the limits is not changed.
    /// Continuous, except where a twist is half a turn from the middle of its range and the nearer end changes.
    pub fn clamp(&self, rest: &Skeleton, pose: &mut Pose) {
        for joint in 0..self.limits.len() {
            self.clamp_joint(rest, pose, joint);
        }
    }

    /// As [`clamp`](Self::clamp), for the next frame of a clip: a twist that goes past half a turn from the middle of its
    /// range stays at the end by which it left and then crosses at a limited speed, instead of jumping between the ends.
    pub fn clamp_next(&self, rest: &Skeleton, pose: &mut Pose, history: &mut TwistHistory) {
        for (joint, state) in history.0.iter_mut().enumerate() {
            self.clamp_one(rest, pose, joint, state);
        }
    }

    /// Clamps one joint to its limits; returns whether it changed.
    pub fn clamp_joint(&self, rest: &Skeleton, pose: &mut Pose, joint: usize) -> bool {
        self.clamp_one(rest, pose, joint, &mut TwistState::default())
    }

    fn clamp_one(&self, rest: &Skeleton, pose: &mut Pose, joint: usize, state: &mut TwistState) -> bool {
        let (Some(limit), Some(rest), Some(local)) =
            (self.get(joint), rest.rest_pose().locals.get(joint), pose.locals.get_mut(joint))
        else {
            return false;
        };
        let Some((inside, _)) = limit.clamped(rest.rotation.conjugate() * local.rotation, state) else {
            return false;
        };
        local.rotation = (rest.rotation * inside).normalize();
        true
    }

    /// How far each joint is beyond its limits, radians; 0 when it is within them or has none.
    pub fn excess(&self, rest: &Skeleton, pose: &Pose) -> Vec<f32> {
        let from_rest = rest.rest_pose().locals.iter().zip(&pose.locals);
        self.limits
            .iter()
            .zip(from_rest)
            .map(|(limit, (rest, local))| {
                let rotation = rest.rotation.conjugate() * local.rotation;
                let clamped = limit.and_then(|limit| limit.clamped(rotation, &mut TwistState::default()));
                clamped.map_or(0.0, |(_, excess)| excess)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
