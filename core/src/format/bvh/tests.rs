use std::path::Path;

use glam::{EulerRot, Vec3};

use crate::format::{Found, Motion, ReadOptions, read_motion_from_bytes};
use crate::math::Rotation;
use crate::space::{Axis, Unit};

const SMALL: &str = "HIERARCHY\nROOT Hips\n{\n\tOFFSET 0 1 0\n\tCHANNELS 6 Xposition Zposition Yposition Zrotation Xrotation Yrotation\n\
    \tJOINT Left Leg\n\t{\n\t\tOFFSET 0.1 -0.1 0\n\t\tCHANNELS 1 Xrotation\n\t\tEnd Site\n\t\t{\n\t\t\tOFFSET 0 -0.9 0\n\t\t}\n\t}\n}\n\
    MOTION\nFrames: 2\nFrame Time: 0.0333333\n1 2 3 10 20 30 40\n4 5 6 0 0 0 0\n";

fn metres() -> ReadOptions {
    ReadOptions { unit: Some(Unit::Metre), up: Some(Axis::Y), ..ReadOptions::default() }
}

fn read(text: &str) -> crate::Result<Motion> {
    read_motion_from_bytes(text.as_bytes(), Path::new("walk.bvh"), &metres())
}

#[test]
fn reads_joints_and_frames() {
    let motion = read(SMALL).unwrap();
    let clip = &motion.clips[0];
    assert_eq!((clip.name(), clip.frame_count(), clip.frames_per_second()), ("walk", 2, 30.0));
    let rest = clip.skeleton();
    assert_eq!(rest.names(), ["Hips", "Left Leg"]);
    assert_eq!(rest.parents(), [None, Some(0)]);
    assert_eq!(rest.ends(), [None, Some(Vec3::new(0.0, -0.9, 0.0))]);
    assert_eq!(rest.rest_pose().locals[1].translation, Vec3::new(0.1, -0.1, 0.0));
    let pose = clip.pose(0);
    // Numbers follow the order of channels: x, z, y.
    assert_eq!(pose.locals[0].translation, Vec3::new(1.0, 3.0, 2.0));
    let radians = |degrees: f32| degrees.to_radians();
    let expected = Rotation::from_euler(EulerRot::ZXY, radians(10.0), radians(20.0), radians(30.0));
    assert!(pose.locals[0].rotation.dot(expected).abs() > 1.0 - 1e-6);
    assert!(pose.locals[1].rotation.dot(Rotation::from_rotation_x(radians(40.0))).abs() > 1.0 - 1e-6);
    assert_eq!(clip.translations().len(), 1, "a joint without position channels stays at its offset");
    assert_eq!(motion.report.rate_found, Found::File);
}

#[test]
fn layout_does_not_matter() {
    let plain = read(SMALL).unwrap();
    let variants = [
        SMALL.replace('\n', "\r\n"),
        SMALL.replace('\n', "\r"),
        SMALL.replace('\t', "    ").replace("Hips\n{", "Hips {"),
        SMALL.replace("MOTION", "\n\nmotion\n").replace("End Site", "END SITE"),
        format!("\u{feff}{}\n \r\n", SMALL.trim_end()),
    ];
    for text in variants {
        assert_eq!(read(&text).unwrap().clips, plain.clips, "{text}");
    }
}

#[test]
fn text_in_utf16_is_read() {
    let bytes: Vec<u8> = SMALL.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let marked = [&[0xff, 0xfe][..], &bytes].concat();
    for bytes in [bytes, marked] {
        let motion = read_motion_from_bytes(&bytes, Path::new("walk.bvh"), &metres()).unwrap();
        assert_eq!(motion.clips, read(SMALL).unwrap().clips);
    }
}

#[test]
fn miscounted_frames_are_read_with_a_word() {
    let plain = read(SMALL).unwrap();
    for said in [1, 3] {
        let motion = read(&SMALL.replace("Frames: 2", &format!("Frames: {said}"))).unwrap();
        assert_eq!(motion.clips, plain.clips);
        let word = format!("the file says {said} frames and has 2");
        assert!(motion.report.warnings.iter().any(|w| w.contains(&word)), "{:?}", motion.report.warnings);
    }
    assert!(!plain.report.warnings.iter().any(|w| w.contains("frames and has")));
}

#[test]
fn a_file_without_a_rate_is_read_at_the_one_that_was_asked_for() {
    let options = ReadOptions { frames_per_second: Some(15.0), ..metres() };
    for time in ["0", "-1", "nan", ""] {
        let text = SMALL.replace("0.0333333", time);
        let motion = read_motion_from_bytes(text.as_bytes(), Path::new("a.bvh"), &options).unwrap();
        assert_eq!((motion.clips[0].frames_per_second(), motion.report.rate_found), (15.0, Found::Asked));
    }
}

#[test]
fn places_that_nobody_reaches_are_told() {
    for (from, to, expected) in [
        ("4 5 6", "4 4e27 6", "joint `Hips`, place in frame 1 of `walk`: 4.000e27 is too large"),
        (
            "4 5 6",
            "4 20000 6",
            "joint `Hips`, place in frame 1 of `walk`: 2.000e4 m is too large, expected at most 10000 m",
        ),
        ("0.1 -0.1 0", "0.1 -3e20 0", "joint `Left Leg`, bone at rest: 3.000e20 is too large"),
        ("0 -0.9 0", "0 -9e20 0", "joint `Left Leg`, end of its bone: 9.000e20 is too large"),
    ] {
        let error = read(&SMALL.replace(from, to)).unwrap_err().to_string();
        assert!(error.contains(expected), "expected `{expected}`, got `{error}`");
    }
}

#[test]
fn several_roots_and_moving_joints() {
    let text = SMALL
        .replace("CHANNELS 1 Xrotation", "CHANNELS 2 Yposition Xrotation")
        .replace("MOTION", "ROOT Prop\n{\nOFFSET 5 5 5\nCHANNELS 0\n}\nMOTION")
        .replace(" 30 40\n", " 30 -0.5 40\n")
        .replace(" 0 0 0 0\n", " 0 0 0 -0.1 0\n");
    let motion = read(&text).unwrap();
    let clip = &motion.clips[0];
    assert_eq!(clip.skeleton().parents(), [None, Some(0), None]);
    // The channel replaces its component of the offset; the others are kept.
    assert_eq!(clip.pose(0).locals[1].translation, Vec3::new(0.1, -0.5, 0.0));
    assert_eq!(clip.translations().iter().map(|t| t.joint).collect::<Vec<_>>(), [0, 1]);
}

#[test]
fn a_second_joint_of_a_name_is_renamed() {
    let motion = read(&SMALL.replace("Left Leg", "Hips")).unwrap();
    assert_eq!(motion.clips[0].skeleton().names(), ["Hips", "Hips.1"]);
    assert!(motion.report.warnings.iter().any(|w| w.contains("`Hips.1`")), "{:?}", motion.report.warnings);
}

#[test]
fn a_rate_that_was_asked_for_wins() {
    let options = ReadOptions { frames_per_second: Some(120.0), ..metres() };
    let motion = read_motion_from_bytes(SMALL.as_bytes(), Path::new("a.bvh"), &options).unwrap();
    assert_eq!((motion.clips[0].frames_per_second(), motion.report.rate_found), (120.0, Found::Asked));
}

#[test]
fn says_what_is_wrong_and_in_which_line() {
    let many = format!("HIERARCHY\n{}", "ROOT a\n{\nOFFSET 0 0 0\nCHANNELS 0\n}\n".repeat(5000));
    let deep = format!("HIERARCHY\nROOT a\n{}", "{\nJOINT a\n".repeat(100_000));
    let cases: [(&str, String); 24] = [
        ("line 1: truncated: expected HIERARCHY", String::new()),
        ("line 1: expected HIERARCHY, got `MOTION`", "MOTION".into()),
        ("expected at most 4096 joints, got more", many),
        ("expected at most 4096 joints, got more", deep),
        ("line 2: expected a joint's name", SMALL.replace("ROOT Hips", "ROOT")),
        ("line 4: three numbers after OFFSET: `nan` is not finite", SMALL.replace("0 1 0\n", "0 nan 0\n")),
        ("line 4: expected three numbers after OFFSET, got the end", SMALL.replace("0 1 0\n", "0 1\n")),
        ("line 5: expected 6 channels, got 5", SMALL.replace("Xrotation Yrotation", "Xrotation")),
        ("line 5: expected the end of the line after 5 channels", SMALL.replace("CHANNELS 6", "CHANNELS 5")),
        ("line 5: expected Xposition", SMALL.replace("Zposition", "Wposition")),
        ("line 5: channel `Xposition` twice", SMALL.replace("Zposition", "Xposition")),
        ("line 5: expected at most 6", SMALL.replace("CHANNELS 6", "CHANNELS 1000000000")),
        ("expected OFFSET of `the end site`, got none", SMALL.replace("OFFSET 0 -0.9 0", "")),
        ("expected 1 to 1048576 frames, got 0", SMALL.replace("Frames: 2", "Frames: 0")),
        (
            "line 18: truncated: expected 900000 frames",
            SMALL.replace("Frames: 2", "Frames: 900000").replace("Frame Time", "Frame\tTime"),
        ),
        (
            "truncated: expected 6 frames, got 2",
            SMALL
                .replace("Frames: 2", "Frames: 6")
                .replace("4 5 6", "4.0000 5.0000 6.0000000000000000000000000"),
        ),
        (
            "line 20: expected 7 channels, got 6",
            SMALL.replace("Frames: 2", "Frames: 1").replace(" 0 0 0 0\n", " 0 0 0\n"),
        ),
        (
            "line 19: a number: `1e30` is too large, expected less than 1e30",
            SMALL.replace("1 2 3", "1 1e30 3"),
        ),
        ("line 20: a number: `-4e400` is too large", SMALL.replace("4 5 6", "4 -4e400 6")),
        (
            "line 20: an angle: -2000000° is too large, expected at most 1000000°",
            SMALL.replace(" 0 0 0 0\n", " 0 -2e6 0 0\n"),
        ),
        ("line 18: expected a Frame Time of 0.001 to 10 seconds, got 0", SMALL.replace("0.0333333", "0")),
        ("line 19: expected 7 channels, got 6", SMALL.replace(" 40\n", "\n")),
        ("line 20: a number: `inf` is not finite", SMALL.replace("4 5 6", "4 inf 6")),
        ("after 2 frames, got `garbage`", format!("{SMALL}garbage")),
    ];
    for (expected, text) in cases {
        let error = read(&text).unwrap_err().to_string();
        assert!(error.contains(expected), "expected `{expected}`, got `{error}`");
    }
}

#[test]
fn damage_is_an_error_or_another_motion() {
    for end in 0..SMALL.len() - 20 {
        assert!(read(&SMALL[..end]).is_err(), "{end}");
    }
    let mut read = 0;
    for at in 0..SMALL.len() {
        for byte in [b'9', b'-', b' ', b'\n', b'{', 0xff] {
            let mut bytes = SMALL.as_bytes().to_vec();
            bytes[at] = byte;
            read += usize::from(
                read_motion_from_bytes(&bytes, Path::new("a.bvh"), &ReadOptions::default()).is_ok(),
            );
        }
    }
    assert!(read > 0, "a changed digit leaves a motion");
}
