//! Rigs under the names of many programs, beside hair, with prefixes and suffixes, facing either way and without toes: all main
//! joints are matched.

use std::collections::BTreeMap;

use glam::Vec3;

use super::*;
use crate::math::RigidTransform;

/// The joints of the person: native name without side, parent, place of the left one.
const PERSON: [(&str, &str, [f32; 3]); 14] = [
    ("pelvis", "", [0.0, 0.95, 0.0]),
    ("spine_01", "pelvis", [0.0, 1.05, 0.0]),
    ("spine_02", "spine_01", [0.0, 1.19, 0.0]),
    ("spine_03", "spine_02", [0.0, 1.31, 0.0]),
    ("neck_01", "spine_03", [0.0, 1.46, 0.0]),
    ("head", "neck_01", [0.0, 1.55, 0.01]),
    ("clavicle", "spine_03", [0.03, 1.42, 0.0]),
    ("upperarm", "clavicle", [0.17, 1.42, 0.0]),
    ("lowerarm", "upperarm", [0.45, 1.42, 0.0]),
    ("hand", "lowerarm", [0.7, 1.42, 0.0]),
    ("thigh", "pelvis", [0.09, 0.91, 0.0]),
    ("calf", "thigh", [0.09, 0.5, 0.005]),
    ("foot", "calf", [0.09, 0.08, -0.01]),
    ("ball", "foot", [0.09, 0.02, 0.11]),
];

/// Words for left and right, and the names in the order of [`PERSON`].
const PROGRAMS: [([&str; 2], &str); 27] = [
    (
        ["l", "r"],
        "pelvis spine_01 spine_02 spine_03 neck_01 head clavicle_* upperarm_* lowerarm_* hand_* thigh_* calf_* foot_* ball_*",
    ),
    (
        ["Left", "Right"],
        "Hips Spine Chest UpperChest Neck Head *Shoulder *UpperArm *LowerArm *Hand *UpperLeg *LowerLeg *Foot *Toes",
    ),
    (
        ["Left", "Right"],
        "mixamorig1:Hips mixamorig1:Spine mixamorig1:Spine1 mixamorig1:Spine2 mixamorig1:Neck mixamorig1:Head mixamorig1:*Shoulder mixamorig1:*Arm mixamorig1:*ForeArm mixamorig1:*Hand mixamorig1:*UpLeg mixamorig1:*Leg mixamorig1:*Foot mixamorig1:*ToeBase",
    ),
    (
        ["Left", "Right"],
        "Robot_Hips Robot_Spine Robot_Spine1 Robot_Spine2 Robot_Neck Robot_Head Robot_*Shoulder Robot_*Arm Robot_*ForeArm Robot_*Hand Robot_*UpLeg Robot_*Leg Robot_*Foot Robot_*ToeBase",
    ),
    (
        ["L", "R"],
        "Skeleton_001_Hip Skeleton_001_Ab Skeleton_001_Spine2 Skeleton_001_Chest Skeleton_001_Neck Skeleton_001_Head Skeleton_001_*Shoulder Skeleton_001_*UArm Skeleton_001_*FArm Skeleton_001_*Hand Skeleton_001_*Thigh Skeleton_001_*Shin Skeleton_001_*Foot Skeleton_001_*Toe",
    ),
    (
        ["L", "R"],
        "CC_Base_Hip CC_Base_Waist CC_Base_Spine01 CC_Base_Spine02 CC_Base_NeckTwist01 CC_Base_Head CC_Base_*_Clavicle CC_Base_*_Upperarm CC_Base_*_Forearm CC_Base_*_Hand CC_Base_*_Thigh CC_Base_*_Calf CC_Base_*_Foot CC_Base_*_ToeBase",
    ),
    (
        ["L", "R"],
        "Root_M Spine1_M Spine2_M Chest_M Neck_M Head_M Scapula_* Shoulder_* Elbow_* Wrist_* Hip_* Knee_* Ankle_* Toes_*",
    ),
    (
        ["L", "R"],
        "lower_body upper_body upper_body2 upper_body3 neck head shoulder_* arm_* elbow_* wrist_* leg_* knee_* ankle_* toe_*",
    ),
    (["左", "右"], "下半身 上半身 上半身2 上半身3 首 頭 *肩 *腕 *ひじ *手首 *足 *ひざ *足首 *つま先"),
    (
        ["L", "R"],
        "root spine05 spine03 spine01 neck01 head clavicle.* upperarm01.* lowerarm01.* wrist.* upperleg01.* lowerleg01.* foot.* toe1-1.*",
    ),
    (
        ["Left", "Right"],
        "mPelvis mTorso mSpine3 mChest mNeck mHead mCollar* mShoulder* mElbow* mWrist* mHip* mKnee* mAnkle* mFoot*",
    ),
    (
        ["l", "r"],
        "hip abdomen abdomen2 chest neck head *Collar *Shldr *ForeArm *Hand *Thigh *Shin *Foot *Toe",
    ),
    (
        ["l", "r"],
        "pelvis abdomenLower abdomenUpper chestLower neckLower head *Collar *ShldrBend *ForearmBend *Hand *ThighBend *Shin *Foot *Toe",
    ),
    (
        ["Left", "Right"],
        "Hips Spine1 Spine2 Spine3 Neck Head *Shoulder *Arm *ForeArm *Hand *Thigh *Shin *Foot *Toe",
    ),
    (
        ["Left", "Right"],
        "Hips Chest Chest2 Chest4 Neck Head *Collar *Shoulder *Elbow *Wrist *Hip *Knee *Ankle *Toe",
    ),
    (
        ["L", "R"],
        "Bip001_Pelvis Bip001_Spine Bip001_Spine1 Bip001_Spine2 Bip001_Neck Bip001_Head Bip001_*_Clavicle Bip001_*_UpperArm Bip001_*_Forearm Bip001_*_Hand Bip001_*_Thigh Bip001_*_Calf Bip001_*_Foot Bip001_*_Toe0",
    ),
    (
        ["L", "R"],
        "ValveBiped.Bip01_Pelvis ValveBiped.Bip01_Spine ValveBiped.Bip01_Spine1 ValveBiped.Bip01_Spine2 ValveBiped.Bip01_Neck1 ValveBiped.Bip01_Head1 ValveBiped.Bip01_*_Clavicle ValveBiped.Bip01_*_UpperArm ValveBiped.Bip01_*_Forearm ValveBiped.Bip01_*_Hand ValveBiped.Bip01_*_Thigh ValveBiped.Bip01_*_Calf ValveBiped.Bip01_*_Foot ValveBiped.Bip01_*_Toe0",
    ),
    (
        ["L", "R"],
        "DEF-spine DEF-spine.001 DEF-spine.002 DEF-spine.003 DEF-spine.004 DEF-spine.006 DEF-shoulder.* DEF-upper_arm.* DEF-forearm.* DEF-hand.* DEF-thigh.* DEF-shin.* DEF-foot.* DEF-toe.*",
    ),
    (
        ["L", "R"],
        "ORG-spine ORG-spine.001 ORG-spine.002 ORG-spine.003 ORG-spine.004 ORG-spine.006 ORG-shoulder.* ORG-upper_arm.* ORG-forearm.* ORG-hand.* ORG-thigh.* ORG-shin.* ORG-foot.* ORG-toe.*",
    ),
    (
        ["left", "right"],
        "pelvis spine1 spine2 spine3 neck head *_collar *_shoulder *_elbow *_wrist *_hip *_knee *_ankle *_foot",
    ),
    (
        ["L", "R"],
        "f_avg_Pelvis f_avg_Spine1 f_avg_Spine2 f_avg_Spine3 f_avg_Neck f_avg_Head f_avg_*_Collar f_avg_*_Shoulder f_avg_*_Elbow f_avg_*_Wrist f_avg_*_Hip f_avg_*_Knee f_avg_*_Ankle f_avg_*_Foot",
    ),
    (
        ["l", "r"],
        "root lowerback upperback thorax lowerneck head *clavicle *humerus *radius *hand *femur *tibia *foot *toes",
    ),
    (
        ["L", "R"],
        "J_Bip_C_Hips J_Bip_C_Spine J_Bip_C_Chest J_Bip_C_UpperChest J_Bip_C_Neck J_Bip_C_Head J_Bip_*_Shoulder J_Bip_*_UpperArm J_Bip_*_LowerArm J_Bip_*_Hand J_Bip_*_UpperLeg J_Bip_*_LowerLeg J_Bip_*_Foot J_Bip_*_ToeBase",
    ),
    (
        ["left", "right"],
        "hips_joint spine_1_joint spine_4_joint spine_7_joint neck_1_joint head_joint *_shoulder_1_joint *_arm_joint *_forearm_joint *_hand_joint *_upLeg_joint *_leg_joint *_foot_joint *_toes_joint",
    ),
    (
        ["left", "right"],
        "pelvis spine_naval spine_chest chest neck head clavicle_* shoulder_* elbow_* wrist_* hip_* knee_* ankle_* foot_*",
    ),
    (
        ["Left", "Right"],
        "pelvis lumbar spine thorax neck head *_clavicle *_humerus *_radius *_hand *_femur *_tibia *_foot *_toes",
    ),
    (
        ["L", "R"],
        "Pelvis_jnt Spine_jnt Spine1_jnt Chest_jnt Neck_jnt Head_jnt Clavicle_*_jnt UpArm_*_jnt ForeArm_*_jnt Hand_*_jnt Thigh_*_jnt Calf_*_jnt Foot_*_jnt Toe_*_jnt",
    ),
];

/// A joint: name, name of its parent, place, and the joint of the rig that it drives.
type Row = (String, String, Vec3, Option<String>);

/// The person under a program's names; `left` and `right` are the program's words.
fn rows([left, right]: [&str; 2], names: &str, toes: bool) -> Vec<Row> {
    let names: Vec<&str> = names.split(' ').collect();
    let name = |native: &str, word: &str| {
        let at = PERSON.iter().position(|row| row.0 == native);
        at.map(|at| names[at].replace('*', word)).unwrap_or_default()
    };
    let mut rows = Vec::new();
    for (native, parent, at) in PERSON.into_iter().filter(|row| toes || row.0 != "ball") {
        let at = Vec3::from_array(at);
        if at.x == 0.0 {
            rows.push((name(native, ""), name(parent, ""), at, Some(native.to_owned())));
            continue;
        }
        for (word, side) in [(left, Side::Left), (right, Side::Right)] {
            let ours = [native, side.joint_suffix()].concat();
            rows.push((
                name(native, word),
                name(parent, word),
                at * Vec3::new(side.sign(), 1.0, 1.0),
                Some(ours),
            ));
        }
    }
    rows
}

/// Two pigtails longer than arms and sixteen short locks, below the head.
fn add_hair(rows: &mut Vec<Row>) {
    let head = rows.iter().find(|row| row.3.as_deref() == Some("head")).map(|row| row.0.clone()).unwrap();
    let mut chain = |pre: String, count: usize, from: Vec3, step: Vec3| {
        let mut parent = head.clone();
        for i in 0..count {
            let name = format!("{pre}_{:02}", i + 1);
            rows.push((name.clone(), parent, Vec3::new(0.0, 1.65, 0.0) + from + step * i as f32, None));
            parent = name;
        }
    };
    chain("HairTail_L".into(), 8, Vec3::X * 0.1, Vec3::new(0.02, -0.2, 0.0));
    chain("HairTail_R".into(), 8, Vec3::X * -0.1, Vec3::new(-0.02, -0.2, 0.0));
    for lock in 0..16 {
        let angle = lock as f32 * 0.4;
        chain(
            format!("Hair{lock}"),
            4,
            Vec3::new(libm::cosf(angle), 0.0, libm::sinf(angle)) * 0.08,
            Vec3::Y * -0.05,
        );
    }
}

fn skeleton(rows: &[Row], facing: f32) -> Skeleton {
    let place = |name: &str| rows.iter().position(|row| row.0 == name);
    let parents: Vec<Option<u32>> = rows.iter().map(|row| place(&row.1).map(|at| at as u32)).collect();
    let local = |(row, parent): (&Row, &Option<u32>)| {
        let from = parent.map_or(Vec3::ZERO, |parent| rows[parent as usize].2);
        let offset = row.2 - from;
        let translation = Vec3::new(offset.x * facing, offset.y, offset.z * facing);
        RigidTransform { translation, ..RigidTransform::IDENTITY }
    };
    let locals = rows.iter().zip(&parents).map(local).collect();
    let names = rows.iter().map(|row| row.0.clone()).collect();
    Skeleton::new(names, parents, locals, vec![None; rows.len()]).unwrap()
}

/// A change of a joint's name; the number is its index.
type Rename = fn(&str, usize) -> String;

#[test]
fn the_main_joints_of_every_program_are_matched_whatever_is_about_them() {
    let renames: [(&str, Rename); 7] = [
        ("as they are", |name, _| name.to_owned()),
        ("a prefix", |name, _| format!("Alice_{name}")),
        ("a suffix", |name, _| format!("{name}.001")),
        ("a word at the end", |name, _| format!("{name}_jnt")),
        ("a path", |name, _| format!("Group|Char:{name}")),
        ("a number each", |name, joint| format!("{name}_{joint:02}")),
        ("all of it", |name, joint| format!("Alice_{name}_{joint:02}.001")),
    ];
    let mut failed = Vec::new();
    for (sides, names) in PROGRAMS {
        for (what, rename) in renames {
            for (hair, toes, facing) in [
                (false, true, 1.0),
                (true, true, 1.0),
                (true, false, -1.0),
                (false, false, -1.0),
                (true, false, 1.0),
            ] {
                let mut rows = rows(sides, names, toes);
                if hair {
                    add_hair(&mut rows);
                }
                let old: Vec<String> = rows.iter().map(|row| row.0.clone()).collect();
                let new = |name: &str| {
                    old.iter().position(|o| o == name).map(|at| rename(name, at)).unwrap_or_default()
                };
                let renamed: Vec<Row> =
                    rows.iter().map(|(n, p, at, ours)| (new(n), new(p), *at, ours.clone())).collect();
                let rest = skeleton(&renamed, facing);
                let Ok(map) = JointMap::find(&rest, &BTreeMap::new()) else {
                    failed.push(format!("{} with {what}: nothing is found", rows[0].0));
                    continue;
                };
                let drives = |joint: usize, ours: &str| match ours.strip_prefix("spine_") {
                    Some(_) => map.spine().contains(&joint),
                    None => map.source_of(RigJoint::from_name(ours).unwrap()) == Some(joint),
                };
                for (joint, row) in renamed.iter().enumerate() {
                    let good = match &row.3 {
                        Some(ours) => drives(joint, ours),
                        None => !map.joints().any(|used| used == joint),
                    };
                    if !good {
                        failed
                            .push(format!("{} with {what}, hair {hair}, toes {toes}: {}", rows[0].0, row.0));
                    }
                }
            }
        }
    }
    assert!(failed.is_empty(), "{} of them, {:#?}", failed.len(), &failed[..failed.len().min(40)]);
}

#[test]
fn a_rig_without_names_gets_arms_and_not_its_hair() {
    let mut rows = rows(["l", "r"], PROGRAMS[0].1, true);
    add_hair(&mut rows);
    let old: Vec<String> = rows.iter().map(|row| row.0.clone()).collect();
    let new = |name: &str| old.iter().position(|o| o == name).map_or(String::new(), |at| format!("b{at}"));
    for row in &mut rows {
        (row.0, row.1) = (new(&row.0), new(&row.1));
    }
    let map = JointMap::find(&skeleton(&rows, 1.0), &BTreeMap::new()).unwrap();
    for ours in ["upperarm_l", "lowerarm_r", "hand_l", "calf_r", "foot_l"] {
        let joint = map.source_of(RigJoint::from_name(ours).unwrap()).unwrap();
        assert_eq!(rows[joint].3.as_deref(), Some(ours));
    }
}
