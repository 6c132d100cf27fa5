//! From MakeHuman's resting arms to an exact T-pose, per body.
//!
//! Upper arm, forearm and hand are swung in turn so that shoulder, elbow, wrist and the middle finger's knuckle
//! lie on one line along ±X. The swing is the shortest rotation, found anew for each body: one rotation for all
//! bodies would leave the arms up to several millimetres off. Vertices follow by linear blend skinning.

use anthronet::Side;
use anthronet::math::Rotation;
use anthronet::skeleton::{RigJoint, SidedJoint};
use glam::Vec3;

use crate::Result;
use crate::assets::Assets;
use crate::landmarks::{ACROMION, RADIALE};

/// The joints of one arm, and how much each point follows its three segments.
struct Arm {
    outward: Vec3,
    // Point numbers of shoulder, elbow, wrist and the knuckle that gives the hand's direction.
    chain: [usize; 4],
    // Point, and its weights for upper arm, forearm and hand; the rest stays.
    weights: Vec<(u32, [f32; 3])>,
}

/// Where the shoulder's centre lies, by points of the skin.
struct Shoulder {
    // Vertices of the cage whose mean is the acromion's outer edge, on this side and on the other.
    acromion: [[usize; 2]; 2],
    // Vertex at the head of the radius.
    radiale: usize,
    // Point numbers of the shoulder and of the collarbone's end.
    joint: [usize; 2],
}

/// The shoulder's centre lies below the acromion by this share of the distance to the head of the radius (de Leva 1996,
/// "Joint center longitudinal positions computed from a selected subset of Chandler's data").
const BELOW_ACROMION: f32 = 0.104;
/// It lies under the middle of the humerus' head, inwards of the acromion's outer edge by this share of the distance between
/// both acromia: 20 mm of 400.
const INSIDE_ACROMION: f32 = 0.05;

impl Shoulder {
    fn place(&self, points: &mut [Vec3]) {
        let [own, other] = self.acromion.map(|[a, b]| (points[a] + points[b]) * 0.5);
        let down = points[self.radiale] - own;
        let centre = own + Vec3::NEG_Y * (BELOW_ACROMION * down.length()) + (other - own) * INSIDE_ACROMION;
        for joint in self.joint {
            points[joint] = centre;
        }
    }
}

/// Swings both arms of a body into the T-pose.
pub struct TPose {
    shoulders: [Shoulder; 2],
    arms: [Arm; 2],
    pelvis: usize,
    ground: usize,
}

impl TPose {
    /// Finds the arms in the rig.
    ///
    /// # Errors
    /// [`Error::Source`](crate::Error::Source) when a joint is missing.
    pub fn new(assets: &Assets) -> Result<Self> {
        let joint = |joint: RigJoint| assets.rig.require(joint.name());
        let heads = assets.mesh.raw_of_surface.len();
        let arm = |side: Side| -> Result<Arm> {
            let chain = [SidedJoint::Upperarm, SidedJoint::Lowerarm, SidedJoint::Hand, SidedJoint::Middle01];
            let mut joints = [0; 4];
            for (slot, of_arm) in joints.iter_mut().zip(chain) {
                *slot = joint(of_arm.on(side))?;
            }
            let outward = match side {
                Side::Left => Vec3::X,
                Side::Right => Vec3::NEG_X,
            };
            Ok(Arm { outward, chain: joints.map(|j| heads + j), weights: weights(assets, &joints) })
        };
        let mirror = |v: u32| {
            let missing = || crate::Error::Source(format!("hm08.mirror: vertex {v} has no mirror image"));
            assets.mesh.mirror.get(&v).copied().ok_or_else(missing)
        };
        let tails = heads + assets.rig.joints.len();
        let shoulder = |side: Side| -> Result<Shoulder> {
            let on = |v: u32, side: Side| -> Result<usize> {
                Ok(if side == Side::Left { v } else { mirror(v)? } as usize)
            };
            let acromion = |side| Ok::<_, crate::Error>([on(ACROMION[0], side)?, on(ACROMION[1], side)?]);
            Ok(Shoulder {
                acromion: [acromion(side)?, acromion(side.mirrored())?],
                radiale: on(RADIALE, side)?,
                joint: [
                    heads + joint(SidedJoint::Upperarm.on(side))?,
                    tails + joint(SidedJoint::Clavicle.on(side))?,
                ],
            })
        };
        Ok(Self {
            shoulders: [shoulder(Side::Left)?, shoulder(Side::Right)?],
            arms: [arm(Side::Left)?, arm(Side::Right)?],
            pelvis: heads + joint(RigJoint::Pelvis)?,
            ground: heads + joint(RigJoint::Root)?,
        })
    }

    /// Straightens the arms and moves the pelvis to the origin; `points` are those of [`Assets`].
    ///
    /// Twist joints are moved to their place along the limb.
    pub fn apply(&self, assets: &Assets, points: &mut [Vec3]) {
        for shoulder in &self.shoulders {
            shoulder.place(points);
        }
        for arm in &self.arms {
            arm.apply(points);
        }
        let heads = assets.mesh.raw_of_surface.len();
        let tails = heads + assets.rig.joints.len();
        for &(joint, place) in &assets.rig.twists {
            let Some(limb) = assets.rig.joints[joint].parent else { continue };
            let (start, end) = (points[heads + limb], points[tails + limb]);
            points[heads + joint] = start.lerp(end, place);
            // Twist joints point along their limb and are a fixed share of its length long.
            points[tails + joint] = points[heads + joint] + (end - start) * 0.25;
        }
        // Root: below the pelvis, on the ground, between the feet.
        let origin = points[self.pelvis];
        let root = points[self.ground];
        points[self.ground] = Vec3::new(origin.x, root.y, origin.z);
        for p in points {
            *p -= origin;
        }
    }
}

impl Arm {
    fn apply(&self, points: &mut [Vec3]) {
        let [shoulder, elbow, wrist, knuckle] = self.chain.map(|p| points[p]);
        let direction = |from: Vec3, to: Vec3| (to - from).normalize_or(self.outward);
        let upper = Rotation::from_rotation_arc(direction(shoulder, elbow), self.outward);
        let lower = Rotation::from_rotation_arc(upper * direction(elbow, wrist), self.outward) * upper;
        let hand = Rotation::from_rotation_arc(lower * direction(wrist, knuckle), self.outward) * lower;
        let new_elbow = shoulder + self.outward * (elbow - shoulder).length();
        let new_wrist = new_elbow + self.outward * (wrist - elbow).length();
        for &(p, [u, l, h]) in &self.weights {
            let x = points[p as usize];
            let moved = (shoulder + upper * (x - shoulder)) * u
                + (new_elbow + lower * (x - elbow)) * l
                + (new_wrist + hand * (x - wrist)) * h;
            points[p as usize] = moved + x * (1.0 - u - l - h);
        }
        // Exactly on the line in spite of rounding.
        points[self.chain[1]] = new_elbow;
        points[self.chain[2]] = new_wrist;
        points[self.chain[3]] = new_wrist + self.outward * (knuckle - wrist).length();
    }
}

/// Which of the three segments a joint belongs to: the one nearest above it.
fn segment(assets: &Assets, joints: &[usize; 4], joint: usize) -> Option<usize> {
    let mut current = Some(joint);
    while let Some(j) = current {
        if let Some(segment) = joints[..3].iter().position(|&of_arm| of_arm == j) {
            return Some(segment);
        }
        current = assets.rig.joints[j].parent;
    }
    None
}

fn weights(assets: &Assets, joints: &[usize; 4]) -> Vec<(u32, [f32; 3])> {
    let mut out = Vec::new();
    for (p, influences) in assets.rig.weights.iter().enumerate() {
        let mut sums = [0.0; 3];
        for &(joint, w) in influences {
            if let Some(s) = segment(assets, joints, joint.into()) {
                sums[s] += w;
            }
        }
        if sums != [0.0; 3] {
            out.push((p as u32, sums));
        }
    }
    // A joint's head is carried by its parent, its tail by itself.
    let heads = assets.mesh.raw_of_surface.len();
    let count = assets.rig.joints.len();
    for (j, joint) in assets.rig.joints.iter().enumerate() {
        for (point, carrier) in [(heads + j, joint.parent), (heads + count + j, Some(j))] {
            if let Some(s) = carrier.and_then(|c| segment(assets, joints, c)) {
                let mut one = [0.0; 3];
                one[s] = 1.0;
                out.push((point as u32, one));
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_that_hangs_is_swung_out_and_keeps_its_lengths() {
        // Shoulder, elbow, wrist, knuckle, then a point of the chest, of the upper arm, the forearm and the hand.
        let chain = [
            Vec3::new(0.2, 1.4, 0.0),
            Vec3::new(0.35, 1.15, -0.03),
            Vec3::new(0.45, 0.95, 0.06),
            Vec3::new(0.46, 0.87, 0.09),
        ];
        let [shoulder, elbow, wrist, knuckle] = chain;
        let middle = |a: Vec3, b: Vec3| a.lerp(b, 0.5);
        let mut points = vec![shoulder, elbow, wrist, knuckle, Vec3::new(0.0, 1.3, 0.1)];
        points.extend([middle(shoulder, elbow), middle(elbow, wrist), middle(wrist, knuckle)]);
        let before = points.clone();
        let arm = Arm {
            outward: Vec3::X,
            chain: [0, 1, 2, 3],
            weights: vec![(5, [1.0, 0.0, 0.0]), (6, [0.0, 1.0, 0.0]), (7, [0.0, 0.0, 1.0])],
        };
        arm.apply(&mut points);
        assert_eq!((points[0], points[4]), (before[0], before[4]));
        for i in 1..4 {
            assert_eq!((points[i].y, points[i].z), (shoulder.y, shoulder.z));
            let length = |p: &[Vec3]| p[i].distance(p[i - 1]);
            assert!((length(&points) - length(&before)).abs() < 1e-6);
            // A point on the bone stays half-way along it.
            assert!(points[i + 4].distance(middle(points[i - 1], points[i])) < 1e-6, "{points:?}");
        }
        // Straight arms stay as they are.
        let straight = points.clone();
        arm.apply(&mut points);
        assert!(points.iter().zip(&straight).all(|(a, b)| a.distance(*b) < 1e-6));
    }
}
