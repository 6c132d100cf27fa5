//! Complete joint lists of other programs: every joint drives the right joint of the rig, and no other does.

use std::collections::BTreeMap;

use super::*;
use crate::math::RigidTransform;

/// Name of the vocabulary, words for left and right, and chains, one per line: in `A > B C`, B is a child of A and C of B.
/// `=` precedes the joint of the rig that it drives; `~` marks a joint that shares the motion of spine or neck; others drive
/// nothing. `*` is the side.
type List = (&'static str, [&'static str; 2], &'static str);

const MIXAMO: List = ("Mixamo", ["Left", "Right"], "
    mixamorig:Hips=pelvis mixamorig:Spine=spine_01 mixamorig:Spine1=spine_02 mixamorig:Spine2=spine_03
    mixamorig:Spine2 > mixamorig:Neck=neck_01 mixamorig:Head=head mixamorig:HeadTop_End
    mixamorig:Head > mixamorig:*Eye=eye
    mixamorig:Spine2 > mixamorig:*Shoulder=clavicle mixamorig:*Arm=upperarm mixamorig:*ForeArm=lowerarm mixamorig:*Hand=hand
    mixamorig:*Hand > mixamorig:*HandThumb1=thumb_01 mixamorig:*HandThumb2=thumb_02 mixamorig:*HandThumb3=thumb_03 mixamorig:*HandThumb4
    mixamorig:*Hand > mixamorig:*HandIndex1=index_01 mixamorig:*HandIndex2=index_02 mixamorig:*HandIndex3=index_03 mixamorig:*HandIndex4
    mixamorig:*Hand > mixamorig:*HandMiddle1=middle_01 mixamorig:*HandMiddle2=middle_02 mixamorig:*HandMiddle3=middle_03 mixamorig:*HandMiddle4
    mixamorig:*Hand > mixamorig:*HandRing1=ring_01 mixamorig:*HandRing2=ring_02 mixamorig:*HandRing3=ring_03 mixamorig:*HandRing4
    mixamorig:*Hand > mixamorig:*HandPinky1=pinky_01 mixamorig:*HandPinky2=pinky_02 mixamorig:*HandPinky3=pinky_03 mixamorig:*HandPinky4
    mixamorig:Hips > mixamorig:*UpLeg=thigh mixamorig:*Leg=calf mixamorig:*Foot=foot mixamorig:*ToeBase=ball mixamorig:*Toe_End
");

const MOTION_BUILDER: List = (
    "MotionBuilder",
    ["Left", "Right"],
    "
    Reference Hips=pelvis Spine=spine_01 Spine1=spine_02 Spine2=spine_03 Spine3~
    Spine3 > Neck=neck_01 Neck1~ Head=head
    Spine3 > *Shoulder=clavicle *Arm=upperarm *ForeArm=lowerarm *Hand=hand
    *Arm > *ArmRoll
    *ForeArm > *ForeArmRoll
    *Hand > *HandEnd=hand_tip
    *Hand > *HandThumb1=thumb_01 *HandThumb2=thumb_02 *HandThumb3=thumb_03 *HandThumb4
    *Hand > *InHandIndex *HandIndex1=index_01 *HandIndex2=index_02 *HandIndex3=index_03 *HandIndex4
    *Hand > *InHandMiddle *HandMiddle1=middle_01 *HandMiddle2=middle_02 *HandMiddle3=middle_03 *HandMiddle4
    *Hand > *InHandRing *HandRing1=ring_01 *HandRing2=ring_02 *HandRing3=ring_03 *HandRing4
    *Hand > *InHandPinky *HandPinky1=pinky_01 *HandPinky2=pinky_02 *HandPinky3=pinky_03 *HandPinky4
    Hips > *UpLeg=thigh *Leg=calf *Foot=foot *ToeBase=ball
    *UpLeg > *UpLegRoll
    *Leg > *LegRoll
",
);

const ROKOKO: List = ("Rokoko", ["Left", "Right"], "
    Hips=pelvis Spine1=spine_01 Spine2~ Spine3~ Spine4~
    Spine4 > Neck=neck_01 Head=head
    Spine4 > *Shoulder=clavicle *Arm=upperarm *ForeArm=lowerarm *Hand=hand
    *Hand > *Finger1Metacarpal=thumb_01 *Finger1Proximal=thumb_02 *Finger1Distal=thumb_03 *Finger1Tip
    *Hand > *Finger2Metacarpal *Finger2Proximal=index_01 *Finger2Medial=index_02 *Finger2Distal=index_03 *Finger2Tip
    *Hand > *Finger3Metacarpal *Finger3Proximal=middle_01 *Finger3Medial=middle_02 *Finger3Distal=middle_03 *Finger3Tip
    *Hand > *Finger4Metacarpal *Finger4Proximal=ring_01 *Finger4Medial=ring_02 *Finger4Distal=ring_03 *Finger4Tip
    *Hand > *Finger5Metacarpal *Finger5Proximal=pinky_01 *Finger5Medial=pinky_02 *Finger5Distal=pinky_03 *Finger5Tip
    Hips > *Thigh=thigh *Shin=calf *Foot=foot *Toe=ball *ToeTip
");

const SMPL_X: List = (
    "SMPL",
    ["left", "right"],
    "
    pelvis=pelvis spine1=spine_01 spine2~ spine3~ neck=neck_01 head=head
    head > jaw=jaw
    head > *_eye_smplhf=eye
    spine3 > *_collar=clavicle *_shoulder=upperarm *_elbow=lowerarm *_wrist=hand
    *_wrist > *_index1=index_01 *_index2=index_02 *_index3=index_03
    *_wrist > *_middle1=middle_01 *_middle2=middle_02 *_middle3=middle_03
    *_wrist > *_pinky1=pinky_01 *_pinky2=pinky_02 *_pinky3=pinky_03
    *_wrist > *_ring1=ring_01 *_ring2=ring_02 *_ring3=ring_03
    *_wrist > *_thumb1=thumb_01 *_thumb2=thumb_02 *_thumb3=thumb_03
    pelvis > *_hip=thigh *_knee=calf *_ankle=foot *_foot=ball
",
);

/// VRM 1.0, whose thumb begins with its metacarpal.
const VRM: List = (
    "VRM",
    ["left", "right"],
    "
    hips=pelvis spine=spine_01 chest=spine_02 upperChest=spine_03 neck=neck_01 head=head
    head > jaw=jaw
    head > *Eye=eye
    upperChest > *Shoulder=clavicle *UpperArm=upperarm *LowerArm=lowerarm *Hand=hand
    *Hand > *ThumbMetacarpal=thumb_01 *ThumbProximal=thumb_02 *ThumbDistal=thumb_03
    *Hand > *IndexProximal=index_01 *IndexIntermediate=index_02 *IndexDistal=index_03
    *Hand > *MiddleProximal=middle_01 *MiddleIntermediate=middle_02 *MiddleDistal=middle_03
    *Hand > *RingProximal=ring_01 *RingIntermediate=ring_02 *RingDistal=ring_03
    *Hand > *LittleProximal=pinky_01 *LittleIntermediate=pinky_02 *LittleDistal=pinky_03
    hips > *UpperLeg=thigh *LowerLeg=calf *Foot=foot *Toes=ball
",
);

/// Unity and VRM 0, which call the same bones of a thumb proximal, intermediate and distal.
const UNITY: List = (
    "Unity",
    ["Left", "Right"],
    "
    Hips=pelvis Spine=spine_01 Chest=spine_02 UpperChest=spine_03 Neck=neck_01 Head=head
    Head > Jaw=jaw
    Head > *Eye=eye
    UpperChest > *Shoulder=clavicle *UpperArm=upperarm *LowerArm=lowerarm *Hand=hand
    *Hand > *ThumbProximal=thumb_01 *ThumbIntermediate=thumb_02 *ThumbDistal=thumb_03
    *Hand > *IndexProximal=index_01 *IndexIntermediate=index_02 *IndexDistal=index_03
    *Hand > *MiddleProximal=middle_01 *MiddleIntermediate=middle_02 *MiddleDistal=middle_03
    *Hand > *RingProximal=ring_01 *RingIntermediate=ring_02 *RingDistal=ring_03
    *Hand > *LittleProximal=pinky_01 *LittleIntermediate=pinky_02 *LittleDistal=pinky_03
    Hips > *UpperLeg=thigh *LowerLeg=calf *Foot=foot *Toes=ball
",
);

const UNREAL_4: List = (
    "native",
    ["l", "r"],
    "
    root pelvis=pelvis spine_01=spine_01 spine_02=spine_02 spine_03=spine_03 neck_01=neck_01 head=head
    spine_03 > clavicle_*=clavicle upperarm_*=upperarm lowerarm_*=lowerarm hand_*=hand
    upperarm_* > upperarm_twist_01_*
    lowerarm_* > lowerarm_twist_01_*
    hand_* > index_01_*=index_01 index_02_*=index_02 index_03_*=index_03
    hand_* > middle_01_*=middle_01 middle_02_*=middle_02 middle_03_*=middle_03
    hand_* > pinky_01_*=pinky_01 pinky_02_*=pinky_02 pinky_03_*=pinky_03
    hand_* > ring_01_*=ring_01 ring_02_*=ring_02 ring_03_*=ring_03
    hand_* > thumb_01_*=thumb_01 thumb_02_*=thumb_02 thumb_03_*=thumb_03
    pelvis > thigh_*=thigh calf_*=calf foot_*=foot ball_*=ball
    thigh_* > thigh_twist_01_*
    calf_* > calf_twist_01_*
    root > ik_foot_root ik_foot_*
    root > ik_hand_root ik_hand_gun ik_hand_*
",
);

const UNREAL_5: List = (
    "native",
    ["l", "r"],
    "
    root pelvis=pelvis spine_01=spine_01 spine_02=spine_02 spine_03=spine_03 spine_04~ spine_05~
    spine_05 > neck_01=neck_01 neck_02~ head=head
    spine_05 > clavicle_*=clavicle upperarm_*=upperarm lowerarm_*=lowerarm hand_*=hand
    upperarm_* > upperarm_twist_01_*
    upperarm_* > upperarm_twist_02_*
    lowerarm_* > lowerarm_twist_02_*
    lowerarm_* > lowerarm_twist_01_*
    hand_* > index_metacarpal_* index_01_*=index_01 index_02_*=index_02 index_03_*=index_03
    hand_* > middle_metacarpal_* middle_01_*=middle_01 middle_02_*=middle_02 middle_03_*=middle_03
    hand_* > pinky_metacarpal_* pinky_01_*=pinky_01 pinky_02_*=pinky_02 pinky_03_*=pinky_03
    hand_* > ring_metacarpal_* ring_01_*=ring_01 ring_02_*=ring_02 ring_03_*=ring_03
    hand_* > thumb_01_*=thumb_01 thumb_02_*=thumb_02 thumb_03_*=thumb_03
    pelvis > thigh_*=thigh calf_*=calf foot_*=foot ball_*=ball
    thigh_* > thigh_twist_01_*
    thigh_* > thigh_twist_02_*
    calf_* > calf_twist_02_*
    calf_* > calf_twist_01_*
    root > ik_foot_root ik_foot_*
    root > interaction
    root > center_of_mass
",
);

/// What a joint of a list does.
#[derive(Debug)]
enum Role {
    Drives(String),
    Shares,
    Nothing,
}

/// The joints of a list: name, parent, role.
fn joints((_, sides, lines): &List) -> Vec<(String, Option<u32>, Role)> {
    let mut found: Vec<(String, Option<u32>, Role)> = Vec::new();
    for line in lines.lines().filter(|line| !line.trim().is_empty()) {
        let both = Side::ALL.map(|side| (sides[side.index()], side.joint_suffix()));
        for (side, suffix) in if line.contains('*') { &both[..] } else { &[("", "")] } {
            let line = line.replace('*', side);
            let place = |found: &[(String, Option<u32>, Role)], name: &str| {
                found.iter().position(|j| j.0 == name.trim()).map(|j| j as u32)
            };
            let (mut above, chain) = match line.split_once(" > ") {
                Some((above, chain)) => (place(&found, above), chain),
                None => (found.len().checked_sub(1).map(|j| j as u32), line.as_str()),
            };
            for word in chain.split_whitespace() {
                let (name, role) = match word.split_once('=') {
                    Some((name, ours)) => (name, Role::Drives(format!("{ours}{suffix}"))),
                    None if word.ends_with('~') => (word.trim_end_matches('~'), Role::Shares),
                    None => (word, Role::Nothing),
                };
                if place(&found, name).is_none() {
                    found.push((name.to_owned(), above, role));
                }
                above = place(&found, name);
            }
        }
    }
    found
}

#[test]
fn every_joint_of_every_program_drives_what_it_should() {
    let lists = [MIXAMO, MOTION_BUILDER, ROKOKO, SMPL_X, VRM, UNITY, UNREAL_4, UNREAL_5];
    for (list, count) in lists.iter().zip([67, 83, 73, 55, 55, 55, 68, 85]) {
        let joints = joints(list);
        assert_eq!(joints.len(), count, "{}: {joints:?}", list.0);
        let rest = Skeleton::new(
            joints.iter().map(|j| j.0.clone()).collect(),
            joints.iter().map(|j| j.1).collect(),
            vec![RigidTransform::IDENTITY; joints.len()],
            vec![None; joints.len()],
        );
        let map = JointMap::find(&rest.unwrap(), &BTreeMap::new()).unwrap();
        assert_eq!(map.report().vocabulary.as_deref(), Some(list.0));
        let driven: BTreeMap<usize, &str> = map.sources.iter().map(|(ours, j)| (*j, ours.name())).collect();
        for (joint, (name, _, role)) in joints.iter().enumerate() {
            let shares = map.spine().contains(&joint) || map.neck().contains(&joint);
            match role {
                Role::Drives(ours) => {
                    assert_eq!(driven.get(&joint), Some(&ours.as_str()), "{}: {name}", list.0);
                }
                Role::Shares => assert!(shares, "{}: {name}", list.0),
                Role::Nothing => {
                    assert!(
                        !driven.contains_key(&joint) && !shares,
                        "{}: {name} {:?}",
                        list.0,
                        driven.get(&joint)
                    );
                }
            }
        }
    }
}
