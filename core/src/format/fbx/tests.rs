use std::f32::consts::FRAC_PI_2;
use std::path::Path;

use glam::Vec3;

use super::binary::binary;
use crate::Error;
use crate::error::FormatError;
use crate::format::{Found, Motion, ReadOptions, read_motion_from_bytes};
use crate::math::Rotation;
use crate::space::{Axis, Unit};

/// Hips above a leg, in centimetres, +Y up, 30 frames per second: the hips rise by 20 cm in a second; the leg, which has a
/// pre-rotation of 90° about Z at rest, rotates by 90° about X; the empty above both is scaled.
pub(in crate::format) const SMALL: &str = r#"; FBX 7.4.0 project file
FBXHeaderExtension: {
    FBXVersion: 7400
}
GlobalSettings: {
    Properties70: {
        P: "UpAxis", "int", "Integer", "",1
        P: "UpAxisSign", "int", "Integer", "",1
        P: "FrontAxis", "int", "Integer", "",2
        P: "FrontAxisSign", "int", "Integer", "",1
        P: "CoordAxis", "int", "Integer", "",0
        P: "CoordAxisSign", "int", "Integer", "",1
        P: "UnitScaleFactor", "double", "Number", "",1
        P: "TimeMode", "enum", "", "",6
    }
}
Objects: {
    Model: 90, "Model::Armature", "Null" {
        Properties70: {
            P: "Lcl Scaling", "Lcl Scaling", "", "A",2,2,2
        }
    }
    NodeAttribute: 101, "NodeAttribute::", "LimbNode" {
        TypeFlags: "Skeleton"
    }
    Model: 100, "Model::mixamorig:Hips", "LimbNode" {
        Properties70: {
            P: "Lcl Translation", "Lcl Translation", "", "A",0,50,0
        }
    }
    NodeAttribute: 111, "NodeAttribute::", "LimbNode" {
        TypeFlags: "Skeleton"
    }
    Model: 110, "Model::mixamorig:LeftUpLeg", "LimbNode" {
        Properties70: {
            P: "RotationActive", "bool", "", "",1
            P: "PreRotation", "Vector3D", "Vector", "",0,0,90
            P: "Lcl Translation", "Lcl Translation", "", "A",5,-5,5
        }
    }
    AnimationStack: 200, "AnimStack::Take 001", "" {
        Properties70: {
            P: "LocalStart", "KTime", "Time", "",0
            P: "LocalStop", "KTime", "Time", "",46186158000
        }
    }
    AnimationLayer: 201, "AnimLayer::Base", "" {
    }
    AnimationCurveNode: 202, "AnimCurveNode::R", "" {
        Properties70: {
            P: "d|X", "Number", "", "A",0
            P: "d|Y", "Number", "", "A",0
            P: "d|Z", "Number", "", "A",0
        }
    }
    AnimationCurve: 203, "AnimCurve::", "" {
        KeyVer: 4008
        KeyTime: *2 {
            a: 0,46186158000
        }
        KeyValueFloat: *2 {
            a: 0,90
        }
        KeyAttrFlags: *1 {
            a: 260
        }
        KeyAttrDataFloat: *4 {
            a: 0,0,0,0
        }
        KeyAttrRefCount: *1 {
            a: 2
        }
    }
    AnimationCurveNode: 204, "AnimCurveNode::T", "" {
        Properties70: {
            P: "d|X", "Number", "", "A",0
            P: "d|Y", "Number", "", "A",50
            P: "d|Z", "Number", "", "A",0
        }
    }
    AnimationCurve: 205, "AnimCurve::", "" {
        KeyVer: 4008
        KeyTime: *2 {
            a: 0,46186158000
        }
        KeyValueFloat: *2 {
            a: 50,60
        }
        KeyAttrFlags: *1 {
            a: 260
        }
        KeyAttrDataFloat: *4 {
            a: 0,0,0,0
        }
        KeyAttrRefCount: *1 {
            a: 2
        }
    }
}
Connections: {
    C: "OO",90,0
    C: "OO",100,90
    C: "OO",101,100
    C: "OO",110,100
    C: "OO",111,110
    C: "OO",201,200
    C: "OO",202,201
    C: "OP",202,110, "Lcl Rotation"
    C: "OP",203,202, "d|X"
    C: "OO",204,201
    C: "OP",204,100, "Lcl Translation"
    C: "OP",205,204, "d|Y"
}
"#;

fn read(text: &str) -> crate::Result<Motion> {
    read_motion_from_bytes(text.as_bytes(), Path::new("a.fbx"), &ReadOptions::default())
}

#[test]
fn text_is_read_in_any_encoding() {
    let plain = read(SMALL).unwrap();
    let marked = format!("\u{feff}{SMALL}");
    let utf16: Vec<u8> = marked.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for bytes in [marked.into_bytes(), SMALL.replace('\n', "\r").into_bytes(), utf16] {
        let motion = read_motion_from_bytes(&bytes, Path::new("a.fbx"), &ReadOptions::default()).unwrap();
        assert_eq!(motion.clips, plain.clips);
    }
}

#[test]
fn bones_turn_as_their_curves_say() {
    let motion = read(SMALL).unwrap();
    let clip = &motion.clips[0];
    assert_eq!((clip.name(), clip.frame_count(), clip.frames_per_second()), ("Take 001", 31, 30.0));
    assert_eq!(clip.skeleton().names(), ["mixamorig:Hips", "mixamorig:LeftUpLeg"]);
    assert_eq!((motion.report.up, motion.report.up_found), (Axis::Y, Found::File));
    assert_eq!((motion.report.unit, motion.report.unit_found), (Unit::Centimetre, Found::File));
    let [hips, leg] = clip.pose(30).locals[..] else { panic!() };
    // The scale of the nodes above is folded into the translations.
    assert!(hips.translation.distance(Vec3::Y * 1.2) < 1e-5, "{hips:?}");
    assert!(leg.translation.distance(Vec3::new(0.1, -0.1, 0.1)) < 1e-5, "{leg:?}");
    let turned = Rotation::from_rotation_z(FRAC_PI_2) * Rotation::from_rotation_x(FRAC_PI_2);
    assert!(leg.rotation.dot(turned).abs() > 1.0 - 1e-5, "{leg:?}");
    let half = Rotation::from_rotation_z(FRAC_PI_2) * Rotation::from_rotation_x(FRAC_PI_2 / 2.0);
    assert!(clip.pose(15).locals[1].rotation.dot(half).abs() > 1.0 - 1e-5);
    assert!(
        clip.skeleton().rest_pose().locals[1].rotation.dot(Rotation::from_rotation_z(FRAC_PI_2)).abs()
            > 1.0 - 1e-5
    );
}

#[test]
fn units_axes_and_rates_are_the_files() {
    let up = |axis: &str, sign: &str, front: &str, front_sign: &str| {
        SMALL
            .replace(
                "\"UpAxis\", \"int\", \"Integer\", \"\",1",
                &format!("\"UpAxis\", \"int\", \"Integer\", \"\",{axis}"),
            )
            .replace(
                "\"UpAxisSign\", \"int\", \"Integer\", \"\",1",
                &format!("\"UpAxisSign\", \"int\", \"Integer\", \"\",{sign}"),
            )
            .replace(
                "\"FrontAxis\", \"int\", \"Integer\", \"\",2",
                &format!("\"FrontAxis\", \"int\", \"Integer\", \"\",{front}"),
            )
            .replace(
                "\"FrontAxisSign\", \"int\", \"Integer\", \"\",1",
                &format!("\"FrontAxisSign\", \"int\", \"Integer\", \"\",{front_sign}"),
            )
    };
    let z_up = up("2", "1", "1", "-1");
    let motion =
        read_motion_from_bytes(z_up.as_bytes(), Path::new("a.fbx"), &ReadOptions::default()).unwrap();
    assert_eq!((motion.report.up, motion.report.up_found), (Axis::Z, Found::File));
    assert!(motion.clips[0].pose(0).locals[0].translation.distance(Vec3::NEG_Z) < 1e-5);

    let y_down = up("1", "-1", "2", "-1");
    let motion =
        read_motion_from_bytes(y_down.as_bytes(), Path::new("a.fbx"), &ReadOptions::default()).unwrap();
    assert!(motion.report.warnings[0].contains("neither +Y nor +Z up"), "{:?}", motion.report.warnings);
    assert!(motion.clips[0].pose(0).locals[0].translation.distance(Vec3::NEG_Y) < 1e-5);

    let left_handed = read(&up("1", "1", "2", "-1")).unwrap_err().to_string();
    assert!(left_handed.contains("expected right-handed axes"), "{left_handed}");

    let film = SMALL.replace("\"TimeMode\", \"enum\", \"\", \"\",6", "\"TimeMode\", \"enum\", \"\", \"\",11");
    assert_eq!(read(&film).unwrap().clips[0].frame_count(), 25);
    let asked = ReadOptions { frames_per_second: Some(60.0), ..Default::default() };
    assert_eq!(
        read_motion_from_bytes(SMALL.as_bytes(), Path::new("a.fbx"), &asked).unwrap().clips[0].frame_count(),
        61
    );
}

#[test]
fn a_scaled_joint_moves_its_children_away() {
    let scaled = SMALL.replace(
        "P: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",0,50,0",
        "P: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",0,50,0\nP: \"Lcl Scaling\", \"Lcl Scaling\", \"\", \"A\",3,3,3",
    );
    let motion = read(&scaled).unwrap();
    assert!(motion.report.warnings[0].contains("`mixamorig:Hips`"), "{:?}", motion.report.warnings);
    let leg = motion.clips[0].pose(0).locals[1].translation;
    assert!(leg.distance(Vec3::new(0.3, -0.3, 0.3)) < 1e-5, "{leg}");
}

/// Reads damaged bytes: a motion of finite numbers, or an error about the file's content.
fn or_reason(bytes: &[u8]) -> crate::Result<()> {
    let motion =
        read_motion_from_bytes(bytes, Path::new("a.fbx"), &ReadOptions::default()).inspect_err(|error| {
            let Error::File { source, .. } = error else { panic!("{error}") };
            assert!(matches!(source, FormatError::Fbx(_) | FormatError::Content(_)), "{error}");
        })?;
    // `Clip::new` has checked that all numbers are finite.
    assert!(!motion.clips.is_empty());
    Ok(())
}

#[test]
fn a_binary_file_is_the_same_motion() {
    let bytes = binary(SMALL);
    let motion = read_motion_from_bytes(&bytes, Path::new("a.fbx"), &ReadOptions::default()).unwrap();
    let text = read(SMALL).unwrap();
    assert_eq!(motion.report, text.report);
    assert_eq!(motion.clips, text.clips);
}

#[test]
fn says_what_is_wrong() {
    let key = |from: &str, to: &str| SMALL.replacen(from, to, 1);
    let bones: String = (0..5000)
        .map(|i| {
            format!(
                "NodeAttribute: {0}, \"NodeAttribute::\", \"LimbNode\" {{\n}}\nModel: {1}, \"Model::b{i}\", \"LimbNode\" {{\n}}\n",
                100_000 + 2 * i,
                100_001 + 2 * i
            )
        })
        .collect();
    let nodes: String =
        (0..70_000).map(|i| format!("Model: {}, \"Model::n{i}\", \"Null\" {{\n}}\n", 100_000 + i)).collect();
    let links: String =
        (0..5000).map(|i| format!("C: \"OO\",{},{}\n", 100_000 + 2 * i, 100_001 + 2 * i)).collect();
    let with = |objects: &str, links: &str| {
        let text = SMALL.replacen("Objects: {\n", &format!("Objects: {{\n{objects}"), 1);
        text.replacen("Connections: {\n", &format!("Connections: {{\n{links}"), 1)
    };
    let cases = [
        ("has no animation", SMALL.replace("AnimationStack: 200", "Other: 200")),
        (
            "has no bones or animated nodes",
            SMALL
                .replace("\"LimbNode\"", "\"Null\"")
                .replace(",202,110, \"Lcl", ",202,999, \"Lcl")
                .replace(",204,100, \"Lcl", ",204,999, \"Lcl"),
        ),
        ("expected at most 1048576 frames and", SMALL.replace("\"\",46186158000", "\"\",46186158000000000")),
        ("is damaged or truncated", SMALL[..SMALL.len() / 2].into()),
        // Curves with different numbers of values and key times.
        (
            "is damaged or truncated",
            key("KeyValueFloat: *2 {\n            a: 0,90", "KeyValueFloat: *1 {\n            a: 0"),
        ),
        (
            "is damaged or truncated",
            key("KeyTime: *2 {\n            a: 0,46186158000", "KeyTime: *1 {\n            a: 0"),
        ),
        ("expected at most 4096 joints, got 5002", with(&bones, &links)),
        ("expected at most 65536 nodes, got ", with(&nodes, "")),
    ];
    for (expected, text) in cases {
        let error = read(&text).unwrap_err().to_string();
        assert!(error.contains(expected), "expected `{expected}`, got `{error}`");
    }
    // A key whose value is NaN.
    let mut bytes = binary(SMALL);
    let value = bytes.windows(4).position(|w| w == 90.0_f32.to_le_bytes()).unwrap();
    bytes[value..value + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = or_reason(&bytes).unwrap_err().to_string();
    assert!(
        error.contains("animation `Take 001`: frame ") && error.contains("`mixamorig:LeftUpLeg`"),
        "{error}"
    );
}

#[test]
fn a_file_that_ends_too_early_is_an_error() {
    for end in (0..SMALL.rfind('}').unwrap()).step_by(11) {
        assert!(or_reason(&SMALL.as_bytes()[..end]).is_err(), "{end} of {}", SMALL.len());
    }
    let bytes = binary(SMALL);
    let footer = bytes.len() - 180;
    for end in (27..footer).step_by(7) {
        let error = or_reason(&bytes[..end]).unwrap_err().to_string();
        assert!(error.contains("is damaged or truncated"), "{end}: {error}");
    }
}

#[test]
fn damage_is_an_error_or_another_motion() {
    let text = SMALL.as_bytes().to_vec();
    for (whole, bytes) in [(text, [b'9', b'{', b'"', 0xff]), (binary(SMALL), [0, 0x7f, 0x80, 0xff])] {
        let (mut read, mut refused) = (0, 0);
        for at in (0..whole.len()).step_by(3) {
            for byte in bytes {
                let mut damaged = whole.clone();
                damaged[at] = byte;
                match or_reason(&damaged) {
                    Ok(()) => read += 1,
                    Err(_) => refused += 1,
                }
            }
        }
        assert!(read > 100 && refused > 100, "{read} read, {refused} refused");
    }
}
