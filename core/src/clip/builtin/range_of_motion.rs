//! Joint after joint is taken through much of its range, from the T-pose.

use super::RATE;
use crate::Side;
use crate::math::smoothstep;
use crate::pose::figure::Figure;
use crate::skeleton::{Pose, RigJoint, SidedJoint};

/// Seconds from one key to the next.
const STEP: f32 = 0.7;

/// What an exercise rotates.
#[derive(Clone, Copy)]
enum Exercised {
    Central(RigJoint),
    /// Both sides together.
    Both(SidedJoint),
}
use Exercised::{Both, Central};

/// Rotations of joints about X, Y and Z in degrees, one after the other, as for the left; both sides move together.
struct Exercise {
    /// Joints and the share of the rotation that each takes.
    joints: &'static [(Exercised, f32)],
    keys: &'static [[f32; 3]],
}

const fn exercise(joints: &'static [(Exercised, f32)], keys: &'static [[f32; 3]]) -> Exercise {
    Exercise { joints, keys }
}

const SPINE: &[(Exercised, f32)] = &[
    (Central(RigJoint::Spine01), 0.34),
    (Central(RigJoint::Spine02), 0.33),
    (Central(RigJoint::Spine03), 0.33),
];
const NECK: &[(Exercised, f32)] = &[(Central(RigJoint::Neck01), 0.5), (Central(RigJoint::Head), 0.5)];
const FINGERS: &[(Exercised, f32)] = &[
    (Both(SidedJoint::Index01), 1.0),
    (Both(SidedJoint::Index02), 1.0),
    (Both(SidedJoint::Index03), 0.7),
    (Both(SidedJoint::Middle01), 1.0),
    (Both(SidedJoint::Middle02), 1.0),
    (Both(SidedJoint::Middle03), 0.7),
    (Both(SidedJoint::Ring01), 1.0),
    (Both(SidedJoint::Ring02), 1.0),
    (Both(SidedJoint::Ring03), 0.7),
    (Both(SidedJoint::Pinky01), 1.0),
    (Both(SidedJoint::Pinky02), 1.0),
    (Both(SidedJoint::Pinky03), 0.7),
    (Both(SidedJoint::Thumb02), 0.3),
    (Both(SidedJoint::Thumb03), 0.6),
];

const UPPER_BODY: &[Exercise] = &[
    exercise(
        NECK,
        &[[45., 0., 0.], [-45., 0., 0.], [0., 65., 0.], [0., -65., 0.], [0., 0., 35.], [0., 0., -35.]],
    ),
    exercise(&[(Central(RigJoint::Jaw), 1.0)], &[[-20., 0., 0.]]),
    exercise(&[(Both(SidedJoint::Eye), 1.0)], &[[20., 0., 0.], [-20., 0., 0.]]),
    exercise(
        SPINE,
        &[[60., 0., 0.], [-25., 0., 0.], [0., 40., 0.], [0., -40., 0.], [0., 0., 30.], [0., 0., -30.]],
    ),
    exercise(
        &[(Both(SidedJoint::Clavicle), 1.0)],
        &[[0., 0., 25.], [0., 0., -8.], [20., 0., 0.], [-20., 0., 0.]],
    ),
    exercise(
        &[(Both(SidedJoint::Upperarm), 1.0)],
        &[[0., 0., -80.], [0., 0., 70.], [90., 0., 0.], [-35., 0., 0.], [0., 60., 0.], [0., -70., 0.]],
    ),
    exercise(&[(Both(SidedJoint::Lowerarm), 1.0)], &[[140., 0., 0.]]),
    exercise(
        &[(Both(SidedJoint::Hand), 1.0)],
        &[[0., 0., -75.], [0., 0., 65.], [20., 0., 0.], [-35., 0., 0.], [0., -90., 0.]],
    ),
    exercise(FINGERS, &[[0., 0., -75.], [0., 0., 10.]]),
];

/// Keys of one leg, degrees: hip X, hip Y (twist), hip Z, knee flexion, ankle, toes. [`lifted`] precedes and follows them.
const LEG: &[[f32; 6]] = &[
    [100., 0., 0., 130., 0., 0.],
    [70., 0., 55., 90., 0., 0.],
    [80., 35., 0., 90., 30., 0.],
    [80., -35., 0., 90., -40., 0.],
    [75., 0., 0., 5., 20., 0.],
    [60., 0., 0., 90., -40., 50.],
    [-15., 0., 0., 100., 0., -25.],
];
/// Knee flexion at which the foot is high enough to move freely, degrees.
const LIFTED: f32 = 75.0;

/// The key with this knee flexion and the foot level and straight above where it stood, so that it lifts without sliding.
fn lifted(figure: &Figure, knee: f32) -> [f32; 6] {
    let [thigh, shin] = figure.leg_bones;
    let flexion = knee.to_radians();
    let hip = libm::atan2f(shin * libm::sinf(flexion), thigh + shin * libm::cosf(flexion)).to_degrees();
    [hip, 0.0, 0.0, knee, knee - hip, 0.0]
}

pub(super) fn poses(figure: &Figure) -> Vec<Pose> {
    let frames = (STEP * RATE as f32) as usize;
    let share = |frame: usize| smoothstep(frame as f32 / frames as f32);
    let mut poses = vec![figure.rest.rest_pose().clone()];
    for exercise in UPPER_BODY {
        let at_rest = [0.0; 3];
        let stops: Vec<[f32; 3]> = [&[at_rest][..], exercise.keys, &[at_rest]].concat();
        for pair in stops.windows(2) {
            poses.extend((1..=frames).map(|frame| {
                let mut pose = figure.rest.rest_pose().clone();
                let [x, y, z] =
                    std::array::from_fn(|i| pair[0][i] + (pair[1][i] - pair[0][i]) * share(frame));
                for (joint, part) in exercise.joints {
                    let rotate = |joint| figure.rotate(&mut pose, joint, x * part, y * part, z * part);
                    match *joint {
                        Central(joint) => [joint].into_iter().for_each(rotate),
                        Both(joint) => joint.both().into_iter().for_each(rotate),
                    }
                }
                pose
            }));
        }
    }
    for side in Side::ALL {
        let up = lifted(figure, LIFTED);
        let stops = [&[lifted(figure, 0.0), up][..], LEG, &[up, lifted(figure, 0.0)]].concat();
        for (i, pair) in stops.windows(2).enumerate() {
            poses.extend((1..=frames).map(|frame| {
                let mut pose = figure.rest.rest_pose().clone();
                let mix = |j: usize| pair[0][j] + (pair[1][j] - pair[0][j]) * share(frame);
                let on_floor = i == 0 || i + 2 == stops.len();
                let at = if on_floor { lifted(figure, mix(3)) } else { std::array::from_fn(mix) };
                let [hip_x, hip_y, hip_z, knee, ankle, toes] = at;
                figure.rotate(&mut pose, SidedJoint::Thigh.on(side), hip_x, hip_y, hip_z);
                figure.rotate(&mut pose, SidedJoint::Calf.on(side), -knee, 0.0, 0.0);
                figure.rotate(&mut pose, SidedJoint::Foot.on(side), ankle, 0.0, 0.0);
                figure.rotate(&mut pose, SidedJoint::Ball.on(side), toes, 0.0, 0.0);
                pose
            }));
        }
    }
    poses
}
