//! Names of the rig's joints in other programs.
//!
//! The rows are those of [`RigJoint`]'s table. The vocabularies besides the rig's own are:
//! - **Unity**: `HumanBodyBones` of the Unity scripting reference; with spaces they are `HumanTrait.BoneName`.
//! - **VRM**: `humanoid.humanBones` of VRMC_vrm 1.0, whose thumbs are metacarpal, proximal, distal.
//! - **Mixamo**: the names in files from mixamo.com, `mixamorig:` included.
//! - **Blender**: Rigify-like, with the suffixes `.L` and `.R` by which Blender finds mirrored bones.
//!
//! The root and the twist joints are not humanoid bones; each vocabulary gets names in its own style for them.

use std::{borrow::Cow, collections::BTreeMap, str::FromStr, sync::LazyLock};

use super::rig_joint::{Bone, CENTRAL, Names, RigJoint, SIDED};
use crate::{Error, Result, Side};

/// The vocabulary in which a file names its joints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum JointNames {
    /// The rig's own names, such as `upperarm_l`.
    #[default]
    Native,
    /// Unity's `HumanBodyBones`, such as `LeftUpperArm`.
    Unity,
    /// Mixamo's, such as `mixamorig:LeftArm`.
    Mixamo,
    /// VRM 1.0's, such as `leftUpperArm`.
    Vrm,
    /// Blender's, such as `upper_arm.L`.
    Blender,
}

impl JointNames {
    /// Every vocabulary.
    pub const ALL: [Self; 5] = [Self::Native, Self::Unity, Self::Mixamo, Self::Vrm, Self::Blender];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Native => "native",
            Self::Unity => "unity",
            Self::Mixamo => "mixamo",
            Self::Vrm => "vrm",
            Self::Blender => "blender",
        }
    }
}

impl FromStr for JointNames {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|scheme| scheme.name() == text).ok_or_else(|| {
            let known = Self::ALL.map(Self::name).join(", ");
            Error::request("joint_names", format!("expected one of {known}, got `{text}`"))
        })
    }
}

/// A joint of the rig that is a bone of the standard humanoid, with its name in every vocabulary.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HumanoidBone {
    /// The joint of the rig.
    pub joint: RigJoint,
    /// Name in the rig.
    pub native: String,
    /// Member of Unity's `HumanBodyBones`.
    pub unity: String,
    /// Name in Unity's `HumanTrait.BoneName`, as `AvatarBuilder` expects it: fingers have spaces, `Left Thumb Proximal`.
    pub unity_trait: String,
    /// Name in files from Mixamo.
    pub mixamo: String,
    /// Key in VRM 1.0's `humanBones`.
    pub vrm: String,
    /// Name in Blender.
    pub blender: String,
    /// Whether Unity and VRM 1.0 require it; both require the same fifteen.
    pub required: bool,
}

/// Prefix or suffix of a side: native, Unity, Mixamo, VRM, Blender.
fn affixes(side: Side) -> Names {
    match side {
        Side::Left => [side.joint_suffix(), "Left", "Left", "left", ".L"],
        Side::Right => [side.joint_suffix(), "Right", "Right", "right", ".R"],
    }
}

const UNITY_FINGERS: [&str; 5] = ["Thumb", "Index", "Middle", "Ring", "Little"];

struct Table {
    /// The humanoid bones: central before sided, left before right, required before optional.
    bones: Vec<HumanoidBone>,
    /// The names of every joint, in the order of [`JointNames::ALL`], by native name.
    names: BTreeMap<String, [String; 5]>,
}

static TABLE: LazyLock<Table> = LazyLock::new(|| {
    let mut table = Table { bones: Vec::new(), names: BTreeMap::new() };
    let mut add = |rows: Vec<(RigJoint, [String; 5], Bone)>| {
        for wanted in [Bone::Required, Bone::Optional] {
            let rows = rows.iter().filter(|row| row.2 == wanted);
            table
                .bones
                .extend(rows.map(|(joint, names, _)| bone(*joint, names.clone(), wanted == Bone::Required)));
        }
        table.names.extend(rows.into_iter().map(|(joint, names, _)| (joint.name().to_owned(), names)));
    };
    add(CENTRAL.iter().map(|(joint, row, bone)| (*joint, central(row), *bone)).collect());
    for side in Side::ALL {
        add(SIDED.iter().map(|(joint, row, bone)| (joint.on(side), sided(row, side), *bone)).collect());
    }
    table
});

fn central(row: &Names) -> [String; 5] {
    let [native, unity, mixamo, vrm, blender] = row.map(str::to_owned);
    [native, unity, format!("mixamorig:{mixamo}"), vrm, blender]
}

fn sided(row: &Names, side: Side) -> [String; 5] {
    let [native, unity, mixamo, vrm, blender] = row;
    let side = affixes(side);
    [
        format!("{native}{}", side[0]),
        format!("{}{unity}", side[1]),
        format!("mixamorig:{}{mixamo}", side[2]),
        format!("{}{vrm}", side[3]),
        format!("{blender}{}", side[4]),
    ]
}

fn bone(joint: RigJoint, [native, unity, mixamo, vrm, blender]: [String; 5], required: bool) -> HumanoidBone {
    let finger = UNITY_FINGERS.iter().find(|finger| unity.contains(*finger));
    let unity_trait = finger.map_or(unity.clone(), |finger| unity.replace(finger, &format!(" {finger} ")));
    HumanoidBone { joint, native, unity, unity_trait, mixamo, vrm, blender, required }
}

/// The humanoid bones of the rig: the seven central ones, then 24 of the left and 24 of the right side.
pub fn humanoid_bones() -> &'static [HumanoidBone] {
    &TABLE.bones
}

/// The humanoid bone with this native name; `None` for the root, twist joints and unknown names.
pub fn humanoid(native: &str) -> Option<&'static HumanoidBone> {
    TABLE.bones.iter().find(|bone| bone.native == native)
}

/// Native names of all joints of the rig, in alphabetical order.
pub fn native_names() -> impl Iterator<Item = &'static str> {
    TABLE.names.keys().map(String::as_str)
}

/// The name of a joint in another vocabulary; a joint that the rig does not have keeps its name.
pub fn renamed(native: &str, names: JointNames) -> Cow<'_, str> {
    match TABLE.names.get(native) {
        Some(row) if names != JointNames::Native => {
            let column = JointNames::ALL.iter().position(|scheme| *scheme == names).unwrap_or_default();
            Cow::Borrowed(row.get(column).map_or(native, String::as_str))
        }
        _ => Cow::Borrowed(native),
    }
}

/// The native name of the joint that has this name in any vocabulary; an unknown name is returned unchanged.
pub fn native_name(name: &str) -> Cow<'_, str> {
    if TABLE.names.contains_key(name) {
        return Cow::Borrowed(name);
    }
    let known = TABLE.names.iter().find(|(_, names)| names.iter().any(|other| other == name));
    known.map_or(Cow::Borrowed(name), |(native, _)| Cow::Borrowed(native.as_str()))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// VRMC_vrm 1.0, humanoid.md, "Required: yes".
    const VRM_REQUIRED: [&str; 15] = [
        "hips",
        "spine",
        "head",
        "leftUpperLeg",
        "leftLowerLeg",
        "leftFoot",
        "rightUpperLeg",
        "rightLowerLeg",
        "rightFoot",
        "leftUpperArm",
        "leftLowerArm",
        "leftHand",
        "rightUpperArm",
        "rightLowerArm",
        "rightHand",
    ];

    #[test]
    fn names_are_unique_in_every_vocabulary() {
        assert_eq!(native_names().count(), 68);
        for scheme in JointNames::ALL {
            let names: BTreeSet<_> = native_names().map(|joint| renamed(joint, scheme)).collect();
            assert_eq!(names.len(), 68, "{scheme:?}");
            assert!(names.iter().all(|name| !name.is_empty()), "{scheme:?}");
            let kept = native_names().filter(|joint| renamed(joint, scheme) == **joint).count();
            // Unity keeps `Root`; VRM and Blender keep `head` and `jaw`.
            assert!(scheme == JointNames::Native || kept <= 2, "{scheme:?} renames too little");
        }
    }

    #[test]
    fn the_required_bones_are_there() {
        let required = |name: fn(&HumanoidBone) -> &str| {
            humanoid_bones().iter().filter(|b| b.required).map(name).collect::<BTreeSet<_>>()
        };
        assert_eq!(required(|b| &b.vrm), BTreeSet::from(VRM_REQUIRED));
        // HumanTrait.RequiredBone has the same fifteen, with capital initials.
        let capital = VRM_REQUIRED.map(|name| name[..1].to_uppercase() + &name[1..]);
        assert_eq!(required(|b| &b.unity), capital.iter().map(String::as_str).collect());
        // HumanTrait.BoneCount is 55: all of Unity's bones are there.
        assert_eq!(humanoid_bones().len(), 55);
    }

    #[test]
    fn names_are_those_of_the_other_programs() {
        let index = humanoid("index_02_r").unwrap();
        assert_eq!(index.unity, "RightIndexIntermediate");
        assert_eq!(index.unity_trait, "Right Index Intermediate");
        assert_eq!(index.mixamo, "mixamorig:RightHandIndex2");
        assert_eq!(index.vrm, "rightIndexIntermediate");
        assert_eq!(index.blender, "f_index.02.R");
        assert!(!index.required);
        let thumb = ["thumb_01_l", "thumb_02_l", "thumb_03_l"].map(|j| humanoid(j).unwrap().vrm.as_str());
        assert_eq!(thumb, ["leftThumbMetacarpal", "leftThumbProximal", "leftThumbDistal"]);
        assert_eq!(humanoid("pinky_01_l").unwrap().unity_trait, "Left Little Proximal");
        assert_eq!(humanoid("pelvis").unwrap().mixamo, "mixamorig:Hips");
        assert_eq!(renamed("calf_l", JointNames::Blender), "shin.L");
        assert_eq!(renamed("upperarm_twist_02_r", JointNames::Mixamo), "mixamorig:RightArmTwist2");
    }

    #[test]
    fn root_twist_joints_and_unknown_names_are_not_humanoid_bones() {
        assert_eq!(humanoid("Root"), None);
        assert_eq!(humanoid("calf_twist_01_l"), None);
        assert_eq!(humanoid("tail"), None);
        assert_eq!(renamed("tail", JointNames::Unity), "tail");
    }

    #[test]
    fn vocabularies_parse_from_their_names() {
        for scheme in JointNames::ALL {
            assert_eq!(scheme.name().parse::<JointNames>().unwrap(), scheme);
        }
        let message = "maya".parse::<JointNames>().unwrap_err().to_string();
        assert_eq!(message, "joint_names: expected one of native, unity, mixamo, vrm, blender, got `maya`");
    }
}
