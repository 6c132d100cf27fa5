//! The person in a motion: its hips, head and legs, and the frames in which it stands, from which gravity is known.

use glam::Vec3;

use super::proportions::{poses, rest_of};
use super::raw::RawMotion;
use crate::Side;
use crate::math::RigidTransform;
use crate::retarget::{JointMap, Overrides};
use crate::skeleton::{RigJoint, SidedJoint, Skeleton, model_from_joints};
use crate::space::Axis;

/// Legs are straight where hip and foot are this far apart, as a part of their length.
const STRAIGHT: f32 = 0.85;
/// Cosine of the angle between trunk and legs up to which a person stands.
const IN_LINE: f32 = 0.8;
/// Cosine of the angle to an axis up to which a person stands along it.
const ALONG: f32 = 0.8;

/// Joints of a person.
#[derive(Clone, Copy, Debug)]
pub(super) struct Figure {
    pub(super) pelvis: usize,
    top: usize,
    /// Hip, knee and foot of each leg; the foot is `None` where the leg ends at the knee.
    legs: [(usize, usize, Option<usize>); 2],
}

/// How the person is held over a motion.
pub(super) struct Stance {
    /// Mean direction from the feet to the head, or of the trunk where the person never stands; shorter than 1 where it
    /// varies. The file's axes.
    pub(super) up: Vec3,
    /// Whether the person stands in any frame.
    pub(super) stands: bool,
    /// Feet to head, the file's unit.
    height: f32,
    /// Feet, hips and head in each of these frames.
    points: Vec<[Vec3; 4]>,
}

impl Figure {
    /// The joints of a person, by name, or by geometry where the skeleton stands along +Y.
    pub(super) fn of(skeleton: &Skeleton) -> Option<Self> {
        let map = JointMap::find(skeleton, &Overrides::new()).ok()?;
        let top = map.source_of(RigJoint::Head).or(map.neck().last().copied());
        let legs = Side::ALL.map(|side| {
            let [hip, knee, foot] = [SidedJoint::Thigh, SidedJoint::Calf, SidedJoint::Foot]
                .map(|joint| map.source_of(joint.on(side)));
            Some((hip?, knee?, foot))
        });
        Some(Self {
            pelvis: map.source_of(RigJoint::Pelvis)?,
            top: top.or(map.spine().last().copied())?,
            legs: [legs[0]?, legs[1]?],
        })
    }

    /// The lowest joints of the legs.
    pub(super) fn feet(&self) -> [usize; 2] {
        self.legs.map(|(_, knee, foot)| foot.unwrap_or(knee))
    }

    /// The axis along which the rest pose stands.
    pub(super) fn rest_axis(&self, raw: &RawMotion) -> Option<Axis> {
        let stance = self.stance_in(raw, std::iter::once(rest_of(raw).to_vec()));
        stance.filter(|stance| stance.stands).and_then(|stance| stance.axis())
    }

    /// How the person is held; `None` without a trunk.
    pub(super) fn stance(&self, raw: &RawMotion) -> Option<Stance> {
        self.stance_in(raw, raw.takes.iter().flat_map(|take| poses(raw, take)))
    }

    fn stance_in(&self, raw: &RawMotion, poses: impl Iterator<Item = Vec<RigidTransform>>) -> Option<Stance> {
        let (mut standing, mut others, mut world) = (Vec::new(), Vec::new(), Vec::new());
        for pose in poses {
            model_from_joints(raw.skeleton.parents(), &pose, &mut world);
            let at = |joint: usize| world[joint].translation;
            let feet = self.feet().map(at);
            let (foot, pelvis, top) = ((feet[0] + feet[1]) / 2.0, at(self.pelvis), at(self.top));
            let straight = self.legs.iter().all(|&(hip, knee, end)| {
                let Some(end) = end else { return true };
                let length = at(hip).distance(at(knee)) + at(knee).distance(at(end));
                at(hip).distance(at(end)) > STRAIGHT * length
            });
            let Some(trunk) = (top - pelvis).try_normalize() else { continue };
            let along = (pelvis - foot).try_normalize().unwrap_or_default();
            let frame = ((top - foot).normalize_or(trunk), trunk, [feet[0], feet[1], pelvis, top]);
            if straight && trunk.dot(along) > IN_LINE { standing.push(frame) } else { others.push(frame) }
        }
        let stands = !standing.is_empty();
        let frames = if stands { standing } else { others };
        let count = frames.len() as f32;
        let up = frames.iter().map(|(up, trunk, _)| if stands { *up } else { *trunk }).sum::<Vec3>() / count;
        let height =
            frames.iter().map(|(.., [a, b, _, top])| top.distance((*a + *b) / 2.0)).sum::<f32>() / count;
        let points = frames.into_iter().map(|(.., points)| points).collect();
        up.is_finite().then_some(Stance { up, stands, height, points })
    }
}

impl Stance {
    /// The axis along which the person is held in most frames.
    pub(super) fn axis(&self) -> Option<Axis> {
        Axis::ALL.into_iter().find(|axis| self.up.dot(axis.direction()) > ALONG)
    }

    /// Mean of the lowest point along an axis, as a part of the height.
    fn lowest(&self, axis: Axis) -> f32 {
        let lowest = |points: &[Vec3; 4]| {
            points.map(|v| v.dot(axis.direction())).into_iter().fold(f32::INFINITY, f32::min)
        };
        self.points.iter().map(lowest).sum::<f32>() / (self.points.len() as f32 * self.height)
    }

    /// Whether the person could stand on a floor at zero.
    pub(super) fn stands_on_floor(&self, axis: Axis) -> bool {
        self.stands && self.lowest(axis).abs() < 0.2
    }

    /// Whether the person could lie, or stand on head or hands, on a floor at zero: joints lie within the body, so above it.
    pub(super) fn lies_on_floor(&self, axis: Axis) -> bool {
        (0.01..0.2).contains(&self.lowest(axis))
    }
}
