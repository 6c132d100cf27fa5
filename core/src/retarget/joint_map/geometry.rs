//! Joint matching by hierarchy and rest pose, for skeletons whose names are unknown.
//!
//! The hips are the deepest joint from which two branches of similar length reach the floor. The chest is the deepest joint
//! below them with a branch to either side: the arms. Within a limb, human proportions tell which joint is the knee or the
//! elbow. The toes point to the front, which tells left from right. The rest pose must stand upright, +Y up, facing any
//! direction; arms may hang or be held out.

use std::collections::BTreeMap;

use glam::Vec3;

use super::Slot;
use crate::Side;
use crate::skeleton::{Finger, RigJoint, SidedJoint, Skeleton};

/// Lengths of upper arm and forearm as shares of thigh and calf together: 50th percentiles of adults (Winter, *Biomechanics and
/// Motor Control of Human Movement*, table 4.1: 0.186 and 0.146 of height to 0.245 and 0.246).
const UPPER_ARM: f32 = 0.38;
const FOREARM: f32 = 0.30;

/// The rest pose of a source, with its tree from parents to children.
struct Tree<'a> {
    rest: &'a Skeleton,
    /// Positions of the joints in model space.
    positions: Vec<Vec3>,
    children: Vec<Vec<usize>>,
    /// The child with the longest path down; `None` where no path has a length.
    longest: Vec<Option<usize>>,
}

/// Joints of a limb beyond this number are ignored.
const MAX_LIMB: usize = 24;

/// The source joints that were found, by slot. Those in `hanging`, one entry per joint, are no part of the body.
pub(super) fn find(rest: &Skeleton, hanging: &[bool]) -> BTreeMap<Slot, usize> {
    let tree = Tree::new(rest, hanging);
    let mut found = BTreeMap::new();
    let Some((hips, legs)) = tree.hips() else { return found };
    let limbs: Vec<_> = legs.iter().filter_map(|&leg| tree.leg(hips, leg)).collect();
    let [first, second] = &limbs[..] else { return found };
    // Toes point to the front; without toes it is assumed to be +Z.
    let front: Vec3 = limbs.iter().map(|leg| leg.toes.with_y(0.0)).sum();
    let front = front.try_normalize().unwrap_or(Vec3::Z);
    let left = Vec3::Y.cross(front);
    let first_is_left = (tree.positions[first.joints[0]] - tree.positions[second.joints[0]]).dot(left) >= 0.0;
    let first_side = if first_is_left { Side::Left } else { Side::Right };
    found.insert(RigJoint::Pelvis.into(), hips);
    for (leg, side) in [(first, first_side), (second, first_side.mirrored())] {
        let ours = [SidedJoint::Thigh, SidedJoint::Calf, SidedJoint::Foot, SidedJoint::Ball];
        for (ours, &joint) in ours.iter().zip(&leg.joints) {
            found.insert(ours.on(side).into(), joint);
        }
    }
    let leg_length = limbs.iter().map(|leg| leg.length).sum::<f32>() / 2.0;
    tree.trunk(hips, &legs, left, leg_length, &mut found);
    found
}

/// A leg of the source.
struct LegChain {
    /// Thigh, calf, foot and, if there is one, ball.
    joints: Vec<usize>,
    /// Length of thigh and calf together.
    length: f32,
    /// From the foot joint to the end of the toes.
    toes: Vec3,
}

impl<'a> Tree<'a> {
    fn new(rest: &'a Skeleton, hanging: &[bool]) -> Self {
        let model = rest.model_from_joints();
        let mut children = vec![Vec::new(); rest.len()];
        for (joint, parent) in rest.parents().iter().enumerate().filter(|(joint, _)| !hanging[*joint]) {
            if let Some(parent) = parent {
                children[*parent as usize].push(joint);
            }
        }
        let positions: Vec<Vec3> = model.iter().map(|m| m.translation).collect();
        let mut longest = vec![None; rest.len()];
        let mut reach = vec![0.0_f32; rest.len()];
        for joint in (0..rest.len()).rev() {
            for &child in &children[joint] {
                let length = reach[child] + positions[child].distance(positions[joint]);
                if length > reach[joint] {
                    (reach[joint], longest[joint]) = (length, Some(child));
                }
            }
        }
        Self { rest, positions, children, longest }
    }

    /// A joint and all below it, parents first.
    fn below(&self, joint: usize) -> Vec<usize> {
        let mut list = vec![joint];
        let mut next = 0;
        while let Some(&j) = list.get(next) {
            list.extend(&self.children[j]);
            next += 1;
        }
        list
    }

    /// The joints from `top` down to `joint`, both included.
    fn path(&self, top: usize, joint: usize) -> Vec<usize> {
        let mut path = vec![joint];
        let mut current = joint;
        while current != top {
            let Some(parent) = self.rest.parents()[current] else { break };
            current = parent as usize;
            path.push(current);
        }
        path.reverse();
        path
    }

    fn length(&self, path: &[usize]) -> f32 {
        path.windows(2).map(|pair| self.positions[pair[0]].distance(self.positions[pair[1]])).sum()
    }

    /// The longest path down from a joint, which is its first element.
    fn longest(&self, top: usize) -> Vec<usize> {
        std::iter::successors(Some(top), |&joint| self.longest[joint]).collect()
    }

    /// The hips and the two branches that are legs.
    fn hips(&self) -> Option<(usize, [usize; 2])> {
        let lowest = self.positions.iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
        let highest = self.positions.iter().map(|p| p.y).fold(f32::NEG_INFINITY, f32::max);
        let height = highest - lowest;
        // Deepest first, as joints come after their parents.
        for hips in (0..self.rest.len()).rev() {
            let mut legs: Vec<(f32, usize)> = self.children[hips]
                .iter()
                .filter_map(|&child| {
                    let path = self.longest(child);
                    let low = path.iter().map(|&j| self.positions[j].y).fold(f32::INFINITY, f32::min);
                    let reaches_floor = low < lowest + 0.12 * height;
                    let length = self.length(&path);
                    (path.len() >= 3 && reaches_floor && length > 0.3 * height).then_some((length, child))
                })
                .collect();
            legs.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            if let [first, second, ..] = legs[..]
                && second.0 > 0.8 * first.0
                && self.positions[hips].y > lowest + 0.3 * height
            {
                return Some((hips, [first.1, second.1]));
            }
        }
        None
    }

    fn leg(&self, hips: usize, branch: usize) -> Option<LegChain> {
        let mut path = self.longest(branch);
        path.truncate(MAX_LIMB);
        let floor = path.iter().map(|&j| self.positions[j].y).fold(f32::INFINITY, f32::min);
        let drop = self.positions[hips].y - floor;
        // The ankle is the first joint within a fifth of the leg above the floor; people have it at about a tenth.
        let ankle = path.iter().position(|&j| self.positions[j].y - floor < 0.2 * drop)?;
        let whole = self.length(&path[..=ankle]);
        let mut best: Option<(f32, usize, usize)> = None;
        for knee in 1..ankle {
            let calf = self.length(&path[knee..=ankle]);
            for thigh in 0..knee {
                let upper = self.length(&path[thigh..=knee]);
                // Thigh and calf have about the same length and are most of the leg.
                if upper + calf < 0.75 * whole || upper <= 0.0 || calf <= 0.0 {
                    continue;
                }
                let cost = libm::logf(upper / calf).abs();
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, thigh, knee));
                }
            }
        }
        let (_, thigh, knee) = best?;
        let foot = path[ankle];
        let ball = path.get(ankle + 1).copied().filter(|&j| self.positions[j] != self.positions[foot]);
        let end = path.last().copied().unwrap_or(foot);
        let toes = if end == foot { self.end(foot) } else { self.positions[end] } - self.positions[foot];
        let joints = [path[thigh], path[knee], foot].into_iter().chain(ball).collect();
        Some(LegChain { joints, length: self.length(&path[thigh..=ankle]), toes })
    }

    /// The far end of a joint's bone; the joint itself when the end is unknown.
    fn end(&self, joint: usize) -> Vec3 {
        let end = self.rest.ends()[joint].unwrap_or(Vec3::ZERO);
        self.rest.model_from_joints()[joint].to_affine().transform_point3(end)
    }

    /// Finds spine, neck, head and arms.
    fn trunk(&self, hips: usize, legs: &[usize; 2], left: Vec3, leg: f32, found: &mut BTreeMap<Slot, usize>) {
        let centre = self.positions[hips];
        let branches: Vec<usize> = self.below(hips).into_iter().filter(|j| !legs.contains(j)).collect();
        // The chest: the deepest joint with an arm on each side. Where several have chains there, hair and skirts are among them:
        // arms hang from the upper trunk, below the head, and are not much longer than a leg.
        let pairs = branches.iter().rev().filter_map(|&chest| {
            let side = |sign: f32| {
                let sideways = self.children[chest].iter().copied().filter(|child| {
                    let path = self.longest(*child);
                    let end = path.last().map_or(centre, |&j| self.positions[j]);
                    let aside = sign * (end - centre).dot(left) > 0.12 * leg;
                    !legs.contains(child) && aside && self.length(&path) > 0.5 * leg && path.len() >= 3
                });
                // The first of them, but rather not one that is too long.
                sideways.min_by_key(|&child| self.is_longer_than_arms(child, leg))
            };
            Some((chest, side(1.0)?, side(-1.0)?))
        });
        let pairs: Vec<_> = pairs.filter(|(chest, ..)| *chest != hips).collect();
        let top = branches.iter().map(|&j| self.positions[j].y).fold(centre.y, f32::max);
        let likely = |&&(chest, left, right): &&(usize, usize, usize)| {
            let high = self.positions[chest].y > centre.y + 0.3 * (top - centre.y);
            high && [left, right].iter().all(|&arm| !self.is_longer_than_arms(arm, leg))
        };
        let Some(&(chest, left_arm, right_arm)) = pairs.iter().rev().find(likely).or(pairs.first()) else {
            return;
        };
        for (branch, side) in [(left_arm, Side::Left), (right_arm, Side::Right)] {
            self.arm(branch, side, leg, left.cross(Vec3::Y), found);
        }
        if let Some(&first) = self.path(hips, chest).get(1) {
            found.insert(RigJoint::Spine01.into(), first);
        }
        let head = self.children[chest]
            .iter()
            .copied()
            .filter(|child| ![left_arm, right_arm].contains(child))
            .map(|child| self.longest(child))
            .max_by(|a, b| {
                let top = |path: &[usize]| path.last().map_or(0.0, |&j| self.positions[j].y);
                top(a).total_cmp(&top(b))
            });
        let Some(path) = head else { return };
        // The head joint has several children, such as eyes; else it is the one nearest to 0.17 leg lengths above the shoulders.
        let shoulders = SidedJoint::Upperarm.both().into_iter().filter_map(|joint| found.get(&joint.into()));
        let shoulder = shoulders.map(|&j| self.positions[j].y).fold(f32::NEG_INFINITY, f32::max);
        let miss = |joint: usize| (self.positions[joint].y - shoulder - 0.17 * leg).abs();
        let head = path.iter().position(|&j| self.children[j].len() > 1).or_else(|| {
            (0..path.len()).min_by(|&a, &b| miss(path[a]).total_cmp(&miss(path[b])).then(b.cmp(&a)))
        });
        let Some(head) = head else { return };
        found.insert(RigJoint::Head.into(), path[head]);
        if head > 0 {
            found.insert(RigJoint::Neck01.into(), path[0]);
        }
    }

    /// Whether a branch is longer than an arm with its fingers, measured by the length of thigh and calf together.
    fn is_longer_than_arms(&self, branch: usize, leg: f32) -> bool {
        self.length(&self.longest(branch)) > 1.5 * leg
    }

    fn arm(&self, branch: usize, side: Side, leg: f32, front: Vec3, found: &mut BTreeMap<Slot, usize>) {
        let mut path = self.longest(branch);
        path.truncate(MAX_LIMB);
        let mut best: Option<(f32, [usize; 3])> = None;
        for wrist in 2..path.len() {
            for elbow in 1..wrist {
                for shoulder in 0..elbow {
                    let miss = |from: usize, to: usize, part: f32| {
                        let length = self.length(&path[from..=to]);
                        libm::logf((length / (part * leg)).max(1e-3)).abs()
                    };
                    let cost = miss(shoulder, elbow, UPPER_ARM) + miss(elbow, wrist, FOREARM);
                    // Several fingers branch from a wrist.
                    let cost = if self.children[path[wrist]].len() >= 3 { cost - 0.5 } else { cost };
                    if best.is_none_or(|(least, _)| cost < least) {
                        best = Some((cost, [shoulder, elbow, wrist]));
                    }
                }
            }
        }
        let Some((_, [shoulder, elbow, wrist])) = best else { return };
        for (ours, at) in
            [(SidedJoint::Upperarm, shoulder), (SidedJoint::Lowerarm, elbow), (SidedJoint::Hand, wrist)]
        {
            found.insert(ours.on(side).into(), path[at]);
        }
        if shoulder > 0 {
            found.insert(SidedJoint::Clavicle.on(side).into(), path[0]);
        }
        self.fingers(path[wrist], side, front, found);
    }

    /// Finds the fingers if a hand has five: the thumb ends nearest to the wrist, the others are in a row beside it.
    fn fingers(&self, hand: usize, side: Side, front: Vec3, found: &mut BTreeMap<Slot, usize>) {
        let mut chains: Vec<Vec<usize>> =
            self.children[hand].iter().map(|&c| self.longest(c)).filter(|path| path.len() >= 3).collect();
        if chains.len() != 5 {
            return;
        }
        let wrist = self.positions[hand];
        for chain in &mut chains {
            // A first joint nearer to the wrist than to its child is that of a metacarpal.
            let first = self.positions[chain[0]].distance(wrist);
            if chain.len() > 3 && first < self.positions[chain[0]].distance(self.positions[chain[1]]) {
                chain.remove(0);
            }
        }
        let reach = |chain: &Vec<usize>| chain.last().map_or(0.0, |&j| self.positions[j].distance(wrist));
        let Some(thumb) = (0..5).min_by(|&a, &b| reach(&chains[a]).total_cmp(&reach(&chains[b]))) else {
            return;
        };
        let thumb = chains.swap_remove(thumb);
        let mean = chains.iter().map(|c| self.positions[c[0]]).sum::<Vec3>() / 4.0;
        let along = (mean - wrist).normalize_or_zero();
        // Across the palm towards the thumb, which is the front in the T-pose.
        let towards = self.positions[thumb[thumb.len() - 1]] - mean;
        let across = (towards - along * towards.dot(along)).try_normalize().unwrap_or(front);
        chains.sort_by(|a, b| {
            (self.positions[b[0]] - mean).dot(across).total_cmp(&(self.positions[a[0]] - mean).dot(across))
        });
        chains.insert(0, thumb);
        for (finger, chain) in Finger::ALL.into_iter().zip(&chains) {
            for (ours, &joint) in finger.joints().into_iter().zip(chain) {
                found.insert(ours.on(side).into(), joint);
            }
        }
    }
}
