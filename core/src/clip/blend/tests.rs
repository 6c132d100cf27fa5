use glam::Vec3;

use super::*;
use crate::math::{RigidTransform, Rotation};
use crate::testing::clips::swing;

#[test]
fn a_blend_of_one_half_is_half_way() {
    let (a, b) = (swing("a", 0.0, 11), swing("b", 1.0, 11));
    let half = blend(&a, &b, 0.5, None).unwrap();
    for frame in 0..11 {
        let wanted = a.rotations(frame)[1].slerp(b.rotations(frame)[1], 0.5);
        assert!(half.rotations(frame)[1].dot(wanted) > 1.0 - 1e-6);
    }
    assert_eq!(blend(&a, &b, 0.0, None).unwrap().rotations(4), a.rotations(4));
    assert!(blend(&a, &b, 1.5, None).unwrap_err().to_string().contains("got 1.5"));
}

#[test]
fn masked_out_joints_keep_the_first_clip() {
    let (a, b) = (swing("a", 0.0, 11), swing("b", 1.0, 11));
    let mask = JointMask::below(a.skeleton(), &["child"]).unwrap();
    let mixed = blend(&a, &b, 1.0, Some(&mask)).unwrap();
    assert_eq!(mixed.rotations(10)[0], a.rotations(10)[0]);
    assert_eq!(mixed.rotations(10)[1], b.rotations(10)[1]);
    let half = JointMask::of_weights(a.skeleton(), &[0.0, 0.5]).unwrap();
    let mixed = blend(&a, &b, 1.0, Some(&half)).unwrap();
    let wanted = a.rotations(10)[1].slerp(b.rotations(10)[1], 0.5);
    assert!(mixed.rotations(10)[1].dot(wanted) > 1.0 - 1e-6 && mixed.rotations(10)[0] == a.rotations(10)[0]);
    for (weights, message) in
        [(&[1.0][..], "expected 2 joints, got 1"), (&[0.0, 1.5], "`child`"), (&[f32::NAN, 0.0], "NaN")]
    {
        assert!(JointMask::of_weights(a.skeleton(), weights).unwrap_err().to_string().contains(message));
    }
    assert!(JointMask::below(a.skeleton(), &["tail"]).unwrap_err().to_string().contains("`tail`"));
}

#[test]
fn an_additive_layer_adds_its_difference_to_the_reference() {
    let (a, b) = (swing("a", 0.3, 11), swing("b", 1.0, 11));
    let same = additive(&a, &b, &b.pose(0), 0.0, None).unwrap();
    assert!(same.rotations(9)[1].dot(a.rotations(9)[1]) > 1.0 - 1e-6);
    let sum = additive(&a, &b, &b.pose(0), 1.0, None).unwrap();
    let difference = b.rotations(0)[1].conjugate() * b.rotations(9)[1];
    assert!(sum.rotations(9)[1].dot(a.rotations(9)[1] * difference).abs() > 1.0 - 1e-5);
    assert!(additive(&a, &b, &Pose::default(), 1.0, None).unwrap_err().to_string().contains("got 0"));
}

#[test]
fn a_crossfade_starts_with_the_first_clip_and_continues_at_its_position() {
    let (a, b) = (swing("a", 0.2, 31), swing("b", 1.0, 31));
    let both = crossfade(&a, &b, 0.4).unwrap();
    assert_eq!(both.frame_count(), 49);
    assert_eq!(both.pose(0), a.pose(0));
    assert!(both.rotations(48)[1].dot(b.rotations(30)[1]) > 1.0 - 1e-6);
    let steps =
        (1..49).map(|f| both.pose(f).locals[0].translation.distance(both.pose(f - 1).locals[0].translation));
    assert!(steps.fold(0.0, f32::max) < 0.12, "it does not jump");
    assert!(crossfade(&a, &b, 5.0).is_err());
}

#[test]
fn layers_blend_to_their_weighted_mean_in_any_order() {
    let (a, b, c) = (swing("a", 0.0, 11), swing("b", 0.6, 11), swing("c", 1.2, 11));
    let layer = |of, weight| Layer { of, weight, mask: None };
    let three = blend_layers(&[layer(&a, 2.0), layer(&b, 2.0), layer(&c, 2.0)]).unwrap();
    let reordered = blend_layers(&[layer(&c, 1.0), layer(&a, 1.0), layer(&b, 1.0)]).unwrap();
    let rotated = |angle| Pose {
        locals: vec![RigidTransform {
            rotation: Rotation::from_rotation_x(angle),
            translation: Vec3::X * angle,
        }],
    };
    let (low, middle, high) = (rotated(0.2), rotated(0.6), rotated(1.0));
    let mut mean = Pose::default();
    blend_poses(&[&low, &middle, &high].map(|of| Layer { of, weight: 2.0, mask: None }), &low, &mut mean);
    assert!(mean.locals[0].rotation.abs_diff_eq(middle.locals[0].rotation, 1e-6));
    assert!(mean.locals[0].translation.distance(Vec3::X * 0.6) < 1e-6);
    for frame in 0..11 {
        assert!(three.rotations(frame)[1].abs_diff_eq(reordered.rotations(frame)[1], 1e-6));
    }
    let alone = blend_layers(&[layer(&c, 0.3), layer(&a, 0.0)]).unwrap();
    assert!(alone.rotations(9)[1].dot(c.rotations(9)[1]).abs() > 1.0 - 1e-6);
    let halves = blend_layers(&[layer(&a, 1.0), layer(&b, 1.0)]).unwrap();
    let spherical = blend(&a, &b, 0.5, None).unwrap();
    assert!(halves.rotations(9)[1].dot(spherical.rotations(9)[1]).abs() > 1.0 - 1e-6);
}

#[test]
fn opposite_quaternions_of_one_rotation_do_not_cancel() {
    let a = swing("a", 1.0, 3).pose(2);
    let mut negated = a.clone();
    for local in &mut negated.locals {
        local.rotation = -local.rotation;
    }
    let mut out = Pose::default();
    let layers = [&a, &negated].map(|of| Layer { of, weight: 0.5, mask: None });
    blend_poses(&layers, &a, &mut out);
    assert!(out.locals[1].rotation.abs_diff_eq(a.locals[1].rotation, 1e-6));
}

#[test]
fn masks_weight_joints_and_vanishing_weights_blend_to_rest() {
    let (a, b) = (swing("a", 0.4, 11), swing("b", 1.0, 11));
    let rest = a.skeleton().rest_pose();
    let child = JointMask::below(a.skeleton(), &["child"]).unwrap();
    let mut out = Pose::default();
    let (first, second) = (a.pose(9), b.pose(9));
    let only_child = Layer { of: &second, weight: 1.0, mask: Some(&child) };
    blend_poses(&[only_child], rest, &mut out);
    assert_eq!(out.locals[0], rest.locals[0]);
    assert!(out.locals[1].rotation.dot(second.locals[1].rotation) > 1.0 - 1e-6);
    blend_poses(&[Layer { of: &first, weight: 0.0, mask: None }], rest, &mut out);
    assert_eq!(out, *rest);
    let angle = |weight| {
        let mut out = Pose::default();
        blend_poses(&[Layer { of: &second, weight, mask: None }], rest, &mut out);
        out.locals[1].rotation.angle_between(rest.locals[1].rotation)
    };
    let all = angle(1.0);
    assert!(
        (angle(0.1) - all).abs() < 1e-4
            && (angle(0.05) - all / 2.0).abs() < 0.02 * all
            && angle(0.001) < 0.02 * all
    );
}

#[test]
fn layers_that_cannot_be_blended_are_refused() {
    let a = swing("a", 0.4, 11);
    let error = |layers: &[Layer<'_, Clip>]| blend_layers(layers).unwrap_err().to_string();
    assert!(error(&[]).contains("expected at least one, got none"));
    let layer = |weight| Layer { of: &a, weight, mask: None };
    assert!(error(&[layer(1.0), layer(-0.5)]).contains("layer 1: expected a finite number from 0, got -0.5"));
    assert!(error(&[layer(f32::NAN)]).contains("NaN"));
}
