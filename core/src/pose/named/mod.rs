//! Static poses by name, for bodies of any size and girth.

mod girth;
mod hands;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use glam::Vec3;

use super::figure::{Arm, Figure, Stance};
use super::limits::JointLimits;
use super::twist;
use crate::skeleton::{Pose, Skeleton};
use crate::{Error, Result};

pub use girth::Girth;

/// How a pose is made.
type Make = fn(&Figure, &Girth) -> Pose;

/// Names of the static poses with what makes them.
const TABLE: [(&str, Make); 4] =
    [("t-pose", t_pose), ("a-pose", a_pose), ("standing", standing), ("sitting", sitting)];

/// Names of the static poses, as [`named`] takes them.
pub const POSES: [&str; 4] = [TABLE[0].0, TABLE[1].0, TABLE[2].0, TABLE[3].0];

/// Angle of the arms below level in the A-pose, degrees.
const A_POSE: f32 = 45.0;
/// Distance between the ankles of somebody sitting, as a share of that between the hips.
const SEATED_APART: f32 = 1.25;

/// A static pose of a body of the rig: `parent_from_joint` of each joint, metres.
/// - `t-pose` is the rest pose;
/// - `a-pose` has straight arms, half-way down;
/// - `standing` has the arms hanging beside hips of this girth, fingers relaxed, the feet a little apart and turned out;
/// - `sitting` has level thighs, upright shins and trunk, and the hands on the thighs.
///
/// The feet are flat on y = 0 and the pelvis is over the origin; joints are within their limits.
///
/// # Errors
/// [`Error::Request`] when the name is not one of [`POSES`], [`Error::Invalid`] naming a joint of the rig that is missing, or
/// when a leg has no length.
pub fn named(name: &str, rest: &Arc<Skeleton>, girth: &Girth) -> Result<Pose> {
    let Some((_, make)) = TABLE.iter().find(|(known, _)| *known == name) else {
        let known = POSES.join(", ");
        return Err(Error::request("pose", format!("expected one of {known}, got `{name}`")));
    };
    let mut pose = make(&Figure::new(rest)?, girth);
    share_rolls(rest, &mut pose);
    Ok(pose)
}

/// Divides the roll of arms and legs among their twist joints.
fn share_rolls(rest: &Skeleton, pose: &mut Pose) {
    let twists = twist::find(rest);
    let mut rotations: Vec<_> = pose.locals.iter().map(|local| local.rotation).collect();
    twist::apply(&twists, &mut rotations, &mut vec![None; twists.len()]);
    pose.locals.iter_mut().zip(rotations).for_each(|(local, rotation)| local.rotation = rotation);
}

fn t_pose(figure: &Figure, _: &Girth) -> Pose {
    figure.rest.rest_pose().clone()
}

fn a_pose(figure: &Figure, _: &Girth) -> Pose {
    let mut pose = figure.rest.rest_pose().clone();
    figure.set_arms(&[Arm { lowered: A_POSE, ..Arm::default() }; 2], &mut pose);
    pose
}

fn standing(figure: &Figure, girth: &Girth) -> Pose {
    let lowered = Arm::HANGING.lowered.min(90.0 - girth.arms_out.to_degrees());
    let mut feet = figure.standing(0.45);
    feet.iter_mut().for_each(|foot| foot.toe_out = 6.0);
    let stance = Stance {
        pelvis: Vec3::Y * (-0.004 * figure.leg_length),
        head: Vec3::X * 2.0,
        arms: [Arm { lowered, ..Arm::HANGING }; 2],
        feet,
        ..Stance::default()
    };
    figure.pose(&figure.within_reach(stance))
}

fn sitting(figure: &Figure, girth: &Girth) -> Pose {
    let (feet, pelvis) = figure.seated(SEATED_APART, 6.0);
    // Bent elbows from which the arms then reach for the thighs, so that elbows bend about their hinges.
    let arm =
        Arm { lowered: 70.0, forward: 20.0, elbow: 60.0, curl: 7.0, wrist: glam::Vec2::ZERO, ..Arm::HANGING };
    let stance = Stance { pelvis, arms: [arm; 2], feet, head: Vec3::X * 2.0, ..Stance::default() };
    let mut pose = figure.pose(&stance);
    hands::rest_on_thighs(figure, girth, &mut pose);
    // Short forearms cannot turn the palms all the way down.
    JointLimits::of_rig(&figure.rest).clamp(&figure.rest, &mut pose);
    pose
}
