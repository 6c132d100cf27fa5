//! Hands that rest on the thighs of somebody sitting.

use glam::Vec3;

use super::girth::{Girth, PLACES};
use crate::Side;
use crate::math::{RigidTransform, Rotation};
use crate::pose::figure::Figure;
use crate::pose::ik::Reach;
use crate::skeleton::Pose;

/// How far the arms may stretch, as a share of their length: elbows stay bent.
const STRETCH: f32 = 0.95;
/// Where the wrists are, as shares of the way from hip to knee: the farthest, and the nearest.
const WRISTS: [f32; 2] = [0.55, 0.15];
/// How far the fingers point inwards, and the palms roll outwards, as thighs are round, radians.
const INWARDS: f32 = 0.14;
const OUTWARDS: f32 = 0.17;

/// Lays both hands on the thighs, palms down and fingers towards the knees.
pub(super) fn rest_on_thighs(figure: &Figure, girth: &Girth, pose: &mut Pose) {
    let model = pose.model_from_joints(figure.rest.parents());
    for side in Side::ALL {
        let arm = figure.arm(side);
        let [hip, knee] = figure.thigh(side).map(|joint| model[joint].translation);
        let shoulder = model[arm.upper].translation;
        let reach = STRETCH * arm.length(pose);
        let wrist = |share: f32| {
            let slope = (girth.thighs[1] - girth.thighs[0]) / (PLACES[1] - PLACES[0]);
            let height = girth.thighs[0] + slope * (share - PLACES[0]) + girth.palms;
            hip.lerp(knee, share) + Vec3::Y * height
        };
        let shares = (0..=20).map(|i| WRISTS[0] + (WRISTS[1] - WRISTS[0]) * i as f32 / 20.0);
        let share = shares.into_iter().find(|share| wrist(*share).distance(shoulder) <= reach);
        let at = wrist(share.unwrap_or(WRISTS[1]));
        let along = wrist(1.0) - wrist(0.0);
        let level = along.with_y(0.0).length();
        let heading = libm::atan2f(along.x, along.z) - side.sign() * INWARDS;
        let pitch = libm::atan2f(-along.y, level);
        // From the T-pose: forwards, then down along the thigh, then about the vertical.
        let forwards = Rotation::from_rotation_y(-side.sign() * std::f32::consts::FRAC_PI_2);
        let rotation = Rotation::from_rotation_y(heading)
            * Rotation::from_rotation_x(pitch)
            * Rotation::from_rotation_z(-side.sign() * OUTWARDS)
            * forwards
            * figure.at_rest(arm.end).rotation;
        let target = RigidTransform { rotation: rotation.normalize(), translation: at };
        // Elbows a little out, behind and below the arms.
        let pole = Some(Vec3::new(0.9 * side.sign(), -0.4, -1.0));
        let parent = figure.rest.parents()[arm.upper].map_or(RigidTransform::IDENTITY, |p| model[p as usize]);
        arm.reach(pose, parent, &Reach { pole, ..Reach::to(target) });
    }
}
