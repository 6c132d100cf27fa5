//! Which joint of a motion file drives which joint of ours: by name, by shape, or by the user's word.

mod geometry;
mod names;
mod overrides;
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

/// What a source must have.
const REQUIRED: [RigJoint; 5] = [
    RigJoint::Pelvis,
    SidedJoint::Thigh.on(Side::Left),
    SidedJoint::Thigh.on(Side::Right),
    SidedJoint::Calf.on(Side::Left),
    SidedJoint::Calf.on(Side::Right),
];
/// Our spine and our neck, upwards.
pub(super) const SPINE: [RigJoint; 3] = [RigJoint::Spine01, RigJoint::Spine02, RigJoint::Spine03];
pub(super) const NECK: [RigJoint; 1] = [RigJoint::Neck01];

/// The joints of a source skeleton that drive ours.
#[derive(Clone, Debug, PartialEq)]
pub struct JointMap {
    sources: BTreeMap<Slot, usize>,
    spine: Vec<usize>,
    neck: Vec<usize>,
    report: JointMapReport,
}

/// How a pair was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MatchedBy {
    /// By its name in the vocabulary.
    Name,
    /// By hierarchy and rest pose.
    Geometry,
    /// By the user's mapping.
    Mapping,
    /// It stands in the spine or the neck, which are transferred as a whole.
    Chain,
}

/// A source joint and what it drives.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointMatch {
    /// Name in the source.
    pub source: String,
    /// Name in our rig: of a joint, or `hand_tip_l` for what only says where a hand points. Joints of a spine or neck
    /// with more joints than ours name the first of ours.
    pub target: String,
    /// How it was found.
    pub by: MatchedBy,
}

/// What became of every joint.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct JointMapReport {
    /// The vocabulary of the names, when joints were matched by name.
    pub vocabulary: Option<String>,
    /// The pairs, in the order of the source.
    pub matched: Vec<JointMatch>,
    /// Source joints above or between matched ones: their motion arrives in the next matched joint below; and twist
    /// joints of our rig, which are set anew.
    pub passed_on: Vec<String>,
    /// Source joints whose motion is lost.
    pub unmatched: Vec<String>,
    /// Joints of ours that nothing drives: they rest, follow their parents, or share the motion of spine and neck.
    pub without_source: Vec<String>,
}

impl JointMap {
    /// Finds the pairs. The vocabulary with the most matches speaks first; what it does not name is looked for by
    /// hierarchy and rest pose, and that comes first when names do not even give pelvis, thighs and calves.
    /// `overrides` win over both: source joint to our joint, or to `None` for a joint that shall drive nothing.
    ///
    /// # Errors
    /// [`Error::Invalid`] when `overrides` names a joint that does not exist, with those most like it, or when pelvis,
    /// thighs or calves are not found, with their names.
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
        let (vocabulary, by_name) = names::best(source.names(), &builder.taken);
        let by_geometry = geometry::find(source);
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

    /// The source joint that drives this joint of ours.
    pub fn source_of(&self, ours: RigJoint) -> Option<usize> {
        self.source_for(Slot::Joint(ours))
    }

    /// The source joint for this slot.
    pub(super) fn source_for(&self, slot: Slot) -> Option<usize> {
        self.sources.get(&slot).copied()
    }

    /// Every source joint that drives something.
    pub(super) fn joints(&self) -> impl Iterator<Item = usize> + '_ {
        self.sources.values().chain(&self.spine).chain(&self.neck).copied()
    }

    /// The source's joints between pelvis and neck, upwards.
    pub fn spine(&self) -> &[usize] {
        &self.spine
    }

    /// The source's joints between spine and head, upwards.
    pub fn neck(&self) -> &[usize] {
        &self.neck
    }

    /// What became of every joint.
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
    /// Adds pairs whose joints are both free.
    fn add(&mut self, found: BTreeMap<Slot, usize>, by: MatchedBy) {
        for (ours, joint) in found {
            // A guess by shape must not contradict what is known above it.
            let known = by != MatchedBy::Geometry || self.fits(ours, joint);
            if known && !self.taken[joint] && !self.pairs.contains_key(&ours) {
                self.taken[joint] = true;
                self.pairs.insert(ours, (joint, by));
            }
        }
    }

    /// Whether the nearest matched joint above is on the same side or in the middle.
    fn fits(&self, ours: Slot, joint: usize) -> bool {
        let Some(above) = self.ancestors(joint).find_map(|j| self.ours_of(j)) else { return true };
        above.side().is_none_or(|side| ours.side() != Some(side.mirrored()))
    }

    fn ours_of(&self, joint: usize) -> Option<Slot> {
        self.pairs.iter().find(|(_, (j, _))| *j == joint).map(|(ours, _)| *ours)
    }

    /// From the joint's parent upwards.
    fn ancestors(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        let parents = self.source.parents();
        std::iter::successors(parents[joint], |&p| parents[p as usize]).map(|p| p as usize)
    }

    fn joint(&self, ours: RigJoint) -> Option<usize> {
        self.pairs.get(&Slot::Joint(ours)).map(|pair| pair.0)
    }

    /// The joints strictly between pelvis and head (or what stands for it), upwards, in spine and neck.
    fn chains(&self, nothing: &[usize]) -> (Vec<usize>, Vec<usize>) {
        let pelvis = self.joint(RigJoint::Pelvis);
        let [[a, b], [c, d]] = [SidedJoint::Clavicle, SidedJoint::Upperarm].map(SidedJoint::both);
        let arms = [a, b, c, d];
        let tops = [RigJoint::Head].into_iter().chain(NECK).chain(arms).chain(SPINE.into_iter().rev());
        let Some((top, joint)) = tops.filter_map(|ours| Some((ours, self.joint(ours)?))).next() else {
            return Default::default();
        };
        let mut path: Vec<usize> = self.ancestors(joint).take_while(|j| Some(*j) != pelvis).collect();
        path.reverse();
        if NECK.contains(&top) || SPINE.contains(&top) {
            path.push(joint);
        }
        path.retain(|joint| !nothing.contains(joint) && self.ours_of(*joint).and_then(Slot::side).is_none());
        // The neck begins at the joint so called, or above the last joint that an arm hangs from.
        let named = self.joint(RigJoint::Neck01).and_then(|neck| path.iter().position(|j| *j == neck));
        let hung = || {
            let last = |ours| {
                self.ancestors(self.joint(ours)?).find_map(|above| path.iter().position(|j| *j == above))
            };
            arms.into_iter().filter_map(last).max().map(|at| at + 1)
        };
        let neck = path.split_off(named.or_else(hung).unwrap_or(path.len()));
        (path, neck)
    }

    fn finish(mut self, vocabulary: Option<String>, nothing: &[usize]) -> JointMap {
        let (spine, neck) = self.chains(nothing);
        for (chain, ours) in [(&spine, &SPINE[..]), (&neck, &NECK)] {
            for (i, &joint) in chain.iter().enumerate() {
                if self.taken[joint] {
                    continue;
                }
                // The joint of ours at the same place in the chain.
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
