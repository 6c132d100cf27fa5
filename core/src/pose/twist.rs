//! Distribution of the roll of limbs over twist joints.
//!
//! Skin weights blend along a limb between its main joint and its twist joints, each of which has full weight at its own
//! position. In upper arm and thigh the main joint has the far end, and twist joints undo its roll towards the near end, so
//! that the skin of the shoulder does not wring. In forearm and calf the main joint has the near end, and twist joints add
//! the roll of hand or foot. The part that a twist joint takes follows from its position along the bone.

use std::f32::consts::{PI, TAU};

use super::SwingTwist;
use crate::math::Rotation;
use crate::skeleton::{RigJoint, SidedJoint, Skeleton};

/// A twist joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Twist {
    joint: usize,
    /// The joint of whose roll it takes a part.
    of: usize,
    /// That part; negative where it undoes the roll.
    part: f32,
    /// Whether the roll is that of the main joint about its own bone (upper arm, thigh), and not that of hand or foot about
    /// the parent's bone.
    own: bool,
    /// Rotation of its `parent_from_joint` at rest.
    rest: Rotation,
    /// Rotation of `parent_from_joint` of `of` at rest.
    rest_of: Rotation,
}

/// The twist joints of a body's skeleton.
pub(crate) fn find(skeleton: &Skeleton) -> Vec<Twist> {
    let rest = skeleton.rest_pose();
    let twist = |(joint, ours): (usize, Option<RigJoint>)| {
        let RigJoint::Sided(helper, side) = ours.filter(|ours| ours.is_twist())? else { return None };
        let limb = helper.main_joint();
        let own = matches!(limb, SidedJoint::Upperarm | SidedJoint::Thigh);
        let of = match limb {
            SidedJoint::Lowerarm => SidedJoint::Hand,
            SidedJoint::Calf => SidedJoint::Foot,
            _ => limb,
        };
        let of = skeleton.rig_joint(of.on(side))?;
        let length = skeleton.rig_joint(limb.on(side)).and_then(|j| skeleton.ends()[j])?.y;
        let position = (rest.locals[joint].translation.y / length.max(1e-6)).clamp(0.0, 1.0);
        let part = if own { position - 1.0 } else { position };
        Some(Twist {
            joint,
            of,
            part,
            own,
            rest: rest.locals[joint].rotation,
            rest_of: rest.locals[of].rotation,
        })
    };
    skeleton.rig_joints().enumerate().filter_map(twist).collect()
}

/// Sets the rotations of twist joints. `before` are the rolls in the previous frame and are updated; `None` at the start.
pub(crate) fn apply(twists: &[Twist], locals: &mut [Rotation], before: &mut [Option<f32>]) {
    for (twist, before) in twists.iter().zip(before) {
        let local = locals[twist.of];
        let from_rest =
            if twist.own { twist.rest_of.conjugate() * local } else { local * twist.rest_of.conjugate() };
        let roll = near(SwingTwist::of(from_rest).twist, *before);
        *before = Some(roll);
        locals[twist.joint] = twist.rest * Rotation::from_rotation_y(roll * twist.part);
    }
}

/// The equivalent angle in −π..=π.
pub(crate) fn wrapped(angle: f32) -> f32 {
    angle - TAU * libm::roundf(angle / TAU)
}

/// The equivalent angle nearest to that of the previous frame, so that a part of it does not jump, unless it is beyond the
/// roll of any arm, 270°.
fn near(angle: f32, before: Option<f32>) -> f32 {
    let Some(before) = before else { return angle };
    let unwound = angle + TAU * libm::roundf((before - angle) / TAU);
    if unwound.abs() <= 1.5 * PI { unwound } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_roll_past_half_a_turn_is_continuous() {
        assert!((near(-3.0, Some(3.1)) - (TAU - 3.0)).abs() < 1e-6);
        assert_eq!(near(1.0, Some(0.5)), 1.0);
        assert_eq!(near(1.5, Some(TAU)), 1.5, "no arm rolls by 7.8 radians");
    }
}
