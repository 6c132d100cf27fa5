//! Poses and forward kinematics.

use crate::math::RigidTransform;

/// A pose: one transform per joint, relative to its parent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// `parent_from_joint` of each joint, metres, in the order of the joints.
    pub locals: Vec<RigidTransform>,
}

impl Pose {
    /// Forward kinematics: `model_from_joint` of each joint, metres; see [`model_from_joints`].
    pub fn model_from_joints(&self, parents: &[Option<u32>]) -> Vec<RigidTransform> {
        let mut out = Vec::with_capacity(self.locals.len());
        model_from_joints(parents, &self.locals, &mut out);
        out
    }
}

/// Forward kinematics: fills `out` with `model_from_joint` of each joint, the product of the `parent_from_joint` in `locals`
/// from its root down. Parents come before their joints; a parent that does not is ignored.
pub fn model_from_joints(parents: &[Option<u32>], locals: &[RigidTransform], out: &mut Vec<RigidTransform>) {
    out.clear();
    for (parent, local) in parents.iter().zip(locals) {
        let above = parent.and_then(|p| out.get(p as usize).copied());
        out.push(above.map_or(*local, |above: RigidTransform| above.then(*local)));
    }
}

/// These joints and all above them, parents first.
pub(crate) fn with_ancestors(parents: &[Option<u32>], joints: impl IntoIterator<Item = usize>) -> Vec<usize> {
    let mut wanted = vec![false; parents.len()];
    for joint in joints {
        let chain = std::iter::successors(Some(joint), |j| parents[*j].map(|parent| parent as usize));
        chain.for_each(|j| wanted[j] = true);
    }
    (0..parents.len()).filter(|j| wanted[*j]).collect()
}

/// As [`model_from_joints`] for `joints` alone, which are [`with_ancestors`]; the others are of no use in `out`.
pub(crate) fn model_from_some_joints(
    parents: &[Option<u32>],
    locals: &[RigidTransform],
    joints: &[usize],
    out: &mut Vec<RigidTransform>,
) {
    out.resize(locals.len(), RigidTransform::IDENTITY);
    for &joint in joints {
        out[joint] = parents[joint].map_or(locals[joint], |parent| out[parent as usize].then(locals[joint]));
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;
    use crate::math::Rotation;
    use crate::space::Space;
    use glam::Vec3;

    #[test]
    fn a_chain_ends_at_the_same_point_in_every_space() {
        let step = |angle| RigidTransform {
            rotation: Rotation::from_rotation_x(angle),
            translation: Vec3::new(1.0, 2.0, 3.0),
        };
        let (root, child) = (step(0.3), step(-1.1));
        for space in [Space::Gltf, Space::Blender, Space::Unity] {
            let there = [root.parent_from_joint_in(space, None), child.parent_from_joint_in(space, Some(0))];
            let end = there[0].then(there[1]);
            let expected = root.then(child).model_from_joint_in(space);
            assert!(end.translation.distance(expected.translation) < 1e-6, "{space:?}");
            assert!(end.rotation.dot(expected.rotation).abs() > 1.0 - 1e-6, "{space:?}");
            let back = there[0].parent_from_joint_out_of(space, None);
            assert!(back.translation == root.translation && back.rotation.dot(root.rotation) > 1.0 - 1e-6);
            assert_eq!(there[1].parent_from_joint_out_of(space, Some(0)), child);
        }
    }

    #[test]
    fn some_joints_are_where_they_are_among_all() {
        let local = |angle| RigidTransform {
            rotation: Rotation::from_rotation_x(angle),
            translation: Vec3::new(1.0, angle, 3.0),
        };
        let parents = [None, Some(0), Some(0), Some(2), Some(1), None];
        let locals: Vec<_> = [0.1, 0.7, -0.3, 1.9, 0.2, 0.4].map(local).to_vec();
        let joints = with_ancestors(&parents, [3, 5]);
        assert_eq!(joints, [0, 2, 3, 5]);
        let (mut all, mut some) = (Vec::new(), Vec::new());
        model_from_joints(&parents, &locals, &mut all);
        model_from_some_joints(&parents, &locals, &joints, &mut some);
        assert_eq!(joints.iter().map(|j| some[*j]).collect::<Vec<_>>(), [all[0], all[2], all[3], all[5]]);
    }

    #[test]
    fn an_elbow_bent_by_a_right_angle() {
        let step = RigidTransform { rotation: Rotation::IDENTITY, translation: Vec3::X };
        let bent = RigidTransform { rotation: Rotation::from_rotation_z(FRAC_PI_2), ..step };
        let pose = Pose { locals: vec![step, bent, step] };
        let joints = pose.model_from_joints(&[None, Some(0), Some(1)]);
        assert!(joints[2].translation.distance(Vec3::new(2.0, 1.0, 0.0)) < 1e-6);
        let matrix = step.to_affine() * bent.to_affine() * step.to_affine();
        assert!((matrix.translation - joints[2].to_affine().translation).length() < 1e-6);
        let back = joints[2].inverse().then(joints[2]);
        assert!(back.translation.length() < 1e-6 && back.rotation.angle_between(Rotation::IDENTITY) < 1e-3);
    }
}
