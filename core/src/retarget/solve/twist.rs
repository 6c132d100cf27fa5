//! The roll of limbs, spread over their twist joints.
//!
//! Skin weights of a limb are split along it between the limb's joint and its twist joints, which stand where they hold
//! full weight. In the upper arm and the thigh the limb's own joint holds the far end and a twist joint at the near end
//! undoes the roll there, so that the shoulder does not wring; in the forearm and the calf the limb's joint holds the
//! near end and the twist joints add the roll of hand or foot. A twist joint's part is where it stands along the bone.

use std::f32::consts::{PI, TAU};

use crate::math::Rotation;

use super::Joints;
use crate::pose::SwingTwist;
use crate::skeleton::{RigJoint, SidedJoint};

/// A twist joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Twist {
    joint: usize,
    /// The joint whose roll it takes part of.
    of: usize,
    /// That part; negative where it undoes.
    part: f32,
    /// Whether the roll is that of the parent about itself, and not that of a joint below about the bone above.
    own: bool,
    /// `parent_from_joint` at rest, of itself and of `of`.
    rest: Rotation,
    rest_of: Rotation,
}

/// The twist joints of the target.
pub(super) fn find(joints: &Joints) -> Vec<Twist> {
    let rest = joints.target.rest_pose();
    let twist = |(joint, ours): (usize, Option<RigJoint>)| {
        let RigJoint::Sided(helper, side) = ours.filter(|ours| ours.is_twist())? else { return None };
        let limb = helper.main_joint();
        let own = matches!(limb, SidedJoint::Upperarm | SidedJoint::Thigh);
        let of = match limb {
            SidedJoint::Lowerarm => SidedJoint::Hand,
            SidedJoint::Calf => SidedJoint::Foot,
            _ => limb,
        };
        let of = joints.target.rig_joint(of.on(side))?;
        let length = joints.target.rig_joint(limb.on(side)).and_then(|j| joints.target.ends()[j])?.y;
        let place = (rest.locals[joint].translation.y / length.max(1e-6)).clamp(0.0, 1.0);
        let part = if own { place - 1.0 } else { place };
        Some(Twist {
            joint,
            of,
            part,
            own,
            rest: rest.locals[joint].rotation,
            rest_of: rest.locals[of].rotation,
        })
    };
    joints.target.rig_joints().enumerate().filter_map(twist).collect()
}

/// Sets the twist joints' rotations; `before` holds each one's roll in the frame before, or none.
pub(super) fn apply(twists: &[Twist], locals: &mut [Rotation], before: &mut [Option<f32>]) {
    for (twist, before) in twists.iter().zip(before) {
        let local = locals[twist.of];
        let turned =
            if twist.own { twist.rest_of.conjugate() * local } else { local * twist.rest_of.conjugate() };
        let roll = near(SwingTwist::of(turned).twist, *before);
        *before = Some(roll);
        locals[twist.joint] = twist.rest * Rotation::from_rotation_y(roll * twist.part);
    }
}

/// An angle in −π..=π; one that lies there stays as it is.
pub(super) fn wrapped(angle: f32) -> f32 {
    angle - TAU * libm::roundf(angle / TAU)
}

/// The same angle near that of the frame before, so that a part of it does not jump, but for rolls that no arm does.
fn near(angle: f32, before: Option<f32>) -> f32 {
    let Some(before) = before else { return angle };
    let turned = angle + TAU * libm::roundf((before - angle) / TAU);
    if turned.abs() <= 1.5 * PI { turned } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_roll_past_half_a_turn_goes_on() {
        assert!((near(-3.0, Some(3.1)) - (TAU - 3.0)).abs() < 1e-6);
        assert_eq!(near(1.0, Some(0.5)), 1.0);
        assert_eq!(near(1.5, Some(TAU)), 1.5, "no arm rolls by 7.8 radians");
    }
}
