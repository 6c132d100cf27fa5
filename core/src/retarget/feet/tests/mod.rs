mod builtin;

use glam::Vec3;

use super::*;
use crate::clip::{TranslationTrack, builtin};
use crate::math::Rotation;
use crate::pose::limits::JointLimits;
use crate::random::Random;
use crate::testing::bodies::bodies;

/// The walk with the flaws of a retargeted capture: a floor that is 7 cm off, root motion scaled by 1.06 so that feet slide,
/// noise of ±2 mm on the pelvis and of ±0.9° on a knee.
fn flawed(rest: &std::sync::Arc<crate::skeleton::Skeleton>) -> Clip {
    let walk = builtin("walk", rest).unwrap();
    let mut random = Random::new(5, 1);
    let mut noise = |size: f64| (random.uniform() - 0.5) as f32 * size as f32;
    let (pelvis, knee) = (rest.find("pelvis").unwrap(), rest.find("calf_r").unwrap());
    let mut rotations = Vec::new();
    let mut tracks = walk.translations().to_vec();
    for frame in 0..walk.frame_count() {
        let mut pose = walk.pose(frame);
        pose.locals[knee].rotation *= Rotation::from_rotation_x(noise(0.03));
        rotations.extend(pose.locals.iter().map(|l| l.rotation));
        for track in &mut tracks {
            let value = &mut track.values[frame];
            if track.joint as usize == pelvis {
                *value += Vec3::new(noise(0.004), 0.07 + noise(0.004), noise(0.004));
            } else {
                value.z *= 1.06;
            }
        }
    }
    Clip::new("flawed".into(), rest.clone(), 30.0, rotations, tracks).unwrap()
}

#[test]
fn feet_are_planted_and_lifted_out_of_the_floor() {
    for (body, rest) in bodies() {
        let clip = flawed(&rest);
        let (planted, report) = plant(&clip, &FeetOptions::default()).unwrap();
        assert!((report.floor - 0.07).abs() < 0.015, "{body}: {report:?}");
        for foot in 0..2 {
            assert!(report.before.contacts[foot] >= 2, "{body}: {report:?}");
            assert!(report.before.worst_slide[foot] > 0.01, "{body}: nothing to correct: {report:?}");
            assert!(report.after.worst_slide[foot] < 0.005, "{body}: {report:?}");
            assert!(report.after.deepest[foot] < 0.01, "{body}: {report:?}");
            let leg = &Leg::both(&rest).unwrap()[foot];
            let [before, after] = [&clip, &planted].map(|clip| {
                let slips = roll::slips(clip, leg, &report.contacts.feet[foot]).unwrap();
                slips.iter().flatten().map(|slip| slip.length()).fold(0.0, f32::max)
            });
            assert!(before > 0.005 && after < 0.001, "{body}: rolls with slips of {before}, then {after}");
        }
        // No pops: joints rotate hardly faster than in the input.
        let limits = JointLimits::of_rig(&rest);
        let fastest = |clip: &Clip| {
            (1..clip.frame_count())
                .flat_map(|f| {
                    clip.rotations(f).iter().zip(clip.rotations(f - 1)).map(|(a, b)| a.angle_between(*b))
                })
                .fold(0.0, f32::max)
        };
        assert!(
            fastest(&planted) < fastest(&clip) + 0.15,
            "{body}: {} {}",
            fastest(&planted),
            fastest(&clip)
        );
        for frame in 0..planted.frame_count() {
            let worst = limits.excess(&rest, &planted.pose(frame)).into_iter().fold(0.0, f32::max);
            assert!(worst < 5.0_f32.to_radians(), "{body} {frame}: {worst}");
        }
    }
}

/// A body that stands on the tips of bent toes and is then lifted by 3 cm a frame.
fn lifted(rest: &std::sync::Arc<crate::skeleton::Skeleton>) -> Clip {
    let mut pose = rest.rest_pose().clone();
    for (joint, degrees) in [("foot_l", -65.0_f32), ("foot_r", -65.0), ("ball_l", -45.0), ("ball_r", -45.0)] {
        pose.locals[rest.find(joint).unwrap()].rotation *= Rotation::from_rotation_x(degrees.to_radians());
    }
    let [ball, pelvis] = ["ball_l", "pelvis"].map(|name| rest.find(name).unwrap());
    let fall = pose.model_from_joints(rest.parents())[ball].translation.y
        - rest.model_from_joints()[ball].translation.y;
    let lift = |frame: usize| Vec3::Y * (0.03 * frame.saturating_sub(10) as f32 - fall);
    let values = (0..20).map(|frame| pose.locals[pelvis].translation + lift(frame)).collect();
    let rotations = (0..20).flat_map(|_| pose.locals.iter().map(|l| l.rotation)).collect();
    let tracks = vec![TranslationTrack { joint: pelvis as u32, values }];
    Clip::new("lifted".into(), rest.clone(), 30.0, rotations, tracks).unwrap()
}

#[test]
fn toes_leave_the_floor_without_a_jump() {
    for (body, rest) in bodies() {
        let (planted, report) = plant(&lifted(&rest), &FeetOptions::default()).unwrap();
        let ball = rest.find("ball_l").unwrap();
        let angles: Vec<f32> = (1..planted.frame_count())
            .map(|f| planted.rotations(f)[ball].angle_between(planted.rotations(f - 1)[ball]).to_degrees())
            .collect();
        let most = angles.iter().copied().fold(0.0, f32::max);
        assert!(angles.iter().sum::<f32>() > 60.0, "{body}: the toes bend on the floor: {angles:?}");
        assert!(most < 21.0, "{body}: {most} degrees in one frame: {angles:?}");
        assert!(report.after.deepest[0] < 0.007, "{body}: {report:?}");
    }
}

#[test]
fn feet_that_stand_well_hardly_change() {
    let (_, rest) = bodies().remove(1);
    let walk = builtin("walk", &rest).unwrap();
    let (planted, report) = plant(&walk, &FeetOptions::default()).unwrap();
    assert!(report.pelvis_drop < 0.01, "{report:?}");
    for frame in 0..walk.frame_count() {
        let [a, b] = [&walk, &planted].map(|c| c.pose(frame).model_from_joints(rest.parents()));
        let apart = a.iter().zip(&b).map(|(a, b)| a.translation.distance(b.translation)).fold(0.0, f32::max);
        assert!(apart < 0.02, "{frame}: {apart}");
    }
}

#[test]
fn contacts_have_the_phases_of_a_walk() {
    let (_, rest) = bodies().remove(0);
    let walk = builtin("walk", &rest).unwrap();
    let found = contacts(&walk, &FeetOptions::default()).unwrap();
    let stands = |foot: usize, point| {
        let frames =
            found.feet[foot].iter().filter(|c| c.point == point).map(|c| c.end - c.start).sum::<usize>();
        frames as f32 / walk.frame_count() as f32
    };
    // Heels stand from heel strike to heel off, 37 % of a stride, balls from foot flat to toe off, 54 %.
    for foot in 0..2 {
        assert!((0.25..0.55).contains(&stands(foot, FootPoint::Heel)), "{}", stands(foot, FootPoint::Heel));
        assert!((0.4..0.65).contains(&stands(foot, FootPoint::Ball)), "{}", stands(foot, FootPoint::Ball));
    }
}

#[test]
fn names_what_is_wrong() {
    let (_, rest) = bodies().remove(0);
    let idle = builtin("idle", &rest).unwrap();
    let error =
        plant(&idle, &FeetOptions { blend: f32::NAN, ..FeetOptions::default() }).unwrap_err().to_string();
    assert!(error.contains("feet.blend") && error.contains("NaN"), "{error}");
    let beyond = Contacts {
        feet: [vec![Contact { point: FootPoint::Ball, start: 0, end: 9999 }], vec![]],
        floor: 0.0,
    };
    assert!(measure(&idle, &beyond).unwrap_err().to_string().contains("9999"));
    let bare = crate::testing::clips::swing("c", 0.0, 2);
    assert!(plant(&bare, &FeetOptions::default()).unwrap_err().to_string().contains("`thigh_l`"));
}

#[test]
fn one_frame_is_enough() {
    let (_, rest) = bodies().remove(0);
    let rotations = rest.rest_rotations().collect();
    let tracks = vec![TranslationTrack { joint: 0, values: vec![Vec3::Y * -0.3] }];
    let clip = Clip::new("c".into(), rest.clone(), 30.0, rotations, tracks).unwrap();
    let (planted, report) = plant(&clip, &FeetOptions::default()).unwrap();
    assert!(
        (report.floor + 0.3).abs() < 1e-4 && report.after.deepest.iter().all(|d| *d < 1e-4),
        "{report:?}"
    );
    assert_eq!(planted.frame_count(), 1);
}
