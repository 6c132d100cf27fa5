//! How far the joints of our rig may turn.
//!
//! The ranges start from the clinical tables (American Academy of Orthopaedic Surgeons, *Joint Motion: Method of
//! Measuring and Recording*, 1965; American Medical Association, *Guides to the Evaluation of Permanent Impairment*):
//! knee 0–150° flexion, elbow 0–150°, hip 120° flexion, 30° extension, 45° abduction, 45° rotation, shoulder 180°
//! flexion, 60° extension, ankle 20° up, 50° down, wrist 80° and 70°, neck 45° to each side and 60–80° of turn. They
//! are widened to passive range, for two reasons: athletes and dancers reach it, and one joint often has to do what
//! several share in the body, such as the whole bend of a back that a motion file gives to one joint.
//!
//! Angles are about the joint's own axes in its rest frame (see [`Skeleton::bind`](crate::skeleton::Skeleton::bind)): +Y
//! along the bone, +Z to the front, and count from the T-pose. For every joint +X carries the bone to where Z leans: a
//! head nods, an elbow flexes, a hip flexes, a foot is lifted; a knee flexes about −X. For left limbs +Z carries an
//! arm up and a leg outwards; right limbs are mirror images.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

use super::SwingTwist;
use crate::Side;
use crate::math::Rotation;
use crate::skeleton::{Pose, RigJoint, SidedJoint, Skeleton};

/// What the limits leave alone, radians: the rounding of a clamped rotation in f32, so that clamping twice is
/// clamping once.
const ROUNDING: f32 = 2e-5;
/// How far past half a turn from the middle of its range a twist stays at the end of the range that it left by, radians
/// (60°).
const PAST_HALF: f32 = 1.05;
/// How fast a twist goes over to the other end of its range when it must, radians a second (600°): as fast as wrists do.
const GOING_OVER: f32 = 10.5;

/// How far a joint in the middle or on the left may turn, degrees.
struct Ranges {
    /// About X: least, most.
    x: [f32; 2],
    /// About Z: least, most.
    z: [f32; 2],
    /// About the bone: least, most.
    twist: [f32; 2],
}

const fn ranges(x: [f32; 2], z: [f32; 2], twist: [f32; 2]) -> Option<Ranges> {
    Some(Ranges { x, z, twist })
}

/// From the clinical ranges of active motion of the American Academy of Orthopaedic Surgeons (*Joint Motion: Method of
/// Measuring and Recording*, 1965) and the American Medical Association (*Guides to the Evaluation of Permanent
/// Impairment*), widened to passive range and to what one joint of a motion file does for several of a body; jaw, eyes and
/// clavicles, of which those say nothing, by eye.
///
/// `None` for joints that turn freely: the root, the pelvis, twist joints.
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
        // From SHOULDER_CENTRE: to across the chest and behind, to overhead and hanging.
        J::Upperarm => ranges([-125., 120.], [-125., 125.], [-125., 125.]),
        // The palm rests downwards, which is nearly full pronation; it may turn until it faces up and behind.
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

/// Where a left shoulder's range has its middle, swing about X and Z: half forward and a little down.
const SHOULDER_CENTRE: [f32; 2] = [45., -15.];
/// A swing is never farther from its middle than this.
const SHOULDER_CONE: f32 = 128.;
const HIP_CONE: f32 = 150.;

/// How far one joint may turn, radians, from [`centre`](Self::centre).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimit {
    /// Swing about X and Z that the ranges count from.
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
    /// The nearest swing and twist within, and how far off that is: the larger of the two. The nearest twist is the
    /// shorter way round, but goes on from the one `before`.
    fn within(&self, given: SwingTwist, before: &mut TwistBefore) -> (SwingTwist, f32) {
        let inside = Vec2::new(
            given.swing.x.clamp(self.swing_x[0], self.swing_x[1]),
            given.swing.y.clamp(self.swing_z[0], self.swing_z[1]),
        )
        .clamp_length_max(self.cone);
        let middle = 0.5 * (self.twist[0] + self.twist[1]);
        let half = 0.5 * (self.twist[1] - self.twist[0]);
        let (off, kept) = before.go_on(given.twist - middle, half);
        let excess = inside.distance(given.swing).max(libm::fabsf(off - kept));
        (SwingTwist { swing: inside, twist: middle + kept }, excess)
    }

    /// The nearest rotation from rest within, and how far off that is; nothing when it is within.
    fn clamped(&self, from_rest: Rotation, before: &mut TwistBefore) -> Option<(Rotation, f32)> {
        let centre = Rotation::from_scaled_axis(Vec3::new(self.centre.x, 0.0, self.centre.y));
        let (inside, excess) = self.within(SwingTwist::of(centre.conjugate() * from_rest), before);
        (excess > ROUNDING).then(|| (centre * inside.rotation(), excess))
    }

    /// The mirror image, for the other side.
    fn mirrored(self) -> Self {
        let flip = |[least, most]: [f32; 2]| [-most, -least];
        Self {
            centre: Vec2::new(self.centre.x, -self.centre.y),
            swing_z: flip(self.swing_z),
            twist: flip(self.twist),
            ..self
        }
    }

    /// The limit of a joint of our rig; `None` when it turns freely.
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

/// How a joint was twisted in the frame before.
#[derive(Clone, Copy, Debug, Default)]
struct TwistBefore {
    /// From the middle of its range, radians: as given, past half a turn if it got there bit by bit, and as kept.
    last: Option<(f32, f32)>,
    /// The farthest that it may go from there to the other end of its range.
    fastest: f32,
}

impl TwistBefore {
    /// The next twist, as given and kept within `half` of the middle of its range.
    fn go_on(&mut self, given: f32, half: f32) -> (f32, f32) {
        let near = |place: f32| given + TAU * libm::roundf((place - given) / TAU);
        let mut off = near(0.0);
        let mut kept = off.clamp(-half, half);
        if let Some((off_before, kept_before)) = self.last {
            let unwound = near(off_before);
            if libm::fabsf(unwound) < PI + PAST_HALF {
                off = unwound;
            }
            let fastest = libm::fabsf(unwound - off_before).max(self.fastest);
            kept = off.clamp(-half, half).clamp(kept_before - fastest, kept_before + fastest);
        }
        self.last = Some((off, kept));
        (off, kept)
    }
}

/// How the joints of a clip were twisted in the frame before: see [`JointLimits::clamp_after`].
#[derive(Clone, Debug, Default)]
pub struct TwistsBefore(Vec<TwistBefore>);

impl TwistsBefore {
    /// Before the first frame.
    pub fn first(limits: &JointLimits, frames_per_second: f64) -> Self {
        let before = TwistBefore { last: None, fastest: GOING_OVER / frames_per_second as f32 };
        Self(vec![before; limits.limits.len()])
    }
}

/// The limits of a skeleton's joints.
#[derive(Clone, Debug, PartialEq)]
pub struct JointLimits {
    limits: Vec<Option<JointLimit>>,
}

impl JointLimits {
    /// Those of the joints that bear our rig's names; joints of other names turn freely.
    pub fn of_rig(rest: &Skeleton) -> Self {
        Self { limits: rest.rig_joints().map(|joint| JointLimit::of(joint?)).collect() }
    }

    /// The same limits, each `by` radians wider in every direction.
    pub fn widened(mut self, by: f32) -> Self {
        for limit in self.limits.iter_mut().flatten() {
            for range in [&mut limit.swing_x, &mut limit.swing_z, &mut limit.twist] {
                *range = [range[0] - by, range[1] + by];
            }
            limit.cone += by;
        }
        self
    }

    /// The limit of a joint; `None` when it turns freely.
    pub fn get(&self, joint: usize) -> Option<&JointLimit> {
        self.limits.get(joint)?.as_ref()
    }

    /// Brings every joint within its limits, to the nearest swing and the nearest twist. A pose within them is not
    /// touched. Continuous but for half turns away from the middle of a joint's range, where the nearest changes.
    pub fn clamp(&self, rest: &Skeleton, pose: &mut Pose) {
        for joint in 0..self.limits.len() {
            self.clamp_joint(rest, pose, joint);
        }
    }

    /// As [`clamp`](Self::clamp), frame after frame of a clip: a joint that twists on past half a turn from the middle
    /// of its range stays at the end that it left by, and goes over to the other in time, instead of jumping to and fro.
    pub fn clamp_after(&self, rest: &Skeleton, pose: &mut Pose, before: &mut TwistsBefore) {
        for (joint, before) in before.0.iter_mut().enumerate() {
            self.clamp_one(rest, pose, joint, before);
        }
    }

    /// Brings one joint within its limits; whether it had to be moved.
    pub fn clamp_joint(&self, rest: &Skeleton, pose: &mut Pose, joint: usize) -> bool {
        self.clamp_one(rest, pose, joint, &mut TwistBefore::default())
    }

    fn clamp_one(&self, rest: &Skeleton, pose: &mut Pose, joint: usize, before: &mut TwistBefore) -> bool {
        let (Some(limit), Some(rest), Some(local)) =
            (self.get(joint), rest.rest_pose().locals.get(joint), pose.locals.get_mut(joint))
        else {
            return false;
        };
        let Some((inside, _)) = limit.clamped(rest.rotation.conjugate() * local.rotation, before) else {
            return false;
        };
        local.rotation = (rest.rotation * inside).normalize();
        true
    }

    /// Radians beyond the limit, a joint each: 0 within.
    pub fn excess(&self, rest: &Skeleton, pose: &Pose) -> Vec<f32> {
        let from_rest = rest.rest_pose().locals.iter().zip(&pose.locals);
        self.limits
            .iter()
            .zip(from_rest)
            .map(|(limit, (rest, local))| {
                let turned = rest.rotation.conjugate() * local.rotation;
                let clamped = limit.and_then(|limit| limit.clamped(turned, &mut TwistBefore::default()));
                clamped.map_or(0.0, |(_, excess)| excess)
            })
            .collect()
    }
}

#[cfg(test)]
mod tests;
