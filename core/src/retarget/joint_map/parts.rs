//! Names taken apart: separators, camel case, numbers, the side and words that say nothing are split off, and what is left is
//! compared with the vocabularies. It serves names with a prefix or a suffix of their own, such as `Alice_LeftUpperArm`,
//! `CC_Base_L_Thigh`, `Hips_01` or `左ひじ`.

use std::collections::{BTreeMap, BTreeSet};

use super::Slot;
use super::names::{self, MORE_VOCABULARIES, VOCABULARIES, local};
use crate::Side;
use crate::skeleton::{RigJoint, SidedJoint, Skeleton};

/// Words that say nothing about the part of the body.
const NOISE: [&str; 9] = ["jnt", "joint", "jt", "bone", "bn", "def", "org", "bind", "skn"];
/// Words of what hangs from a body or is held by it, and is no part of it.
const HANGING: [&str; 32] = [
    "hair",
    "bang",
    "bangs",
    "pony",
    "ponytail",
    "twintail",
    "pigtail",
    "braid",
    "ribbon",
    "tail",
    "skirt",
    "cape",
    "cloak",
    "cloth",
    "dress",
    "coat",
    "scarf",
    "sleeve",
    "wing",
    "wings",
    "ear",
    "ears",
    "breast",
    "bust",
    "sword",
    "weapon",
    "gun",
    "shield",
    "prop",
    "髪",
    "スカート",
    "リボン",
];
/// The least number of names that share a prefix or suffix.
const SHARED: usize = 8;
/// The most prefixes and the most suffixes that are tried.
const TRIED: usize = 8;
/// The most words of one of them.
const LONGEST: usize = 7;
/// From this number of joints of the main chains on, which are 19, no other prefix and suffix is tried: toes may be missing.
const ENOUGH: usize = 17;

/// A side, if the name tells one, and what the name says otherwise.
pub(super) type Key = (Option<Side>, String);

/// What is taken off one end of the names.
#[derive(Clone, Debug, PartialEq)]
enum Affix {
    Nothing,
    /// A number, whichever it is.
    Number,
    Words(Vec<String>),
    /// A number beside these words.
    NumberAnd(Vec<String>),
}

/// The words of a name in lower case: split at separators, capitals, numbers and the signs of the sides.
fn words(name: &str) -> Vec<String> {
    #[derive(Clone, Copy, PartialEq)]
    enum Kind {
        Lower,
        Upper,
        Digit,
        Other,
    }
    let mut words: Vec<String> = Vec::new();
    let mut before: Option<Kind> = None;
    for c in local(name).chars() {
        // Full-width letters and digits are as good as the others.
        let c = match u32::from(c) {
            wide @ 0xFF01..=0xFF5E => char::from_u32(wide - 0xFEE0).unwrap_or(c),
            _ => c,
        };
        let kind = match c {
            _ if !c.is_alphanumeric() => None,
            _ if c.is_ascii_digit() => Some(Kind::Digit),
            _ if c.is_uppercase() => Some(Kind::Upper),
            _ if c.is_lowercase() => Some(Kind::Lower),
            _ => Some(Kind::Other),
        };
        if let Some(kind) = kind {
            if before == Some(Kind::Upper) && kind == Kind::Lower {
                // The capital before a small letter begins the word: `LArm` is `l`, `arm`.
                let last = words.last_mut().filter(|word| word.chars().count() > 1);
                if let Some(capital) = last.and_then(String::pop) {
                    words.push(capital.to_string());
                }
            } else if before != Some(kind) || matches!(c, '左' | '右') {
                words.push(String::new());
            }
            if let Some(word) = words.last_mut() {
                word.extend(c.to_lowercase());
            }
        }
        // What follows the sign of a side is another word.
        before = kind.filter(|_| !matches!(c, '左' | '右'));
    }
    words
}

fn side_of(word: &str) -> Option<Side> {
    match word {
        "left" | "lft" | "lt" | "l" | "左" => Some(Side::Left),
        "right" | "rgt" | "rt" | "r" | "右" => Some(Side::Right),
        _ => None,
    }
}

fn is_number(word: &str) -> bool {
    word.bytes().all(|b| b.is_ascii_digit())
}

/// The words as one, and the same with numbers without leading zeros.
fn joined(words: &[&str]) -> [String; 2] {
    let short = |word: &&str| match word.trim_start_matches('0') {
        _ if !is_number(word) => (*word).to_owned(),
        "" => "0".to_owned(),
        short => short.to_owned(),
    };
    [words.concat(), words.iter().map(short).collect()]
}

/// What a name may be called in a vocabulary, the likeliest first.
fn keys(words: &[String]) -> Vec<Key> {
    let mut kept: Vec<&str> = words.iter().map(String::as_str).filter(|word| !NOISE.contains(word)).collect();
    let letters = kept.len() > 1;
    let place = |long: bool| {
        kept.iter().position(|word| side_of(word).is_some() && (word.len() > 1) == long && (long || letters))
    };
    let side = place(true).or_else(|| place(false)).and_then(|at| side_of(kept.remove(at)));
    if kept.len() > 1 {
        // The sign of what has no side: `Root_M`, `J_Bip_C_Hips`.
        kept.retain(|word| !matches!(*word, "m" | "c"));
    }
    let mut keys: Vec<Key> = joined(&kept).into_iter().map(|stem| (side, stem)).collect();
    if side.is_none() {
        // `lfemur`, `LUArm`, `leftarm`, `armright`.
        let glued = |stem: &str| {
            let of =
                |word: &'static str, side| stem.strip_prefix(word).map(|rest| (Some(side), rest.to_owned()));
            let end =
                |word: &'static str, side| stem.strip_suffix(word).map(|rest| (Some(side), rest.to_owned()));
            let (left, right) = (Side::Left, Side::Right);
            [
                of("left", left),
                of("right", right),
                end("left", left),
                end("right", right),
                of("l", left),
                of("r", right),
            ]
        };
        let both: Vec<Key> = keys.iter().flat_map(|(_, stem)| glued(stem)).flatten().collect();
        keys.extend(both);
    }
    keys.retain(|(_, stem)| !stem.is_empty());
    keys
}

/// Prefixes or suffixes, as `take` cuts them off the words of a name, that many names share.
fn shared(names: &[Vec<String>], take: fn(&[String], usize) -> &[String]) -> Vec<Affix> {
    let mut counts = BTreeMap::<&[String], usize>::new();
    for words in names {
        for count in 1..words.len().min(LONGEST + 1) {
            let affix = take(words, count);
            if affix.iter().all(|word| side_of(word).is_none()) {
                *counts.entry(affix).or_default() += 1;
            }
        }
    }
    let mut most: Vec<_> = counts.into_iter().filter(|(_, count)| *count >= SHARED).collect();
    most.sort_by_key(|(affix, count)| (std::cmp::Reverse(*count), std::cmp::Reverse(affix.len())));
    let words = most.into_iter().take(TRIED).map(|(words, _)| Affix::Words(words.to_vec()));
    [Affix::Nothing, Affix::Number].into_iter().chain(words).collect()
}

/// The words without a prefix and a suffix; those that lack them stay as they are.
fn bare<'a>(mut words: &'a [String], prefix: &Affix, suffix: &Affix) -> &'a [String] {
    words = match (prefix, words) {
        (Affix::Number, [first, rest @ ..]) if !rest.is_empty() && is_number(first) => rest,
        (Affix::Words(prefix), _) => {
            words.strip_prefix(&prefix[..]).filter(|rest| !rest.is_empty()).unwrap_or(words)
        }
        _ => words,
    };
    let without =
        |suffix: &[String]| words.strip_suffix(suffix).filter(|rest| !rest.is_empty()).unwrap_or(words);
    match suffix {
        Affix::Nothing => words,
        Affix::Number => without_number(words),
        Affix::Words(suffix) => without(suffix),
        Affix::NumberAnd(suffix) => without_number(without(suffix)),
    }
}

fn without_number(words: &[String]) -> &[String] {
    match words {
        [rest @ .., last] if !rest.is_empty() && is_number(last) => rest,
        _ => words,
    }
}

/// Joints by what their names may be called. Of two with the same key, that whose name says it more plainly is taken, then
/// the first.
fn index<'a>(names: impl Iterator<Item = (usize, &'a [String])>) -> BTreeMap<Key, usize> {
    let mut ranked = BTreeMap::<Key, (usize, usize)>::new();
    for (joint, words) in names {
        for (rank, key) in keys(words).into_iter().enumerate() {
            let found = ranked.entry(key).or_insert((rank, joint));
            *found = (*found).min((rank, joint));
        }
    }
    ranked.into_iter().map(|(key, (_, joint))| (key, joint)).collect()
}

/// Keys of a vocabulary's name that tells its side itself.
pub(super) fn keys_of_name(name: &str) -> Vec<Key> {
    let mut keys = keys(&words(name));
    keys.truncate(2);
    keys
}

/// Keys of a vocabulary's name from which the side has been left out.
pub(super) fn keys_of_stem(side: Option<Side>, stem: &str) -> [Key; 2] {
    let words = words(stem);
    joined(&words.iter().map(String::as_str).collect::<Vec<_>>()).map(|stem| (side, stem))
}

/// A joint of the main chains, and the one that must be above it.
type Link = (Slot, Option<Slot>);

/// The joints of the main chains.
fn chains() -> Vec<Link> {
    let mut chains = vec![(RigJoint::Pelvis.into(), None), (RigJoint::Neck01.into(), None)];
    chains.push((RigJoint::Head.into(), Some(RigJoint::Neck01.into())));
    for side in Side::ALL {
        let mut push = |ours: SidedJoint, above: Option<SidedJoint>| {
            chains.push((ours.on(side).into(), above.map(|above| above.on(side).into())));
        };
        push(SidedJoint::Thigh, None);
        push(SidedJoint::Calf, Some(SidedJoint::Thigh));
        push(SidedJoint::Foot, Some(SidedJoint::Calf));
        push(SidedJoint::Ball, Some(SidedJoint::Foot));
        push(SidedJoint::Clavicle, None);
        push(SidedJoint::Upperarm, Some(SidedJoint::Clavicle));
        push(SidedJoint::Lowerarm, Some(SidedJoint::Upperarm));
        push(SidedJoint::Hand, Some(SidedJoint::Lowerarm));
    }
    chains
}

/// Whether limbs, head and pelvis have all been found.
pub(super) fn is_complete(found: &BTreeMap<Slot, usize>) -> bool {
    let optional = |slot: &Slot| {
        let Slot::Joint(joint) = slot else { return true };
        matches!(joint.sided(), Some(SidedJoint::Clavicle | SidedJoint::Ball)) || *joint == RigJoint::Neck01
    };
    chains().iter().all(|(slot, _)| optional(slot) || found.contains_key(slot))
}

/// How many joints of the main chains were found and are in their order, and how many of all.
fn score(source: &Skeleton, chains: &[Link], found: &BTreeMap<Slot, usize>) -> (usize, usize) {
    let fits = |(slot, above): &Link| {
        let Some(joint) = found.get(slot) else { return false };
        above.and_then(|above| found.get(&above)).is_none_or(|above| is_below(source, *joint, *above))
    };
    (chains.iter().filter(|link| fits(link)).count(), found.len())
}

fn is_below(source: &Skeleton, joint: usize, above: usize) -> bool {
    source.ancestors(joint).any(|ancestor| ancestor == above)
}

/// What `found` lacks, after the names have been taken apart: the vocabulary with the most joints in the right order takes
/// its place if it has more of them; then other vocabularies' words fill what is still open in the main chains.
pub(super) fn improve(
    source: &Skeleton,
    taken: &[bool],
    mut found: (&'static str, BTreeMap<Slot, usize>),
) -> (&'static str, BTreeMap<Slot, usize>) {
    let names: Vec<Vec<String>> = source.names().iter().map(|name| words(name)).collect();
    let free = || (0..names.len()).filter(|joint| !taken[*joint]);
    let vocabularies = || VOCABULARIES.iter().chain(MORE_VOCABULARIES.iter());
    let prefixes = shared(&names, |words, count| &words[..count]);
    let mut suffixes = shared(&names, |words, count| &words[words.len() - count..]);
    let numbered = suffixes.iter().filter_map(|suffix| match suffix {
        Affix::Words(words) => Some(Affix::NumberAnd(words.clone())),
        _ => None,
    });
    suffixes.extend(numbered.take(2).collect::<Vec<_>>());
    let chains = chains();
    let mut best = score(source, &chains, &found.1);
    let mut form = index(free().map(|joint| (joint, &names[joint][..])));
    for (prefix, suffix) in
        prefixes.iter().flat_map(|prefix| suffixes.iter().map(move |suffix| (prefix, suffix)))
    {
        let index = index(free().map(|joint| (joint, bare(&names[joint], prefix, suffix))));
        let mut better = false;
        for vocabulary in vocabularies() {
            let matched = names::matched(&vocabulary.keys, &index);
            let reached = score(source, &chains, &matched);
            if reached > best {
                (best, found, better) = (reached, (vocabulary.name, matched), true);
            }
        }
        if better {
            form = index;
        }
        if best.0 >= ENOUGH && is_complete(&found.1) {
            break;
        }
    }
    fill(source, &form, &mut found.1);
    found
}

/// Adds joints of the main chains under any vocabulary's word where they fit between those found.
fn fill(source: &Skeleton, index: &BTreeMap<Key, usize>, found: &mut BTreeMap<Slot, usize>) {
    let chains = chains();
    let mut used: BTreeSet<usize> = found.values().copied().collect();
    for (slot, above) in &chains {
        if found.contains_key(slot) {
            continue;
        }
        let fits = |joint: usize| {
            let over =
                above.and_then(|above| found.get(&above)).is_none_or(|over| is_below(source, joint, *over));
            let mut next =
                chains.iter().filter(|(_, over)| *over == Some(*slot)).filter_map(|(s, _)| found.get(s));
            over && next.all(|under| is_below(source, *under, joint))
        };
        let rows = VOCABULARIES
            .iter()
            .chain(MORE_VOCABULARIES.iter())
            .flat_map(|vocabulary| &vocabulary.keys)
            .filter(|(ours, _)| ours == slot);
        let mut joints = rows.flat_map(|(_, keys)| keys).filter_map(|key| index.get(key).copied());
        if let Some(joint) = joints.find(|joint| !used.contains(joint) && fits(*joint)) {
            used.insert(joint);
            found.insert(*slot, joint);
        }
    }
}

/// Joints whose names say that they hang from the body or are held by it, with all below them: hair, skirts, tails, weapons.
/// A subtree that has joints in `body` or most of the skeleton is not among them: the word is part of the character's name.
pub(super) fn hanging(source: &Skeleton, body: &[usize]) -> Vec<bool> {
    let count = source.len();
    let said = |name: &String| words(name).iter().any(|word| HANGING.contains(&word.as_str()));
    let said: Vec<bool> = source.names().iter().map(said).collect();
    let mut sizes = vec![1usize; count];
    let mut has_body: Vec<bool> = (0..count).map(|joint| body.contains(&joint)).collect();
    for (joint, parent) in source.parents().iter().enumerate().rev() {
        if let Some(parent) = parent.map(|parent| parent as usize) {
            sizes[parent] += sizes[joint];
            has_body[parent] |= has_body[joint];
        }
    }
    let mut hangs = vec![false; count];
    for (joint, parent) in source.parents().iter().enumerate() {
        let own = said[joint] && !has_body[joint] && 2 * sizes[joint] < count;
        hangs[joint] = own || parent.is_some_and(|parent| hangs[parent as usize]);
    }
    hangs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(name: &str) -> Key {
        keys(&words(name)).swap_remove(0)
    }

    #[test]
    fn a_name_is_taken_apart() {
        let (left, right) = (Some(Side::Left), Some(Side::Right));
        for (name, side, stem) in [
            ("LeftUpperArm", left, "upperarm"),
            ("upper_arm.R", right, "upperarm"),
            ("L Thigh", left, "thigh"),
            ("RThigh", right, "thigh"),
            ("Root_M", None, "root"),
            ("mHipLeft", left, "hip"),
            ("left_shoulder_1_joint", left, "shoulder1"),
            ("右ひじ", right, "ひじ"),
            ("上半身２", None, "上半身2"),
            ("a|b:Hips_jnt", None, "hips"),
        ] {
            assert_eq!(first(name), (side, stem.to_owned()), "{name}");
        }
        assert!(keys(&words("LUArm")).contains(&(left, "uarm".to_owned())));
        assert!(keys(&words("spine_003")).contains(&(None, "spine3".to_owned())));
    }
}
