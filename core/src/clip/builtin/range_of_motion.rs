//! Joint after joint through much of its range, from the T-pose.

use super::figure::Figure;
use super::{RATE, smooth};
use crate::skeleton::Pose;

/// Seconds from one key to the next.
const STEP: f32 = 0.7;

/// Turns of joints about X, Y, Z in degrees, as for the left, one after the other; both sides move together.
struct Exercise {
    /// Joints, without the side; `share` of the turn for each.
    joints: &'static [(&'static str, f32)],
    keys: &'static [[f32; 3]],
}

const fn exercise(joints: &'static [(&'static str, f32)], keys: &'static [[f32; 3]]) -> Exercise {
    Exercise { joints, keys }
}

const SPINE: &[(&str, f32)] = &[("spine_01", 0.34), ("spine_02", 0.33), ("spine_03", 0.33)];
const NECK: &[(&str, f32)] = &[("neck_01", 0.5), ("head", 0.5)];
const FINGERS: &[(&str, f32)] = &[
    ("index_01", 1.0),
    ("index_02", 1.0),
    ("index_03", 0.7),
    ("middle_01", 1.0),
    ("middle_02", 1.0),
    ("middle_03", 0.7),
    ("ring_01", 1.0),
    ("ring_02", 1.0),
    ("ring_03", 0.7),
    ("pinky_01", 1.0),
    ("pinky_02", 1.0),
    ("pinky_03", 0.7),
    ("thumb_02", 0.3),
    ("thumb_03", 0.6),
];

const UPPER_BODY: &[Exercise] = &[
    exercise(
        NECK,
        &[[45., 0., 0.], [-45., 0., 0.], [0., 65., 0.], [0., -65., 0.], [0., 0., 35.], [0., 0., -35.]],
    ),
    exercise(&[("jaw", 1.0)], &[[-20., 0., 0.]]),
    exercise(&[("eye", 1.0)], &[[20., 0., 0.], [-20., 0., 0.]]),
    exercise(
        SPINE,
        &[[60., 0., 0.], [-25., 0., 0.], [0., 40., 0.], [0., -40., 0.], [0., 0., 30.], [0., 0., -30.]],
    ),
    exercise(&[("clavicle", 1.0)], &[[0., 0., 25.], [0., 0., -8.], [20., 0., 0.], [-20., 0., 0.]]),
    exercise(
        &[("upperarm", 1.0)],
        &[[0., 0., -80.], [0., 0., 70.], [90., 0., 0.], [-35., 0., 0.], [0., 60., 0.], [0., -70., 0.]],
    ),
    exercise(&[("lowerarm", 1.0)], &[[140., 0., 0.]]),
    exercise(
        &[("hand", 1.0)],
        &[[0., 0., -75.], [0., 0., 65.], [20., 0., 0.], [-35., 0., 0.], [0., -90., 0.]],
    ),
    exercise(FINGERS, &[[0., 0., -75.], [0., 0., 10.]]),
];

/// Of one leg: hip X, hip Y (twist), hip Z, knee flexion, ankle, toes. Before and after comes [`lifted`].
const LEG: &[[f32; 6]] = &[
    [100., 0., 0., 130., 0., 0.],
    [70., 0., 55., 90., 0., 0.],
    [80., 35., 0., 90., 30., 0.],
    [80., -35., 0., 90., -40., 0.],
    [75., 0., 0., 5., 20., 0.],
    [60., 0., 0., 90., -40., 50.],
    [-15., 0., 0., 100., 0., -25.],
];
/// Knee flexion, degrees, at which the foot is high enough to move freely.
const LIFTED: f32 = 75.0;

/// The leg with its foot straight above its place, level, for a knee flexion: feet do not slide as they leave the floor.
fn lifted(figure: &Figure, knee: f32) -> [f32; 6] {
    let [thigh, shin] = figure.leg_bones;
    let flexion = knee.to_radians();
    let hip = libm::atan2f(shin * libm::sinf(flexion), thigh + shin * libm::cosf(flexion)).to_degrees();
    [hip, 0.0, 0.0, knee, knee - hip, 0.0]
}

pub(super) fn poses(figure: &Figure) -> Vec<Pose> {
    let frames = (STEP * RATE as f32) as usize;
    let share = |frame: usize| smooth(frame as f32 / frames as f32);
    let mut poses = vec![figure.rest.rest_pose().clone()];
    for exercise in UPPER_BODY {
        let home = [0.0; 3];
        let stops: Vec<[f32; 3]> = [&[home][..], exercise.keys, &[home]].concat();
        for pair in stops.windows(2) {
            poses.extend((1..=frames).map(|frame| {
                let mut pose = figure.rest.rest_pose().clone();
                let [x, y, z] =
                    std::array::from_fn(|i| pair[0][i] + (pair[1][i] - pair[0][i]) * share(frame));
                for (joint, part) in exercise.joints {
                    let central = figure.rest.find(joint).is_some();
                    for name in if central { vec![(*joint).to_owned()] } else { sided(joint) } {
                        figure.turn(&mut pose, &name, x * part, y * part, z * part);
                    }
                }
                pose
            }));
        }
    }
    for side in ["l", "r"] {
        let up = lifted(figure, LIFTED);
        let stops = [&[lifted(figure, 0.0), up][..], LEG, &[up, lifted(figure, 0.0)]].concat();
        for (i, pair) in stops.windows(2).enumerate() {
            poses.extend((1..=frames).map(|frame| {
                let mut pose = figure.rest.rest_pose().clone();
                let mix = |j: usize| pair[0][j] + (pair[1][j] - pair[0][j]) * share(frame);
                let on_floor = i == 0 || i + 2 == stops.len();
                let at = if on_floor { lifted(figure, mix(3)) } else { std::array::from_fn(mix) };
                let [hip_x, hip_y, hip_z, knee, ankle, toes] = at;
                figure.turn(&mut pose, &format!("thigh_{side}"), hip_x, hip_y, hip_z);
                figure.turn(&mut pose, &format!("calf_{side}"), -knee, 0.0, 0.0);
                figure.turn(&mut pose, &format!("foot_{side}"), ankle, 0.0, 0.0);
                figure.turn(&mut pose, &format!("ball_{side}"), toes, 0.0, 0.0);
                pose
            }));
        }
    }
    poses
}

fn sided(joint: &str) -> Vec<String> {
    ["l", "r"].map(|side| format!("{joint}_{side}")).to_vec()
}
