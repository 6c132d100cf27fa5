//! Sliding of a sole that rolls over the floor.
//!
//! As a standing foot tilts, the contact area moves over the round heel, and over the ball to the toes. A foot slides when
//! the skin in the contact area moves, not when some fixed point of the sole does. The shapes are fitted to the skin of 24
//! random bodies, tilted by up to 35° along and 22° across: the centre of the contact area is off by 3 mm on average, as
//! much as bodies differ.

use std::slice;

use glam::Vec3;

use super::contacts::{Contact, FootPoint, runs};
use super::for_each_pose;
use crate::clip::Clip;
use crate::math::RigidTransform;
use crate::pose::Leg;

/// The heel is the underside of an ellipsoid. Its lowest point in a flat foot, ahead of the ankle and to the outer side, as
/// shares of the distance from ankle to ball along the floor; bodies differ by 0.035.
const HEEL_AT: [f32; 2] = [-0.135, 0.035];
/// Half the ellipsoid's length, width and height as shares of that distance.
const HEEL_AXES: [f32; 3] = [0.18, 0.16, 0.08];
/// The pad of the ball is a round patch. How far its lowest point is ahead of the ball joint in a flat foot, metres.
const PAD_AHEAD: f32 = 0.003;
/// Radius of the patch, metres.
const PAD_RADIUS: f32 = 0.03;
/// Radii of its curvature along the foot and across, metres.
const PAD_CURVATURE: [f32; 2] = [0.055, 0.3];
/// Sample points along the pad's diameter.
const PAD_SAMPLES: usize = 9;
/// Height above its lowest point up to which the pad touches the floor, metres, as skin yields.
const TOUCHING: f32 = 0.005;
/// Distances ahead of the ball joint between which the skin blends from the foot to the toes, metres.
const TOE_BLEND: [f32; 2] = [0.0, 0.04];

/// A point of the sole, skinned to foot and toes.
#[derive(Clone, Copy, Debug)]
struct SolePoint {
    in_foot: Vec3,
    in_ball: Vec3,
    /// Weight of the ball joint.
    ball_weight: f32,
}

/// The parts of a sole that touch the floor: an ellipsoid at the heel and a pad at the ball.
#[derive(Clone, Debug)]
struct RoundSole {
    /// Centre of the heel's ellipsoid in the foot's space.
    heel: Vec3,
    /// Its half axes in the foot's space.
    axes: [Vec3; 3],
    /// Points of the pad.
    ball: Vec<SolePoint>,
}

impl RoundSole {
    fn of(leg: &Leg, model: &[RigidTransform]) -> Self {
        let [foot, ball] = [model[leg.limb.end], model[leg.ball]];
        let forward = (ball.translation - foot.translation).with_y(0.0);
        let length = forward.length();
        let ahead = forward.normalize_or_zero();
        let across = Vec3::Y.cross(ahead);
        // Left feet are at +X.
        let outwards = across * foot.translation.x.signum();
        let line = |i: usize| PAD_RADIUS * (2.0 * i as f32 / (PAD_SAMPLES - 1) as f32 - 1.0);
        let grid = (0..PAD_SAMPLES * PAD_SAMPLES).map(|i| (line(i % PAD_SAMPLES), line(i / PAD_SAMPLES)));
        let pad = grid.filter(|(x, z)| x * x + z * z <= PAD_RADIUS * PAD_RADIUS * 1.001).map(|(x, z)| {
            let [along, aside] = PAD_CURVATURE;
            let up = 0.5 * (z * z / along + x * x / aside);
            let z = z + PAD_AHEAD;
            let point = (ball.translation + across * x + ahead * z).with_y(up);
            SolePoint {
                in_foot: foot.rotation.conjugate() * (point - foot.translation),
                in_ball: ball.rotation.conjugate() * (point - ball.translation),
                ball_weight: ((z - TOE_BLEND[0]) / (TOE_BLEND[1] - TOE_BLEND[0])).clamp(0.0, 1.0),
            }
        });
        let [to_front, to_side] = HEEL_AT;
        let low = foot.translation.with_y(0.0) + (ahead * to_front + outwards * to_side) * length;
        let [long, wide, high] = HEEL_AXES.map(|axis| axis * length);
        let into_foot = |v: Vec3| foot.rotation.conjugate() * v;
        Self {
            heel: into_foot(low + Vec3::Y * high - foot.translation),
            axes: [into_foot(ahead * long), into_foot(across * wide), into_foot(Vec3::Y * high)],
            ball: pad.collect(),
        }
    }

    /// Displacement along the floor of the contact area from one frame to the next, from `model_from_joint` of foot and ball.
    fn step(&self, point: FootPoint, before: &[RigidTransform; 2], now: &[RigidTransform; 2]) -> Vec3 {
        let step = match point {
            FootPoint::Heel => {
                let low = self.lowest_of_heel(before[0]);
                at(now[0], low) - at(before[0], low)
            }
            FootPoint::Ball => {
                let positions: Vec<Vec3> = self.ball.iter().map(|point| point.at(before)).collect();
                let lowest = positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
                let touching = self.ball.iter().zip(&positions).filter(|(_, p)| p.y < lowest + TOUCHING);
                let steps = touching.map(|(point, position)| point.at(now) - *position);
                let (sum, count) = steps.fold((Vec3::ZERO, 0), |(sum, count), s| (sum + s, count + 1));
                sum / count.max(1) as f32
            }
        };
        step.with_y(0.0)
    }

    /// The lowest point of the heel, in the foot's space. The point of an ellipsoid with half axes aᵢ that is farthest in the
    /// direction d is Σ aᵢ (aᵢ·d) / √Σ (aᵢ·d)² from its centre.
    fn lowest_of_heel(&self, foot: RigidTransform) -> Vec3 {
        let down = foot.rotation.conjugate() * Vec3::NEG_Y;
        let far: Vec3 = self.axes.iter().map(|axis| *axis * axis.dot(down)).sum();
        self.heel + far / libm::sqrtf(far.dot(down)).max(f32::MIN_POSITIVE)
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
pub(super) fn steps(clip: &Clip, leg: &Leg, contacts: &[Contact]) -> Vec<Vec<Vec3>> {
    let sole = RoundSole::of(leg, &clip.skeleton().model_from_joints());
    let mut joints = Vec::with_capacity(clip.frame_count());
    for_each_pose(clip, slice::from_ref(leg), |_, _, model| {
        joints.push([model[leg.limb.end], model[leg.ball]]);
    });
    let of_contact = |contact: &Contact| {
        let frames = joints.get(contact.start..contact.end).unwrap_or_default();
        frames.windows(2).map(|pair| sole.step(contact.point, &pair[0], &pair[1])).collect()
    };
    contacts.iter().map(of_contact).collect()
}

/// How far a foot has slid along the floor in each frame, metres, relative to the mean over the frames in which it stays on
/// the floor; `None` in frames in which neither heel nor ball touches.
pub(super) fn slips(clip: &Clip, leg: &Leg, contacts: &[Contact]) -> Vec<Option<Vec3>> {
    let count = clip.frame_count();
    let mut touches = vec![false; count];
    // Sums and counts of the steps that lead to each frame.
    let mut sums = vec![(Vec3::ZERO, 0.0); count];
    for (contact, steps) in contacts.iter().zip(steps(clip, leg, contacts)) {
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
    slips
}

#[cfg(test)]
mod tests {
    use crate::math::Rotation;

    use super::*;
    use crate::testing::bodies::bodies;

    const POINTS: [FootPoint; 2] = [FootPoint::Heel, FootPoint::Ball];

    fn left(rest: &crate::skeleton::Skeleton) -> (RoundSole, [RigidTransform; 2]) {
        let (leg, model) = (Leg::both(rest).unwrap()[0], rest.model_from_joints());
        (RoundSole::of(&leg, &model), [model[leg.limb.end], model[leg.ball]])
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
                let heel = at(standing[0], sole.lowest_of_heel(standing[0]));
                let pivoted = rotated(&standing, Rotation::from_rotation_y(0.3), heel);
                let [heel, ball] = POINTS.map(|point| sole.step(point, &standing, &pivoted).length());
                assert!(heel < 1e-5 && ball > 0.03, "{body}: {heel} {ball}");
            }
        }
    }

    #[test]
    fn the_heel_touches_at_the_lowest_point_of_its_ellipsoid() {
        let (_, rest) = bodies().remove(0);
        let (sole, flat) = left(&rest);
        for (pitch, roll) in [(0.0_f32, 0.0_f32), (-0.3, 0.0), (0.1, 0.2), (-0.1, -0.3)] {
            let foot = rotated(
                &flat,
                Rotation::from_rotation_x(pitch) * Rotation::from_rotation_z(roll),
                Vec3::ZERO,
            )[0];
            let lowest = at(foot, sole.lowest_of_heel(foot));
            let sphere = (0..200).flat_map(|i| (0..200).map(move |j| (i as f32 * 0.0315, j as f32 * 0.0158)));
            let surface = sphere.map(|(u, v)| {
                let [a, b, c] = sole.axes;
                at(foot, sole.heel + a * u.cos() * v.sin() + b * u.sin() * v.sin() + c * v.cos())
            });
            let sampled = surface.min_by(|a, b| a.y.total_cmp(&b.y)).unwrap();
            assert!(lowest.y <= sampled.y + 1e-6 && lowest.distance(sampled) < 5e-4, "{lowest} {sampled}");
        }
        // In a flat foot that point is on the floor and behind the ankle.
        let lowest = at(flat[0], sole.lowest_of_heel(flat[0]));
        assert!(lowest.y.abs() < 1e-5 && lowest.z < flat[0].translation.z, "{lowest}");
    }
}
