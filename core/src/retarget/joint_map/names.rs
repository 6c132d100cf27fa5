//! Tables of joint names in other programs and the joint of the rig that each drives.
//!
//! Names are compared without namespace, common prefix, case and separators. Five vocabularies are those of
//! [`skeleton::humanoid`](crate::skeleton::humanoid), which can also be written; the others are only read:
//! - **CMU ASF**: the Carnegie Mellon motion capture database's own skeleton. Its `lwrist` rolls the forearm two thirds
//!   down its length; the wrist that bends is `lhand`.
//! - **cgspeed**: B. Hahne's BVH conversion of that database. The wrist that bends is `LeftFingerBase`, and
//!   `LeftHandIndex1` stands for all fingers.
//! - **MotionBuilder**: the names of its template, also in FAIR's and many other BVH files.
//! - **Biovision**: the names of the first BVH files, such as `LeftKnee`.
//! - **SMPL**, SMPL-H, SMPL-X: names of the published models, whose `left_foot` is the ball of the foot.
//! - **Rokoko**, **Xsens**, **3ds Max Biped**, **Daz**, **VRoid**, **Rigify**: names that these programs export.
//!
//! Those of `programs.rs` are compared where these do not give all limbs.

use std::{collections::BTreeMap, sync::LazyLock};

use super::parts::Key;
use super::programs::MORE;
use super::{Slot, parts};
use crate::Side;
use crate::skeleton::Skeleton;
use crate::skeleton::humanoid::humanoid_bones;

/// A vocabulary: slots with their names, the preferred name first.
pub(super) struct Vocabulary {
    pub(super) name: &'static str,
    pub(super) rows: Vec<(Slot, Vec<String>)>,
    /// The same taken apart.
    pub(super) keys: Vec<(Slot, Vec<Key>)>,
}

/// Source text of a vocabulary: rows `ours=theirs|theirs…`, with `*` for the side.
pub(super) struct VocabularyText {
    pub(super) name: &'static str,
    pub(super) sides: [&'static str; 2],
    pub(super) central: &'static str,
    pub(super) sided: &'static str,
}

const TEXTS: [VocabularyText; 12] = [
    VocabularyText {
        name: "CMU ASF",
        sides: ["l", "r"],
        central: "pelvis=root|hips spine_01=lowerback neck_01=lowerneck|neck head=head",
        sided: "thigh=*femur calf=*tibia foot=*foot ball=*toes clavicle=*clavicle upperarm=*humerus \
                lowerarm=*radius hand=*hand|*wrist hand_tip=*fingers thumb_01=*thumb",
    },
    VocabularyText {
        name: "MotionBuilder",
        sides: ["left", "right"],
        central: "pelvis=hips spine_01=spine spine_02=spine1 spine_03=spine2 neck_01=neck head=head jaw=jaw",
        sided: "thigh=*upleg calf=*leg foot=*foot ball=*toebase clavicle=*shoulder upperarm=*arm \
                lowerarm=*forearm hand=*hand hand_tip=*handend eye=*eye \
                thumb_01=*handthumb1 thumb_02=*handthumb2 thumb_03=*handthumb3 \
                index_01=*handindex1 index_02=*handindex2 index_03=*handindex3 \
                middle_01=*handmiddle1 middle_02=*handmiddle2 middle_03=*handmiddle3 \
                ring_01=*handring1 ring_02=*handring2 ring_03=*handring3 \
                pinky_01=*handpinky1 pinky_02=*handpinky2 pinky_03=*handpinky3",
    },
    VocabularyText {
        name: "cgspeed",
        sides: ["left", "right"],
        central: "pelvis=hips spine_01=lowerback spine_02=spine spine_03=spine1 neck_01=neck head=head",
        sided: "thigh=*upleg calf=*leg foot=*foot ball=*toebase clavicle=*shoulder upperarm=*arm \
                lowerarm=*forearm hand=*fingerbase hand_tip=*handindex1 thumb_01=*thumb",
    },
    VocabularyText {
        name: "Biovision",
        sides: ["left", "right"],
        central: "pelvis=hips spine_01=lowerback|chest neck_01=neck head=head",
        sided: "thigh=*hip calf=*knee foot=*ankle ball=*toe clavicle=*collar upperarm=*shoulder|*uparm \
                lowerarm=*elbow|*lowarm hand=*wrist|*hand hand_tip=*fingers",
    },
    VocabularyText {
        name: "SMPL",
        sides: ["left", "right"],
        central: "pelvis=pelvis spine_01=spine1 neck_01=neck head=head jaw=jaw",
        sided: "thigh=*hip calf=*knee foot=*ankle ball=*foot clavicle=*collar upperarm=*shoulder \
                lowerarm=*elbow hand=*wrist hand_tip=*hand eye=*eyesmplhf|*eye \
                thumb_01=*thumb1 thumb_02=*thumb2 thumb_03=*thumb3 index_01=*index1 index_02=*index2 \
                index_03=*index3 middle_01=*middle1 middle_02=*middle2 middle_03=*middle3 ring_01=*ring1 \
                ring_02=*ring2 ring_03=*ring3 pinky_01=*pinky1 pinky_02=*pinky2 pinky_03=*pinky3",
    },
    VocabularyText {
        name: "SMPL in Maya",
        sides: ["l", "r"],
        central: "pelvis=pelvis spine_01=spine1 neck_01=neck head=head",
        sided: "thigh=*hip calf=*knee foot=*ankle ball=*foot clavicle=*collar upperarm=*shoulder \
                lowerarm=*elbow hand=*wrist hand_tip=*hand",
    },
    VocabularyText {
        name: "Rokoko",
        sides: ["left", "right"],
        central: "pelvis=hips spine_01=spine1|spine neck_01=neck head=head",
        sided: "thigh=*thigh calf=*shin foot=*foot ball=*toe clavicle=*shoulder upperarm=*arm \
                lowerarm=*forearm hand=*hand \
                thumb_01=*finger1metacarpal thumb_02=*finger1proximal thumb_03=*finger1distal \
                index_01=*finger2proximal index_02=*finger2medial|*finger2intermediate \
                index_03=*finger2distal middle_01=*finger3proximal \
                middle_02=*finger3medial|*finger3intermediate middle_03=*finger3distal \
                ring_01=*finger4proximal ring_02=*finger4medial|*finger4intermediate \
                ring_03=*finger4distal pinky_01=*finger5proximal \
                pinky_02=*finger5medial|*finger5intermediate pinky_03=*finger5distal",
    },
    VocabularyText {
        name: "Xsens",
        sides: ["left", "right"],
        central: "pelvis=hips|pelvis spine_01=chest|l5 neck_01=neck head=head",
        sided: "thigh=*hip|*upperleg calf=*knee|*lowerleg foot=*ankle|*foot ball=*toe \
                clavicle=*collar|*shoulder upperarm=*upperarm|*shoulder lowerarm=*forearm|*elbow \
                hand=*hand|*wrist",
    },
    VocabularyText {
        name: "3ds Max Biped",
        sides: ["l", "r"],
        central: "pelvis=pelvis spine_01=spine neck_01=neck head=head",
        sided: "thigh=*thigh calf=*calf foot=*foot ball=*toe0 clavicle=*clavicle upperarm=*upperarm \
                lowerarm=*forearm hand=*hand thumb_01=*finger0 thumb_02=*finger01 thumb_03=*finger02 \
                index_01=*finger1 index_02=*finger11 index_03=*finger12 middle_01=*finger2 \
                middle_02=*finger21 middle_03=*finger22 ring_01=*finger3 ring_02=*finger31 \
                ring_03=*finger32 pinky_01=*finger4 pinky_02=*finger41 pinky_03=*finger42",
    },
    VocabularyText {
        name: "Daz",
        sides: ["l", "r"],
        central: "pelvis=pelvis|hip spine_01=abdomenlower|abdomen neck_01=necklower|neck head=head",
        sided: "thigh=*thighbend|*thigh calf=*shin foot=*foot ball=*toe clavicle=*collar \
                upperarm=*shldrbend|*shldr lowerarm=*forearmbend|*forearm hand=*hand eye=*eye \
                thumb_01=*thumb1 thumb_02=*thumb2 thumb_03=*thumb3 index_01=*index1 index_02=*index2 \
                index_03=*index3 middle_01=*mid1 middle_02=*mid2 middle_03=*mid3 ring_01=*ring1 \
                ring_02=*ring2 ring_03=*ring3 pinky_01=*pinky1 pinky_02=*pinky2 pinky_03=*pinky3",
    },
    VocabularyText {
        name: "VRoid",
        sides: ["l", "r"],
        central: "pelvis=chips spine_01=cspine neck_01=cneck head=chead",
        sided: "thigh=*upperleg calf=*lowerleg foot=*foot ball=*toebase clavicle=*shoulder \
                upperarm=*upperarm lowerarm=*lowerarm hand=*hand thumb_01=*thumb1 thumb_02=*thumb2 \
                thumb_03=*thumb3 index_01=*index1 index_02=*index2 index_03=*index3 middle_01=*middle1 \
                middle_02=*middle2 middle_03=*middle3 ring_01=*ring1 ring_02=*ring2 ring_03=*ring3 \
                pinky_01=*little1 pinky_02=*little2 pinky_03=*little3",
    },
    VocabularyText {
        name: "Rigify",
        sides: ["l", "r"],
        central: "pelvis=spine spine_01=spine001 neck_01=spine004 head=spine006",
        sided: "thigh=thigh* calf=shin* foot=foot* ball=toe* clavicle=shoulder* upperarm=upperarm* \
                lowerarm=forearm* hand=hand* thumb_01=thumb01* thumb_02=thumb02* thumb_03=thumb03* \
                index_01=findex01* index_02=findex02* index_03=findex03* middle_01=fmiddle01* \
                middle_02=fmiddle02* middle_03=fmiddle03* ring_01=fring01* ring_02=fring02* \
                ring_03=fring03* pinky_01=fpinky01* pinky_02=fpinky02* pinky_03=fpinky03*",
    },
];

/// The vocabularies of this file, the rig's own first: of several with equally many matches the first is taken.
pub(super) static VOCABULARIES: LazyLock<Vec<Vocabulary>> = LazyLock::new(|| {
    let bones = humanoid_bones();
    let column = |name, of: fn(usize) -> &'static str| {
        let slots = || bones.iter().enumerate().map(|(b, bone)| (Slot::Joint(bone.joint), of(b)));
        Vocabulary {
            name,
            rows: slots().map(|(slot, name)| (slot, vec![plain(name)])).collect(),
            keys: slots().map(|(slot, name)| (slot, parts::keys_of_name(name))).collect(),
        }
    };
    let mut all = vec![
        column("native", |b| &humanoid_bones()[b].native),
        column("Mixamo", |b| &humanoid_bones()[b].mixamo),
        column("Unity", |b| &humanoid_bones()[b].unity),
        column("VRM", |b| &humanoid_bones()[b].vrm),
        column("Blender", |b| &humanoid_bones()[b].blender),
    ];
    all.extend(TEXTS.iter().map(VocabularyText::parse));
    all
});

/// Vocabularies of more programs, for names that those do not match whole.
pub(super) static MORE_VOCABULARIES: LazyLock<Vec<Vocabulary>> =
    LazyLock::new(|| MORE.iter().map(VocabularyText::parse).collect());

impl VocabularyText {
    fn parse(&self) -> Vocabulary {
        let (mut rows, mut keys) = (Vec::new(), Vec::new());
        let mut add = |slot: Option<Slot>, theirs: &str, word: &str| {
            let Some(slot) = slot else { return };
            rows.push((slot, theirs.split('|').map(|name| name.replace('*', word)).collect()));
            let stems = theirs.split('|').map(|name| name.replace('*', ""));
            keys.push((slot, stems.flat_map(|stem| parts::keys_of_stem(slot.side(), &stem)).collect()));
        };
        let pairs = |text: &'static str| text.split_ascii_whitespace().filter_map(|row| row.split_once('='));
        for (ours, theirs) in pairs(self.central) {
            add(Slot::from_name(ours), theirs, "");
        }
        for (word, side) in self.sides.iter().zip(Side::ALL) {
            for (ours, theirs) in pairs(self.sided) {
                add(Slot::from_name(&[ours, side.joint_suffix()].concat()), theirs, word);
            }
        }
        Vocabulary { name: self.name, rows, keys }
    }
}

/// A name without its namespace and the path before it.
pub(super) fn local(name: &str) -> &str {
    name.rsplit([':', '|']).next().unwrap_or(name)
}

/// A name without namespace and separators, in lower case.
fn plain(name: &str) -> String {
    local(name).chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// The names of a skeleton, normalised for comparison: as [`plain`], and without a prefix that most of them share, such as
/// `Bip01 ` or `DEF-`.
pub(super) fn comparable(names: &[String]) -> Vec<String> {
    let local: Vec<&str> = names.iter().map(|name| local(name)).collect();
    let mut counts = BTreeMap::<&str, usize>::new();
    for name in &local {
        for (end, _) in name.match_indices(['_', ' ', '-', '.']) {
            *counts.entry(&name[..=end]).or_insert(0) += 1;
        }
    }
    let most = counts.into_iter().filter(|(_, n)| n * 5 >= names.len() * 3 && names.len() > 2);
    // The longest prefix that most names share.
    let prefix = most.max_by_key(|(prefix, _)| prefix.len()).map_or("", |(prefix, _)| prefix);
    local.iter().map(|name| plain(name.strip_prefix(prefix).unwrap_or(name))).collect()
}

/// The vocabulary that matches the most joints, with its matches. Source joints in `taken` are skipped. Of two source joints
/// with the same normalised name the first is used. Where names as they are do not give all limbs, they are taken apart.
pub(super) fn best(source: &Skeleton, taken: &[bool]) -> (&'static str, BTreeMap<Slot, usize>) {
    let mut index = BTreeMap::new();
    for (joint, name) in comparable(source.names()).into_iter().enumerate() {
        if !taken[joint] {
            index.entry(name).or_insert(joint);
        }
    }
    let mut found = ("", BTreeMap::new());
    for vocabulary in VOCABULARIES.iter() {
        let matched = matched(&vocabulary.rows, &index);
        if matched.len() > found.1.len() {
            found = (vocabulary.name, matched);
        }
    }
    if parts::is_complete(&found.1) { found } else { parts::improve(source, taken, found) }
}

/// The joints that a vocabulary's rows find in an index of names; each joint is found once.
pub(super) fn matched<K: Ord>(rows: &[(Slot, Vec<K>)], index: &BTreeMap<K, usize>) -> BTreeMap<Slot, usize> {
    let mut used = std::collections::BTreeSet::new();
    let mut matched = BTreeMap::new();
    for (ours, theirs) in rows {
        let joint = theirs.iter().find_map(|name| index.get(name));
        if let Some(&joint) = joint.filter(|j| used.insert(**j)) {
            matched.insert(*ours, joint);
        }
    }
    matched
}
