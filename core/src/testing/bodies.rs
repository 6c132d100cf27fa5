//! Three skeletons of the rig with very different proportions about those of the model's mean bodies, made without the model.

use std::sync::Arc;

use glam::Vec3;

use crate::Side;
use crate::skeleton::{BonePositions, JointTree, SidedJoint, Skeleton};

/// A central or left joint: name, parent, head and tail as shares of the body's height.
type Row = (&'static str, &'static str, [f32; 3], [f32; 3]);

const CENTRAL: [Row; 7] = [
    ("Root", "", [0., 0., 0.], [0., 0.1, 0.]),
    ("pelvis", "Root", [0., 0.53, 0.], [0., 0.575, -0.025]),
    ("spine_01", "pelvis", [0., 0.575, -0.025], [0., 0.615, -0.015]),
    ("spine_02", "spine_01", [0., 0.615, -0.015], [0., 0.67, -0.01]),
    ("spine_03", "spine_02", [0., 0.67, -0.01], [0., 0.84, -0.005]),
    ("neck_01", "spine_03", [0., 0.84, -0.005], [0., 0.905, 0.02]),
    ("head", "neck_01", [0., 0.905, 0.02], [0., 1.0, 0.02]),
];

const LEFT: [Row; 11] = [
    ("clavicle", "spine_03", [0.015, 0.8, 0.01], [0.1, 0.79, 0.01]),
    ("upperarm", "clavicle", [0.1, 0.79, 0.01], [0.265, 0.79, 0.01]),
    ("upperarm_twist_01", "upperarm", [0.1, 0.79, 0.01], [0.18, 0.79, 0.01]),
    ("lowerarm", "upperarm", [0.265, 0.79, 0.01], [0.405, 0.79, 0.01]),
    ("hand", "lowerarm", [0.405, 0.79, 0.01], [0.46, 0.787, 0.015]),
    ("index_01", "hand", [0.46, 0.785, 0.025], [0.47, 0.782, 0.026]),
    ("thigh", "pelvis", [0.064, 0.515, -0.005], [0.088, 0.288, 0.012]),
    ("calf", "thigh", [0.088, 0.288, 0.012], [0.113, 0.04, 0.0]),
    ("foot", "calf", [0.113, 0.04, 0.0], [0.114, 0.0055, 0.0745]),
    ("ball", "foot", [0.114, 0.0055, 0.0745], [0.1115, 0.0065, 0.118]),
    ("calf_twist_01", "calf", [0.113, 0.04, 0.0], [0.12, 0.02, 0.0]),
];

const LEG: [SidedJoint; 4] = [SidedJoint::Thigh, SidedJoint::Calf, SidedJoint::Foot, SidedJoint::Ball];

/// Short with short legs, tall with long legs, and wide with long arms and feet apart.
pub(crate) fn bodies() -> Vec<(&'static str, Arc<Skeleton>)> {
    [
        ("short", 1.49, Vec3::new(1.0, 0.93, 1.0), 1.0),
        ("tall", 1.99, Vec3::new(0.9, 1.05, 0.95), 0.95),
        ("wide", 1.7, Vec3::new(1.5, 1.0, 1.2), 1.2),
    ]
    .map(|(name, height, legs, width)| (name, Arc::new(body(height, legs, width))))
    .to_vec()
}

/// Scales the legs by `legs`, lifts the upper body by what that adds, and scales its width by `width`.
fn body(height: f32, legs: Vec3, width: f32) -> Skeleton {
    let lift = (legs.y - 1.0) * 0.515;
    let position = |name: &str, [x, y, z]: [f32; 3]| {
        let leg = LEG.iter().any(|joint| name.starts_with(joint.name()));
        let at = match (name, leg) {
            ("Root", _) => return Vec3::ZERO,
            (_, true) => Vec3::new(x, y, z) * legs,
            _ => Vec3::new(x * width, y + lift, z),
        };
        at * height
    };
    let left = LEFT.map(|(name, parent, head, tail)| (name, parent, head, tail, Side::Left.joint_suffix()));
    let right = LEFT.map(|(name, parent, head, tail)| {
        let mirror = |[x, y, z]: [f32; 3]| [-x, y, z];
        (name, parent, mirror(head), mirror(tail), Side::Right.joint_suffix())
    });
    let central = CENTRAL.map(|(name, parent, head, tail)| (name, parent, head, tail, ""));
    let (mut names, mut parents, mut shape) = (Vec::<String>::new(), Vec::new(), BonePositions::default());
    for (name, parent, head, tail, side) in central.into_iter().chain(left).chain(right) {
        let found = [format!("{parent}{side}"), parent.to_owned()]
            .iter()
            .find_map(|p| names.iter().position(|n| n == p));
        parents.push(found.map(|p| p as u32));
        names.push(format!("{name}{side}"));
        shape.heads.push(position(name, head));
        shape.tails.push(if name == "Root" { Vec3::Y } else { position(name, tail) });
    }
    shape.skeleton(&Arc::new(JointTree::new(names, parents).unwrap())).unwrap()
}
