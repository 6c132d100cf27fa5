//! The built-in clips, checked by foot contacts and joint limits.
use crate::pose::limits::JointLimits;
use std::sync::Arc;

use crate::Side;
use crate::clip::{BUILTIN, builtin};
use crate::retarget::feet;
use crate::retarget::feet::FeetOptions;
use crate::skeleton::{RigJoint, SidedJoint, Skeleton};
use crate::testing::bodies::bodies;

#[test]
fn joints_stay_within_their_limits_and_feet_on_the_floor() {
    for (body, rest) in bodies() {
        let limits = JointLimits::of_rig(&rest);
        for name in BUILTIN {
            let clip = builtin(name, &rest).unwrap();
            for frame in 0..clip.frame_count() {
                let excess = limits.excess(&rest, &clip.pose(frame));
                let worst = (0..excess.len()).max_by(|a, b| excess[*a].total_cmp(&excess[*b])).unwrap();
                assert_eq!(excess[worst], 0.0, "{body} {name} {frame}: {}", rest.names()[worst]);
            }
            let options = FeetOptions { find_floor: false, ..FeetOptions::default() };
            let found = feet::contacts(&clip, &options).unwrap();
            let measured = feet::measure(&clip, &found).unwrap();
            assert!(measured.contacts.iter().all(|c| *c > 0), "{body} {name}: {measured:?}");
            assert!(measured.worst_slide.iter().all(|s| *s < 0.01), "{body} {name}: {measured:?}");
            assert!(measured.deepest.iter().all(|d| *d < 0.01), "{body} {name}: {measured:?}");
        }
    }
}

#[test]
fn the_last_pose_is_the_first_but_for_root_motion() {
    for (body, rest) in bodies() {
        for name in BUILTIN {
            let clip = builtin(name, &rest).unwrap();
            let (first, last) = (clip.pose(0), clip.pose(clip.frame_count() - 1));
            for (a, b) in first.locals.iter().zip(&last.locals) {
                assert!(a.rotation.dot(b.rotation).abs() > 1.0 - 1e-5, "{body} {name}");
            }
            let travel = last.locals[0].translation - first.locals[0].translation;
            assert_eq!(travel.z > 0.0, name == "walk", "{body} {name}: {travel}");
        }
    }
}

#[test]
fn walking_looks_like_walking() {
    for (body, rest) in bodies() {
        let clip = builtin("walk", &rest).unwrap();
        for frame in 0..clip.frame_count() {
            let model = clip.pose(frame).model_from_joints(rest.parents());
            let at = |joint: RigJoint| model[rest.rig_joint(joint).unwrap()].translation;
            for side in Side::ALL {
                let leg = [SidedJoint::Thigh, SidedJoint::Calf, SidedJoint::Foot];
                let [hip, knee, ankle] = leg.map(|joint| at(joint.on(side)));
                let share = (knee.y - ankle.y) / (hip.y - ankle.y);
                assert!(knee.z > (ankle + (hip - ankle) * share).z, "{body} {frame}: knee behind the leg");
                let arm = [SidedJoint::Upperarm, SidedJoint::Lowerarm, SidedJoint::Hand];
                let [shoulder, elbow, wrist] = arm.map(|joint| at(joint.on(side)));
                assert!(elbow.y < shoulder.y && wrist.y < elbow.y, "{body} {frame}: arms hang");
                let share = (elbow.y - wrist.y) / (shoulder.y - wrist.y);
                assert!(elbow.z < (wrist + (shoulder - wrist) * share).z, "{body} {frame}: elbow in front");
                let toes = at(SidedJoint::Ball.on(side)) - ankle;
                assert!(toes.z > libm::fabsf(toes.x), "{body} {frame}: foot points aside");
            }
            let forward = model[0].translation.z;
            assert!(
                (at(RigJoint::Pelvis).z - forward).abs() < 0.1,
                "{body} {frame}: the root is under the pelvis"
            );
        }
        // A comfortable walk: 1.0 to 1.6 m/s for legs of 0.6 to 1.1 m.
        let travel = clip.pose(clip.frame_count() - 1).locals[0].translation.z;
        let speed = f64::from(travel) / clip.duration();
        assert!((0.9..1.7).contains(&speed), "{body}: {speed} m/s");
    }
}

#[test]
fn names_what_is_wrong() {
    let (_, rest) = bodies().remove(0);
    let error = builtin("dance", &rest).unwrap_err().to_string();
    assert!(error.contains("idle, walk") && error.contains("`dance`"), "{error}");
    let root = crate::math::RigidTransform::IDENTITY;
    let rest = Skeleton::new(vec!["Root".into()], vec![None], vec![root], vec![None]).unwrap();
    let error = builtin("idle", &Arc::new(rest)).unwrap_err().to_string();
    assert!(error.contains("`thigh_l`"), "{error}");
}
