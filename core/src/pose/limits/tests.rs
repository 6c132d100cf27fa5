use proptest::prelude::*;

use super::*;
use crate::math::RigidTransform;

const NAMES: [&str; 8] = [
    "pelvis",
    "upperarm_l",
    "upperarm_r",
    "lowerarm_l",
    "lowerarm_r",
    "calf_l",
    "calf_twist_01_l",
    "index_02_r",
];

fn rest() -> Skeleton {
    let local = RigidTransform { rotation: Rotation::from_rotation_x(0.4), translation: Vec3::Y };
    let names = NAMES.map(String::from).to_vec();
    let parents = (0..NAMES.len() as u32).map(|j| j.checked_sub(1)).collect();
    Skeleton::new(names, parents, vec![local; NAMES.len()], vec![None; NAMES.len()]).unwrap()
}

/// Degrees beyond the limit when one joint is rotated from rest about its own axes.
fn beyond(joint: &str, x: f32, y: f32, z: f32) -> f32 {
    let rest = rest();
    let mut pose = rest.rest_pose().clone();
    let rotation = Vec3::new(x, y, z).map(f32::to_radians);
    pose.locals[rest.find(joint).unwrap()].rotation *= Rotation::from_scaled_axis(rotation);
    JointLimits::of_rig(&rest).excess(&rest, &pose).into_iter().sum::<f32>().to_degrees()
}

#[test]
fn limbs_bend_in_their_anatomical_directions() {
    assert_eq!(beyond("calf_l", -140.0, 0.0, 0.0), 0.0, "a knee flexes");
    assert!((beyond("calf_l", 40.0, 0.0, 0.0) - 28.0).abs() < 0.01, "and does not bend forwards");
    assert_eq!(beyond("lowerarm_r", 140.0, 0.0, 0.0), 0.0, "an elbow flexes");
    assert!((beyond("lowerarm_r", -40.0, 0.0, 0.0) - 25.0).abs() < 0.01);
    assert_eq!(beyond("upperarm_l", 0.0, 0.0, -90.0), 0.0, "an arm hangs");
    assert_eq!(beyond("upperarm_r", 0.0, 0.0, 90.0), 0.0);
    assert!(beyond("upperarm_l", -110.0, 0.0, 0.0) > 0.0, "an arm does not point backwards");
    assert_eq!(beyond("pelvis", 170.0, 0.0, 0.0), 0.0);
    assert_eq!(beyond("calf_twist_01_l", 0.0, 179.0, 0.0), 0.0);
}

#[test]
fn right_is_the_mirror_image_of_left() {
    for (left, right) in [("upperarm_l", "upperarm_r"), ("lowerarm_l", "lowerarm_r")] {
        for [x, y, z] in [[30., 150., 20.], [-100., 20., -60.], [10., -140., 100.], [150., 0., -30.]] {
            assert!((beyond(left, x, y, z) - beyond(right, x, -y, -z)).abs() < 0.01);
        }
    }
}

#[test]
fn twist_is_clamped_to_the_nearer_end() {
    // −170 to 60: 175 is nearer to −170 than to 60.
    assert!((beyond("lowerarm_l", 0.0, 175.0, 0.0) - 15.0).abs() < 0.01);
    assert!((beyond("lowerarm_l", 0.0, 90.0, 0.0) - 30.0).abs() < 0.01);
}

/// The clamped twist of a forearm for each of these twists, frame by frame at 30 frames a second; degrees.
fn clamped_twists(twists: impl IntoIterator<Item = f32>) -> Vec<f32> {
    let rest = rest();
    let limits = JointLimits::of_rig(&rest);
    let mut history = TwistHistory::new(&limits, 30.0);
    let joint = rest.find("lowerarm_l").unwrap();
    let frame = |twist: f32| {
        let mut pose = rest.rest_pose().clone();
        pose.locals[joint].rotation *= Rotation::from_rotation_y(twist.to_radians());
        limits.clamp_next(&rest, &mut pose, &mut history);
        assert!(limits.excess(&rest, &pose).iter().all(|e| *e == 0.0));
        let kept = rest.rest_pose().locals[joint].rotation.conjugate() * pose.locals[joint].rotation;
        SwingTwist::of(kept).twist.to_degrees()
    };
    twists.into_iter().map(frame).collect()
}

#[test]
fn a_twist_past_half_a_turn_stays_clamped_to_the_same_end() {
    // −170 to 60: half a turn from the middle is at 125.
    let there_and_back: Vec<f32> = clamped_twists((40..160).chain((40..160).rev()).map(|d| d as f32));
    assert!(there_and_back.iter().all(|t| (39.9..60.1).contains(t)), "{there_and_back:?}");
}

#[test]
fn a_full_turn_crosses_the_range_at_a_limited_speed() {
    let round = clamped_twists((0..=360).step_by(5).map(|d| d as f32));
    let steps = round.windows(2).map(|w| (w[1] - w[0]).abs());
    assert!(steps.fold(0.0, f32::max) < 21.0, "{round:?}");
    assert!(round.iter().any(|t| *t < -120.0) && round.last().unwrap().abs() < 0.1, "{round:?}");
    // Within its range a twist is followed at any speed.
    let inside = clamped_twists([0.0, -100.0, 50.0]);
    assert!(inside.iter().zip([0.0, -100.0, 50.0]).all(|(a, b)| (a - b).abs() < 0.01), "{inside:?}");
}

proptest! {
    #[test]
    fn clamping_twice_is_clamping_once_and_ends_within(
        rotations in prop::collection::vec((-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0), NAMES.len()),
    ) {
        let rest = rest();
        let limits = JointLimits::of_rig(&rest);
        let mut pose = rest.rest_pose().clone();
        for (local, (x, y, z, w)) in pose.locals.iter_mut().zip(rotations) {
            let rotation = Rotation::from_xyzw(x, y, z, w);
            prop_assume!(rotation.length_squared() > 1e-3);
            local.rotation *= rotation.normalize();
        }
        let given = pose.clone();
        let before = limits.excess(&rest, &pose);
        limits.clamp(&rest, &mut pose);
        prop_assert!(limits.excess(&rest, &pose).iter().all(|e| *e == 0.0));
        let once = pose.clone();
        limits.clamp(&rest, &mut pose);
        prop_assert_eq!(&pose, &once);
        for (j, excess) in before.iter().enumerate() {
            if *excess == 0.0 {
                prop_assert_eq!(given.locals[j], once.locals[j]);
            }
        }
    }

    #[test]
    fn a_small_step_stays_small(
        x in -2.2f32..2.2, y in -2.0f32..2.0, z in -2.2f32..2.2,
        dx in -0.01f32..0.01, dy in -0.01f32..0.01, dz in -0.01f32..0.01,
    ) {
        let rest = rest();
        let limits = JointLimits::of_rig(&rest);
        let clamped = |v: Vec2, twist: f32, joint: usize| {
            let mut pose = rest.rest_pose().clone();
            pose.locals[joint].rotation *= SwingTwist { swing: v, twist }.rotation();
            limits.clamp(&rest, &mut pose);
            pose.locals[joint].rotation
        };
        prop_assume!(Vec2::new(x, z).length() < 2.4);
        for joint in [rest.find("calf_l").unwrap(), rest.find("index_02_r").unwrap()] {
            let a = clamped(Vec2::new(x, z), y, joint);
            let b = clamped(Vec2::new(x + dx, z + dz), y + dy, joint);
            // Swing and twist each change by at most their step, but swing coordinates stretch near half a turn.
            prop_assert!(a.angle_between(b) < 0.08, "{}", a.angle_between(b));
        }
    }
}
