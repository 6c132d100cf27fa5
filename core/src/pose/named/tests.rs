use std::f32::consts::FRAC_PI_2;

use super::*;
use crate::Side;
use crate::math::RigidTransform;
use crate::pose::limits::JointLimits;
use crate::skeleton::SidedJoint;
use crate::testing::bodies::bodies;

/// `model_from_joint` of each joint.
fn model(rest: &Skeleton, pose: &Pose) -> Vec<RigidTransform> {
    pose.model_from_joints(rest.parents())
}

/// Each test body with its poses.
fn all() -> impl Iterator<Item = (&'static str, Arc<Skeleton>, &'static str, Pose)> {
    bodies().into_iter().flat_map(|(body, rest)| {
        let girth = Girth::slender(&rest).unwrap();
        POSES.map(|name| (body, rest.clone(), name, named(name, &rest, &girth).unwrap()))
    })
}

#[test]
fn feet_are_flat_on_the_floor_and_the_pelvis_is_over_the_origin() {
    for (body, rest, name, pose) in all() {
        let (posed, at_rest) = (model(&rest, &pose), rest.model_from_joints());
        for side in Side::ALL {
            for part in [SidedJoint::Foot, SidedJoint::Ball] {
                let joint = rest.require_rig_joint(part.on(side)).unwrap();
                let lifted = posed[joint].translation.y - at_rest[joint].translation.y;
                assert!(lifted.abs() < 1e-4, "{body} {name} {part:?}: {lifted}");
            }
        }
        let pelvis = rest.require("pelvis").unwrap();
        let moved = (posed[pelvis].translation - at_rest[pelvis].translation).with_y(0.0);
        assert!(moved.length() < 1e-5, "{body} {name}: {moved}");
    }
}

#[test]
fn joints_stay_within_their_limits() {
    for (body, rest, name, pose) in all() {
        let excess = JointLimits::of_rig(&rest).excess(&rest, &pose);
        let worst = excess.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).unwrap();
        assert!(*worst.1 < 1e-3, "{body} {name}: {} by {}", rest.names()[worst.0], worst.1);
    }
}

#[test]
fn somebody_sitting_has_level_thighs_upright_shins_and_hands_on_the_thighs() {
    for (body, rest, _, pose) in all().filter(|(_, _, name, _)| *name == "sitting") {
        let posed = model(&rest, &pose);
        let at = |part: SidedJoint, side| posed[rest.require_rig_joint(part.on(side)).unwrap()].translation;
        for side in Side::ALL {
            let [hip, knee, ankle] =
                [SidedJoint::Thigh, SidedJoint::Calf, SidedJoint::Foot].map(|j| at(j, side));
            // The two legs of a body differ by fractions of a millimetre.
            assert!((knee.y - hip.y).abs() < 1e-3, "{body}: {hip} {knee}");
            assert!((ankle - knee).with_y(0.0).length() < 1e-3, "{body}: {knee} {ankle}");
            assert!(knee.z > hip.z + 0.3);
            let hand = at(SidedJoint::Hand, side);
            let share = (hand.z - hip.z) / (knee.z - hip.z);
            assert!((0.1..0.6).contains(&share), "{body}: {share}");
            let height = hand.y - hip.y;
            assert!((0.05..0.25).contains(&height), "{body}: {height}");
            let trunk = rest.require("neck_01").unwrap();
            assert!(posed[trunk].translation.with_y(0.0).length() < 0.06);
        }
    }
}

#[test]
fn wide_hips_hold_hanging_arms_out() {
    let (_, rest) = bodies().swap_remove(1);
    let slender = Girth::slender(&rest).unwrap();
    let hand = |girth: &Girth| {
        let pose = named("standing", &rest, girth).unwrap();
        model(&rest, &pose)[rest.require("hand_l").unwrap()].translation.x
    };
    let wide = Girth { arms_out: 0.4, ..slender };
    assert!(hand(&wide) > hand(&slender) + 0.08, "{} {}", hand(&wide), hand(&slender));
}

#[test]
fn girth_is_read_of_the_skin() {
    let (_, rest) = bodies().swap_remove(1);
    let at_rest = rest.model_from_joints();
    let joint = |name: &str| rest.require(name).unwrap();
    let [hip, knee, shoulder] =
        ["thigh_l", "calf_l", "upperarm_l"].map(|name| at_rest[joint(name)].translation);
    let front = hip.lerp(knee, 0.45) + Vec3::Z * 0.1;
    let side = Vec3::new(shoulder.x + 0.1, hip.y, shoulder.z);
    let girth = Girth::of(&rest, [(front, joint("thigh_l")), (side, joint("pelvis"))].into_iter()).unwrap();
    assert!((girth.thighs[0] - 0.1).abs() < 0.01, "{girth:?}");
    let tangent = (0.1 + 0.012) / (shoulder.y - hip.y);
    assert!((girth.arms_out - libm::atanf(tangent)).abs() < 1e-3 && girth.arms_out < FRAC_PI_2, "{girth:?}");
    assert_eq!(
        Girth::of(&rest, std::iter::empty()).unwrap().arms_out,
        Girth::slender(&rest).unwrap().arms_out
    );
}

#[test]
fn unknown_names_list_the_known_ones() {
    let (_, rest) = bodies().swap_remove(0);
    let error = named("lotus", &rest, &Girth::slender(&rest).unwrap()).unwrap_err().to_string();
    assert_eq!(error, "pose: expected one of t-pose, a-pose, standing, sitting, got `lotus`");
}
