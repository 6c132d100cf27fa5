//! Sliding of a sole that rolls over the floor.
//!
//! As a standing foot tilts, the contact area moves over the round heel, and over the ball to the toes. A foot slides when
//! the skin in the contact area moves, not when some fixed point of the sole does.

use std::slice;

use glam::Vec3;

use super::contacts::{Contact, FootPoint, runs};
use super::for_each_pose;
use super::shape::{SoleVertex, sole_skin};
use crate::Result;
use crate::clip::Clip;
use crate::math::RigidTransform;
use crate::pose::Leg;
use crate::skeleton::Skeleton;

/// Height above its lowest point up to which a sole touches the floor, metres, as skin yields.
const TOUCHING: f32 = 0.005;

/// A point of the sole, skinned to foot and toes.
#[derive(Clone, Copy, Debug)]
struct SolePoint {
    in_foot: Vec3,
    in_ball: Vec3,
    /// Weight of the ball joint.
    ball_weight: f32,
}

/// The parts of a sole that touch the floor: under the heel and under the ball.
#[derive(Clone, Debug)]
pub(super) struct RoundSole {
    /// Under the heel and under the ball.
    parts: [Vec<SolePoint>; 2],
    /// The outline, without toes.
    rim: Vec<SolePoint>,
}

impl RoundSole {
    /// The sole of a leg.
    ///
    /// # Errors
    /// As [`sole_skin`].
    pub(super) fn of(rest: &Skeleton, leg: &Leg) -> Result<Self> {
        let model = rest.model_from_joints();
        let [foot, ball] = [model[leg.limb.end], model[leg.ball]];
        let point = |vertex: &SoleVertex| SolePoint {
            in_foot: foot.rotation.conjugate() * (vertex.position - foot.translation),
            in_ball: ball.rotation.conjugate() * (vertex.position - ball.translation),
            ball_weight: vertex.ball_weight,
        };
        let skin = sole_skin(rest, leg, &model)?;
        let points = |vertices: &Vec<SoleVertex>| vertices.iter().map(point).collect();
        Ok(Self { parts: skin.parts.each_ref().map(points), rim: points(&skin.rim) })
    }

    /// Height of the lowest point of the outline, from `model_from_joint` of foot and ball, metres.
    pub(super) fn lowest(&self, joints: &[RigidTransform; 2]) -> f32 {
        self.rim.iter().map(|point| point.at(joints).y).fold(f32::INFINITY, f32::min)
    }

    /// Displacement along the floor of the contact area from one frame to the next, from `model_from_joint` of foot and ball.
    fn step(&self, point: FootPoint, before: &[RigidTransform; 2], now: &[RigidTransform; 2]) -> Vec3 {
        let part = &self.parts[point as usize];
        let positions: Vec<Vec3> = part.iter().map(|point| point.at(before)).collect();
        let lowest = positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
        let touching = part.iter().zip(&positions).filter(|(_, p)| p.y < lowest + TOUCHING);
        let steps = touching.map(|(point, position)| point.at(now) - *position);
        let (sum, count) = steps.fold((Vec3::ZERO, 0), |(sum, count), step| (sum + step, count + 1));
        (sum / count.max(1) as f32).with_y(0.0)
    }
}

impl SolePoint {
    fn at(&self, joints: &[RigidTransform; 2]) -> Vec3 {
        at(joints[0], self.in_foot).lerp(at(joints[1], self.in_ball), self.ball_weight)
    }
}

fn at(joint: RigidTransform, point: Vec3) -> Vec3 {
    joint.translation + joint.rotation * point
}

/// Displacements of the contact area along the floor in each contact, from each of its frames to the next; metres.
///
/// # Errors
/// As [`sole_skin`].
pub(super) fn steps(clip: &Clip, leg: &Leg, contacts: &[Contact]) -> Result<Vec<Vec<Vec3>>> {
    let sole = RoundSole::of(clip.skeleton(), leg)?;
    let mut joints = Vec::with_capacity(clip.frame_count());
    for_each_pose(clip, slice::from_ref(leg), |_, _, model| {
        joints.push([model[leg.limb.end], model[leg.ball]]);
    });
    let of_contact = |contact: &Contact| {
        let frames = joints.get(contact.start..contact.end).unwrap_or_default();
        frames.windows(2).map(|pair| sole.step(contact.point, &pair[0], &pair[1])).collect()
    };
    Ok(contacts.iter().map(of_contact).collect())
}

/// How far a foot has slid along the floor in each frame, metres, relative to the mean over the frames in which it stays on
/// the floor; `None` in frames in which neither heel nor ball touches.
///
/// # Errors
/// As [`sole_skin`].
pub(super) fn slips(clip: &Clip, leg: &Leg, contacts: &[Contact]) -> Result<Vec<Option<Vec3>>> {
    let count = clip.frame_count();
    let mut touches = vec![false; count];
    // Sums and counts of the steps that lead to each frame.
    let mut sums = vec![(Vec3::ZERO, 0.0); count];
    for (contact, steps) in contacts.iter().zip(steps(clip, leg, contacts)?) {
        touches[contact.start..contact.end].fill(true);
        for ((sum, count), step) in sums[contact.start..].iter_mut().skip(1).zip(steps) {
            *sum += step;
            *count += 1.0;
        }
    }
    let mut slips = vec![None; count];
    for (start, end) in runs(&touches) {
        let path = sums[start..end].iter().scan(Vec3::ZERO, |position, (sum, count)| {
            *position += *sum / f32::max(*count, 1.0);
            Some(*position)
        });
        let path: Vec<Vec3> = path.collect();
        let mean = path.iter().sum::<Vec3>() / path.len() as f32;
        slips[start..end].iter_mut().zip(path).for_each(|(slip, position)| *slip = Some(position - mean));
    }
    Ok(slips)
}

#[cfg(test)]
mod tests {
    use crate::math::Rotation;

    use super::*;
    use crate::testing::bodies::bodies;

    const POINTS: [FootPoint; 2] = [FootPoint::Heel, FootPoint::Ball];

    fn left(rest: &Skeleton) -> (RoundSole, [RigidTransform; 2]) {
        let (leg, model) = (Leg::both(rest).unwrap()[0], rest.model_from_joints());
        (RoundSole::of(rest, &leg).unwrap(), [model[leg.limb.end], model[leg.ball]])
    }

    /// The middle of what touches the floor.
    fn touching(sole: &RoundSole, point: FootPoint, joints: &[RigidTransform; 2]) -> Vec3 {
        let positions: Vec<Vec3> = sole.parts[point as usize].iter().map(|p| p.at(joints)).collect();
        let lowest = positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
        let low: Vec<Vec3> = positions.into_iter().filter(|p| p.y < lowest + TOUCHING).collect();
        low.iter().sum::<Vec3>() / low.len() as f32
    }

    fn rotated(joints: &[RigidTransform; 2], by: Rotation, about: Vec3) -> [RigidTransform; 2] {
        joints.map(|joint| RigidTransform {
            rotation: by * joint.rotation,
            translation: about + by * (joint.translation - about),
        })
    }

    #[test]
    fn a_foot_that_rotates_about_its_contact_does_not_slide_and_one_that_moves_does() {
        for (body, rest) in bodies() {
            let (sole, flat) = left(&rest);
            for tilt in [Rotation::IDENTITY, Rotation::from_rotation_x(-0.2), Rotation::from_rotation_z(0.15)]
            {
                let standing = rotated(&flat, tilt, flat[0].translation);
                let by = Vec3::new(0.03, 0.0, -0.01);
                let moved = standing.map(|j| RigidTransform { translation: j.translation + by, ..j });
                for point in POINTS {
                    let step = sole.step(point, &standing, &moved);
                    assert!(step.distance(by) < 1e-5, "{body} {point:?}: {step}");
                }
                let heel = touching(&sole, FootPoint::Heel, &standing);
                let pivoted = rotated(&standing, Rotation::from_rotation_y(0.3), heel);
                let [heel, ball] = POINTS.map(|point| sole.step(point, &standing, &pivoted).length());
                assert!(heel < 1e-5 && ball > 0.03, "{body}: {heel} {ball}");
            }
        }
    }

    #[test]
    fn a_foot_that_rolls_back_or_forwards_stands_on_the_back_of_the_heel_or_the_front_of_the_ball() {
        for (body, rest) in bodies() {
            let (sole, flat) = left(&rest);
            let rolled = |degrees: f32, point: FootPoint| {
                let tilt = Rotation::from_rotation_x(degrees.to_radians());
                let tilted = rotated(&flat, tilt, flat[0].translation);
                let at = tilt.conjugate() * (touching(&sole, point, &tilted) - flat[0].translation);
                flat[0].translation + at
            };
            let [flat_heel, back] = [0.0, -20.0].map(|tilt| rolled(tilt, FootPoint::Heel));
            let [flat_ball, front] = [0.0, 20.0].map(|tilt| rolled(tilt, FootPoint::Ball));
            assert!(back.z < flat_heel.z - 0.003, "{body}: {back} behind {flat_heel}");
            assert!(front.z > flat_ball.z + 0.003, "{body}: {front} ahead of {flat_ball}");
            assert!(flat_heel.z < flat[0].translation.z, "{body}: {flat_heel} behind the ankle");
            assert!(
                flat_heel.y.abs() < 0.006 && flat_ball.y.abs() < 0.006,
                "{body}: {flat_heel} {flat_ball}"
            );
        }
    }
}
