//! A leg of the rig and the points of its sole.

use glam::Vec3;

use super::ik::{Bend, Limb};
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::{SidedJoint, Skeleton};
use crate::{Result, Side};

/// How far the heel reaches behind the ankle, as a share of the distance from ankle to ball along the floor; bodies of the
/// model have a quarter to a third.
const HEEL: f32 = 0.28;
/// Half the width of the flat part of the sole at heel and ball, as shares of the same distance.
const HALF_WIDTHS: [f32; 2] = [0.18, 0.3];

/// The joints of a leg, and where its sole is: at y = 0 in the rest pose, in which feet stand on the floor. Lengths are in
/// metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leg {
    /// Hip, knee, ankle.
    pub(crate) limb: Limb,
    /// Parent of the hip joint.
    pub(crate) parent: Option<usize>,
    /// The ball joint, about which the toes bend.
    pub(crate) ball: usize,
    /// Back end of the heel, in the foot joint's space.
    pub(crate) heel: Vec3,
    /// Tip of the toes, in the ball joint's space.
    pub(crate) tip: Vec3,
    /// Heights of ball joint and tip above the sole at rest. The sole is round there, so rolling keeps them.
    pub(crate) clearance: [f32; 2],
    /// From heel to ball along the floor at rest, in model space.
    pub(crate) sole: Vec3,
    /// The foot joint's rotation at rest, in model space.
    pub(crate) foot_at_rest: Rotation,
    /// From the ball joint straight down to the sole at rest, in the foot's and in the ball joint's space: the skin there
    /// follows both joints.
    pub(crate) under_ball: [Vec3; 2],
    /// Half the width of the sole at heel and ball.
    pub(crate) half_widths: [f32; 2],
}

/// Points of a sole in model space, metres, with heights above the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sole {
    pub(crate) heel: Vec3,
    pub(crate) ball: Vec3,
    pub(crate) tip: Vec3,
    /// The ball joint, above the ball.
    pub(crate) joint: Vec3,
    /// Rotation of the foot from its rest pose, in which it lies flat; model space.
    pub(crate) rotation: Rotation,
}

impl Sole {
    /// Height of the lowest of heel, ball and tip, metres.
    pub(crate) fn lowest(&self) -> f32 {
        self.heel.y.min(self.ball.y).min(self.tip.y)
    }
}

impl Leg {
    /// The left and the right leg.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) naming a joint that is missing.
    pub(crate) fn both(rest: &Skeleton) -> Result<[Self; 2]> {
        Ok([Self::on(rest, Side::Left)?, Self::on(rest, Side::Right)?])
    }

    fn on(rest: &Skeleton, side: Side) -> Result<Self> {
        let chain = [SidedJoint::Thigh, SidedJoint::Calf, SidedJoint::Foot].map(|joint| joint.on(side));
        let limb = Limb::of(rest, chain, Bend::Forwards)?;
        let ball = rest.require_rig_joint(SidedJoint::Ball.on(side))?;
        let model = rest.model_from_joints();
        let (ankle, joint) = (model[limb.end], model[ball]);
        let forward = (joint.translation - ankle.translation).with_y(0.0);
        let heel = (ankle.translation - forward * HEEL).with_y(0.0);
        // Toes without a known end are taken to be half as long as the foot.
        let tip = rest.ends()[ball].unwrap_or_else(|| joint.rotation.conjugate() * (forward * 0.5));
        Ok(Self {
            limb,
            parent: rest.parents()[limb.upper].map(|p| p as usize),
            ball,
            heel: ankle.rotation.conjugate() * (heel - ankle.translation),
            tip,
            clearance: [joint.translation.y, (joint.translation + joint.rotation * tip).y],
            sole: forward * (1.0 + HEEL),
            foot_at_rest: ankle.rotation,
            under_ball: [ankle, joint].map(|j| j.rotation.conjugate() * (Vec3::NEG_Y * joint.translation.y)),
            half_widths: HALF_WIDTHS.map(|share| share * forward.length()),
        })
    }

    /// The skin below the ball joint, from `model_from_joint` of foot and ball.
    fn skin_below_ball(&self, foot: RigidTransform, ball: RigidTransform) -> Vec3 {
        let [of_foot, of_ball] = self.under_ball;
        ball.translation + 0.5 * (foot.rotation * of_foot + ball.rotation * of_ball)
    }

    /// The points of the sole, from `model_from_joint` of foot and ball.
    pub(crate) fn points(&self, foot: RigidTransform, ball: RigidTransform) -> Sole {
        Sole {
            heel: foot.translation + foot.rotation * self.heel,
            ball: self.skin_below_ball(foot, ball).with_y(ball.translation.y - self.clearance[0]),
            tip: ball.translation + ball.rotation * self.tip - Vec3::Y * self.clearance[1],
            joint: ball.translation,
            rotation: (foot.rotation * self.foot_at_rest.conjugate()).normalize(),
        }
    }

    /// `model_from_joint` of the hip's parent.
    pub(crate) fn model_from_parent(&self, model: &[RigidTransform]) -> RigidTransform {
        self.parent.map_or(RigidTransform::IDENTITY, |p| model[p])
    }
}
