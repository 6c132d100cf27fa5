use std::sync::Arc;

use glam::Vec3;

use super::*;
use crate::clip::builtin;
use crate::math::{RigidTransform, Rotation};
use crate::random::Random;
use crate::retarget::feet::measure;
use crate::testing::bodies::bodies;
use crate::testing::person::{motion, person};

/// Position of a joint along the floor, frame by frame.
fn path(clip: &Clip, joint: &str) -> Vec<Vec3> {
    let rest = clip.skeleton();
    let joint = rest.find(joint).unwrap();
    (0..clip.frame_count())
        .map(|frame| clip.pose(frame).model_from_joints(rest.parents())[joint].translation.with_y(0.0))
        .collect()
}

/// Two strides of the short body with a limp, whose end does not match their beginning, and the skeleton of the tall body.
fn limp() -> (Clip, Arc<Skeleton>) {
    let all = bodies();
    let walk = builtin("walk", &all[0].1).unwrap();
    let (frames, rest) = (walk.frame_count(), walk.skeleton().clone());
    let knee = rest.find("calf_l").unwrap();
    let mut rotations = Vec::new();
    let mut tracks = walk.translations().to_vec();
    let travel: Vec<Vec3> = tracks.iter().map(|t| (t.values[frames - 1] - t.values[0]).with_y(0.0)).collect();
    for (track, travel) in tracks.iter_mut().zip(travel) {
        let again: Vec<Vec3> = track.values[1..].iter().map(|v| *v + travel).collect();
        track.values.extend(again);
    }
    for frame in (0..frames).chain(1..frames) {
        let share = rotations.len() as f32 / (2 * frames * rest.len()) as f32;
        let mut pose = walk.pose(frame);
        pose.locals[knee].rotation *= Rotation::from_rotation_x(-0.25 * share);
        rotations.extend(pose.locals.iter().map(|local| local.rotation));
    }
    let clip = Clip::new("limp".into(), rest, 30.0, rotations, tracks).unwrap();
    (clip, all[1].1.clone())
}

fn run(source: &Clip, target: &Arc<Skeleton>, options: &RetargetOptions) -> (Clip, ClipReport) {
    let (mut clips, mut report) = retarget(std::slice::from_ref(source), target, options).unwrap();
    assert_eq!((clips.len(), report.clips.len()), (1, 1));
    (clips.remove(0), report.clips.remove(0))
}

#[test]
fn a_looped_clip_closes_and_its_feet_stay_planted() {
    let (motion, target) = limp();
    let (open, _) = run(&motion, &target, &RetargetOptions::default());
    let (closed, quality) =
        run(&motion, &target, &RetargetOptions { looped: true, ..RetargetOptions::default() });
    let gap = |clip: &Clip| {
        let [first, last] = [0, clip.frame_count() - 1].map(|frame| clip.pose(frame));
        // Exact near zero, unlike an arc cosine.
        let angle = |(a, b): (&RigidTransform, &RigidTransform)| {
            2.0 * libm::asinf((a.rotation.conjugate() * b.rotation).vector().length().min(1.0))
        };
        let angles = first.locals.iter().zip(&last.locals).map(angle);
        angles.fold(0.0, f32::max)
    };
    assert!(gap(&open) > 0.05, "nothing to close: {}", gap(&open));
    // Rounding of f32.
    assert!(gap(&closed) < 1e-5, "{}", gap(&closed));
    let pelvis = path(&closed, "pelvis");
    assert!(pelvis[0].distance(pelvis[pelvis.len() - 1]) > 1.0, "it still travels");

    // The report is of the looped clip, not of the one before looping.
    let feet = quality.feet.unwrap();
    let found =
        measure(&closed, &crate::retarget::feet::Contacts { floor: 0.0, ..feet.contacts.clone() }).unwrap();
    assert_eq!(found, feet.after);
    assert!(feet.after.contacts.iter().all(|n| *n >= 2), "{feet:?}");
    assert!(feet.after.worst_slide.iter().all(|slide| *slide < 0.01), "{feet:?}");
    assert!(feet.after.deepest.iter().all(|depth| *depth < 0.01), "{feet:?}");
    // Nor does it pop from one cycle to the next.
    let step = |a: usize, b: usize| {
        let pairs = closed.rotations(a).iter().zip(closed.rotations(b));
        pairs.map(|(a, b)| a.angle_between(*b)).fold(0.0, f32::max)
    };
    let last = closed.frame_count() - 1;
    let usual = (1..last).map(|f| step(f - 1, f)).fold(0.0, f32::max);
    assert!(step(last - 1, last) <= usual + 0.02, "{} after {usual}", step(last - 1, last));
}

#[test]
fn in_place_the_body_stays_where_it_starts() {
    let (motion, target) = limp();
    let (walks, _) = run(&motion, &target, &RetargetOptions::default());
    let (stays, _) = run(&motion, &target, &RetargetOptions { in_place: true, ..RetargetOptions::default() });
    let pelvis = path(&walks, "pelvis");
    assert!(pelvis[0].distance(pelvis[pelvis.len() - 1]) > 1.0);
    for joint in ["Root", "pelvis"] {
        let path = path(&stays, joint);
        // A few roundings of metres in f32.
        assert!(path.iter().all(|at| at.distance(path[0]) < 1e-5), "{joint}");
    }
    for frame in 0..walks.frame_count() {
        assert_eq!(walks.rotations(frame), stays.rotations(frame));
    }
}

/// The clip with another rotation of a joint on top.
fn bent(source: &Clip, joint: &str, by: Rotation) -> Clip {
    let joint = source.skeleton().find(joint).unwrap();
    let rotations = (0..source.frame_count())
        .flat_map(|frame| {
            let mut pose = source.pose(frame);
            pose.locals[joint].rotation *= by;
            pose.locals.into_iter().map(|local| local.rotation)
        })
        .collect();
    let tracks = source.translations().to_vec();
    Clip::new("bent".into(), source.skeleton().clone(), 30.0, rotations, tracks).unwrap()
}

#[test]
fn hands_and_feet_that_limits_hold_back_are_noted() {
    let (source, target) = limp();
    let notes = |clip: &Clip, limits: bool| {
        let options = RetargetOptions { limits, feet: None, ..RetargetOptions::default() };
        retarget(std::slice::from_ref(clip), &target, &options).unwrap().1.notes()
    };
    assert_eq!(notes(&source, true), Vec::<String>::new());
    // About the bone, so that the foot points where it pointed.
    let rolled = bent(&source, "foot_l", Rotation::from_rotation_y(1.5));
    let told = notes(&rolled, true);
    assert!(told.len() == 1 && told[0].starts_with("`sole_l` of `bent` is "), "{told:?}");
    assert_eq!(notes(&rolled, false), Vec::<String>::new());
}

#[test]
fn without_limits_a_wrist_bends_as_far_as_the_source() {
    let (source, target) = limp();
    let motion = bent(&source, "hand_l", Rotation::from_rotation_z(2.4));
    let (_, kept) = run(&motion, &target, &RetargetOptions::default());
    assert!(kept.beyond_limits < 5.0, "{kept:?}");
    let (clip, free) =
        run(&motion, &target, &RetargetOptions { limits: false, ..RetargetOptions::default() });
    assert!(free.beyond_limits > 30.0, "{free:?}");
    assert_eq!(free.beyond_limits_joint.as_deref(), Some("hand_l"));
    let (excess, joint) = worst_limit_excess(&JointLimits::of_rig(&target), &clip);
    assert_eq!((f64::from(excess).to_degrees(), joint), (free.beyond_limits, target.find("hand_l")));
}

#[test]
fn without_planting_feet_slide() {
    let (motion, _) = limp();
    // Wide hips and legs of other proportions make feet slide that stood in the source.
    let target = bodies().remove(2).1;
    let (held, quality) = run(&motion, &target, &RetargetOptions::default());
    let feet = quality.feet.unwrap();
    let (free, quality) =
        run(&motion, &target, &RetargetOptions { feet: None, ..RetargetOptions::default() });
    assert!(quality.feet.is_none());
    assert_eq!(measure(&free, &feet.contacts).unwrap(), feet.before);
    let worst = |pair: [f32; 2]| pair[0].max(pair[1]);
    assert!(worst(feet.before.worst_slide) > worst(feet.after.worst_slide), "{feet:?}");
    assert!(held != free);
}

/// The same motion in the world on a skeleton whose joints have axes that are turned at random.
fn with_other_axes(clip: &Clip, seed: u64) -> Clip {
    let skeleton = clip.skeleton();
    let mut random = Random::new(seed, 3);
    let turns: Vec<Rotation> = (0..skeleton.len())
        .map(|_| {
            let [x, y, z, w] = std::array::from_fn(|_| random.normal() as f32);
            Rotation::from_xyzw(x, y, z, w).normalize()
        })
        .collect();
    let of_parent = |joint: usize| {
        skeleton.parents()[joint].map_or(Rotation::IDENTITY, |parent| turns[parent as usize].conjugate())
    };
    let turned = |(joint, rotation): (usize, &Rotation)| of_parent(joint) * *rotation * turns[joint];
    let rest = skeleton.rest_pose().locals.iter().enumerate().map(|(joint, local)| RigidTransform {
        rotation: turned((joint, &local.rotation)),
        translation: of_parent(joint) * local.translation,
    });
    let ends = skeleton.ends().iter().zip(&turns).map(|(end, turn)| end.map(|end| turn.conjugate() * end));
    let (names, parents) = (skeleton.names().to_vec(), skeleton.parents().to_vec());
    let other = Skeleton::new(names, parents, rest.collect(), ends.collect()).unwrap();
    let frames = 0..clip.frame_count();
    let rotations = frames.flat_map(|frame| clip.rotations(frame).iter().enumerate().map(turned)).collect();
    let mut tracks = clip.translations().to_vec();
    for track in &mut tracks {
        let turn = of_parent(track.joint as usize);
        track.values.iter_mut().for_each(|value| *value = turn * *value);
    }
    Clip::new(clip.name().into(), Arc::new(other), clip.frames_per_second(), rotations, tracks).unwrap()
}

#[test]
fn axes_of_the_source_change_neither_poses_nor_measures() {
    let clip = motion(&person(), 40);
    let target = bodies().remove(1).1;
    let (expected, report) = run(&clip, &target, &RetargetOptions::default());
    let groups = |report: &ClipReport| {
        let DirectionError { limbs, ends, trunk, rolls, .. } = report.direction.clone();
        [limbs, ends, trunk, rolls].concat()
    };
    let parts: Vec<String> = groups(&report).into_iter().map(|part| part.bone).collect();
    for part in ["upperarm_l", "hips", "shoulders", "spine", "neck_01", "head", "sole_l", "sole_r"] {
        assert!(parts.iter().any(|name| name == part), "{part} of {parts:?}");
    }
    for seed in 0..8 {
        let (found, other) = run(&with_other_axes(&clip, seed), &target, &RetargetOptions::default());
        for frame in 0..expected.frame_count() {
            for (joint, (a, b)) in expected.rotations(frame).iter().zip(found.rotations(frame)).enumerate() {
                let degrees = a.angle_between(*b).to_degrees();
                assert!(degrees < 0.5, "{seed} {frame} {}: {degrees}", target.names()[joint]);
            }
        }
        let others = groups(&other);
        assert_eq!(parts.len(), others.len());
        for (a, b) in groups(&report).iter().zip(&others) {
            assert_eq!(a.bone, b.bone);
            assert!((a.mean - b.mean).abs() < 0.5 && (a.max - b.max).abs() < 0.5, "{seed}: {a:?} {b:?}");
        }
        // Left and right may be equally bad.
        let [a, b] = [&report, &other].map(|report| report.direction.worst.as_ref().unwrap().mean);
        assert!((a - b).abs() < 0.5, "{seed}: {a} {b}");
    }
}
