use std::sync::Arc;

use glam::Vec3;

use super::*;
use crate::clip::{TranslationTrack, builtin};
use crate::random::Random;
use crate::retarget::{RetargetOptions, retarget};
use crate::testing::bodies::bodies;

/// A clip of a body that stands at first, and the body's skeleton.
fn squat() -> (Clip, Arc<Skeleton>) {
    let body = bodies().swap_remove(0).1;
    (builtin("squat", &body).unwrap(), body)
}

/// The same motion of a rig whose joints have other axes: at zero they are all parallel and the body is a heap of bones.
fn heap(clip: &Clip, seed: u64) -> Clip {
    let (rest, mut random) = (clip.skeleton(), Random::new(seed, 0));
    let axes: Vec<Rotation> = (0..rest.len())
        .map(|_| {
            let mut number = || random.normal() as f32;
            Rotation::from_xyzw(number(), number(), number(), number()).normalize()
        })
        .collect();
    let back =
        |joint: usize| rest.parents()[joint].map_or(Rotation::IDENTITY, |p| axes[p as usize].conjugate());
    let turned = |locals: &[RigidTransform]| -> Vec<RigidTransform> {
        let turn = |(joint, local): (usize, &RigidTransform)| RigidTransform {
            rotation: back(joint) * local.rotation * axes[joint],
            translation: back(joint) * local.translation,
        };
        locals.iter().enumerate().map(turn).collect()
    };
    let zero = turned(&rest.rest_pose().locals);
    let zero =
        zero.into_iter().map(|local| RigidTransform { rotation: Rotation::IDENTITY, ..local }).collect();
    let ends =
        rest.ends().iter().enumerate().map(|(j, end)| end.map(|end| axes[j].conjugate() * end)).collect();
    let skeleton = Arc::new(Skeleton::from_rest_pose(rest.tree().clone(), zero, ends).unwrap());
    let poses: Vec<Vec<RigidTransform>> =
        (0..clip.frame_count()).map(|f| turned(&clip.pose(f).locals)).collect();
    let rotations = poses.iter().flatten().map(|local| local.rotation).collect();
    let track = |joint: u32| {
        let values = poses.iter().map(|pose| pose[joint as usize].translation).collect();
        TranslationTrack { joint, values }
    };
    let tracks = clip.translations().iter().map(|moved| track(moved.joint)).collect();
    Clip::new("heap".into(), skeleton, clip.frames_per_second(), rotations, tracks).unwrap()
}

fn run(source: &Clip, body: &Arc<Skeleton>) -> (Clip, Option<ReferenceFrame>) {
    let (mut clips, report) =
        retarget(std::slice::from_ref(source), body, &RetargetOptions::default()).unwrap();
    (clips.swap_remove(0), report.reference)
}

/// The largest angle between the same joints of two clips in model space, degrees, and the joint.
fn apart(a: &Clip, b: &Clip, joints: &[&str]) -> (f32, String) {
    let rest = a.skeleton();
    let mut worst = (0.0, String::new());
    for frame in 0..a.frame_count() {
        let [a, b] = [a, b].map(|clip| clip.pose(frame).model_from_joints(rest.parents()));
        for name in joints {
            let joint = rest.find(name).unwrap();
            let degrees = a[joint].rotation.angle_between(b[joint].rotation).to_degrees();
            if degrees > worst.0 {
                worst = (degrees, (*name).to_owned());
            }
        }
    }
    worst
}

const JOINTS: [&str; 10] =
    ["pelvis", "spine_03", "head", "thigh_l", "thigh_r", "calf_l", "calf_r", "foot_l", "foot_r", "neck_01"];

#[test]
fn the_axes_of_joints_do_not_matter() {
    let (clip, body) = squat();
    let (wanted, reference) = run(&clip, &body);
    assert_eq!(reference, None, "a T-pose is a person");
    let found: Vec<Clip> = (1..5)
        .map(|seed| {
            let (found, reference) = run(&heap(&clip, seed), &body);
            assert!(reference.is_some(), "a heap is none");
            found
        })
        .collect();
    for other in &found {
        let (degrees, joint) = apart(&wanted, other, &JOINTS);
        assert!(degrees < 5.0, "{joint} is off by {degrees}°");
        let all: Vec<&str> = body.names().iter().map(String::as_str).collect();
        let (degrees, joint) = apart(&found[0], other, &all);
        assert!(degrees < 0.5, "{joint} differs by {degrees}° between rigs");
    }
}

/// The clip without the frames in which the body stands.
fn crouching(clip: &Clip) -> Clip {
    let middle = clip.frame_count() / 2;
    let rotations = clip.rotations(middle).to_vec();
    let track = |t: &TranslationTrack| TranslationTrack { joint: t.joint, values: vec![t.values[middle]] };
    let tracks = clip.translations().iter().map(track).collect();
    Clip::new("low".into(), clip.skeleton().clone(), 30.0, rotations, tracks).unwrap()
}

#[test]
fn a_heap_that_never_stands_is_refused() {
    let (clip, body) = squat();
    let low = heap(&crouching(&clip), 1);
    let error = retarget(&[low], &body, &RetargetOptions::default()).unwrap_err().to_string();
    assert!(error.contains("zero pose") && error.contains("no person stands"), "{error}");
    assert!(
        retarget(&[crouching(&clip)], &body, &RetargetOptions::default()).is_ok(),
        "its rest pose stands"
    );
}

#[test]
fn a_rest_pose_that_is_a_frame_gives_way_to_one_that_stands() {
    let (clip, body) = squat();
    let (wanted, _) = run(&clip, &body);
    for frame in [clip.frame_count() / 4, clip.frame_count() / 2] {
        let saved = clip.pose(frame).locals;
        let rest = Skeleton::from_rest_pose(body.tree().clone(), saved, body.ends().to_vec()).unwrap();
        let rotations = (0..clip.frame_count()).flat_map(|f| clip.rotations(f).to_vec()).collect();
        let tracks = clip.translations().to_vec();
        let saved =
            Clip::new("saved".into(), Arc::new(rest), clip.frames_per_second(), rotations, tracks).unwrap();
        let (found, reference) = run(&saved, &body);
        assert!(reference.is_some());
        let (degrees, joint) = apart(&wanted, &found, &JOINTS);
        assert!(degrees < 5.0, "frame {frame}: {joint} is off by {degrees}°");
    }
}

#[test]
fn a_lifted_heel_does_not_stay_lifted() {
    let (clip, body) = squat();
    let (wanted, _) = run(&clip, &body);
    let mut saved = clip.pose(0).locals;
    for foot in ["foot_l", "foot_r"] {
        saved[body.find(foot).unwrap()].rotation *= Rotation::from_rotation_x(0.38);
    }
    let rest = Skeleton::from_rest_pose(body.tree().clone(), saved, body.ends().to_vec()).unwrap();
    let rotations = (0..clip.frame_count()).flat_map(|f| clip.rotations(f).to_vec()).collect();
    let tracks = clip.translations().to_vec();
    let lifted = Clip::new("lifted".into(), Arc::new(rest), 30.0, rotations, tracks).unwrap();
    let (found, reference) = run(&lifted, &body);
    assert!(reference.is_some());
    let (degrees, joint) = apart(&wanted, &found, &["foot_l", "foot_r"]);
    assert!(degrees < 5.0, "{joint} is off by {degrees}°");
}

#[test]
fn a_rig_of_unknown_names_is_matched_in_a_frame() {
    let (clip, body) = squat();
    let heap = heap(&clip, 3);
    let names: Vec<String> = (0..body.len()).map(|joint| format!("j{joint}")).collect();
    let (rest, count) = (heap.skeleton(), heap.frame_count());
    let nameless =
        Skeleton::new(names, rest.parents().to_vec(), rest.rest_pose().locals.clone(), rest.ends().to_vec());
    let rotations = (0..count).flat_map(|f| heap.rotations(f).to_vec()).collect();
    let clip =
        Clip::new("n".into(), Arc::new(nameless.unwrap()), 30.0, rotations, heap.translations().to_vec());
    let map = find_map(&[&clip.unwrap()], &Overrides::new()).unwrap();
    for name in ["thigh_l", "calf_r", "foot_l", "upperarm_l"] {
        assert_eq!(map.source_of(RigJoint::from_name(name).unwrap()), body.find(name), "{name}");
    }
}

#[test]
fn sides_that_contradict_the_shape_are_refused_unless_mapped() {
    let (clip, body) = squat();
    let exchanged = |name: &str| match name.rsplit_once('_') {
        Some((stem, "l")) => format!("{stem}_r"),
        Some((stem, "r")) => format!("{stem}_l"),
        _ => name.to_owned(),
    };
    let renamed = Arc::new(clip.skeleton().renamed(exchanged).unwrap());
    let rotations = (0..clip.frame_count()).flat_map(|f| clip.rotations(f).to_vec()).collect();
    let tracks = clip.translations().to_vec();
    let swapped = Clip::new("swapped".into(), renamed, clip.frames_per_second(), rotations, tracks).unwrap();
    // The same with x mirrored, as numbers of a left-handed program.
    let mirror = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
    let turn = |r: Rotation| {
        let [x, y, z, w] = r.to_array();
        Rotation::from_xyzw(x, -y, -z, w)
    };
    let locals = body.rest_pose().locals.iter();
    let locals =
        locals.map(|l| RigidTransform { rotation: turn(l.rotation), translation: mirror(l.translation) });
    let ends = body.ends().iter().map(|end| end.map(mirror)).collect();
    let rest = Skeleton::from_rest_pose(body.tree().clone(), locals.collect(), ends).unwrap();
    let rotations = (0..clip.frame_count()).flat_map(|f| clip.rotations(f).to_vec()).map(turn).collect();
    let track = |t: &TranslationTrack| TranslationTrack {
        joint: t.joint,
        values: t.values.iter().copied().map(mirror).collect(),
    };
    let tracks = clip.translations().iter().map(track).collect();
    let mirrored =
        Clip::new("mirrored".into(), Arc::new(rest), clip.frames_per_second(), rotations, tracks).unwrap();
    for source in [&swapped, &mirrored] {
        let found = retarget(std::slice::from_ref(source), &body, &RetargetOptions::default());
        let error = found.unwrap_err().to_string();
        assert!(error.contains("left and right contradict each other"), "{error}");
    }
    let pairs = body.names().iter().filter(|name| !name.contains("twist") && exchanged(name) != **name);
    let mapping = pairs.map(|name| (name.clone(), Some(exchanged(name)))).collect();
    let options = RetargetOptions { mapping, ..RetargetOptions::default() };
    let (found, _) = retarget(&[swapped], &body, &options).unwrap();
    let (degrees, joint) = apart(&run(&clip, &body).0, &found[0], &JOINTS);
    assert!(degrees < 1.0, "{joint} is off by {degrees}°");
}

#[test]
fn a_rest_pose_that_a_clip_goes_through_stays_the_reference() {
    // The range of motion begins at rest, then turns the feet alone, and stands with straighter legs than at rest.
    for (_, body) in bodies() {
        for name in crate::clip::BUILTIN {
            let (_, reference) = run(&builtin(name, &body).unwrap(), &body);
            assert_eq!(reference, None, "{name}");
        }
    }
}

/// Somebody who waves and nods meanwhile; the file rests in the middle of it.
#[test]
fn a_rest_pose_of_somebody_who_stands_but_nods_gives_way_to_a_straight_frame() {
    let body = bodies().swap_remove(0).1;
    let wave = builtin("wave", &body).unwrap();
    let (head, frames) = (body.find("head").unwrap(), wave.frame_count());
    let poses: Vec<Vec<RigidTransform>> = (0..frames)
        .map(|frame| {
            let mut locals = wave.pose(frame).locals;
            let share = frame as f32 / (frames - 1) as f32;
            let nod = 0.7 * libm::sinf(share * std::f32::consts::PI);
            locals[head].rotation *= Rotation::from_rotation_x(nod);
            locals
        })
        .collect();
    let resting_in = |rest: Vec<RigidTransform>| {
        let skeleton = Skeleton::from_rest_pose(body.tree().clone(), rest, body.ends().to_vec()).unwrap();
        let rotations = poses.iter().flatten().map(|local| local.rotation).collect();
        let tracks = wave.translations().to_vec();
        Clip::new("nod".into(), Arc::new(skeleton), wave.frames_per_second(), rotations, tracks).unwrap()
    };
    let (wanted, reference) = run(&resting_in(body.rest_pose().locals.clone()), &body);
    assert_eq!(reference, None);
    let (found, reference) = run(&resting_in(poses[frames / 2].clone()), &body);
    assert!(reference.is_some(), "a head that hangs is no rest");
    let (degrees, joint) = apart(&wanted, &found, &JOINTS);
    assert!(degrees < 5.0, "{joint} is off by {degrees}°");
}
