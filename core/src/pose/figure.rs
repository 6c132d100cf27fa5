//! Poses a body of the rig from anatomical parameters: arms lowered, feet rolled, spine bent.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::Leg;
use super::ik::{Bend, Limb, Reach};
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::{Finger, Pose, RigJoint, SidedJoint, Skeleton, model_from_joints};
use crate::{Error, Result, Side};

/// Largest extension of a leg, as a share of its length, so that knees never lock.
const STRETCH: f32 = 0.992;

/// Parameters of an arm, degrees. All zero is the T-pose.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Arm {
    /// Down from horizontal; 90 hangs.
    pub(crate) lowered: f32,
    /// Then forwards about the axis through both shoulders.
    pub(crate) forward: f32,
    /// Before both, outward rotation about the bone, which lifts a bent forearm.
    pub(crate) outward: f32,
    /// Elbow flexion.
    pub(crate) elbow: f32,
    /// Wrist: radial deviation, flexion.
    pub(crate) wrist: Vec2,
    /// Curl of each finger joint beyond rest.
    pub(crate) curl: f32,
    /// Clavicle, upwards.
    pub(crate) shrug: f32,
}

impl Arm {
    /// At the side, elbow slightly bent, fingers relaxed.
    pub(crate) const HANGING: Self = Self {
        lowered: 79.0,
        forward: 3.0,
        outward: 0.0,
        elbow: 16.0,
        wrist: Vec2::new(0.0, 4.0),
        curl: 14.0,
        shrug: -3.0,
    };
}

/// Parameters of a foot, relative to rest.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Foot {
    /// Displacement from rest in model space, metres.
    pub(crate) shift: Vec3,
    /// Degrees: positive raises the heel about the ball with the toes flat, negative raises the toes about the heel.
    pub(crate) roll: f32,
    /// Outward rotation of the foot about the vertical, degrees.
    pub(crate) toe_out: f32,
    /// Where the knee points, in model space; `None` leaves it to the hinge.
    pub(crate) knee: Option<Vec3>,
}

/// Parameters of a whole body, angles in degrees; arms and feet are left, right.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stance {
    /// Translation of the root, metres.
    pub(crate) root: Vec3,
    /// Displacement of the pelvis from rest, metres.
    pub(crate) pelvis: Vec3,
    /// Outward rotation of the thighs, with the knees.
    pub(crate) knees_out: f32,
    /// Rotation of the pelvis about X (forward lean), Y (to the left), Z (lean to the right) in model space.
    pub(crate) pelvis_rotation: Vec3,
    /// The same for the spine, divided among its joints.
    pub(crate) spine: Vec3,
    /// The same for neck and head, divided among them.
    pub(crate) head: Vec3,
    pub(crate) arms: [Arm; 2],
    pub(crate) feet: [Foot; 2],
}

struct ArmJoints {
    clavicle: usize,
    upper: usize,
    lower: usize,
    hand: usize,
    /// Twist joints of the upper arm and the factor of its twist that each applies: −1 at the shoulder, −½ half-way.
    twists: Vec<(usize, f32)>,
    fingers: Vec<usize>,
}

/// A skeleton with the indices of its joints and its proportions.
pub(crate) struct Figure {
    pub(crate) rest: Arc<Skeleton>,
    model: Vec<RigidTransform>,
    root: usize,
    pelvis: usize,
    spine: [usize; 3],
    neck: [usize; 2],
    arms: [ArmJoints; 2],
    legs: [Leg; 2],
    /// Length of a leg from hip to ankle, metres.
    pub(crate) leg_length: f32,
    /// Lengths of thigh and shin, metres.
    pub(crate) leg_bones: [f32; 2],
}

impl Figure {
    pub(crate) fn new(rest: &Arc<Skeleton>) -> Result<Self> {
        let joint = |joint: RigJoint| rest.require_rig_joint(joint);
        let arm = |side: Side| -> Result<ArmJoints> {
            let of = |part: SidedJoint| joint(part.on(side));
            let twists = [(SidedJoint::UpperarmTwist01, -1.0), (SidedJoint::UpperarmTwist02, -0.5)];
            let is_finger = |joint: RigJoint| {
                joint.side() == Some(side)
                    && joint.finger().is_some_and(|(finger, _)| finger != Finger::Thumb)
            };
            let fingers = rest.rig_joints().enumerate().filter(|(_, joint)| joint.is_some_and(is_finger));
            Ok(ArmJoints {
                clavicle: of(SidedJoint::Clavicle)?,
                upper: of(SidedJoint::Upperarm)?,
                lower: of(SidedJoint::Lowerarm)?,
                hand: of(SidedJoint::Hand)?,
                twists: twists
                    .iter()
                    .filter_map(|(part, share)| Some((rest.rig_joint(part.on(side))?, *share)))
                    .collect(),
                fingers: fingers.map(|(joint, _)| joint).collect(),
            })
        };
        let legs = Leg::both(rest)?;
        let lengths = legs.map(|leg| leg.limb.length(rest.rest_pose()));
        if lengths.iter().any(|l| *l < 1e-3) {
            return Err(Error::invalid(
                "skeleton",
                format!("expected legs with a length, got {lengths:?} m"),
            ));
        }
        let bone = |joint: usize| rest.rest_pose().locals[joint].translation.length();
        Ok(Self {
            rest: rest.clone(),
            model: rest.model_from_joints(),
            root: joint(RigJoint::Root)?,
            pelvis: joint(RigJoint::Pelvis)?,
            spine: [joint(RigJoint::Spine01)?, joint(RigJoint::Spine02)?, joint(RigJoint::Spine03)?],
            neck: [joint(RigJoint::Neck01)?, joint(RigJoint::Head)?],
            arms: [arm(Side::Left)?, arm(Side::Right)?],
            leg_length: lengths[0].min(lengths[1]),
            leg_bones: [bone(legs[0].limb.lower), bone(legs[0].limb.end)],
            legs,
        })
    }

    /// Both feet flat on the floor, at `share` of the way from below the hip (0) to their rest position (1).
    pub(crate) fn standing(&self, share: f32) -> [Foot; 2] {
        self.legs.map(|leg| {
            let [hip, ankle] = [leg.limb.upper, leg.limb.end].map(|j| self.model[j].translation.x);
            Foot { shift: Vec3::X * ((hip - ankle) * (1.0 - share)), ..Foot::default() }
        })
    }

    /// Feet flat on the floor with upright shins and level thighs, and how the pelvis has to move for that, metres; the pelvis
    /// stays over the origin. `apart` is the distance between the ankles as a share of that between the hips.
    pub(crate) fn seated(&self, apart: f32, toe_out: f32) -> ([Foot; 2], Vec3) {
        let mut sink = 0.0;
        let mut feet = [Foot { toe_out, knee: Some(Vec3::Y), ..Foot::default() }; 2];
        for (f, leg) in self.legs.iter().enumerate() {
            let hip = self.model[leg.limb.upper].translation;
            let [thigh, shin] = [leg.limb.lower, leg.limb.end]
                .map(|joint| self.rest.rest_pose().locals[joint].translation.length());
            let flat = self.foot_goal(f, &feet[f]).translation;
            let aside = hip.x * (apart - 1.0);
            let ahead = libm::sqrtf((thigh * thigh - aside * aside).max(0.0));
            feet[f].shift = Vec3::new(hip.x + aside, flat.y, hip.z + ahead) - flat;
            sink += 0.5 * (flat.y + shin - hip.y);
        }
        (feet, Vec3::Y * sink)
    }

    /// How far the pelvis has to come down for the legs of `feet` to reach the floor without locking a knee, metres; negative
    /// when they reach.
    pub(crate) fn required_drop(&self, stance: &Stance, feet: impl Iterator<Item = usize>) -> f32 {
        let mut pose = self.rest.rest_pose().clone();
        self.set_trunk(stance, &mut pose);
        let mut model = Vec::new();
        model_from_joints(self.rest.parents(), &pose.locals, &mut model);
        feet.map(|f| {
            let leg = &self.legs[f];
            let ankle = self.foot_goal(f, &stance.feet[f]).translation;
            let hip = model[leg.limb.upper].translation - stance.root;
            let reach = leg.limb.length(&pose) * STRETCH;
            let level = (ankle - hip).with_y(0.0).length();
            hip.y - ankle.y - libm::sqrtf((reach * reach - level * level).max(0.0))
        })
        .fold(f32::NEG_INFINITY, f32::max)
    }

    /// Lowers the pelvis as far as both legs need to reach their feet.
    pub(crate) fn within_reach(&self, mut stance: Stance) -> Stance {
        stance.pelvis.y -= self.required_drop(&stance, 0..2).max(0.0);
        stance
    }

    /// The pose of a stance.
    pub(crate) fn pose(&self, stance: &Stance) -> Pose {
        let mut pose = self.rest.rest_pose().clone();
        self.set_trunk(stance, &mut pose);
        self.set_arms(&stance.arms, &mut pose);
        let mut model = Vec::new();
        model_from_joints(self.rest.parents(), &pose.locals, &mut model);
        for (f, leg) in self.legs.iter().enumerate() {
            let mut target = self.foot_goal(f, &stance.feet[f]);
            target.translation += stance.root;
            // Bend the knee about its hinge first, as inverse kinematics keeps the plane in which the leg bends.
            let outwards = -Side::ALL[f].sign() * stance.knees_out.to_radians();
            pose.locals[leg.limb.upper].rotation *= Rotation::from_rotation_y(outwards);
            pose.locals[leg.limb.lower].rotation *= Rotation::from_rotation_x(-0.5);
            let reach = Reach { pole: stance.feet[f].knee, ..Reach::to(target) };
            leg.limb.reach(&mut pose, leg.model_from_parent(&model), &reach);
            let toes = Rotation::from_rotation_x(stance.feet[f].roll.max(0.0).to_radians());
            pose.locals[leg.ball].rotation *= toes;
        }
        pose
    }

    fn set_trunk(&self, stance: &Stance, pose: &mut Pose) {
        pose.locals[self.root].translation += stance.root;
        let local = &mut pose.locals[self.pelvis];
        let parent =
            self.rest.parents()[self.pelvis].map_or(Rotation::IDENTITY, |p| self.model[p as usize].rotation);
        let to_parent = parent.conjugate();
        local.translation += to_parent * stance.pelvis;
        local.rotation = to_parent * euler(stance.pelvis_rotation) * parent * local.rotation;
        for (joints, rotation) in [(&self.spine[..], stance.spine), (&self.neck[..], stance.head)] {
            let share = euler(rotation / joints.len() as f32);
            for joint in joints {
                pose.locals[*joint].rotation *= share;
            }
        }
    }

    /// Rotates the joints of both arms from rest; left, right.
    pub(crate) fn set_arms(&self, arms: &[Arm; 2], pose: &mut Pose) {
        for ((joints, arm), side) in self.arms.iter().zip(arms).zip(Side::ALL) {
            Self::set_arm(joints, arm, side, pose);
        }
    }

    /// Shoulder, elbow and wrist.
    pub(crate) fn arm(&self, side: Side) -> Limb {
        let joints = &self.arms[side.index()];
        Limb { upper: joints.upper, lower: joints.lower, end: joints.hand, bend: Bend::Backwards }
    }

    /// The joints of hip and knee.
    pub(crate) fn thigh(&self, side: Side) -> [usize; 2] {
        let leg = self.legs[side.index()].limb;
        [leg.upper, leg.lower]
    }

    /// `model_from_joint` of a joint at rest.
    pub(crate) fn at_rest(&self, joint: usize) -> RigidTransform {
        self.model[joint]
    }

    fn set_arm(joints: &ArmJoints, arm: &Arm, side: Side, pose: &mut Pose) {
        let x = |degrees: f32| Rotation::from_rotation_x(degrees.to_radians());
        let y = |degrees: f32| Rotation::from_rotation_y(side.sign() * degrees.to_radians());
        let z = |degrees: f32| Rotation::from_rotation_z(side.sign() * degrees.to_radians());
        let mut rotate = |joint: usize, by: Rotation| pose.locals[joint].rotation *= by;
        rotate(joints.clavicle, z(arm.shrug));
        rotate(joints.upper, y(-arm.forward) * z(-arm.lowered - arm.shrug) * y(-arm.outward));
        rotate(joints.lower, x(arm.elbow));
        rotate(joints.hand, x(arm.wrist.x) * z(-arm.wrist.y));
        for (joint, share) in &joints.twists {
            rotate(*joint, y(-arm.outward * share));
        }
        for joint in &joints.fingers {
            rotate(*joint, z(-arm.curl));
        }
    }

    /// `model_from_joint` of the foot, without root motion.
    fn foot_goal(&self, f: usize, foot: &Foot) -> RigidTransform {
        let leg = &self.legs[f];
        let (ankle, ball) = (self.model[leg.limb.end], self.model[leg.ball]);
        let heel = ankle.translation + ankle.rotation * leg.heel;
        let pivot = if foot.roll > 0.0 { ball.translation } else { heel };
        let toe_out = Rotation::from_rotation_y(Side::ALL[f].sign() * foot.toe_out.to_radians());
        let rotation = toe_out * Rotation::from_rotation_x(foot.roll.to_radians());
        // Rotate about the middle of the foot, roll about the pivot.
        let middle = (0.5 * (heel + ball.translation)).with_y(0.0);
        let rolled = pivot + Rotation::from_rotation_x(foot.roll.to_radians()) * (ankle.translation - pivot);
        RigidTransform {
            rotation: rotation * ankle.rotation,
            translation: middle + toe_out * (rolled - middle) + foot.shift,
        }
    }

    /// Rotates a joint about its own axes, degrees, as for the left; right joints are mirrored.
    pub(crate) fn rotate(&self, pose: &mut Pose, joint: RigJoint, x: f32, y: f32, z: f32) {
        let sign = joint.side().map_or(1.0, Side::sign);
        if let Some(joint) = self.rest.rig_joint(joint) {
            pose.locals[joint].rotation *= euler(Vec3::new(x, sign * y, sign * z));
        }
    }
}

/// Rotation about Y, then the new X, then the new Z; degrees.
fn euler(degrees: Vec3) -> Rotation {
    let [x, y, z] = degrees.to_array().map(f32::to_radians);
    Rotation::from_euler(glam::EulerRot::YXZ, y, x, z)
}
