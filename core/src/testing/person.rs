//! A skeleton of the full rig with round numbers, a clip of it, and the same clip as other programs would write it.

use std::sync::Arc;

use glam::Vec3;

use crate::Side;
use crate::clip::{Clip, TranslationTrack};
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::{BonePositions, JointTree, RigJoint, SidedJoint, Skeleton, model_from_joints};

/// Central joints: name, parent, position in metres.
const CENTRAL: [(&str, &str, [f32; 3]); 8] = [
    ("Root", "", [0.0, 0.0, 0.0]),
    ("pelvis", "Root", [0.0, 0.93, 0.0]),
    ("spine_01", "pelvis", [0.0, 1.0, -0.04]),
    ("spine_02", "spine_01", [0.0, 1.08, -0.03]),
    ("spine_03", "spine_02", [0.0, 1.18, -0.02]),
    ("neck_01", "spine_03", [0.0, 1.47, 0.0]),
    ("head", "neck_01", [0.0, 1.58, 0.03]),
    ("jaw", "head", [0.0, 1.59, 0.05]),
];

/// Left joints: name, parent, position in metres.
const LEFT: [(&str, &str, [f32; 3]); 30] = [
    ("eye", "head", [0.03, 1.63, 0.1]),
    ("clavicle", "spine_03", [0.03, 1.4, 0.02]),
    ("upperarm", "clavicle", [0.16, 1.39, 0.02]),
    ("upperarm_twist_01", "upperarm", [0.16, 1.39, 0.02]),
    ("upperarm_twist_02", "upperarm", [0.305, 1.39, 0.02]),
    ("lowerarm", "upperarm", [0.45, 1.39, 0.02]),
    ("lowerarm_twist_01", "lowerarm", [0.57, 1.39, 0.02]),
    ("lowerarm_twist_02", "lowerarm", [0.69, 1.39, 0.02]),
    ("hand", "lowerarm", [0.69, 1.39, 0.02]),
    ("thumb_01", "hand", [0.72, 1.385, 0.04]),
    ("thumb_02", "thumb_01", [0.735, 1.365, 0.06]),
    ("thumb_03", "thumb_02", [0.755, 1.35, 0.075]),
    ("index_01", "hand", [0.787, 1.385, 0.04]),
    ("index_02", "index_01", [0.81, 1.377, 0.043]),
    ("index_03", "index_02", [0.826, 1.368, 0.045]),
    ("middle_01", "hand", [0.787, 1.387, 0.016]),
    ("middle_02", "middle_01", [0.815, 1.377, 0.012]),
    ("middle_03", "middle_02", [0.837, 1.366, 0.011]),
    ("ring_01", "hand", [0.782, 1.386, -0.002]),
    ("ring_02", "ring_01", [0.805, 1.378, -0.01]),
    ("ring_03", "ring_02", [0.825, 1.369, -0.014]),
    ("pinky_01", "hand", [0.773, 1.381, -0.019]),
    ("pinky_02", "pinky_01", [0.789, 1.374, -0.026]),
    ("pinky_03", "pinky_02", [0.8, 1.367, -0.03]),
    ("thigh", "pelvis", [0.1, 0.92, 0.0]),
    ("thigh_twist_01", "thigh", [0.1, 0.92, 0.0]),
    ("calf", "thigh", [0.14, 0.48, 0.02]),
    ("calf_twist_01", "calf", [0.19, 0.08, -0.01]),
    ("foot", "calf", [0.19, 0.08, -0.01]),
    ("ball", "foot", [0.19, 0.01, 0.115]),
];

/// The far end of a bone that ends in no joint.
fn tail(name: &str, head: Vec3) -> Vec3 {
    let side = Side::of_joint_name(name).map_or(1.0, Side::sign);
    head + match name {
        "pelvis" => Vec3::new(0.0, 0.07, -0.04),
        "head" => Vec3::new(0.0, 0.2, 0.0),
        "jaw" => Vec3::new(0.0, -0.04, 0.06),
        _ if name.starts_with("eye") => Vec3::Z * 0.02,
        _ if name.starts_with("ball") => Vec3::Z * 0.07,
        _ => Vec3::new(0.02 * side, -0.01, 0.0),
    }
}

/// The person at rest, all 68 joints.
pub(crate) fn person() -> Arc<Skeleton> {
    let mut joints: Vec<(String, String, Vec3)> =
        CENTRAL.iter().map(|(n, p, at)| ((*n).to_owned(), (*p).to_owned(), Vec3::from_array(*at))).collect();
    for side in Side::ALL {
        let own = |name: &str| [name, side.joint_suffix()].concat();
        for (name, parent, [x, y, z]) in LEFT {
            let central = CENTRAL.iter().any(|(n, ..)| *n == parent);
            let parent = if central { parent.to_owned() } else { own(parent) };
            joints.push((own(name), parent, Vec3::new(side.sign() * x, y, z)));
        }
    }
    let index = |name: &str| joints.iter().position(|(n, ..)| n == name);
    let parents: Vec<Option<u32>> = joints.iter().map(|(_, p, _)| index(p).map(|p| p as u32)).collect();
    let next = |name: &str| -> Option<Vec3> {
        let limb = match RigJoint::from_name(name).unwrap() {
            RigJoint::Sided(joint, side) => joint.main_joint().on(side).name(),
            joint => joint.name(),
        };
        let main = |child: &str| {
            let child = RigJoint::from_name(child).unwrap();
            !child.is_twist() && child != RigJoint::Jaw && child.sided() != Some(SidedJoint::Eye)
        };
        let wanted = |child: &str| !limb.starts_with("hand") || child.starts_with("middle");
        let wanted = |child: &str| wanted(child) && (limb != "spine_03" || child == "neck_01");
        if limb == "pelvis" || limb == "Root" {
            return None;
        }
        joints.iter().find(|(n, p, _)| p == limb && main(n) && wanted(n)).map(|(.., at)| *at)
    };
    let tails = joints.iter().map(|(name, _, at)| next(name).unwrap_or_else(|| tail(name, *at))).collect();
    let tree = JointTree::new(joints.iter().map(|j| j.0.clone()).collect(), parents).unwrap();
    let shape = BonePositions { heads: joints.iter().map(|j| j.2).collect(), tails };
    Arc::new(shape.skeleton(&Arc::new(tree)).unwrap())
}

/// The rest pose with joints rotated by scaled axes in their own space, degrees.
pub(crate) fn posed(rest: &Skeleton, rotations: &[(&str, [f32; 3])]) -> Vec<RigidTransform> {
    let mut locals = rest.rest_pose().locals.clone();
    for (name, axis) in rotations {
        let axis = Vec3::from_array(*axis).map(f32::to_radians);
        locals[rest.find(name).unwrap()].rotation *= Rotation::from_scaled_axis(axis);
    }
    locals
}

/// A clip of 30 frames a second that travels, waves with the left arm and nods; elbows and knees only bend about X.
pub(crate) fn motion(rest: &Arc<Skeleton>, frames: usize) -> Clip {
    let mut rotations = Vec::new();
    let mut positions = Vec::new();
    for frame in 0..frames {
        let t = frame as f32 * 0.2;
        let (s, c) = libm::sincosf(t);
        let joint_rotations = [
            ("pelvis", [4.0 * s, 60.0 + 10.0 * t, 3.0 * c]),
            ("spine_01", [8.0 * s, 4.0 * c, 2.0]),
            ("spine_02", [3.0 * c, 6.0 * s, 0.0]),
            ("spine_03", [6.0 * s, 5.0 * s, 3.0 * c]),
            ("neck_01", [5.0 * s, 10.0 * c, 0.0]),
            ("head", [15.0 * s, 20.0 * c, 5.0]),
            ("clavicle_l", [0.0, 0.0, 10.0 + 5.0 * s]),
            ("upperarm_l", [20.0, 30.0 * s, 40.0 + 20.0 * c]),
            ("lowerarm_l", [70.0 + 40.0 * s, 0.0, 0.0]),
            ("hand_l", [5.0, -50.0 + 20.0 * s, -20.0 * c]),
            ("index_01_l", [0.0, 0.0, -30.0]),
            ("index_02_l", [0.0, 0.0, -30.0]),
            ("upperarm_r", [10.0 * s, 15.0, 70.0]),
            ("lowerarm_r", [20.0 + 10.0 * c, 0.0, 0.0]),
            ("hand_r", [0.0, 30.0, 10.0 * s]),
            ("thigh_l", [25.0 * s, 5.0, 4.0]),
            ("calf_l", [-30.0 + 20.0 * c, 0.0, 0.0]),
            ("foot_l", [10.0 * c, 4.0, 3.0]),
            ("ball_l", [10.0 + 10.0 * s, 0.0, 0.0]),
            ("thigh_r", [-25.0 * s, -6.0, 2.0]),
            ("calf_r", [-45.0 - 20.0 * c, 0.0, 0.0]),
            ("foot_r", [-8.0 * c, 0.0, 0.0]),
        ];
        rotations.extend(posed(rest, &joint_rotations).iter().map(|local| local.rotation));
        positions.push(Vec3::new(0.3 * s, 0.9 + 0.03 * c, 0.5 * t));
    }
    let track =
        TranslationTrack { joint: rest.rig_joint(RigJoint::Pelvis).unwrap() as u32, values: positions };
    Clip::new("motion".into(), rest.clone(), 30.0, rotations, vec![track]).unwrap()
}

/// How another program writes a clip of [`person`].
pub(crate) struct Style<'a> {
    /// New names; `None` drops a joint without children.
    pub(crate) rename: &'a dyn Fn(&str) -> Option<String>,
    /// The rest pose, `parent_from_joint` of [`person`]'s joints.
    pub(crate) rest: Vec<RigidTransform>,
    /// Rotation of the rest pose about +Y, radians.
    pub(crate) facing: f32,
    /// Whether every joint's own axes are rotated.
    pub(crate) frames: bool,
    /// Scale of all lengths.
    pub(crate) scale: f32,
}

/// The clip in another style, with the same motion in model space but for the scale.
pub(crate) fn restyled(clip: &Clip, style: &Style) -> Clip {
    let ours = clip.skeleton();
    let kept: Vec<usize> = (0..ours.len()).filter(|&j| (style.rename)(&ours.names()[j]).is_some()).collect();
    let index = |j: u32| kept.iter().position(|&k| k == j as usize).map(|k| k as u32);
    let parents: Vec<Option<u32>> = kept.iter().map(|&j| ours.parents()[j].and_then(index)).collect();
    let axes = |j: usize| {
        let axis = Vec3::new(1.3 * j as f32, 0.7 - j as f32, 0.4 * j as f32);
        if style.frames { Rotation::from_scaled_axis(axis) } else { Rotation::IDENTITY }
    };
    let locals_of = |pose: &[RigidTransform], facing: Rotation| -> Vec<RigidTransform> {
        let mut model = Vec::new();
        model_from_joints(ours.parents(), pose, &mut model);
        let model: Vec<RigidTransform> = kept
            .iter()
            .map(|&j| RigidTransform {
                rotation: facing * model[j].rotation * axes(j),
                translation: facing * model[j].translation * style.scale,
            })
            .collect();
        let local = |j: usize| parents[j].map_or(model[j], |p| model[p as usize].inverse().then(model[j]));
        (0..model.len()).map(local).collect()
    };
    let names = kept.iter().filter_map(|&j| (style.rename)(&ours.names()[j])).collect();
    let ends =
        kept.iter().map(|&j| ours.ends()[j].map(|end| axes(j).conjugate() * end * style.scale)).collect();
    let facing = Rotation::from_rotation_y(style.facing);
    let rest = Skeleton::new(names, parents.clone(), locals_of(&style.rest, facing), ends).unwrap();
    let mut rotations = Vec::new();
    let pelvis = index(ours.rig_joint(RigJoint::Pelvis).unwrap() as u32).unwrap();
    let mut values = Vec::new();
    for frame in 0..clip.frame_count() {
        let locals = locals_of(&clip.pose(frame).locals, Rotation::IDENTITY);
        values.push(locals[pelvis as usize].translation);
        rotations.extend(locals.iter().map(|local| local.rotation));
    }
    let track = TranslationTrack { joint: pelvis, values };
    Clip::new(clip.name().into(), Arc::new(rest), clip.frames_per_second(), rotations, vec![track]).unwrap()
}
