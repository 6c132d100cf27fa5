//! Walking: one stride of two steps.
//!
//! Stride and speed of a comfortable walk scale with the leg (Alexander, "Stride length and speed for adults, children,
//! and fossil hominids", 1984); the phases of the foot are those of gait analysis (Perry, *Gait Analysis*, 1992): heel
//! strike, foot flat at 8 % of the stride, heel off at 37 %, toe off at 62 %.

use std::f32::consts::TAU;

use glam::Vec3;

use super::{RATE, keyed};
use crate::math::smoothstep;
use crate::pose::figure::{Arm, Figure, Foot, Stance};
use crate::skeleton::Pose;

/// Stride over leg length.
const STRIDE: f32 = 1.38;
/// Speed over √(g · leg length).
const SPEED: f32 = 0.41;
const GRAVITY: f32 = 9.81;
const TOE_OFF: f32 = 0.62;
/// Phase at which the pelvis is above the stance foot's ankle: early, as the rising heel carries the ankle forward.
const OVER_ANKLE: f32 = 0.25;
/// Phase at which the pelvis is highest: about the middle of the other foot's swing.
const MID_STANCE: f32 = 0.33;
/// Keys of the foot's roll over a stride: phase, degrees.
const ROLL: [(f32, f32); 7] =
    [(0.0, -20.0), (0.08, 0.0), (0.37, 0.0), (TOE_OFF, 55.0), (0.70, 48.0), (0.87, -8.0), (1.0, -20.0)];

pub(super) fn poses(figure: &Figure) -> Vec<Pose> {
    let leg = figure.leg_length;
    let stride = STRIDE * leg;
    let seconds = stride / (SPEED * libm::sqrtf(GRAVITY * leg));
    let frames = libm::roundf(seconds * RATE as f32).max(8.0) as usize;
    let stances: Vec<Stance> =
        (0..frames).map(|f| stance(figure, f as f32 / frames as f32, stride)).collect();
    // One offset for all frames, so that the pelvis keeps its bob.
    let drop = stances
        .iter()
        .map(|s| figure.required_drop(s, (0..2).filter(|f| s.feet[*f].shift.y == 0.0)))
        .fold(f32::NEG_INFINITY, f32::max);
    (0..=frames)
        .map(|f| {
            let mut stance = stances[f % frames];
            stance.pelvis.y -= drop;
            stance.root = Vec3::Z * (stride * f as f32 / frames as f32);
            figure.pose(&stance)
        })
        .collect()
}

/// The stance at a phase, 0 to 1, of the stride that begins with the left heel strike; feet are relative to the root, which
/// moves at constant speed.
fn stance(figure: &Figure, phase: f32, stride: f32) -> Stance {
    let wave = |shift: f32| libm::cosf(TAU * (phase + shift));
    let standing = figure.standing(0.15);
    let foot = |side: usize| {
        let own = if side == 0 { phase } else { (phase + 0.5) % 1.0 };
        let swing = ((own - TOE_OFF) / (1.0 - TOE_OFF)).max(0.0);
        let along = stride * (OVER_ANKLE - own + smoothstep(swing));
        let lift = 0.045 * figure.leg_length * libm::powf(libm::sinf(0.5 * TAU * swing), 2.0);
        let shift = standing[side].shift + Vec3::new(0.0, if swing > 0.0 { lift } else { 0.0 }, along);
        Foot { shift, roll: keyed(&ROLL, own), toe_out: 3.0, ..Foot::default() }
    };
    // An arm is forward when the opposite heel strikes.
    let arm = |side: f32| {
        let swing = -side * wave(-0.02);
        Arm { forward: 2.0 + 21.0 * swing, lowered: 80.0, elbow: 22.0 + 10.0 * swing, ..Arm::HANGING }
    };
    let bob = libm::cosf(2.0 * TAU * (phase - MID_STANCE));
    let sway = libm::sinf(TAU * (phase - 0.04));
    Stance {
        pelvis: figure.leg_length * Vec3::new(0.022 * sway, 0.02 * bob, 0.0),
        pelvis_rotation: Vec3::new(2.0, -5.0 * wave(0.0), 3.0 * sway),
        spine: Vec3::new(1.0, 10.0 * wave(-0.02), -4.0 * sway),
        head: Vec3::new(0.0, -5.0 * wave(-0.02), 1.0 * sway),
        arms: [arm(1.0), arm(-1.0)],
        feet: [foot(0), foot(1)],
        ..Stance::default()
    }
}
