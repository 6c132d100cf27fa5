//! Standing: two breaths, one shift of weight to each side.

use std::f32::consts::TAU;

use glam::Vec3;

use super::RATE;
use crate::pose::figure::{Arm, Figure, Stance};
use crate::skeleton::Pose;

const SECONDS: f32 = 8.0;
const BREATHS: f32 = 2.0;

pub(super) fn poses(figure: &Figure) -> Vec<Pose> {
    let frames = (SECONDS * RATE as f32) as usize;
    // The last frame repeats the first.
    (0..=frames)
        .map(|f| figure.pose(&figure.within_reach(stance(figure, (f % frames) as f32 / frames as f32))))
        .collect()
}

/// The stance at a phase of the cycle, 0 to 1.
pub(super) fn stance(figure: &Figure, phase: f32) -> Stance {
    let wave = |times: f32, shift: f32| libm::sinf(TAU * (times * phase + shift));
    let breath = wave(BREATHS, 0.0);
    // Weight on the left leg, then on the right.
    let weight = wave(1.0, 0.0);
    let arm = |side: f32| Arm {
        lowered: Arm::HANGING.lowered + side * 0.8 * weight - 0.5 * breath,
        forward: Arm::HANGING.forward + 1.0 * wave(1.0, 0.2 + 0.1 * side),
        elbow: Arm::HANGING.elbow + 1.0 * breath,
        shrug: Arm::HANGING.shrug + 1.2 * breath,
        ..Arm::HANGING
    };
    let mut feet = figure.standing(0.45);
    feet.iter_mut().for_each(|foot| foot.toe_out = 5.0);
    Stance {
        pelvis: figure.leg_length * Vec3::new(0.022 * weight, -0.004, 0.003 * wave(2.0, 0.1)),
        pelvis_rotation: Vec3::new(0.0, 1.0 * wave(1.0, 0.1), 1.2 * weight),
        spine: Vec3::new(-0.8 * breath, -0.8 * wave(1.0, 0.1), -1.8 * weight),
        head: Vec3::new(2.0 + 0.8 * breath, 3.0 * wave(1.0, 0.35), 0.6 * weight),
        arms: [arm(1.0), arm(-1.0)],
        feet,
        ..Stance::default()
    }
}
