//! A squat: thighs nearly level, heels on the floor, arms stretched forward for balance.

use glam::{Vec2, Vec3};

use super::{RATE, keyed};
use crate::pose::figure::{Arm, Figure, Stance};
use crate::skeleton::Pose;

const SECONDS: f32 = 3.6;
/// Forward lean of the shins at the bottom, degrees.
const SHIN: f32 = 30.0;
/// Angle of the thighs above level at the bottom, degrees.
const THIGH: f32 = 8.0;

pub(super) fn poses(figure: &Figure) -> Vec<Pose> {
    let frames = (SECONDS * RATE as f32) as usize;
    (0..=frames)
        .map(|f| {
            let keys = [(0.2, 0.0), (1.6, 1.0), (2.0, 1.0), (3.4, 0.0)];
            let depth = keyed(&[&[(0.0, 0.0)][..], &keys].concat(), f as f32 / RATE as f32);
            figure.pose(&figure.within_reach(stance(figure, depth)))
        })
        .collect()
}

/// The stance at a depth from 0, standing, to 1, the bottom.
fn stance(figure: &Figure, depth: f32) -> Stance {
    let [thigh, shin] = figure.leg_bones;
    // From ankle to hip in the plane of the leg: forward, up; metres.
    let hip = |depth: f32| {
        let (shin_angle, thigh_angle) =
            ((90.0 - SHIN * depth).to_radians(), (90.0 + (90.0 - THIGH) * depth).to_radians());
        let at = |angle: f32| Vec2::new(libm::cosf(angle), libm::sinf(angle));
        shin * at(shin_angle) + thigh * at(thigh_angle)
    };
    let moved = hip(depth) - hip(0.0);
    let mix = |from: f32, to: f32| from + (to - from) * depth;
    let arm = Arm {
        lowered: mix(Arm::HANGING.lowered, 88.0),
        forward: mix(Arm::HANGING.forward, 112.0),
        elbow: mix(Arm::HANGING.elbow, 8.0),
        shrug: mix(Arm::HANGING.shrug, 4.0),
        ..Arm::HANGING
    };
    let mut feet = figure.standing(1.0);
    feet.iter_mut().for_each(|foot| foot.toe_out = 10.0);
    Stance {
        pelvis: Vec3::new(0.0, moved.y - 0.004 * figure.leg_length, moved.x),
        pelvis_rotation: Vec3::X * mix(0.0, 28.0),
        knees_out: 24.0 * depth,
        spine: Vec3::X * mix(0.0, 14.0),
        head: Vec3::X * mix(0.0, -30.0),
        arms: [arm; 2],
        feet,
        ..Stance::default()
    }
}
