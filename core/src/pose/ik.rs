//! Two-bone inverse kinematics: hip, knee, ankle; shoulder, elbow, wrist.
//!
//! The law of cosines gives the bend of the middle joint. The shortest rotation then swings the limb to the target and
//! carries the plane in which it bends along, unless a pole gives that plane. A limb that is straight or bent backwards
//! bends in the natural direction of its middle joint.
//!
//! ```text
//!           lower (knee)
//!             o
//!      a    / |\    b         distance² = a² + b² − 2ab cos(angle at lower)
//!          /  |  \
//!         /   | sin · a       offset of the middle joint from the line, towards the pole
//!   upper o---+-----o end
//!          cos · a
//! ```

use glam::Vec3;

use crate::math::{RigidTransform, Rotation};
use crate::skeleton::{Pose, RigJoint, Skeleton};
use crate::{Error, Result};

/// To which side the middle joint of a limb moves when the limb bends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bend {
    /// Towards the upper joint's +Z axis, about its X axis: knees.
    Forwards,
    /// Away from +Z: elbows.
    Backwards,
}

/// Two bones, one behind the other, and the joint at their end: an arm or a leg. Joints are indices into the skeleton.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    /// Hip or shoulder.
    pub upper: usize,
    /// Knee or elbow, a child of `upper`.
    pub lower: usize,
    /// Ankle or wrist, a child of `lower`.
    pub end: usize,
    /// To which side it bends.
    pub bend: Bend,
}

/// The goal of a limb.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Where the end joint is to be and its rotation, `model_from_joint`, metres.
    pub target: RigidTransform,
    /// To which side of the line from the upper to the end joint the middle joint is to lie: a direction in model space, of
    /// any length. `None`, or a direction along that line, keeps the plane in which the limb bends.
    pub pole: Option<Vec3>,
    /// 0 keeps the pose, 1 reaches for the target; between, joint rotations are interpolated. Clamped to 0..=1.
    pub weight: f32,
    /// The last part of the limb's stretch, as a share of its length, over which it approaches straightness ever more
    /// slowly; a target there is missed by up to that. Clamped to 0..=0.5.
    pub softness: f32,
}

impl Reach {
    /// Reaches fully for a target, without softness, in the plane in which the limb bends.
    pub const fn to(target: RigidTransform) -> Self {
        Self { target, pole: None, weight: 1.0, softness: 0.0 }
    }
}

/// How far from its target an end joint may be and still count as there, as a share of the limb's length: rounding of two
/// bones in `f32`.
const REACHED: f32 = 1e-4;

impl Limb {
    /// The limb of these three joints.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming a joint that is missing or is not a child of the one before.
    pub fn of(rest: &Skeleton, chain: [RigJoint; 3], bend: Bend) -> Result<Self> {
        let mut joints = [0; 3];
        for (i, joint) in chain.iter().enumerate() {
            joints[i] = rest.require_rig_joint(*joint)?;
            if i > 0 && rest.parents()[joints[i]] != Some(joints[i - 1] as u32) {
                let message = format!("expected joint `{joint}` to be a child of `{}`", chain[i - 1]);
                return Err(Error::invalid("skeleton", message));
            }
        }
        let [upper, lower, end] = joints;
        Ok(Self { upper, lower, end, bend })
    }

    /// `model_from_joint` of upper, lower and end; `parent` is that of the upper joint's parent.
    pub fn model_from_joints(&self, pose: &Pose, parent: RigidTransform) -> [RigidTransform; 3] {
        let upper = parent.then(pose.locals[self.upper]);
        let lower = upper.then(pose.locals[self.lower]);
        [upper, lower, lower.then(pose.locals[self.end])]
    }

    /// Length of the straight limb, metres.
    pub fn length(&self, pose: &Pose) -> f32 {
        pose.locals[self.lower].translation.length() + pose.locals[self.end].translation.length()
    }

    /// Rotates the three joints so that the end joint takes the target's position and rotation. For a target out of reach
    /// the limb points at it. `parent` is `model_from_joint` of the upper joint's parent. The pose does not change when a
    /// bone has no length or a number is not finite.
    ///
    /// Returns whether the end reaches the target at full weight: not when that is too far, too near, or within the soft
    /// stretch.
    pub fn reach(&self, pose: &mut Pose, parent: RigidTransform, reach: &Reach) -> bool {
        let [upper, lower, end] = self.model_from_joints(pose, parent);
        let (first, second) = (lower.translation - upper.translation, end.translation - lower.translation);
        let (a, b) = (first.length(), second.length());
        let to_target = reach.target.translation - upper.translation;
        let finite = to_target.is_finite() && reach.target.rotation.is_finite() && reach.weight.is_finite();
        if !finite || a.min(b) < 1e-6 {
            return false;
        }
        let line = (first + second).try_normalize().or(first.try_normalize()).unwrap_or(Vec3::NEG_Y);
        let distance = soften(to_target.length(), a + b, reach.softness).max((a - b).abs());
        let pole = self.pole(upper.rotation, line, first);

        // Bend the limb to the distance along its old line, then swing it to the target.
        let cos = ((a * a + distance * distance - b * b) / (2.0 * a * distance.max(1e-6))).clamp(-1.0, 1.0);
        let sin = libm::sqrtf(1.0 - cos * cos);
        let new_first = line * (a * cos) + pole * (a * sin);
        let new_second = line * distance - new_first;
        let swing = arc(line, to_target);
        let swing =
            reach.pole.and_then(|wanted| roll(to_target, swing * pole, wanted)).map_or(swing, |r| r * swing);
        let upper_rotation = (swing * arc(first, new_first) * upper.rotation).normalize();
        let unbent = upper_rotation * pose.locals[self.lower].rotation;
        let second_now = unbent * pose.locals[self.end].translation;
        let lower_rotation = (arc(second_now, swing * new_second) * unbent).normalize();

        let solved = [
            (self.upper, parent.rotation.conjugate() * upper_rotation),
            (self.lower, upper_rotation.conjugate() * lower_rotation),
            (self.end, lower_rotation.conjugate() * reach.target.rotation),
        ];
        let weight = reach.weight.clamp(0.0, 1.0);
        for (joint, rotation) in solved {
            let local = &mut pose.locals[joint].rotation;
            let rotation = rotation.normalize();
            *local = if weight == 1.0 { rotation } else { local.slerp(rotation, weight) };
        }
        (distance - to_target.length()).abs() <= REACHED * (a + b)
    }

    /// The direction from the line between the ends to the middle joint. A small bias to the natural side decides when the
    /// joint lies on the line or on the wrong side of it.
    fn pole(&self, upper: Rotation, line: Vec3, first: Vec3) -> Vec3 {
        let across = |v: Vec3| v - line * v.dot(line);
        // From the hinge axis, not the bone's front: the line of a tightly folded leg may run along or past its front.
        let hinge = match self.bend {
            Bend::Forwards => upper * Vec3::X,
            Bend::Backwards => upper * Vec3::NEG_X,
        };
        let natural = hinge.cross(line).try_normalize().unwrap_or_else(|| line.any_orthonormal_vector());
        let offset = across(first);
        let right_side = offset - natural * offset.dot(natural).min(0.0);
        // The bias matters when the limb bends by less than about 5°.
        (right_side + natural * (0.04 * first.length())).try_normalize().unwrap_or(natural)
    }
}

/// How far the limb reaches for a target at `distance`: all the way up to the soft stretch, then approaching `length`
/// exponentially (A. Nicholls, "Soft IK", 2010).
fn soften(distance: f32, length: f32, softness: f32) -> f32 {
    let soft = length * softness.clamp(0.0, 0.5);
    let exact = length - soft;
    if distance <= exact {
        distance
    } else if soft < 1e-6 {
        length
    } else {
        length - soft * libm::expf(-(distance - exact) / soft)
    }
}

/// The rotation about `line` that aligns `from` with `to` as seen along it; `None` when one of them lies along `line`.
fn roll(line: Vec3, from: Vec3, to: Vec3) -> Option<Rotation> {
    let line = line.try_normalize()?;
    let across = |v: Vec3| {
        let part = v - line * v.dot(line);
        // Below this it is the rounding error of a direction along the line.
        (part.length() > 1e-4 * v.length()).then_some(part)?.try_normalize()
    };
    let (from, to) = (across(from)?, across(to)?);
    Some(Rotation::from_axis_angle(line, libm::atan2f(from.cross(to).dot(line), from.dot(to))))
}

/// The shortest rotation from one direction to another; the identity when one of them has no length.
fn arc(from: Vec3, to: Vec3) -> Rotation {
    let (Some(from), Some(to)) = (from.try_normalize(), to.try_normalize()) else {
        return Rotation::IDENTITY;
    };
    let cos = from.dot(to);
    if cos < 0.0 {
        return Rotation::from_rotation_arc(from, to);
    }
    // `from_rotation_arc` ignores angles below 0.7 mrad, which move the end of a leg by half a millimetre.
    let axis = from.cross(to);
    Rotation::from_xyzw(axis.x, axis.y, axis.z, 1.0 + cos).normalize()
}

#[cfg(test)]
mod tests {
    use glam::Vec3Swizzles;
    use proptest::prelude::*;

    use super::*;
    use crate::Side;
    use crate::skeleton::SidedJoint;

    const LEG: [RigJoint; 3] =
        [SidedJoint::Thigh.on(Side::Left), SidedJoint::Calf.on(Side::Left), SidedJoint::Foot.on(Side::Left)];

    /// A straight leg that hangs from the origin along −Y: thigh 0.5 m, calf 0.4 m, +Z axes forwards.
    fn leg() -> (Skeleton, Limb) {
        let down =
            Rotation::from_rotation_x(std::f32::consts::PI) * Rotation::from_rotation_y(std::f32::consts::PI);
        let local = |rotation, translation| RigidTransform { rotation, translation };
        let locals = vec![
            local(down, Vec3::ZERO),
            local(Rotation::IDENTITY, Vec3::Y * 0.5),
            local(Rotation::IDENTITY, Vec3::Y * 0.4),
        ];
        let parents = vec![None, Some(0), Some(1)];
        let names = LEG.map(|joint| joint.name().to_owned()).to_vec();
        let rest = Skeleton::new(names, parents, locals, vec![None; 3]).unwrap();
        let limb = Limb::of(&rest, LEG, Bend::Forwards).unwrap();
        (rest, limb)
    }

    fn reached(target: Vec3, softness: f32) -> [RigidTransform; 3] {
        let (rest, limb) = leg();
        let mut pose = rest.rest_pose().clone();
        let target = RigidTransform { rotation: Rotation::from_rotation_y(0.3), translation: target };
        limb.reach(&mut pose, RigidTransform::IDENTITY, &Reach { softness, ..Reach::to(target) });
        limb.model_from_joints(&pose, RigidTransform::IDENTITY)
    }

    #[test]
    fn a_straight_leg_bends_its_knee_forwards() {
        assert!((leg().0.model_from_joints()[0].rotation * Vec3::Z - Vec3::Z).length() < 1e-5);
        let [_, knee, ankle] = reached(Vec3::new(0.0, -0.7, 0.0), 0.0);
        assert!(ankle.translation.distance(Vec3::new(0.0, -0.7, 0.0)) < 1e-5);
        assert!(knee.translation.z > 0.2 && knee.translation.x.abs() < 1e-4, "{knee:?}");
        assert!(ankle.rotation.angle_between(Rotation::from_rotation_y(0.3)) < 1e-3);
    }

    #[test]
    fn out_of_reach_is_straight_and_soft_reach_falls_short_by_little() {
        let [_, knee, ankle] = reached(Vec3::new(0.0, 0.0, 3.0), 0.0);
        assert!(ankle.translation.distance(Vec3::new(0.0, 0.0, 0.9)) < 1e-4, "{ankle:?}");
        assert!(knee.translation.distance(Vec3::new(0.0, 0.0, 0.5)) < 1e-3, "{knee:?}");
        let [_, _, soft] = reached(Vec3::new(0.0, -0.9, 0.0), 0.02);
        let short = 0.9 + soft.translation.y;
        // 2 % of 0.9 m, divided by e.
        assert!((short - 0.018 / std::f32::consts::E).abs() < 1e-4, "{short}");
    }

    #[test]
    fn the_knee_lies_towards_the_pole_and_still_bends_about_its_hinge() {
        let (rest, limb) = leg();
        let target = RigidTransform { rotation: Rotation::IDENTITY, translation: Vec3::new(0.1, -0.6, 0.2) };
        let line = target.translation.normalize_or_zero();
        for pole in [Vec3::X, Vec3::NEG_X * 7.0, Vec3::new(0.3, 2.0, 1.0), Vec3::NEG_Z] {
            let mut pose = rest.rest_pose().clone();
            let reach = Reach { pole: Some(pole), ..Reach::to(target) };
            assert!(limb.reach(&mut pose, RigidTransform::IDENTITY, &reach));
            let [_, knee, ankle] = limb.model_from_joints(&pose, RigidTransform::IDENTITY);
            assert!(ankle.translation.distance(target.translation) < 1e-5);
            let across = |v: Vec3| (v - line * v.dot(line)).normalize_or_zero();
            assert!(across(knee.translation).distance(across(pole)) < 1e-3, "{pole}: {knee:?}");
            let hinge = pose.locals[limb.lower].rotation.to_scaled_axis();
            assert!(hinge.x.abs() > 0.5 && hinge.yz().length() < 1e-3, "{pole}: {hinge}");
        }
        let mut pose = rest.rest_pose().clone();
        let along = Reach { pole: Some(target.translation), ..Reach::to(target) };
        assert!(limb.reach(&mut pose, RigidTransform::IDENTITY, &along));
        let mut kept = rest.rest_pose().clone();
        limb.reach(&mut kept, RigidTransform::IDENTITY, &Reach::to(target));
        assert_eq!(pose, kept);
    }

    #[test]
    fn out_of_reach_returns_false_and_weight_blends_from_the_pose_to_the_target() {
        let (rest, limb) = leg();
        let reach = |y: f32, weight: f32, softness: f32| {
            let mut pose = rest.rest_pose().clone();
            let target = RigidTransform { rotation: Rotation::IDENTITY, translation: Vec3::new(0.0, y, 0.0) };
            let options = Reach { weight, softness, ..Reach::to(target) };
            let reached = limb.reach(&mut pose, RigidTransform::IDENTITY, &options);
            (reached, pose)
        };
        assert!(reach(-0.7, 1.0, 0.0).0 && reach(-0.9, 1.0, 0.0).0 && reach(-0.7, 0.5, 0.0).0);
        assert!(!reach(-0.92, 1.0, 0.0).0 && !reach(-0.05, 1.0, 0.0).0 && !reach(-0.9, 1.0, 0.02).0);
        assert!(!reach(f32::NAN, 1.0, 0.0).0 && !reach(-0.7, f32::NAN, 0.0).0);
        assert_eq!(reach(f32::NAN, 1.0, 0.0).1, *rest.rest_pose());
        let bend = |pose: &Pose| pose.locals[limb.lower].rotation.angle_between(Rotation::IDENTITY);
        let (none, half, all) = (reach(-0.7, 0.0, 0.0).1, reach(-0.7, 0.5, 0.0).1, reach(-0.7, 1.0, 0.0).1);
        assert!(
            none.locals[limb.upper].rotation.angle_between(rest.rest_pose().locals[limb.upper].rotation)
                < 1e-3
        );
        assert!(bend(&none) < 1e-3 && (bend(&half) - bend(&all) / 2.0).abs() < 1e-3 && bend(&all) > 0.5);
    }

    #[test]
    fn a_missing_joint_is_named() {
        let (rest, _) = leg();
        let [hip, knee, ankle] = LEG;
        let refused = |chain| Limb::of(&rest, chain, Bend::Forwards).unwrap_err().to_string();
        let error = refused([hip, SidedJoint::Calf.on(Side::Right), ankle]);
        assert!(error.contains("`calf_r`"), "{error}");
        let error = refused([hip, ankle, knee]);
        assert!(error.contains("`foot_l` to be a child of `thigh_l`"), "{error}");
    }

    /// Reaches for `offset` (metres, from the hip) with a leg turned sideways by `turn` and bent by `bend`, radians.
    fn reaches_or_points_at(offset: Vec3, bend: f32, turn: f32) {
        let (rest, limb) = leg();
        let mut pose = rest.rest_pose().clone();
        pose.locals[0].rotation *= Rotation::from_rotation_z(turn);
        pose.locals[1].rotation *= Rotation::from_rotation_x(bend);
        let hip = Vec3::new(0.1, 1.0, 0.0);
        let parent = RigidTransform { rotation: Rotation::from_rotation_z(turn), translation: hip };
        let target = RigidTransform { rotation: Rotation::from_rotation_x(turn), translation: hip + offset };
        limb.reach(&mut pose, parent, &Reach::to(target));
        let [upper, _, end] = limb.model_from_joints(&pose, parent);
        let wanted = offset.length();
        let distance = wanted.clamp(0.1, 0.9);
        let reached = end.translation.distance(upper.translation);
        assert!((reached - distance).abs() < 1e-4, "{offset}, {bend}, {turn}: {reached} for {distance}");
        let direction = offset / wanted;
        assert!(end.translation.distance(upper.translation + direction * distance) < 1e-3);
        assert!(end.rotation.dot(target.rotation).abs() > 1.0 - 1e-5);
    }

    #[test]
    fn a_turn_of_less_than_a_milliradian_is_not_lost() {
        // Taken for no turn at all, it leaves the foot 0.3 mm from its target.
        reaches_or_points_at(Vec3::new(-0.092_480_34, 0.269_650_82, -0.462_176_86), -1.861_891_8, 0.0);
    }

    proptest! {
        #[test]
        fn every_target_is_reached_or_pointed_at(
            x in -1.2f32..1.2, y in -1.2f32..1.2, z in -1.2f32..1.2, bend in -2.0f32..0.2, turn in -1.5f32..1.5,
        ) {
            let offset = Vec3::new(x, y, z);
            prop_assume!(offset.length() > 1e-3);
            reaches_or_points_at(offset, bend, turn);
        }
    }
}
