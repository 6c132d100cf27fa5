//! Angles between parts of the body in a retargeted clip and in its source.

use glam::{DVec3, Vec3};
use serde::Serialize;

use super::super::JointMap;
use super::bones::{Bone, LIMB_BONES};
use super::reference::Reference;
use super::{FootMode, Joints};
use crate::Side;
use crate::clip::Clip;
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::{Pose, RigJoint, SidedJoint};

/// Angle between a part of the body in source and target, over the frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BoneError {
    /// The joint of the rig at which a bone begins, or `hips`, `spine`, `shoulders`, `palm_l`, `palm_r`, `sole_l`, `sole_r`.
    pub bone: String,
    /// Mean over the frames, degrees.
    pub mean: f64,
    /// Maximum over the frames, degrees.
    pub max: f64,
}

/// The result of [`direction_error`]. Parts that source or target lacks are left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DirectionError {
    /// Upper arms, forearms, thighs and calves.
    pub limbs: Vec<BoneError>,
    /// Hands and feet. The bone of a flat foot has different slopes in different skeletons; with
    /// [`FootMode::Sole`](super::FootMode::Sole) its error is that difference.
    pub ends: Vec<BoneError>,
    /// The lines through the `hips` and through the `shoulders`, the `spine` from the middle of hips to that of shoulders, and how
    /// `neck_01` and `head` have turned since the pose in which both skeletons stand, as their slopes differ by design.
    /// The error of a spine contains how differently two skeletons lean when they stand.
    pub trunk: Vec<BoneError>,
    /// Rolls about the bones of hands and feet: of the `palm`, where the source has knuckles of index and little finger, and of
    /// the `sole` since the pose in which both skeletons stand.
    pub rolls: Vec<BoneError>,
    /// The part of all these with the largest mean.
    pub worst: Option<BoneError>,
}

impl DirectionError {
    /// Mean over [`limbs`](Self::limbs), degrees; 0 without any.
    pub fn mean(&self) -> f64 {
        mean(&self.limbs)
    }

    /// Mean over [`trunk`](Self::trunk), degrees; 0 without any.
    pub fn trunk_mean(&self) -> f64 {
        mean(&self.trunk)
    }

    /// Mean over [`rolls`](Self::rolls), degrees; 0 without any.
    pub fn roll_mean(&self) -> f64 {
        mean(&self.rolls)
    }

    /// Maximum over [`limbs`](Self::limbs) in any frame, degrees.
    pub fn max(&self) -> f64 {
        self.limbs.iter().map(|bone| bone.max).fold(0.0, f64::max)
    }
}

fn mean(parts: &[BoneError]) -> f64 {
    parts.iter().map(|part| part.mean).sum::<f64>() / parts.len().max(1) as f64
}

/// Compares the directions of parts of the body in model space, in the frames that both clips have. The source's rest pose is
/// the pose in which it stands.
pub fn direction_error(source: &Clip, target: &Clip, map: &JointMap) -> DirectionError {
    direction_error_from(source, source.skeleton().model_from_joints(), target, map)
}

/// As [`direction_error`], with a pose in which the source stands, `model_from_joint`.
pub(in crate::retarget) fn direction_error_from(
    source: &Clip,
    source_rest: Vec<RigidTransform>,
    target: &Clip,
    map: &JointMap,
) -> DirectionError {
    let joints = Joints {
        source: source.skeleton(),
        target: target.skeleton(),
        source_rest,
        target_rest: target.skeleton().model_from_joints(),
    };
    let mut parts = parts(&Reference::new(map, &joints));
    let (mut pose, mut theirs, mut ours) = (Pose::default(), Vec::new(), Vec::new());
    for frame in 0..source.frame_count().min(target.frame_count()) {
        source.model_into(frame, &mut pose, &mut theirs);
        target.model_into(frame, &mut pose, &mut ours);
        for part in &mut parts {
            part.add(&theirs, &ours);
        }
    }
    let mut result = DirectionError::default();
    for part in parts.into_iter().filter(|part| part.frames > 0) {
        let error = BoneError { bone: part.name, mean: part.sum / part.frames as f64, max: part.max };
        if result.worst.as_ref().is_none_or(|worst| error.mean > worst.mean) {
            result.worst = Some(error.clone());
        }
        match part.group {
            Group::Limb => &mut result.limbs,
            Group::End => &mut result.ends,
            Group::Trunk => &mut result.trunk,
            Group::Roll => &mut result.rolls,
        }
        .push(error);
    }
    result
}

#[derive(Clone, Copy)]
enum Group {
    Limb,
    End,
    Trunk,
    Roll,
}

/// How the angle of a part is found.
enum Measure {
    /// Between bones.
    Bone(Bone),
    /// Between lines from the second joint to the first: of the source, of the target.
    Line([usize; 2], [usize; 2]),
    /// Between lines from the middle of the first two joints to the middle of the others.
    Middles([usize; 4], [usize; 4]),
    /// Between lines from the second joint to the first. This correction, in the space of the source's joint below them, takes that
    /// of the source to that of the target in the pose in which both stand.
    Turned { source: [usize; 2], target: [usize; 2], below: usize, correction: Rotation },
    /// From where the joint of the source, turned by this offset, would have the target's to where that is.
    Turn { source: usize, target: usize, offset: Rotation },
    /// About a bone, between the lines from the second joint to the first.
    RollOfLine(Bone, [usize; 2], [usize; 2]),
    /// The part of a turn about the target's bone, seen on a direction in the target joint's space.
    RollOfTurn(Bone, Rotation, Vec3),
}

struct Part {
    name: String,
    group: Group,
    measure: Measure,
    sum: f64,
    max: f64,
    frames: usize,
}

impl Part {
    fn new(name: impl Into<String>, group: Group, measure: Measure) -> Self {
        Self { name: name.into(), group, measure, sum: 0.0, max: 0.0, frames: 0 }
    }

    fn add(&mut self, theirs: &[RigidTransform], ours: &[RigidTransform]) {
        if let Some(degrees) = self.measure.angle(theirs, ours).map(f64::to_degrees) {
            self.sum += degrees;
            self.max = self.max.max(degrees);
            self.frames += 1;
        }
    }
}

impl Measure {
    /// The angle in a frame, radians; `None` where a direction has no length.
    fn angle(&self, theirs: &[RigidTransform], ours: &[RigidTransform]) -> Option<f64> {
        let line = |model: &[RigidTransform], [to, from]: [usize; 2]| {
            model[to].translation - model[from].translation
        };
        match self {
            Self::Bone(bone) => Some(between(bone.of_source(theirs), bone.of_target(ours))),
            Self::Line(source, target) => Some(between(line(theirs, *source), line(ours, *target))),
            Self::Middles(source, target) => {
                let middles = |model: &[RigidTransform], [a, b, c, d]: [usize; 4]| {
                    line(model, [c, a]) + line(model, [d, b])
                };
                Some(between(middles(theirs, *source), middles(ours, *target)))
            }
            Self::Turned { source, target, below, correction } => {
                let below = theirs[*below].rotation;
                let corrected = below * (*correction * (below.conjugate() * line(theirs, *source)));
                Some(between(corrected, line(ours, *target)))
            }
            Self::Turn { source, target, offset } => {
                let turn = (theirs[*source].rotation * *offset).conjugate() * ours[*target].rotation;
                let [x, y, z] = turn.vector().to_array().map(f64::from);
                Some(2.0 * libm::atan2(DVec3::new(x, y, z).length(), f64::from(turn.w).abs()))
            }
            Self::RollOfLine(bone, source, target) => {
                let (from, to) = (bone.of_target(ours), bone.of_source(theirs));
                let arc = Rotation::from_rotation_arc(from.try_normalize()?, to.try_normalize()?);
                about(to, line(theirs, *source), arc * line(ours, *target))
            }
            Self::RollOfTurn(bone, offset, up) => {
                let turned = theirs[bone.source].rotation * *offset * *up;
                let along = bone.of_target(ours);
                about(along, turned, ours[bone.target].rotation * *up)
            }
        }
    }
}

fn between(a: Vec3, b: Vec3) -> f64 {
    let (a, b) = (a.as_dvec3(), b.as_dvec3());
    libm::atan2(a.cross(b).length(), a.dot(b))
}

/// The angle between two directions, seen along an axis; `None` where one of them has hardly any length across it.
fn about(axis: Vec3, a: Vec3, b: Vec3) -> Option<f64> {
    let axis = axis.try_normalize()?;
    let across = |v: Vec3| {
        let across = v.reject_from_normalized(axis);
        (across.length() > 0.2 * v.length()).then_some(across)
    };
    Some(between(across(a)?, across(b)?))
}

/// The parts that both skeletons have.
fn parts(reference: &Reference) -> Vec<Part> {
    let joints: &Joints = reference.joints;
    let map = reference.map;
    let pair = |joint: RigJoint| map.source_of(joint).zip(joints.target.rig_joint(joint));
    let both = |[a, b]: [RigJoint; 2]| {
        let ((a, c), (b, d)) = pair(a).zip(pair(b))?;
        Some(([a, b], [c, d]))
    };
    let bone = |joint: RigJoint| Bone::of(joint, map, joints.source, joints.target);
    let mut parts = Vec::new();
    for side in Side::ALL {
        for (stem, _) in LIMB_BONES {
            let end = matches!(stem, SidedJoint::Hand | SidedJoint::Foot);
            let group = if end { Group::End } else { Group::Limb };
            let joint = stem.on(side);
            parts.extend(bone(joint).map(|bone| Part::new(joint.name(), group, Measure::Bone(bone))));
        }
        let suffix = side.joint_suffix();
        let knuckles = both([SidedJoint::Index01.on(side), SidedJoint::Pinky01.on(side)]);
        if let Some((hand, (theirs, ours))) = bone(SidedJoint::Hand.on(side)).zip(knuckles) {
            let measure = Measure::RollOfLine(hand, theirs, ours);
            parts.push(Part::new(format!("palm{suffix}"), Group::Roll, measure));
        }
        if let Some(foot) = bone(SidedJoint::Foot.on(side)) {
            let [.., alignment] = reference.leg(side, FootMode::Sole);
            let offset = reference.offset(foot.source, foot.target, alignment);
            let up = joints.target_rest[foot.target].rotation.conjugate() * Vec3::Y;
            let measure = Measure::RollOfTurn(foot, offset, up);
            parts.push(Part::new(format!("sole{suffix}"), Group::Roll, measure));
        }
    }
    let (hips, shoulders) = (both(SidedJoint::Thigh.both()), both(SidedJoint::Upperarm.both()));
    for (name, line) in [("hips", hips), ("shoulders", shoulders)] {
        let measure = line.map(|(theirs, ours)| Measure::Line(theirs, ours));
        parts.extend(measure.map(|measure| Part::new(name, Group::Trunk, measure)));
    }
    if let Some((([a, b], [i, j]), ([c, d], [k, l]))) = hips.zip(shoulders) {
        let measure = Measure::Middles([a, b, c, d], [i, j, k, l]);
        parts.push(Part::new("spine", Group::Trunk, measure));
    }
    parts.extend(neck(reference));
    if let Some((source, target)) = pair(RigJoint::Head) {
        let offset = reference.offset(source, target, reference.trunk());
        parts.push(Part::new("head", Group::Trunk, Measure::Turn { source, target, offset }));
    }
    parts
}

/// The neck, from where it begins to the head; `None` unless both skeletons have it.
fn neck(reference: &Reference) -> Option<Part> {
    let (joints, map): (&Joints, _) = (reference.joints, reference.map);
    let source = [map.source_of(RigJoint::Head)?, *map.neck().first()?];
    let target = [RigJoint::Head, RigJoint::Neck01].map(|joint| joints.target.rig_joint(joint));
    let target = [target[0]?, target[1]?];
    let below = map.spine().last().copied().or(map.source_of(RigJoint::Pelvis))?;
    let line = |model: &[RigidTransform], [to, from]: [usize; 2]| {
        (model[to].translation - model[from].translation).try_normalize()
    };
    let theirs = line(&joints.source_rest, source)?;
    let ours = reference.trunk() * line(&joints.target_rest, target)?;
    let at_rest = joints.source_rest[below].rotation;
    let correction = at_rest.conjugate() * Rotation::from_rotation_arc(theirs, ours) * at_rest;
    let measure = Measure::Turned { source, target, below, correction };
    Some(Part::new(RigJoint::Neck01.name(), Group::Trunk, measure))
}
