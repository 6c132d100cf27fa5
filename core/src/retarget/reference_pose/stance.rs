//! How a body stands, from positions of its joints alone.

use glam::{Mat3, Vec3};

use super::super::joint_map::{JointMap, NECK, SPINE};
use crate::Side;
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::{RigJoint, SidedJoint, Skeleton};

/// Bends of a knee below this do not tell to which side it bends, radians (20°).
const BENT: f32 = 0.35;

/// Left and right are no mirror images if a joint is farther from where the other would be than this part of the height from
/// hips to shoulders.
const ASYMMETRIC: f32 = 0.05;

/// Limits of the angles of a body that stands, radians.
struct Limits {
    /// Of thighs and calves forwards or backwards.
    leg: f32,
    /// Of thighs and calves to the side.
    aside: f32,
    knee: f32,
    trunk: f32,
    head: f32,
    /// Of the lines through hips and shoulders against the horizontal.
    tilt: f32,
}

/// 40°, 60°, 30°, 40°, 75°, 30°: a rest pose, which may have its legs apart and lean a little.
const PERSON: Limits = Limits { leg: 0.70, aside: 1.05, knee: 0.52, trunk: 0.70, head: 1.31, tilt: 0.52 };
/// 20°, 30°, 25°, 15°, 45°, 10°: a frame of somebody who stands.
const STRAIGHT: Limits = Limits { leg: 0.35, aside: 0.52, knee: 0.44, trunk: 0.26, head: 0.79, tilt: 0.175 };

/// How a body stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Upright {
    /// As somebody who stands.
    Straight,
    /// As a rest pose may.
    Person,
    Not,
}

/// A body's angles, radians, and directions.
pub(super) struct Stance {
    /// For each leg, of thigh and calf: the angle from downwards to the front, and to the side.
    legs: Vec<[[f32; 2]; 2]>,
    /// Bends of the knees.
    knees: Vec<f32>,
    trunk: f32,
    /// Of the head above the shoulders or the neck, and of its own end above it.
    head: f32,
    tilts: Vec<f32>,
    /// Angle about the vertical between the lines through hips and shoulders.
    wrung: f32,
    toes: Option<f32>,
    front_of_knees: Option<f32>,
}

fn place(map: &JointMap, model: &[RigidTransform], joint: RigJoint) -> Option<Vec3> {
    map.source_of(joint).map(|joint| model[joint].translation)
}

/// Positions of a joint on the left and the right.
fn both(map: &JointMap, model: &[RigidTransform], joint: SidedJoint) -> Option<[Vec3; 2]> {
    let [left, right] = joint.both().map(|joint| place(map, model, joint));
    Some([left?, right?])
}

/// The axes of a body: its left, up along the trunk, its front.
pub(super) fn axes(map: &JointMap, model: &[RigidTransform]) -> Option<Rotation> {
    let hips = both(map, model, SidedJoint::Thigh)?;
    let up = (top(map, model)? - (hips[0] + hips[1]) / 2.0).try_normalize()?;
    let front = (hips[0] - hips[1]).cross(up).try_normalize()?;
    Some(Rotation::from_mat3(&Mat3::from_cols(up.cross(front), up, front)).normalize())
}

/// The top of the trunk; of legs alone a point above them.
fn top(map: &JointMap, model: &[RigidTransform]) -> Option<Vec3> {
    let shoulders = both(map, model, SidedJoint::Upperarm).map(|[left, right]| (left + right) / 2.0);
    let at = |joint: &RigJoint| place(map, model, *joint);
    let neck = || NECK.iter().find_map(at);
    let above_legs = || {
        let [hips, knees] =
            [SidedJoint::Thigh, SidedJoint::Calf].map(|joint| both(map, model, joint).map(|[l, r]| l + r));
        Some(hips? - knees? / 2.0)
    };
    let trunk =
        shoulders.or_else(neck).or_else(|| at(&RigJoint::Head)).or_else(|| SPINE.iter().rev().find_map(at));
    trunk.or_else(above_legs)
}

/// Whether a body is a person in the pose of somebody who stands, even if it lies as a whole.
pub(super) fn is_person(map: &JointMap, skeleton: &Skeleton, model: &[RigidTransform]) -> bool {
    let stands =
        |model: &[RigidTransform]| Stance::of(map, skeleton, model).is_some_and(|stance| stance.is_person());
    let lies = || {
        let upright = axes(map, model)?.conjugate();
        let righted = RigidTransform { rotation: upright, ..RigidTransform::IDENTITY };
        Some(model.iter().map(|joint| righted.then(*joint)).collect::<Vec<_>>())
    };
    stands(model) || lies().is_some_and(|righted| stands(&righted))
}

/// Whether left and right are mirror images, as in poses that are made to rest in and hardly in frames of a motion.
pub(super) fn is_symmetric(map: &JointMap, model: &[RigidTransform]) -> bool {
    use SidedJoint as J;
    let Some((axes, hips)) = axes(map, model).zip(both(map, model, J::Thigh)) else { return false };
    let middle = (hips[0] + hips[1]) / 2.0;
    let Some(height) = top(map, model).map(|top| top.distance(middle)) else { return false };
    let limbs = [J::Calf, J::Foot, J::Upperarm, J::Lowerarm, J::Hand].into_iter();
    limbs.filter_map(|joint| both(map, model, joint)).all(|places| {
        let [left, right] = places.map(|place| axes.conjugate() * (place - middle));
        left.distance(right * Vec3::new(-1.0, 1.0, 1.0)) < ASYMMETRIC * height
    })
}

fn angle(a: Vec3, b: Vec3) -> f32 {
    libm::atan2f(a.cross(b).length(), a.dot(b))
}

impl Stance {
    /// `model` is a pose of `skeleton` in model space. `None` when hips and shoulders or head are not known, or lie on one point.
    pub(super) fn of(map: &JointMap, skeleton: &Skeleton, model: &[RigidTransform]) -> Option<Self> {
        let hips = both(map, model, SidedJoint::Thigh)?;
        let shoulders = both(map, model, SidedJoint::Upperarm);
        let middle = |[left, right]: [Vec3; 2]| (left + right) / 2.0;
        let head = place(map, model, RigJoint::Head);
        let neck = NECK.into_iter().find_map(|joint| place(map, model, joint));
        let up = (top(map, model)? - middle(hips)).try_normalize()?;
        let across = (hips[0] - hips[1]).try_normalize()?;
        let front = across.cross(up).try_normalize()?;
        let tilt = |[left, right]: [Vec3; 2]| {
            let across = (left - right).try_normalize()?;
            Some(libm::asinf(across.y.clamp(-1.0, 1.0)).abs())
        };
        let yaw = |[left, right]: [Vec3; 2]| (left - right).with_y(0.0);
        let mut stance = Self {
            legs: Vec::new(),
            knees: Vec::new(),
            trunk: angle(up, Vec3::Y),
            head: 0.0,
            tilts: [Some(hips), shoulders].into_iter().flatten().filter_map(tilt).collect(),
            wrung: shoulders.map_or(0.0, |shoulders| angle(yaw(shoulders), yaw(hips))),
            toes: None,
            front_of_knees: None,
        };
        let above = neck.or_else(|| shoulders.map(middle));
        let end = map.source_of(RigJoint::Head).and_then(|joint| {
            let end = skeleton.ends().get(joint).copied().flatten()?;
            Some(model[joint].rotation * end)
        });
        let raised = head.zip(above).map(|(head, above)| head - above);
        for direction in [raised, end].into_iter().flatten().filter(|v| v.length() > 1e-3) {
            stance.head = stance.head.max(angle(direction, Vec3::Y));
        }
        for side in Side::ALL {
            stance.add_leg(map, (skeleton, model), side, front);
        }
        (!stance.legs.is_empty()).then_some(stance)
    }

    fn add_leg(&mut self, map: &JointMap, body: (&Skeleton, &[RigidTransform]), side: Side, front: Vec3) {
        let (skeleton, model) = body;
        let at = |joint: SidedJoint| place(map, model, joint.on(side));
        let (Some(hip), Some(knee)) = (at(SidedJoint::Thigh), at(SidedJoint::Calf)) else { return };
        let ahead = front.with_y(0.0).normalize_or(Vec3::Z);
        let from_down = |bone: Vec3| {
            let forwards = libm::atan2f(bone.dot(ahead), -bone.y);
            [forwards.abs(), libm::atan2f(bone.dot(ahead.cross(Vec3::Y)).abs(), -bone.y)]
        };
        let thigh = knee - hip;
        let calf = at(SidedJoint::Foot).map_or(thigh, |foot| foot - knee);
        self.legs.push([from_down(thigh), from_down(calf)]);
        let bend = angle(thigh, calf);
        self.knees.push(bend);
        let add = |sum: &mut Option<f32>, direction: Vec3| {
            let cosine = direction.try_normalize().map(|direction| direction.dot(front));
            *sum = match (*sum, cosine) {
                (Some(sum), Some(cosine)) => Some((sum + cosine) / 2.0),
                (sum, cosine) => sum.or(cosine),
            };
        };
        if bend > BENT {
            // The knee is on the front of the line from hip to ankle.
            let leg = (thigh + calf).normalize_or_zero();
            add(&mut self.front_of_knees, thigh - leg * thigh.dot(leg));
        }
        let Some(foot) = map.source_of(SidedJoint::Foot.on(side)) else { return };
        let end = skeleton.ends().get(foot).copied().flatten().map(|end| model[foot].rotation * end);
        let ball = at(SidedJoint::Ball).map(|ball| ball - model[foot].translation);
        if let Some(toes) = ball.or(end).filter(|toes| toes.length() > 1e-3) {
            // Without what goes on along the leg: a foot that is stretched points nowhere.
            let leg = calf.normalize_or_zero();
            let across = toes - leg * toes.dot(leg);
            if across.length() > 0.3 * toes.length() {
                add(&mut self.toes, across);
            }
        }
    }

    pub(super) fn upright(&self) -> Upright {
        let is = |limits: &Limits| {
            let leg = |[forwards, aside]: &[f32; 2]| *forwards < limits.leg && *aside < limits.aside;
            self.legs.iter().flatten().all(leg)
                && self.knees.iter().all(|knee| *knee < limits.knee)
                && self.trunk < limits.trunk
                && self.head < limits.head
                && self.tilts.iter().all(|tilt| *tilt < limits.tilt)
        };
        match (is(&STRAIGHT), is(&PERSON)) {
            (true, _) => Upright::Straight,
            (_, true) => Upright::Person,
            _ => Upright::Not,
        }
    }

    fn is_person(&self) -> bool {
        self.upright() != Upright::Not
    }

    /// How far the body is from standing straight: a mean of its angles, radians. Legs may be apart.
    pub(super) fn strain(&self) -> f32 {
        let forwards = self.legs.iter().flatten().map(|[forwards, _]| *forwards).sum::<f32>();
        forwards / (2.0 * self.legs.len() as f32) + self.upper_strain()
    }

    /// The part of trunk and head in [`strain`](Self::strain).
    pub(super) fn upper_strain(&self) -> f32 {
        let tilts = self.tilts.iter().sum::<f32>() / self.tilts.len().max(1) as f32;
        self.trunk + self.head / 2.0 + tilts + self.wrung / 2.0
    }

    /// Cosine between the front by left and right, and where the toes point.
    pub(super) fn toes(&self) -> Option<f32> {
        self.toes
    }

    /// The same for bent knees.
    pub(super) fn knees(&self) -> Option<f32> {
        self.front_of_knees
    }
}
