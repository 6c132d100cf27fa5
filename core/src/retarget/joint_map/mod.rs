//! Joint matching: which joint of a motion file drives which joint of the rig, by name, by geometry, or by the user's mapping.

mod geometry;
mod names;
mod overrides;
mod parts;
mod programs;
#[cfg(test)]
mod rigs;
mod slot;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod vendors;

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

pub use overrides::{Overrides, read_overrides};
pub(super) use slot::Slot;

use crate::skeleton::humanoid::{humanoid_bones, native_name};
use crate::skeleton::{RigJoint, SidedJoint, Skeleton};
use crate::{Error, Result, Side};

/// Joints that a source must have.
const REQUIRED: [RigJoint; 5] = [
    RigJoint::Pelvis,
    SidedJoint::Thigh.on(Side::Left),
    SidedJoint::Thigh.on(Side::Right),
    SidedJoint::Calf.on(Side::Left),
    SidedJoint::Calf.on(Side::Right),
];
/// The spine and the neck of the rig, upwards.
pub(in crate::retarget) const SPINE: [RigJoint; 3] =
    [RigJoint::Spine01, RigJoint::Spine02, RigJoint::Spine03];
pub(in crate::retarget) const NECK: [RigJoint; 1] = [RigJoint::Neck01];

/// The joints of a source skeleton that drive those of the rig.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMap {
    sources: BTreeMap<Slot, usize>,
    spine: Vec<usize>,
    neck: Vec<usize>,
    report: JointMapReport,
}

/// How a match was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MatchedBy {
    /// By name, in the vocabulary of the report.
    Name,
    /// By hierarchy and rest pose.
    Geometry,
    /// By the file's own table of human bones, as VRM has one.
    Table,
    /// By the user's mapping.
    Mapping,
    /// By its position in the spine or the neck, which are transferred as a whole.
    Chain,
}

/// A source joint and what it drives.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointMatch {
    /// Name in the source.
    pub source: String,
    /// Name in the rig: of a joint, or `hand_tip_l` for a joint that only gives the direction of a hand. Where a spine or
    /// neck has more joints than the rig's, several have the same target.
    pub target: String,
    /// How it was found.
    pub by: MatchedBy,
}

/// The result of matching for every joint.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct JointMapReport {
    /// The vocabulary of the names; `None` when no joint was matched by name.
    pub vocabulary: Option<String>,
    /// The matches, in the order of the source.
    pub matched: Vec<JointMatch>,
    /// Source joints above or between matched ones, whose motion reaches the next matched joint below, and joints with names
    /// of twist joints, which are recomputed.
    pub passed_on: Vec<String>,
    /// Source joints whose motion is lost.
    pub unmatched: Vec<String>,
    /// Humanoid joints of the rig without a source: they stay at rest or share the motion of spine and neck.
    pub without_source: Vec<String>,
}

impl JointMap {
    /// Matches the joints of a source. The file's own table of human bones comes first, if it has one, then names in the
    /// vocabulary with the most matches, then hierarchy and rest pose for what is left; these the other way round when names do
    /// not give pelvis, thighs and calves. `overrides` take precedence over all: source joint to joint of the rig, or to `None`
    /// for a joint that is to drive nothing.
    ///
    /// # Errors
    /// [`Error::Invalid`] when `overrides` names a joint that does not exist (with similar names) or maps two to one, or when
    /// pelvis, thighs or calves are not found, naming them.
    pub fn find(source: &Skeleton, overrides: &Overrides) -> Result<Self> {
        let (mapped, nothing) = overrides::check(source, overrides)?;
        let mut taken = vec![false; source.len()];
        for &joint in mapped.values().chain(&nothing) {
            taken[joint] = true;
        }
        let mut builder = Builder { source, taken, pairs: BTreeMap::new() };
        for (ours, joint) in mapped {
            builder.pairs.insert(ours, (joint, MatchedBy::Mapping));
        }
        builder.add_table();
        let (vocabulary, by_name) = names::best(source, &builder.taken);
        let body: Vec<usize> = by_name.values().copied().chain(builder.joints()).collect();
        let by_geometry = geometry::find(source, &parts::hanging(source, &body));
        let named = |slot: Slot| by_name.contains_key(&slot) || builder.pairs.contains_key(&slot);
        let names_first = REQUIRED.iter().all(|joint| named(Slot::Joint(*joint)));
        let mut guesses = [(by_name, MatchedBy::Name), (by_geometry, MatchedBy::Geometry)];
        if !names_first {
            guesses.reverse();
        }
        for (found, by) in guesses {
            builder.add(found, by);
        }
        let missing: Vec<&str> = REQUIRED
            .into_iter()
            .filter(|joint| builder.joint(*joint).is_none())
            .map(RigJoint::name)
            .collect();
        if !missing.is_empty() {
            let joints: Vec<&str> = source.names().iter().take(12).map(String::as_str).collect();
            return Err(Error::invalid(
                "joint mapping",
                format!(
                    "found no {} among {} joints ({}{}): name them in a mapping file",
                    missing.join(", "),
                    source.len(),
                    joints.join(", "),
                    if source.len() > joints.len() { ", …" } else { "" },
                ),
            ));
        }
        let any_named = builder.pairs.values().any(|(_, by)| *by == MatchedBy::Name);
        Ok(builder.finish(any_named.then(|| vocabulary.to_owned()), &nothing))
    }

    /// Index of the source joint that drives this joint of the rig.
    pub fn source_of(&self, ours: RigJoint) -> Option<usize> {
        self.source_for(Slot::Joint(ours))
    }

    /// Index of the source joint for this slot.
    pub(super) fn source_for(&self, slot: Slot) -> Option<usize> {
        self.sources.get(&slot).copied()
    }

    /// Every source joint that drives something.
    pub(super) fn joints(&self) -> impl Iterator<Item = usize> + '_ {
        self.sources.values().chain(&self.spine).chain(&self.neck).copied()
    }

    /// How the source joint of this joint of the rig was found.
    pub(super) fn matched_by(&self, ours: RigJoint) -> Option<MatchedBy> {
        self.report.matched.iter().find(|found| found.target == ours.name()).map(|found| found.by)
    }

    /// Name of a source joint that drives a joint of the rig.
    pub(super) fn name_of(&self, ours: RigJoint) -> Option<&str> {
        self.report
            .matched
            .iter()
            .find(|found| found.target == ours.name())
            .map(|found| found.source.as_str())
    }

    /// Joints that are no part of the body by their names, with all below them: hair, skirts, weapons.
    pub(super) fn hanging(&self, source: &Skeleton) -> Vec<bool> {
        parts::hanging(source, &self.joints().collect::<Vec<_>>())
    }

    /// The source's joints between pelvis and neck, upwards.
    pub fn spine(&self) -> &[usize] {
        &self.spine
    }

    /// The source's joints between spine and head, upwards.
    pub fn neck(&self) -> &[usize] {
        &self.neck
    }

    /// The result of matching for every joint.
    pub fn report(&self) -> &JointMapReport {
        &self.report
    }
}

struct Builder<'a> {
    source: &'a Skeleton,
    taken: Vec<bool>,
    pairs: BTreeMap<Slot, (usize, MatchedBy)>,
}

impl Builder<'_> {
    /// Adds what the file's own table says of joints that are free.
    fn add_table(&mut self) {
        for &(ours, joint) in self.source.humanoid() {
            let (ours, joint) = (Slot::Joint(ours), joint as usize);
            if !self.taken[joint] && !self.pairs.contains_key(&ours) {
                self.taken[joint] = true;
                self.pairs.insert(ours, (joint, MatchedBy::Table));
            }
        }
    }

    /// Adds matches whose joints are both free.
    fn add(&mut self, found: BTreeMap<Slot, usize>, by: MatchedBy) {
        // Names beside a table may be those of another character.
        let by_table = self.pairs.values().any(|(_, by)| *by == MatchedBy::Table);
        for (ours, joint) in found {
            // A match by geometry must not contradict the matches above it.
            let consistent = match by {
                MatchedBy::Geometry => self.fits(ours, joint) && self.is_below_its_limb(ours, joint),
                _ => !by_table || self.fits(ours, joint),
            };
            if consistent && !self.taken[joint] && !self.pairs.contains_key(&ours) {
                self.taken[joint] = true;
                self.pairs.insert(ours, (joint, by));
            }
        }
    }

    /// Whether the nearest matched joint above is not on the other side of the body.
    fn fits(&self, ours: Slot, joint: usize) -> bool {
        let Some(above) = self.ancestors(joint).find_map(|j| self.ours_of(j)) else { return true };
        above.side().is_none_or(|side| ours.side() != Some(side.mirrored()))
    }

    /// Whether the joint is below the nearest joint of its own limb that is matched by something better than geometry.
    fn is_below_its_limb(&self, ours: Slot, joint: usize) -> bool {
        let Slot::Joint(RigJoint::Sided(stem, side)) = ours else { return true };
        let limbs = [
            [SidedJoint::Clavicle, SidedJoint::Upperarm, SidedJoint::Lowerarm, SidedJoint::Hand],
            [SidedJoint::Thigh, SidedJoint::Calf, SidedJoint::Foot, SidedJoint::Ball],
        ];
        let stem = if stem.finger().is_some() { SidedJoint::Hand } else { stem };
        let Some(limb) = limbs.iter().find(|limb| limb.contains(&stem)) else { return true };
        let own = limb.iter().position(|joint| *joint == stem).unwrap_or(0);
        let above = limb[..own].iter().rev().find_map(|near| {
            let (at, by) = self.pairs.get(&Slot::Joint(near.on(side)))?;
            (*by != MatchedBy::Geometry).then_some(*at)
        });
        above.is_none_or(|above| self.ancestors(joint).any(|j| j == above))
    }

    fn joints(&self) -> impl Iterator<Item = usize> + '_ {
        self.pairs.values().map(|(joint, _)| *joint)
    }

    fn ours_of(&self, joint: usize) -> Option<Slot> {
        self.pairs.iter().find(|(_, (j, _))| *j == joint).map(|(ours, _)| *ours)
    }

    /// The joint's ancestors, from its parent upwards.
    fn ancestors(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        self.source.ancestors(joint)
    }

    fn joint(&self, ours: RigJoint) -> Option<usize> {
        self.pairs.get(&Slot::Joint(ours)).map(|pair| pair.0)
    }

    /// Spine and neck: the joints strictly between pelvis and head, upwards. Without a head the path ends at the topmost match
    /// of neck, arms or spine.
    fn chains(&self, nothing: &[usize]) -> (Vec<usize>, Vec<usize>) {
        let pelvis = self.joint(RigJoint::Pelvis);
        let [[a, b], [c, d]] = [SidedJoint::Clavicle, SidedJoint::Upperarm].map(SidedJoint::both);
        let arms = [a, b, c, d];
        let tops = [RigJoint::Head].into_iter().chain(NECK).chain(arms).chain(SPINE.into_iter().rev());
        let Some((top, joint)) = tops.filter_map(|ours| Some((ours, self.joint(ours)?))).next() else {
            return Default::default();
        };
        // In some skeletons the pelvis is beside the spine, below a joint that moves both.
        let below: Vec<usize> =
            pelvis.into_iter().flat_map(|pelvis| self.ancestors(pelvis).chain([pelvis])).collect();
        let mut path: Vec<usize> = self.ancestors(joint).take_while(|j| !below.contains(j)).collect();
        path.reverse();
        if NECK.contains(&top) || SPINE.contains(&top) {
            path.push(joint);
        }
        path.retain(|joint| !nothing.contains(joint) && self.ours_of(*joint).and_then(Slot::side).is_none());
        // The neck begins at the joint matched as such, or above the last joint from which an arm branches.
        let named = self.joint(RigJoint::Neck01).and_then(|neck| path.iter().position(|j| *j == neck));
        let above_arms = || {
            let last = |ours| {
                self.ancestors(self.joint(ours)?).find_map(|above| path.iter().position(|j| *j == above))
            };
            arms.into_iter().filter_map(last).max().map(|at| at + 1)
        };
        let neck = path.split_off(named.or_else(above_arms).unwrap_or(path.len()));
        (path, neck)
    }

    fn finish(mut self, vocabulary: Option<String>, nothing: &[usize]) -> JointMap {
        let (spine, neck) = self.chains(nothing);
        for (chain, ours) in [(&spine, &SPINE[..]), (&neck, &NECK)] {
            for (i, &joint) in chain.iter().enumerate() {
                if self.taken[joint] {
                    continue;
                }
                // The joint of the rig at the same position in the chain.
                let at = if chain.len() > ours.len() { i * ours.len() / chain.len() } else { i };
                let free = (at..ours.len()).find(|&k| self.joint(ours[k]).is_none());
                self.taken[joint] = true;
                if let Some(ours) = free.and_then(|k| ours.get(k)) {
                    self.pairs.insert(Slot::Joint(*ours), (joint, MatchedBy::Chain));
                }
            }
        }
        let matched_or_above: BTreeSet<usize> =
            self.pairs.values().flat_map(|(joint, _)| self.ancestors(*joint).chain([*joint])).collect();
        let names = self.source.names();
        let mut report = JointMapReport { vocabulary, ..Default::default() };
        for (joint, name) in names.iter().enumerate() {
            if let Some((ours, (_, by))) = self.pairs.iter().find(|(_, (j, _))| *j == joint) {
                let target = ours.name().to_owned();
                report.matched.push(JointMatch { source: name.clone(), target, by: *by });
            } else if let Some(ours) = chain_slot(joint, &spine, &neck) {
                let (target, by) = (ours.name().to_owned(), MatchedBy::Chain);
                report.matched.push(JointMatch { source: name.clone(), target, by });
            } else if matched_or_above.contains(&joint)
                || RigJoint::from_name(&native_name(name)).is_some_and(RigJoint::is_twist)
            {
                report.passed_on.push(name.clone());
            } else {
                report.unmatched.push(name.clone());
            }
        }
        let without = humanoid_bones().iter().filter(|bone| self.joint(bone.joint).is_none());
        report.without_source = without.map(|bone| bone.native.clone()).collect();
        let sources = self.pairs.into_iter().map(|(ours, (joint, _))| (ours, joint)).collect();
        JointMap { sources, spine, neck, report }
    }
}

fn chain_slot(joint: usize, spine: &[usize], neck: &[usize]) -> Option<RigJoint> {
    let place = |chain: &[usize]| chain.iter().position(|j| *j == joint);
    let spine_slot = |at: usize| SPINE[at * SPINE.len() / spine.len()];
    place(spine).map(spine_slot).or_else(|| place(neck).map(|_| RigJoint::Neck01))
}
