use std::sync::Arc;

use glam::Vec3;

use super::*;
use crate::clip::builtin;
use crate::math::{RigidTransform, Rotation};
use crate::retarget::feet::measure;
use crate::testing::bodies::bodies;

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

#[test]
fn without_limits_a_wrist_bends_as_far_as_the_source() {
    let (motion, target) = limp();
    let source = &motion;
    let hand = source.skeleton().find("hand_l").unwrap();
    let rotations = (0..source.frame_count())
        .flat_map(|frame| {
            let mut pose = source.pose(frame);
            pose.locals[hand].rotation *= Rotation::from_rotation_z(2.4);
            pose.locals.into_iter().map(|local| local.rotation)
        })
        .collect();
    let tracks = source.translations().to_vec();
    let bent = Clip::new("bent".into(), source.skeleton().clone(), 30.0, rotations, tracks).unwrap();
    let motion = bent;
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
