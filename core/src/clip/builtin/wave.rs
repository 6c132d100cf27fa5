//! Waving with the right hand while standing.

use std::f32::consts::TAU;

use glam::Vec2;

use super::{RATE, idle, keyed};
use crate::pose::figure::{Arm, Figure};
use crate::skeleton::Pose;

const SECONDS: f32 = 4.0;
/// When the arm has been raised and when it is lowered again, seconds.
const UP: f32 = 0.9;
const DOWN: f32 = 3.0;
/// Swings of the hand per second.
const SWINGS: f32 = 1.9;

pub(super) fn poses(figure: &Figure) -> Vec<Pose> {
    let frames = (SECONDS * RATE as f32) as usize;
    (0..=frames)
        .map(|f| {
            let at = f as f32 / RATE as f32;
            // The first quarter of the idle cycle and back shifts the weight to the left, away from the arm.
            let shifted = 0.5 - 0.5 * libm::cosf(TAU * at / SECONDS);
            let mut stance = idle::stance(figure, 0.25 * shifted);
            let raised = keyed(&[(0.0, 0.0), (UP, 1.0), (DOWN, 1.0), (SECONDS, 0.0)], at);
            // The elbow is bent a little before the arm is up.
            let bent = keyed(&[(0.0, 0.0), (0.8 * UP, 1.0), (DOWN, 1.0), (0.95 * SECONDS, 0.0)], at);
            let swinging =
                keyed(&[(0.0, 0.0), (UP, 0.0), (UP + 0.3, 1.0), (DOWN - 0.3, 1.0), (DOWN, 0.0)], at);
            let swing = swinging * libm::sinf(TAU * SWINGS * (at - UP));
            let hanging = stance.arms[1];
            let mix = |from: f32, to: f32, share: f32| from + (to - from) * share;
            stance.arms[1] = Arm {
                lowered: mix(hanging.lowered, 22.0, raised),
                forward: mix(hanging.forward, 12.0, raised),
                outward: mix(0.0, 82.0, raised),
                elbow: mix(hanging.elbow, 105.0, bent) + 16.0 * swing,
                wrist: hanging.wrist.lerp(Vec2::new(0.0, 0.0), raised) + Vec2::X * (10.0 * swing),
                curl: mix(hanging.curl, -8.0, raised),
                shrug: mix(hanging.shrug, 6.0, raised),
            };
            stance.head.z -= 3.0 * raised;
            stance.spine.z -= 1.5 * raised;
            figure.pose(&figure.within_reach(stance))
        })
        .collect()
}
