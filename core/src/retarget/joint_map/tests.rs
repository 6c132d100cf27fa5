use super::*;
use crate::math::RigidTransform;
use crate::testing::person::{Style, motion, person, posed, restyled};

/// A chain with these names, whose geometry is not that of a person.
fn named(names: &[&str]) -> Skeleton {
    let names: Vec<String> = names.iter().map(|n| (*n).to_owned()).collect();
    let parents = (0..names.len() as u32).map(|j| j.checked_sub(1)).collect();
    let count = names.len();
    Skeleton::new(names, parents, vec![RigidTransform::IDENTITY; count], vec![None; count]).unwrap()
}

#[test]
#[expect(clippy::too_many_lines, reason = "a table of names")]
fn every_vocabulary_is_known_by_its_names() {
    // Vocabulary; pelvis, thigh, calf, foot, ball, clavicle, upper arm, forearm, hand of the left; head.
    let cases: [(&str, &str, &str, &str); 19] = [
        (
            "native",
            "pelvis thigh_* calf_* foot_* ball_* clavicle_* upperarm_* lowerarm_* hand_* head",
            "l",
            "r",
        ),
        (
            "native",
            "UE|pelvis UE|thigh_* UE|calf_* UE|foot_* UE|ball_* UE|clavicle_* UE|upperarm_* \
                    UE|lowerarm_* UE|hand_* UE|head",
            "L",
            "R",
        ),
        (
            "Mixamo",
            "mixamorig:Hips mixamorig:*UpLeg mixamorig:*Leg mixamorig:*Foot mixamorig:*ToeBase \
                    mixamorig:*Shoulder mixamorig:*Arm mixamorig:*ForeArm mixamorig:*Hand mixamorig:Head",
            "Left",
            "Right",
        ),
        (
            "Mixamo",
            "Character1_Hips Character1_*UpLeg Character1_*Leg Character1_*Foot Character1_*ToeBase \
                    Character1_*Shoulder Character1_*Arm Character1_*ForeArm Character1_*Hand Character1_Head",
            "Left",
            "Right",
        ),
        (
            "Unity",
            "Hips *UpperLeg *LowerLeg *Foot *Toes *Shoulder *UpperArm *LowerArm *Hand Head",
            "Left",
            "Right",
        ),
        (
            "Unity",
            "hips *UpperLeg *LowerLeg *Foot *Toes *Shoulder *UpperArm *LowerArm *Hand head",
            "left",
            "right",
        ),
        (
            "Blender",
            "hips thigh.* shin.* foot.* toe.* shoulder.* upper_arm.* forearm.* hand.* head",
            "L",
            "R",
        ),
        (
            "Rigify",
            "DEF-spine DEF-thigh.* DEF-shin.* DEF-foot.* DEF-toe.* DEF-shoulder.* DEF-upper_arm.* \
                    DEF-forearm.* DEF-hand.* DEF-spine.006",
            "L",
            "R",
        ),
        ("CMU ASF", "root *femur *tibia *foot *toes *clavicle *humerus *radius *hand head", "l", "r"),
        (
            "cgspeed",
            "Hips *UpLeg *Leg *Foot *ToeBase *Shoulder *Arm *ForeArm *FingerBase Head *HandIndex1 *Hand *Thumb",
            "Left",
            "Right",
        ),
        (
            "MotionBuilder",
            "Hips *UpLeg *Leg *Foot *ToeBase *Shoulder *Arm *ForeArm *Hand Head *HandEnd",
            "Left",
            "Right",
        ),
        ("Biovision", "Hips *Hip *Knee *Ankle *Toe *Collar *Shoulder *Elbow *Wrist Head", "Left", "Right"),
        (
            "SMPL",
            "pelvis *_hip *_knee *_ankle *_foot *_collar *_shoulder *_elbow *_wrist head",
            "left",
            "right",
        ),
        (
            "SMPL in Maya",
            "m_avg_Pelvis m_avg_*_Hip m_avg_*_Knee m_avg_*_Ankle m_avg_*_Foot m_avg_*_Collar \
                          m_avg_*_Shoulder m_avg_*_Elbow m_avg_*_Wrist m_avg_Head",
            "L",
            "R",
        ),
        ("Rokoko", "Hips *Thigh *Shin *Foot *Toe *Shoulder *Arm *ForeArm *Hand Head", "Left", "Right"),
        (
            "Xsens",
            "Pelvis *UpperLeg *LowerLeg *Foot *Toe *Shoulder *UpperArm *ForeArm *Hand Head",
            "Left",
            "Right",
        ),
        (
            "3ds Max Biped",
            "Bip01_Pelvis Bip01_*_Thigh Bip01_*_Calf Bip01_*_Foot Bip01_*_Toe0 Bip01_*_Clavicle \
                           Bip01_*_UpperArm Bip01_*_Forearm Bip01_*_Hand Bip01_Head",
            "L",
            "R",
        ),
        ("Daz", "hip *ThighBend *Shin *Foot *Toe *Collar *ShldrBend *ForearmBend *Hand head", "l", "r"),
        (
            "VRoid",
            "J_Bip_C_Hips J_Bip_*_UpperLeg J_Bip_*_LowerLeg J_Bip_*_Foot J_Bip_*_ToeBase J_Bip_*_Shoulder \
                   J_Bip_*_UpperArm J_Bip_*_LowerArm J_Bip_*_Hand J_Bip_C_Head",
            "L",
            "R",
        ),
    ];
    let ours =
        ["pelvis", "thigh", "calf", "foot", "ball", "clavicle", "upperarm", "lowerarm", "hand", "head"];
    for (vocabulary, template, left, right) in cases {
        let theirs: Vec<&str> = template.split_ascii_whitespace().collect();
        let mut names = Vec::new();
        let mut expected = Vec::new();
        for (i, name) in theirs.iter().enumerate() {
            for (side, suffix) in [left, right].into_iter().zip(Side::ALL.map(Side::joint_suffix)) {
                let name = name.replace('*', side);
                if !names.contains(&name) {
                    let central = i == 0 || i == 9;
                    let ours =
                        ours.get(i).map(|o| if central { (*o).to_owned() } else { format!("{o}{suffix}") });
                    names.push(name);
                    expected.push(ours);
                }
            }
        }
        let refs: Vec<&str> = names.iter().map(String::as_str).collect();
        let map = JointMap::find(&named(&refs), &BTreeMap::new()).unwrap();
        assert_eq!(map.report().vocabulary.as_deref(), Some(vocabulary), "{refs:?}");
        for (joint, ours) in expected.iter().enumerate() {
            if let Some(ours) = ours {
                assert_eq!(source_of(&map, ours), Some(joint), "{vocabulary}: {ours}");
            }
        }
    }
}

fn source_of(map: &JointMap, ours: &str) -> Option<usize> {
    map.source_of(RigJoint::from_name(ours).unwrap())
}

fn scrambled(name: &str) -> Option<String> {
    let number: u32 = name.bytes().fold(7, |n, b| n.wrapping_mul(31).wrapping_add(u32::from(b)));
    Some(format!("j{number}"))
}

#[test]
fn a_person_with_unknown_names_is_matched_by_geometry() {
    let rest = person();
    let clip = motion(&rest, 1);
    let a_pose = posed(&rest, &[("upperarm_l", [0.0, 0.0, -60.0]), ("upperarm_r", [0.0, 0.0, 60.0])]);
    for (pose, facing, scale) in [(rest.rest_pose().locals.clone(), 0.0, 1.0), (a_pose, -1.6, 100.0)] {
        let style = Style { rename: &scrambled, rest: pose, facing, frames: true, scale };
        let source = restyled(&clip, &style);
        let map = JointMap::find(source.skeleton(), &BTreeMap::new()).unwrap();
        let mut wrong = Vec::new();
        for (joint, name) in rest.names().iter().enumerate() {
            // Eyes and jaw look like any leaf of the head; joints of the spine are matched as a chain.
            let undetectable = ["Root", "twist", "eye", "jaw", "spine_02", "spine_03"];
            if !undetectable.iter().any(|part| name.contains(part)) && source_of(&map, name) != Some(joint) {
                wrong.push(name);
            }
        }
        assert!(wrong.is_empty(), "{wrong:?}");
        assert_eq!((map.spine(), map.neck()), (&[2, 3, 4][..], &[5][..]));
        assert_eq!(map.report().vocabulary, None);
        assert_eq!(map.report().passed_on.len(), 1, "the root above the pelvis");
        let everything = map.report();
        let count = everything.matched.len() + everything.passed_on.len() + everything.unmatched.len();
        assert_eq!(count, rest.len(), "every joint is reported");
    }
}

#[test]
fn geometry_fills_in_what_names_do_not_give() {
    let rest = person();
    let style = Style {
        rename: &|name| if name.starts_with("hand") { scrambled(name) } else { Some(name.to_owned()) },
        rest: rest.rest_pose().locals.clone(),
        facing: 0.0,
        frames: false,
        scale: 1.0,
    };
    let source = restyled(&motion(&rest, 1), &style);
    let map = JointMap::find(source.skeleton(), &BTreeMap::new()).unwrap();
    assert_eq!(source_of(&map, "hand_l"), rest.find("hand_l"));
    let hand = map.report().matched.iter().find(|m| m.target == "hand_l").unwrap();
    assert_eq!(hand.by, MatchedBy::Geometry);
    assert_eq!(map.report().vocabulary.as_deref(), Some("native"));
}

#[test]
fn spine_and_neck_take_all_joints_between_pelvis_and_head() {
    let names = "Hips LHipJoint LeftUpLeg LeftLeg RHipJoint RightUpLeg RightLeg LowerBack Spine Spine1 Spine2 Neck \
                 Neck1 Head LeftShoulder LeftArm";
    let names: Vec<String> = names.split_ascii_whitespace().map(str::to_owned).collect();
    let parents = [0, 0, 1, 2, 0, 4, 5, 0, 7, 8, 9, 10, 11, 12, 10, 14];
    let parents = parents.iter().enumerate().map(|(j, p)| (j > 0).then_some(*p)).collect();
    let rest = Skeleton::new(names, parents, vec![RigidTransform::IDENTITY; 16], vec![None; 16]).unwrap();
    let map = JointMap::find(&rest, &BTreeMap::new()).unwrap();
    assert_eq!(map.spine(), [7, 8, 9, 10]);
    assert_eq!(map.neck(), [11, 12]);
    assert_eq!(map.report().passed_on, ["LHipJoint", "RHipJoint"]);
    assert!(map.report().unmatched.is_empty());
    assert!(map.report().without_source.contains(&"hand_l".to_owned()));
    let neck1 = map.report().matched.iter().find(|m| m.source == "Neck1").unwrap();
    assert_eq!((neck1.target.as_str(), neck1.by), ("neck_01", MatchedBy::Chain));
}

#[test]
fn the_users_mapping_takes_precedence() {
    let names = "hub legA shinA legB shinB LeftArm";
    let rest = named(&names.split(' ').collect::<Vec<_>>());
    let none = JointMap::find(&rest, &BTreeMap::new()).unwrap_err().to_string();
    assert!(none.contains("found no pelvis, thigh_l, thigh_r, calf_l, calf_r among 6 joints"), "{none}");
    let json =
        r#"{"hub": "pelvis", "legA": "thigh_l", "shinA": "calf_l", "legB": "thigh_r", "shinB": "calf_r"}"#;
    let overrides = read_overrides(json, "map.json".as_ref()).unwrap();
    let map = JointMap::find(&rest, &overrides).unwrap();
    assert_eq!(source_of(&map, "calf_r"), Some(4));
    assert!(map.report().matched.iter().any(|m| m.by == MatchedBy::Mapping));

    let fails = |json: &str| {
        let overrides = read_overrides(json, "map.json".as_ref());
        overrides.and_then(|o| JointMap::find(&rest, &o)).unwrap_err().to_string()
    };
    assert!(fails(r#"{"legC": "thigh_l"}"#).contains("no joint `legC`: did you mean `legA`"));
    assert!(fails(r#"{"legA": "thig_l"}"#).contains("no joint `thig_l`: did you mean `thigh_l`"));
    assert!(fails(r#"{"legA": "thigh_l", "legB": "thigh_l"}"#).contains("both `legA` and `legB`"));
    assert!(fails(r#"{"legA": 3}"#).starts_with("map.json: expected"));

    let rest = person();
    let map = JointMap::find(&rest, &BTreeMap::from([("hand_l".to_owned(), None)])).unwrap();
    assert_eq!(source_of(&map, "hand_l"), None);
    assert!(map.report().passed_on.contains(&"hand_l".to_owned()));
}
