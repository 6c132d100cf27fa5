use std::path::Path;

use glam::Vec3;

use super::*;
use crate::format::read_motion_from_bytes;
use crate::math::Rotation;

/// A standing person of 1.7 m as BVH, with lengths divided by `unit` and the given up axis.
pub(in crate::format) fn person(unit: f64, up: Axis) -> String {
    let v = |x: f64, y: f64, z: f64| {
        let [x, y, z] = match up {
            Axis::Y => [x, y, z],
            _ => [x, -z, y],
        };
        format!("{} {} {}", x / unit, y / unit, z / unit)
    };
    let bone = |name: &str, at: String, inner: String| {
        format!("JOINT {name}\n{{\nOFFSET {at}\nCHANNELS 1 Xrotation\n{inner}}}\n")
    };
    let end = |at: String| format!("End Site\n{{\nOFFSET {at}\n}}\n");
    let mut body = bone(
        "Spine",
        v(0.0, 0.25, 0.0),
        [
            bone("Neck", v(0.0, 0.3, 0.0), end(v(0.0, 0.25, 0.0))),
            bone("LeftArm", v(0.2, 0.2, 0.0), bone("LeftHand", v(0.5, 0.0, 0.0), end(v(0.18, 0.0, 0.0)))),
            bone(
                "RightArm",
                v(-0.2, 0.2, 0.0),
                bone("RightHand", v(-0.5, 0.0, 0.0), end(v(-0.18, 0.0, 0.0))),
            ),
        ]
        .concat(),
    );
    for (side, x) in [("Left", 0.1), ("Right", -0.1)] {
        let foot = bone(&format!("{side}Foot"), v(0.0, -0.82, 0.0), end(v(0.0, -0.05, 0.2)));
        body += &bone(&format!("{side}Leg"), v(x, -0.05, 0.0), foot);
    }
    let root =
        format!("OFFSET {}\nCHANNELS 4 Xposition Yposition Zposition Xrotation\n{body}", v(0.0, 0.0, 0.0));
    let frame = format!("{} {}\n", v(0.0, 0.92, 0.0), ["0"; 11].join(" "));
    format!("HIERARCHY\nROOT Hips\n{{\n{root}}}\nMOTION\nFrames: 1\nFrame Time: 0.04\n{frame}")
}

fn read(text: &str, options: &ReadOptions) -> Motion {
    read_motion_from_bytes(text.as_bytes(), Path::new("a.bvh"), options).unwrap()
}

/// Position of a joint in the first frame.
fn joint(motion: &Motion, name: &str) -> Vec3 {
    let clip = &motion.clips[0];
    let joints = clip.pose(0).model_from_joints(clip.skeleton().parents());
    joints[clip.skeleton().find(name).unwrap()].translation
}

#[test]
fn units_and_axes_are_found_from_the_body() {
    let units = [Unit::Metre, Unit::Decimetre, Unit::Centimetre, Unit::Millimetre, Unit::Inch, Unit::Acclaim];
    for unit in units {
        for up in [Axis::Y, Axis::Z] {
            let motion = read(&person(unit.metres(), up), &ReadOptions::default());
            let report = &motion.report;
            assert_eq!((report.unit, report.unit_found), (unit, Found::Detected));
            assert_eq!((report.up, report.up_found), (up, Found::Detected));
            // The ratio of span to stature is only an average.
            assert!((report.stature - 1.7).abs() < 0.1, "{}", report.stature);
            assert!(report.warnings.is_empty(), "{:?}", report.warnings);
            for (name, place) in
                [("Hips", [0.0, 0.92, 0.0]), ("Neck", [0.0, 1.47, 0.0]), ("LeftArm", [0.2, 1.37, 0.0])]
            {
                assert!(joint(&motion, name).distance(place.into()) < 1e-5, "{name} in {unit}, {up} up");
            }
            let rest = motion.clips[0].skeleton();
            let neck = rest.model_from_joints()[rest.find("Neck").unwrap()].translation;
            assert!(neck.distance(Vec3::new(0.0, 0.55, 0.0)) < 1e-5, "the rest pose stands, too");
            let toes = rest.ends()[rest.find("LeftFoot").unwrap()].unwrap();
            let turn = if up == Axis::Z {
                Rotation::from_rotation_x(-std::f32::consts::FRAC_PI_2)
            } else {
                Rotation::IDENTITY
            };
            assert!((turn * toes).distance(Vec3::new(0.0, -0.05, 0.2)) < 1e-5, "joint spaces are the file's");
        }
    }
}

#[test]
fn what_is_asked_for_wins() {
    let options = ReadOptions { unit: Some(Unit::Inch), up: Some(Axis::Z), ..ReadOptions::default() };
    let motion = read(&person(1.0, Axis::Y), &options);
    assert_eq!((motion.report.unit_found, motion.report.up_found), (Found::Asked, Found::Asked));
    assert!(joint(&motion, "Hips").distance(Vec3::new(0.0, 0.0, -0.92 * 0.0254)) < 1e-6);
    assert!(
        motion.report.warnings[0].contains("with lengths in in the body is about 0.04 m"),
        "{:?}",
        motion.report.warnings
    );
}

/// A person in this unit and up axis, in a file that claims another.
fn claiming(unit: Unit, up: Axis, claim: (Unit, Axis)) -> Motion {
    let text = person(unit.metres(), up);
    let mut raw = crate::format::bvh::BVH.read_motion.unwrap()(
        text.as_bytes(),
        Path::new("a"),
        &ReadOptions::default(),
    )
    .unwrap();
    (raw.unit, raw.up) = (Some(claim.0), Some(claim.1));
    resolve(raw, &ReadOptions::default()).unwrap()
}

#[test]
fn a_file_is_believed_unless_its_body_is_impossible() {
    let motion = claiming(Unit::Inch, Axis::Z, (Unit::Inch, Axis::Z));
    assert_eq!((motion.report.unit_found, motion.report.up_found), (Found::File, Found::File));
    assert!(motion.report.warnings.is_empty());

    // 170 m and 0.017 m tall according to the file, and horizontal in every frame.
    for (unit, claim) in [(Unit::Centimetre, Unit::Metre), (Unit::Metre, Unit::Centimetre)] {
        let motion = claiming(unit, Axis::Z, (claim, Axis::Y));
        assert_eq!((motion.report.unit, motion.report.unit_found), (unit, Found::Detected));
        assert_eq!((motion.report.up, motion.report.up_found), (Axis::Z, Found::Detected));
        let warnings = motion.report.warnings.join("\n");
        assert!(warnings.contains(&format!("the file says {claim}, by which the body is")), "{warnings}");
        assert!(warnings.contains("says that Y points up, but the body stands along Z"), "{warnings}");
        assert!(joint(&motion, "Neck").distance(Vec3::new(0.0, 1.47, 0.0)) < 1e-5);
    }
    // The stature of a child is plausible.
    assert_eq!(
        claiming(Unit::Centimetre, Axis::Y, (Unit::Metres(0.005), Axis::Y)).report.unit_found,
        Found::File
    );
}

#[test]
fn a_body_of_no_usual_unit_is_scaled_to_a_person() {
    let report = read(&person(0.04, Axis::Y), &ReadOptions::default()).report;
    assert!((report.stature - TYPICAL).abs() < 1e-6 && report.unit_found == Found::Detected);
    assert!((report.unit.metres() / 0.04 - 1.0).abs() < 0.1, "{}", report.unit);
    assert!(report.warnings[0].contains("scaled to 1.70 m"), "{:?}", report.warnings);
}

#[test]
fn a_scale_of_a_hundred_too_much_is_seen() {
    // Millimetres, claimed to be decimetres.
    let motion = claiming(Unit::Millimetre, Axis::Y, (Unit::Decimetre, Axis::Y));
    assert_eq!(motion.report.unit, Unit::Millimetre);
    // A hundredth of a centimetre, which is not a named unit.
    let motion = claiming(Unit::Metres(1e-4), Axis::Y, (Unit::Centimetre, Axis::Y));
    assert!((motion.report.unit.metres() - 1e-4).abs() < 1e-12);
    assert!(joint(&motion, "Neck").distance(Vec3::new(0.0, 1.47, 0.0)) < 1e-5);
}

#[test]
fn a_body_that_tells_nothing_is_taken_as_it_is() {
    let text = "HIERARCHY ROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\nMOTION\nFrames: 1\nFrame Time: 0.04\n7\n";
    let report = read(text, &ReadOptions::default()).report;
    assert_eq!((report.unit, report.unit_found), (Unit::Metre, Found::Assumed));
    assert_eq!((report.up, report.up_found), (Axis::Y, Found::Assumed));
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(
        (&json["unit"], &json["unit_found"], &json["up"]),
        (&"m".into(), &"assumed".into(), &"Y".into())
    );
}

/// A vector of ours in the axes of a file.
fn to_file(axis: Axis, v: Vec3) -> Vec3 {
    axis.ours_from_file().conjugate() * v
}

/// A person who squats with the feet on the spot, in centimetres, of whom the root's way is in `root` metres, and whose rest pose
/// stands along +Y while the motion is `up`, moved by `shift` metres.
fn squatter(up: Axis, root: f64, shift: Vec3) -> String {
    let bone = |name: &str, [x, y, z]: [f64; 3], inner: String| {
        format!(
            "JOINT {name}\n{{\nOFFSET {} {} {}\nCHANNELS 1 Xrotation\n{inner}}}\n",
            x * 100.0,
            y * 100.0,
            z * 100.0
        )
    };
    let end = |x: f64, y: f64, z: f64| format!("End Site\n{{\nOFFSET {x} {y} {z}\n}}\n");
    let mut body = String::new();
    for (side, x) in [("Left", 1.0), ("Right", -1.0)] {
        let foot = bone(&format!("{side}Foot"), [0.0, -0.42, 0.0], end(0.0, -6.0, 18.0));
        let shin = bone(&format!("{side}Leg"), [0.0, -0.42, 0.0], foot);
        body += &bone(&format!("{side}UpLeg"), [0.1 * x, -0.02, 0.0], shin);
    }
    let mut chest = bone("Neck", [0.0, 0.25, 0.0], bone("Head", [0.0, 0.1, 0.0], end(0.0, 20.0, 0.0)));
    for (side, x) in [("Left", 1.0), ("Right", -1.0)] {
        let hand = bone(&format!("{side}Hand"), [0.25 * x, 0.0, 0.0], end(18.0 * x, 0.0, 0.0));
        let arm = bone(&format!("{side}ForeArm"), [0.28 * x, 0.0, 0.0], hand);
        chest += &bone(&format!("{side}Arm"), [0.2 * x, 0.2, 0.0], arm);
    }
    body += &bone("Spine", [0.0, 0.2, 0.0], chest);
    let mut frames = String::new();
    for frame in 0..16 {
        let bend: f64 = 40.0 * (f64::from(frame) / 15.0 * std::f64::consts::PI).sin();
        let height = 0.1 + 0.84 * bend.to_radians().cos();
        let place = to_file(up, Vec3::new(0.0, height as f32, 0.0) + shift) / root as f32;
        let turn = match up {
            Axis::X => "-90 0",
            Axis::NegativeX => "90 0",
            Axis::Y => "0 0",
            Axis::Z => "0 90",
            Axis::NegativeY => "0 180",
            Axis::NegativeZ => "0 -90",
        };
        let leg = format!("{} {} {}", -bend, 2.0 * bend, -bend);
        frames += &format!("{} {} {} {turn} {leg} {leg} 0 0 0 0 0 0 0 0 0\n", place.x, place.y, place.z);
    }
    let channels = "CHANNELS 5 Xposition Yposition Zposition Zrotation Xrotation";
    format!(
        "HIERARCHY\nROOT Hips\n{{\nOFFSET 0 0 0\n{channels}\n{body}}}\nMOTION\nFrames: 16\nFrame Time: 0.0666667\n{frames}"
    )
}

#[test]
fn a_person_is_set_upright_along_any_axis() {
    let expected = read(&squatter(Axis::Y, 0.01, Vec3::ZERO), &ReadOptions::default());
    assert!(expected.report.warnings.is_empty(), "{:?}", expected.report.warnings);
    for up in Axis::ALL {
        let text = squatter(up, 0.01, Vec3::ZERO);
        let asked = ReadOptions { up: Some(up), ..ReadOptions::default() };
        for (options, found) in [(ReadOptions::default(), Found::Detected), (asked, Found::Asked)] {
            let motion = read(&text, &options);
            assert_eq!((motion.report.up, motion.report.up_found), (up, found));
            for name in ["Hips", "Head", "LeftFoot", "RightHand"] {
                assert!(joint(&motion, name).distance(joint(&expected, name)) < 1e-4, "{name}, {up}");
            }
            assert_eq!(
                motion.report.warnings.is_empty(),
                found == Found::Asked || matches!(up, Axis::Y | Axis::Z)
            );
        }
    }
}

#[test]
fn who_lies_or_stands_on_the_head_is_told() {
    let words = |text: &str, options: &ReadOptions| read(text, options).report.warnings.join("\n");
    // A file that is upside down above a floor at zero could be of somebody who stands on the head.
    let head_stand = words(&squatter(Axis::NegativeY, 0.01, Vec3::NEG_Y * 1.55), &ReadOptions::default());
    assert!(head_stand.contains("with Y up the person is upside down: head below feet"), "{head_stand}");
    let asked = ReadOptions { up: Some(Axis::Z), ..ReadOptions::default() };
    let lying = words(&squatter(Axis::Y, 0.01, Vec3::ZERO), &asked);
    assert!(lying.contains("with Z up the person lies along the axis Y"), "{lying}");
}

#[test]
fn a_root_in_another_unit_than_the_bones_is_scaled() {
    let expected = read(&squatter(Axis::Y, 0.01, Vec3::ZERO), &ReadOptions::default());
    for (root, scale) in [(1.0, "100"), (0.1, "10"), (0.001, "0.1"), (0.0254, "2.54")] {
        let motion = read(&squatter(Axis::Y, root, Vec3::ZERO), &ReadOptions::default());
        let warnings = motion.report.warnings.join("\n");
        assert!(
            warnings.contains("the root's translation is in another unit") && warnings.contains(scale),
            "{warnings}"
        );
        for frame in [0, 8] {
            let [a, b] = [&expected, &motion].map(|m| m.clips[0].pose(frame).locals[0].translation);
            assert!(a.distance(b) < 1e-4, "{a} {b}, {root}");
        }
    }
    // No units' ratio.
    let told = read(&squatter(Axis::Y, 0.05, Vec3::ZERO), &ReadOptions::default()).report.warnings.join("\n");
    assert!(told.contains("the root moves 0.200 times as far"), "{told}");
    // A root that stays in its place is that of a motion in place.
    let mut lines: Vec<String> = squatter(Axis::Y, 0.01, Vec3::ZERO).lines().map(str::to_owned).collect();
    for line in lines.iter_mut().rev().take(16) {
        let (_, rest) = line.match_indices(' ').nth(2).map(|(at, _)| line.split_at(at)).unwrap();
        *line = format!("0 0.9 0{rest}");
    }
    let still = read(&(lines.join("\n") + "\n"), &ReadOptions::default()).report.warnings;
    assert!(still.is_empty(), "{still:?}");
}
