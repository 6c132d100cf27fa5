//! The rest pose of a file whose joints were saved in another one: nodes may hold a frame of the motion, as in exports of the
//! current frame, while the skin still knows the pose that it was bound in.

use glam::DQuat;

use crate::math::{RigidTransform, RigidTransformF64};
use crate::skeleton::model_from_joints;

/// Rotations that differ by less count as the same, radians (0.2°).
const SAME: f64 = 0.0035;
/// How far the length of a bone may be off, as a part of it, and how many of the bones must be within that.
const OFF: f64 = 0.05;
const WITHIN: f64 = 0.8;
/// A bind pose that is turned by more against the nodes is in a space that is not known, radians (75°).
const ASTRAY: f64 = 1.3;

/// `parent_from_joint` of every joint in the bind pose. `nodes` is the same as the nodes hold it; `bind` is `model_from_joint`
/// of the joints whose bind pose is known, all in one space, from which one of `turns` leads to model space. `None` where both
/// are the same pose, or where the lengths of bones show that the bind matrices are of something else.
pub(crate) fn rest_from_bind(
    nodes: &[RigidTransform],
    parents: &[Option<u32>],
    bind: &[Option<RigidTransformF64>],
    turns: &[DQuat],
) -> Option<Vec<RigidTransform>> {
    if !same_bones(nodes, parents, bind) {
        return None;
    }
    let mut model = Vec::new();
    model_from_joints(parents, nodes, &mut model);
    let above = |joint: usize| parents[joint].map(|parent| parent as usize);
    let angle = |turn: DQuat, joint: usize, bind: &RigidTransformF64| {
        let node: DQuat = model[joint].rotation.into();
        (turn * bind.rotation).angle_between(node)
    };
    // The joints from which the others hang tell the space: they are turned the least.
    let known = || bind.iter().enumerate().filter_map(|(joint, bind)| Some((joint, bind.as_ref()?)));
    let tops = || known().filter(|(joint, _)| above(*joint).is_none_or(|parent| bind[parent].is_none()));
    let most = |turn: DQuat| tops().map(|(joint, bind)| angle(turn, joint, bind)).fold(0.0, f64::max);
    let turn = turns.iter().copied().min_by(|a, b| most(*a).total_cmp(&most(*b)))?;
    if most(turn) > ASTRAY || known().all(|(joint, bind)| angle(turn, joint, bind) < SAME) {
        return None;
    }
    let mut rest: Vec<RigidTransform> = Vec::with_capacity(nodes.len());
    let mut world: Vec<DQuat> = Vec::with_capacity(nodes.len());
    for (joint, node) in nodes.iter().enumerate() {
        let parent = above(joint).map_or(DQuat::IDENTITY, |parent| world[parent]);
        let own = match &bind[joint] {
            Some(bind) => (turn * bind.rotation).normalize(),
            None => parent * DQuat::from(node.rotation),
        };
        world.push(own);
        rest.push(RigidTransform { rotation: (parent.conjugate() * own).normalize().into(), ..*node });
    }
    Some(rest)
}

/// Whether the bones have the same lengths in both, up to one scale: lengths do not depend on the pose.
fn same_bones(nodes: &[RigidTransform], parents: &[Option<u32>], bind: &[Option<RigidTransformF64>]) -> bool {
    let bone = |(joint, node): (usize, &RigidTransform)| {
        let parent = parents[joint].and_then(|parent| bind[parent as usize])?;
        let length = bind[joint]?.relative_to(parent).translation.length();
        Some((f64::from(node.translation.length()), length))
    };
    let bones: Vec<(f64, f64)> = nodes.iter().enumerate().filter_map(bone).collect();
    let longest = bones.iter().map(|(node, _)| *node).fold(0.0, f64::max);
    let mut ratios: Vec<f64> = bones
        .iter()
        .filter(|(node, bind)| *node > 0.02 * longest && *bind > 0.0)
        .map(|(node, bind)| node / bind)
        .collect();
    ratios.sort_by(f64::total_cmp);
    let Some(middle) = ratios.get(ratios.len() / 2).copied() else { return false };
    let good = ratios.iter().filter(|ratio| (*ratio / middle - 1.0).abs() < OFF).count();
    good as f64 >= WITHIN * ratios.len() as f64
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::math::Rotation;

    fn chain(angles: [f32; 3]) -> Vec<RigidTransform> {
        let local =
            |angle: f32| RigidTransform { rotation: Rotation::from_rotation_x(angle), translation: Vec3::Y };
        angles.map(local).to_vec()
    }

    fn bound(locals: &[RigidTransform], scale: f64) -> Vec<Option<RigidTransformF64>> {
        let mut model = Vec::new();
        model_from_joints(&PARENTS, locals, &mut model);
        let bind = |m: &RigidTransform| RigidTransformF64 {
            rotation: m.rotation.into(),
            translation: m.translation.as_dvec3() * scale,
        };
        model.iter().map(|m| Some(bind(m))).collect()
    }

    const PARENTS: [Option<u32>; 3] = [None, Some(0), Some(1)];

    #[test]
    fn the_pose_of_the_skin_takes_the_place_of_that_of_the_nodes() {
        let (posed, straight) = (chain([0.2, 0.4, -0.3]), chain([0.0; 3]));
        let turns = [DQuat::from_rotation_x(-1.57), DQuat::IDENTITY];
        for scale in [1.0, 100.0] {
            let rest = rest_from_bind(&posed, &PARENTS, &bound(&straight, scale), &turns).unwrap();
            for (rest, wanted) in rest.iter().zip(&straight) {
                assert!(rest.rotation.angle_between(wanted.rotation) < 1e-3);
                assert_eq!(rest.translation, wanted.translation);
            }
        }
        let mut partly = bound(&straight, 1.0);
        partly[2] = None;
        let rest = rest_from_bind(&posed, &PARENTS, &partly, &turns).unwrap();
        assert!(rest[2].rotation.angle_between(posed[2].rotation) < 1e-3, "it follows its parent");
    }

    #[test]
    fn the_nodes_stay_where_both_agree_or_the_skin_is_of_something_else() {
        let posed = chain([0.2, 0.4, -0.3]);
        let turns = [DQuat::IDENTITY];
        assert_eq!(rest_from_bind(&posed, &PARENTS, &bound(&posed, 1.0), &turns), None);
        assert_eq!(rest_from_bind(&posed, &PARENTS, &[None; 3], &turns), None);
        let mut other = bound(&chain([0.0; 3]), 1.0);
        other[1].as_mut().unwrap().translation = DVec3::Y * 7.0;
        assert_eq!(rest_from_bind(&posed, &PARENTS, &other, &turns), None);
        let lying = bound(&chain([1.57, 0.0, 0.0]), 1.0);
        assert_eq!(rest_from_bind(&chain([0.0; 3]), &PARENTS, &lying, &turns), None);
    }
}
