use super::*;
use crate::skeleton::RigJoint;
use crate::skeleton::humanoid::{JointNames, renamed};
use crate::testing::person::{Style, motion, person, posed, restyled};

/// Rounding of f32 through a chain of a dozen joints, radians and metres.
const EXACT: f32 = 1e-5;
/// The same where directions were aligned: `Rotation::from_rotation_arc` ignores angles below 7e-4.
const CLOSE: f32 = 4e-3;

fn source_floor() -> TransferOptions {
    TransferOptions { floor: Floor::Source, ..Default::default() }
}

fn retarget(clip: &Clip, target: &Arc<Skeleton>, options: &TransferOptions) -> Clip {
    let map = JointMap::find(clip.skeleton(), &Default::default()).unwrap();
    Retargeter::new(clip.skeleton(), target.clone(), &map, options).unwrap().retarget(clip).unwrap()
}

/// Asserts that rotations and translations differ by less than `tolerance`; twist joints are compared only if `twists`.
fn assert_same(a: &Clip, b: &Clip, tolerance: f32, twists: bool) {
    assert_eq!(a.frame_count(), b.frame_count());
    for frame in 0..a.frame_count() {
        let pairs = a.pose(frame).locals.into_iter().zip(b.pose(frame).locals);
        for ((x, y), name) in pairs.zip(a.skeleton().names()) {
            if name.contains("twist") && !twists {
                continue;
            }
            let q = x.rotation.conjugate() * y.rotation;
            let angle = 2.0 * libm::asinf(q.vector().length().min(1.0));
            assert!(angle < tolerance, "frame {frame}, {name}: {angle} rad");
            let distance = x.translation.distance(y.translation);
            assert!(distance < tolerance, "frame {frame}, {name}: {} m for {}", y.translation, x.translation);
        }
    }
}

fn mixamo(name: &str) -> Option<String> {
    (!name.contains("twist") && name != "Root").then(|| renamed(name, JointNames::Mixamo).into_owned())
}

#[test]
fn a_clip_of_the_target_itself_does_not_change() {
    let rest = person();
    let clip = motion(&rest, 20);
    assert_same(&clip, &retarget(&clip, &rest, &source_floor()), EXACT, false);
    // Elbows that roll and bend sideways are kept when hinges are off.
    let mut rotations: Vec<Rotation> = (0..20).flat_map(|f| clip.rotations(f).to_vec()).collect();
    for (i, q) in rotations.iter_mut().enumerate() {
        *q *= Rotation::from_scaled_axis(glam::Vec3::new(0.1, 0.2, -0.1) * (i % 5) as f32);
    }
    // Twist joints, Root and face do not come from the source.
    let names = rest.names();
    for (i, q) in rotations.iter_mut().enumerate() {
        let joint = i % rest.len();
        if ["twist", "Root", "eye", "jaw"].iter().any(|part| names[joint].contains(part)) {
            *q = rest.rest_pose().locals[joint].rotation;
        }
    }
    let wild = Clip::new("wild".into(), rest.clone(), 30.0, rotations, clip.translations().to_vec()).unwrap();
    let found = retarget(&wild, &rest, &TransferOptions { hinges: false, ..source_floor() });
    assert_same(&wild, &found, EXACT, false);
}

#[test]
fn axes_facing_and_rest_pose_of_the_source_do_not_matter() {
    let rest = person();
    let clip = motion(&rest, 20);
    let expected = retarget(&clip, &rest, &source_floor());
    let a_pose = posed(
        &rest,
        &[
            ("upperarm_l", [0.0, 0.0, -50.0]),
            ("upperarm_r", [0.0, 0.0, 50.0]),
            ("index_01_l", [0.0, 0.0, 20.0]),
        ],
    );
    // Crouching with the arms forward, soles flat, one upper arm rolled.
    let bent = posed(
        &rest,
        &[
            ("upperarm_l", [30.0, 0.0, -40.0]),
            ("lowerarm_l", [50.0, 0.0, 0.0]),
            ("upperarm_r", [0.0, -60.0, 0.0]),
            ("lowerarm_r", [80.0, 0.0, 0.0]),
            ("thigh_l", [20.0, 0.0, 0.0]),
            ("calf_l", [-40.0, 0.0, 0.0]),
            ("foot_l", [20.0, 0.0, 0.0]),
            ("thigh_r", [30.0, 0.0, 0.0]),
            ("calf_r", [-50.0, 0.0, 0.0]),
            ("foot_r", [20.0, 0.0, 0.0]),
        ],
    );
    let t_pose = rest.rest_pose().locals.clone();
    for (what, pose, facing, frames) in [
        ("T", &t_pose, 0.0, false),
        ("other axes", &t_pose, 0.0, true),
        ("facing -X", &t_pose, -1.6, true),
        ("facing back", &t_pose, 3.1, false),
        ("A-pose", &a_pose, 0.0, true),
        ("bent", &bent, 2.0, true),
    ] {
        let style = Style { rename: &mixamo, rest: pose.clone(), facing, frames, scale: 1.0 };
        let source = restyled(&clip, &style);
        println!("{what}");
        for feet in [FootMode::Sole, FootMode::Bone] {
            // With bent knees the slant of the legs at rest adds an error.
            let tolerance = if what == "bent" { 0.05 } else { CLOSE };
            let found = retarget(&source, &rest, &TransferOptions { feet, ..source_floor() });
            assert_same(&expected, &found, tolerance, false);
        }
    }
}

#[test]
fn root_motion_and_heights_scale_with_leg_length() {
    let rest = person();
    let clip = motion(&rest, 12);
    let style = Style {
        rename: &mixamo,
        rest: rest.rest_pose().locals.clone(),
        facing: 0.0,
        frames: true,
        scale: 2.0,
    };
    let giant = restyled(&clip, &style);
    assert_same(
        &retarget(&clip, &rest, &source_floor()),
        &retarget(&giant, &rest, &source_floor()),
        CLOSE,
        false,
    );
    let twice = retarget(&giant, &rest, &TransferOptions { scale: Some(1.0), ..source_floor() });
    let height = |clip: &Clip| clip.pose(0).locals[clip.skeleton().find("pelvis").unwrap()].translation.y;
    assert!((height(&twice) - height(&clip)).abs() > 0.8);
}

#[test]
fn left_stays_left() {
    let rest = person();
    let raised = posed(&rest, &[("upperarm_l", [0.0, 0.0, 80.0])]);
    let rotations: Vec<Rotation> = raised.iter().map(|l| l.rotation).collect();
    let clip = Clip::new("wave".into(), rest.clone(), 30.0, rotations, vec![]).unwrap();
    let style = Style {
        rename: &mixamo,
        rest: rest.rest_pose().locals.clone(),
        facing: -1.6,
        frames: true,
        scale: 1.0,
    };
    let found = retarget(&restyled(&clip, &style), &rest, &TransferOptions::default());
    let model = found.pose(0).model_from_joints(rest.parents());
    let [left, right] = SidedJoint::Hand.both().map(|hand| model[rest.rig_joint(hand).unwrap()].translation);
    assert!(left.y > 1.8 && (right.y - 1.39).abs() < 0.01, "{left} {right}");
    assert!(left.x > 0.1 && right.x < -0.5);
}

#[test]
fn roll_is_spread_along_limbs() {
    let rest = person();
    let retarget_roll = |rotations: &[(&str, [f32; 3])]| {
        let rotations: Vec<Rotation> = posed(&rest, rotations).iter().map(|l| l.rotation).collect();
        let clip = Clip::new("roll".into(), rest.clone(), 30.0, rotations, vec![]).unwrap();
        retarget(&clip, &rest, &source_floor())
    };
    let roll = |clip: &Clip, name: &str| {
        let joint = rest.find(name).unwrap();
        let q = rest.rest_pose().locals[joint].rotation.conjugate() * clip.rotations(0)[joint];
        crate::pose::SwingTwist::of(q).twist.to_degrees()
    };
    // A forearm that is rolled at the elbow is rolled at the wrist instead.
    for rotations in [[("hand_l", [0.0, -80.0, 0.0])], [("lowerarm_l", [0.0, -80.0, 0.0])]] {
        let clip = retarget_roll(&rotations);
        let rolls = ["lowerarm_l", "lowerarm_twist_01_l", "lowerarm_twist_02_l"].map(|n| roll(&clip, n));
        for (found, expected) in rolls.into_iter().zip([0.0, -40.0, -80.0]) {
            assert!((found - expected).abs() < 1.5, "{rolls:?}");
        }
    }
    let clip = retarget_roll(&[("upperarm_l", [0.0, 60.0, 0.0]), ("thigh_r", [0.0, 20.0, 0.0])]);
    for (name, expected) in
        [("upperarm_twist_01_l", -60.0), ("upperarm_twist_02_l", -30.0), ("thigh_twist_01_r", -20.0)]
    {
        assert!((roll(&clip, name) - expected).abs() < 0.5, "{name}: {}", roll(&clip, name));
    }
}

#[test]
fn spines_with_other_numbers_of_joints_bend_as_a_whole() {
    let rest = person();
    let clip = motion(&rest, 10);
    for drop in [&["spine_02"][..], &["spine_01", "spine_02"], &["spine_02", "neck_01"]] {
        let rename = |name: &str| mixamo(name);
        let style = Style {
            rename: &rename,
            rest: rest.rest_pose().locals.clone(),
            facing: 0.3,
            frames: true,
            scale: 1.0,
        };
        let source = restyled(&clip, &style);
        // A joint that is mapped to nothing is left out of the chain.
        let overrides = drop.iter().map(|name| (mixamo(name).unwrap(), None)).collect();
        let map = JointMap::find(source.skeleton(), &overrides).unwrap();
        let retargeter = Retargeter::new(source.skeleton(), rest.clone(), &map, &source_floor()).unwrap();
        let found = retargeter.retarget(&source).unwrap();
        let error = direction_error(&source, &found, &map);
        // Degrees; shortest arcs ignore angles below 7e-4 rad.
        assert!(error.max() < 0.1, "{error:?}");
        let parts = error.trunk.iter().chain(&error.rolls);
        // A spine of fewer joints bends at other places, which moves the shoulders a little.
        let most = |part: &BoneError| if part.bone == "spine" { 1.0 } else { 0.1 };
        assert!(parts.clone().all(|part| part.max < most(part)), "{error:?}");
        let lines = ["hips", "spine", "shoulders", "palm_l", "sole_r"];
        assert!(lines.iter().all(|name| parts.clone().any(|part| part.bone == *name)), "{error:?}");
        for frame in 0..10 {
            let chest = |clip: &Clip| {
                clip.pose(frame).model_from_joints(rest.parents())[rest.find("spine_03").unwrap()].rotation
            };
            assert!(chest(&clip).angle_between(chest(&found)) < CLOSE);
        }
    }
}

#[test]
fn root_motion_can_be_on_the_root_joint() {
    let rest = person();
    let clip = motion(&rest, 10);
    let pelvis = retarget(&clip, &rest, &TransferOptions::default());
    let root = retarget(&clip, &rest, &TransferOptions { root: RootMotion::Root, ..Default::default() });
    assert_eq!(pelvis.translations().len(), 1);
    assert_eq!(root.translations()[0].joint, 0);
    assert!(root.translations()[0].values.iter().all(|v| v.y == 0.0));
    for frame in 0..10 {
        let positions = |clip: &Clip| clip.pose(frame).model_from_joints(rest.parents());
        for (a, b) in positions(&pelvis)[1..].iter().zip(&positions(&root)[1..]) {
            assert!(a.translation.distance(b.translation) < EXACT);
        }
    }
}

#[test]
fn feet_stand_on_the_floor_when_the_source_floats() {
    let rest = person();
    let clip = motion(&rest, 30);
    let mut track = clip.translations()[0].clone();
    track.values.iter_mut().for_each(|v| v.y += 3.0);
    let rotations = (0..30).flat_map(|f| clip.rotations(f).to_vec()).collect();
    let floating = Clip::new("up".into(), rest.clone(), 30.0, rotations, vec![track]).unwrap();
    let found = retarget(&floating, &rest, &TransferOptions::default());
    let resting = rest.model_from_joints();
    let mut lowest = f32::INFINITY;
    for frame in 0..30 {
        let model = found.pose(frame).model_from_joints(rest.parents());
        for name in ["foot_l", "foot_r", "ball_l", "ball_r"] {
            let joint = rest.find(name).unwrap();
            lowest = lowest.min(model[joint].translation.y - resting[joint].translation.y);
        }
    }
    assert!(lowest.abs() < 1e-4, "{lowest}");
}

#[test]
fn hands_without_fingers_are_relaxed() {
    let rest = person();
    let clip = motion(&rest, 3);
    let fingerless = |name: &str| mixamo(name).filter(|n| !n.contains("Index") && !n.contains("Pinky"));
    let fingerless = |name: &str| fingerless(name).filter(|n| !n.contains("Middle") && !n.contains("Ring"));
    let style = Style {
        rename: &fingerless,
        rest: rest.rest_pose().locals.clone(),
        facing: 0.0,
        frames: false,
        scale: 1.0,
    };
    let source = restyled(&clip, &style);
    let curl = |fingers, joint: RigJoint| {
        let found = retarget(&source, &rest, &TransferOptions { fingers, ..Default::default() });
        let joint = rest.rig_joint(joint).unwrap();
        let down = |q: Rotation| (q * glam::Vec3::Y).y;
        // In the T-pose a curl lowers the finger's tip.
        let upright = rest.model_from_joints();
        let parent = upright[rest.parents()[joint].unwrap() as usize].rotation;
        down(parent * rest.rest_pose().locals[joint].rotation) - down(parent * found.rotations(0)[joint])
    };
    for side in Side::ALL {
        let fingers = [SidedJoint::Index01, SidedJoint::Pinky01];
        let [index, pinky] = fingers.map(|finger| curl(FingerMode::Source, finger.on(side)));
        assert!(index > 0.1 && pinky > index + 0.05, "{index} {pinky}");
        assert_eq!(curl(FingerMode::Rest, SidedJoint::Index01.on(side)), 0.0);
    }
}

#[test]
fn unsuitable_scales_targets_and_clips_are_refused() {
    let rest = person();
    let clip = motion(&rest, 2);
    let map = JointMap::find(&rest, &Default::default()).unwrap();
    let new = |target: &Arc<Skeleton>, scale| {
        Retargeter::new(&rest, target.clone(), &map, &TransferOptions { scale, ..Default::default() })
    };
    assert!(new(&rest, Some(0.0)).unwrap_err().to_string().contains("positive scale"));
    let other = restyled(
        &clip,
        &Style {
            rename: &mixamo,
            rest: rest.rest_pose().locals.clone(),
            facing: 0.0,
            frames: false,
            scale: 1.0,
        },
    );
    assert!(new(other.skeleton(), None).unwrap_err().to_string().contains("no pelvis"));
    let message = new(&rest, None).unwrap().retarget(&other).unwrap_err().to_string();
    assert!(message.contains("another skeleton"), "{message}");
}

#[test]
fn a_trunk_a_palm_and_a_sole_that_are_turned_are_seen() {
    let rest = person();
    let clip = motion(&rest, 10);
    let map = JointMap::find(&rest, &Default::default()).unwrap();
    for (joint, axis, part) in [
        ("head", glam::Vec3::Y, "head"),
        ("spine_03", glam::Vec3::Y, "shoulders"),
        ("hand_l", glam::Vec3::Y, "palm_l"),
        ("foot_r", glam::Vec3::Y, "sole_r"),
    ] {
        let turned = rest.find(joint).unwrap();
        let mut rotations: Vec<Rotation> = (0..10).flat_map(|f| clip.rotations(f).to_vec()).collect();
        for rotation in rotations.iter_mut().skip(turned).step_by(rest.len()) {
            *rotation *= Rotation::from_axis_angle(axis, 0.35);
        }
        let other =
            Clip::new("turned".into(), rest.clone(), 30.0, rotations, clip.translations().to_vec()).unwrap();
        let error = direction_error(&clip, &other, &map);
        let found = error.trunk.iter().chain(&error.rolls).find(|error| error.bone == part).unwrap();
        assert!((15.0..21.0).contains(&found.mean), "{part}: {error:?}");
        assert!(error.worst.is_some_and(|worst| worst.mean >= found.mean), "{part}");
    }
}
