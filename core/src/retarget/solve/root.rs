//! Where the body stands: the middle of the hips follows the source's, scaled by the length of the legs.

use glam::Vec3;

use super::super::JointMap;
use super::bones::Bone;
use super::{Joints, Reference, RootMotion};
use crate::Side;
use crate::clip::Clip;
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::{RigJoint, SidedJoint, model_from_joints};

/// Of the frames, those whose lowest foot is taken for standing on the floor at least: less would follow noise, more
/// would sink who steps off it.
const FLOOR_FRAMES: f32 = 0.02;

/// The way of the pelvis.
#[derive(Clone, Debug)]
pub(super) struct Root {
    pub(super) pelvis: usize,
    parent: Option<usize>,
    thighs: [usize; 2],
    /// From the pelvis to the middle of the hip joints, in the pelvis' space.
    hips: Vec3,
    pub(super) scale: f32,
    /// Joints of the feet and their heights at rest, above the floor.
    feet: Vec<(usize, f32)>,
}

impl Root {
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
            pelvis,
            parent: target.parents()[pelvis].map(|p| p as usize),
            thighs,
            hips: target_rest[pelvis].inverse().to_affine().transform_point3(hips),
            scale,
            feet: feet.map(|j| (j, target_rest[j].translation.y)).collect(),
        })
    }

    /// Where the pelvis is, by the source's pose and its own rotation, both in model space.
    pub(super) fn place(&self, source: &[RigidTransform], rotation: Rotation) -> Vec3 {
        let [l, r] = self.thighs;
        (source[l].translation + source[r].translation) / 2.0 * self.scale - rotation * self.hips
    }

    /// How far the feet would stand above the floor, metres: what to lower the body by. `places` are the pelvis',
    /// frame by frame, in model space.
    pub(super) fn above_floor(&self, joints: &Joints, rotations: &[Rotation], places: &[Vec3]) -> f32 {
        let parents = joints.target.parents();
        let mut locals = joints.target.rest_pose().locals.clone();
        let mut model = Vec::new();
        let mut lowest: Vec<f32> = Vec::with_capacity(places.len());
        for (frame, place) in rotations.chunks_exact(locals.len()).zip(places) {
            for (local, rotation) in locals.iter_mut().zip(frame) {
                local.rotation = *rotation;
            }
            model_from_joints(parents, &locals, &mut model);
            let pelvis = model[self.pelvis].translation.y;
            let foot = self.feet.iter().map(|(j, height)| model[*j].translation.y - height);
            lowest.push(foot.fold(f32::INFINITY, f32::min) - pelvis + place.y);
        }
        lowest.sort_by(f32::total_cmp);
        let at = (FLOOR_FRAMES * (lowest.len() - 1) as f32) as usize;
        if self.feet.is_empty() { 0.0 } else { lowest[at] }
    }

    /// Translations of Root and pelvis in their parents, from the pelvis' places in model space.
    pub(super) fn split(
        &self,
        joints: &Joints,
        motion: RootMotion,
        places: Vec<Vec3>,
    ) -> Vec<(usize, Vec<Vec3>)> {
        let rest = &joints.target_rest;
        let Some(root) = self.parent else { return vec![(self.pelvis, places)] };
        let from_root = rest[root].inverse();
        let in_root = |place: &Vec3| from_root.to_affine().transform_point3(*place);
        match motion {
            RootMotion::Pelvis => vec![(self.pelvis, places.iter().map(in_root).collect())],
            RootMotion::Root => {
                let hips = rest[self.pelvis].translation;
                let way: Vec<Vec3> = places.iter().map(|place| (*place - hips).with_y(0.0)).collect();
                let pelvis = places.iter().zip(&way).map(|(place, way)| in_root(&(*place - *way))).collect();
                let above = joints.target.parents()[root].map(|p| rest[p as usize].inverse());
                let of_root = |way: &Vec3| {
                    let place = rest[root].translation + *way;
                    above.map_or(place, |from_model| from_model.to_affine().transform_point3(place))
                };
                vec![(root, way.iter().map(of_root).collect()), (self.pelvis, pelvis)]
            }
        }
    }
}

/// The target's leg to the source's: thigh, calf, and how far the ankle stands above the ball of the foot.
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
    /// Where a frame's joints are: `model_from_joint`.
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
