//! Position of the body: the midpoint of the hips follows the source's, scaled by the ratio of leg lengths.

use glam::Vec3;

use super::super::JointMap;
use super::bones::Bone;
use super::{Joints, Reference, RootMotion};
use crate::Side;
use crate::clip::Clip;
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::{RigJoint, SidedJoint, model_from_joints};

/// The quantile, over the frames, of the lower foot's height that is taken for the floor: a lower one would follow noise, a
/// higher one would sink a body that steps off the floor.
const FLOOR_FRAMES: f32 = 0.02;

/// The motion of the pelvis.
#[derive(Clone, Debug)]
pub(super) struct PelvisMotion {
    /// The target's pelvis.
    pub(super) joint: usize,
    parent: Option<usize>,
    /// The source's thighs.
    thighs: [usize; 2],
    /// Midpoint of the target's hip joints, in the pelvis' space, metres.
    hips: Vec3,
    pub(super) scale: f32,
    /// The target's joints of the feet and their heights above the floor at rest, metres.
    feet: Vec<(usize, f32)>,
}

impl PelvisMotion {
    pub(super) fn new(reference: &Reference, scale: Option<f32>) -> Option<Self> {
        let Joints { target, target_rest, .. } = reference.joints;
        let pelvis = target.rig_joint(RigJoint::Pelvis)?;
        let middle = |model: &[RigidTransform], [l, r]: [usize; 2]| {
            (model[l].translation + model[r].translation) / 2.0
        };
        let [left, right] = SidedJoint::Thigh.both();
        let of_target = [target.rig_joint(left)?, target.rig_joint(right)?];
        let thighs = [reference.map.source_of(left)?, reference.map.source_of(right)?];
        let hips = middle(target_rest, of_target);
        let scale = scale.unwrap_or_else(|| leg_ratio(reference.map, reference.joints));
        let feet = [SidedJoint::Foot, SidedJoint::Ball].into_iter().flat_map(SidedJoint::both);
        let feet = feet.filter_map(|joint| target.rig_joint(joint));
        Some(Self {
            joint: pelvis,
            parent: target.parents()[pelvis].map(|p| p as usize),
            thighs,
            hips: target_rest[pelvis].inverse().to_affine().transform_point3(hips),
            scale,
            feet: feet.map(|j| (j, target_rest[j].translation.y)).collect(),
        })
    }

    /// Position of the pelvis, from the source's pose and its own rotation, all in model space; metres.
    pub(super) fn position(&self, source: &[RigidTransform], rotation: Rotation) -> Vec3 {
        let [l, r] = self.thighs;
        (source[l].translation + source[r].translation) / 2.0 * self.scale - rotation * self.hips
    }

    /// How far the feet are above the floor, metres, by which the body is to be lowered. `rotations` are those of
    /// `parent_from_joint` (frames × joints), `positions` those of the pelvis in model space.
    pub(super) fn height_above_floor(
        &self,
        joints: &Joints,
        rotations: &[Rotation],
        positions: &[Vec3],
    ) -> f32 {
        let parents = joints.target.parents();
        let mut locals = joints.target.rest_pose().locals.clone();
        let mut model = Vec::new();
        let mut lowest: Vec<f32> = Vec::with_capacity(positions.len());
        for (frame, position) in rotations.chunks_exact(locals.len()).zip(positions) {
            for (local, rotation) in locals.iter_mut().zip(frame) {
                local.rotation = *rotation;
            }
            model_from_joints(parents, &locals, &mut model);
            let pelvis = model[self.joint].translation.y;
            let foot = self.feet.iter().map(|(j, height)| model[*j].translation.y - height);
            lowest.push(foot.fold(f32::INFINITY, f32::min) - pelvis + position.y);
        }
        lowest.sort_by(f32::total_cmp);
        let at = (FLOOR_FRAMES * (lowest.len() - 1) as f32) as usize;
        if self.feet.is_empty() { 0.0 } else { lowest[at] }
    }

    /// Translation tracks of root and pelvis, relative to their parents, from positions of the pelvis in model space.
    pub(super) fn translations(
        &self,
        joints: &Joints,
        motion: RootMotion,
        positions: Vec<Vec3>,
    ) -> Vec<(usize, Vec<Vec3>)> {
        let rest = &joints.target_rest;
        let Some(root) = self.parent else { return vec![(self.joint, positions)] };
        let root_from_model = rest[root].inverse();
        let in_root = |position: &Vec3| root_from_model.to_affine().transform_point3(*position);
        match motion {
            RootMotion::Pelvis => vec![(self.joint, positions.iter().map(in_root).collect())],
            RootMotion::Root => {
                let at_rest = rest[self.joint].translation;
                let travel: Vec<Vec3> =
                    positions.iter().map(|position| (*position - at_rest).with_y(0.0)).collect();
                let pelvis =
                    positions.iter().zip(&travel).map(|(position, by)| in_root(&(*position - *by))).collect();
                let parent_from_model = joints.target.parents()[root].map(|p| rest[p as usize].inverse());
                let of_root = |by: &Vec3| {
                    let position = rest[root].translation + *by;
                    parent_from_model.map_or(position, |parent| parent.to_affine().transform_point3(position))
                };
                vec![(root, travel.iter().map(of_root).collect()), (self.joint, pelvis)]
            }
        }
    }
}

/// Ratio of the target's leg length to the source's: thigh, calf, and height of the ankle above the ball of the foot.
fn leg_ratio(map: &JointMap, joints: &Joints) -> f32 {
    let (mut source, mut target) = (0.0, 0.0);
    for side in Side::ALL {
        for joint in [SidedJoint::Thigh, SidedJoint::Calf, SidedJoint::Foot] {
            let Some(bone) = Bone::of(joint.on(side), map, joints.source, joints.target) else {
                continue;
            };
            let (theirs, ours) = (bone.of_source(&joints.source_rest), bone.of_target(&joints.target_rest));
            if joint == SidedJoint::Foot {
                source += theirs.y.abs();
                target += ours.y.abs();
            } else {
                source += theirs.length();
                target += ours.length();
            }
        }
    }
    if source > 1e-4 && target > 1e-4 { target / source } else { 1.0 }
}

impl Clip {
    /// Forward kinematics of a frame: fills `model` with `model_from_joint`.
    pub(super) fn model_into(
        &self,
        frame: usize,
        pose: &mut crate::skeleton::Pose,
        model: &mut Vec<RigidTransform>,
    ) {
        self.pose_into(frame, pose);
        model_from_joints(self.skeleton().parents(), &pose.locals, model);
    }
}
