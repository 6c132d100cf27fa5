use glam::Vec3;

use super::*;
use crate::math::Rotation;

/// Typical of other programs: centimetres, +Z up, xformOps above the skeleton, a child before its parent, an animation
/// whose joint order differs and which lacks one joint and has a foreign one.
pub(in crate::format) const OTHERS: &str = r#"#usda 1.0
(
    metersPerUnit = 0.01
    timeCodesPerSecond = 48
    upAxis = "Z"
)
def Xform "World"
{
    double3 xformOp:translate = (0, 0, 100)
    float3 xformOp:rotateZYX = (90, 0, 0)
    float3 xformOp:scale = (2, 2, 2)
    uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateZYX", "xformOp:scale"]
    def SkelRoot "Man"
    {
        def Skeleton "Skel" (prepend apiSchemas = ["SkelBindingAPI"])
        {
            uniform token[] joints = ["Hips/Leg", "Hips", "Hips/Arm"]
            uniform token[] jointNames = ["the leg", "hips", "arm"]
            uniform matrix4d[] restTransforms = [
                ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, -40, 0, 1)),
                ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 50, 0, 1)),
                ((0, 1, 0, 0), (-1, 0, 0, 0), (0, 0, 1, 0), (20, 0, 0, 1))]
            rel skel:animationSource = <Walk>
            def SkelAnimation "Walk"
            {
                uniform token[] joints = ["Hips/Arm", "Other", "Hips"]
                quatf[] rotations.timeSamples = {
                    1: [(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)],
                    3: [(0, 0, 0, 2), (1, 0, 0, 0), (1, 0, 0, 0)],
                    5: [(0, 0, 0, 1), (1, 0, 0, 0), (0, 1, 0, 0)],
                }
                float3[] translations.timeSamples = {
                    1: [(20, 0, 0), (7, 7, 7), (0, 50, 0)],
                    5: [(20, 0, 0), (7, 7, 7), (0, 50, 8)],
                }
                half3[] scales = [(1, 1, 1), (1, 1, 1), (0.5, 0.5, 0.5)]
            }
        }
    }
}
"#;

fn read(text: &str) -> Result<RawMotion> {
    read_with(text.as_bytes(), &ReadOptions::default())
}

fn read_with(bytes: &[u8], options: &ReadOptions) -> Result<RawMotion> {
    super::read(&Document::open(bytes, std::path::Path::new("file.usd"))?, "file", options)
}

#[test]
fn text_is_read_in_any_encoding() {
    let plain = read(OTHERS).unwrap();
    let marked = format!("\u{feff}{OTHERS}");
    let utf16: Vec<u8> = marked.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for bytes in [marked.into_bytes(), utf16] {
        let raw = read_with(&bytes, &ReadOptions::default()).unwrap();
        assert_eq!(raw.takes[0].rotations, plain.takes[0].rotations);
        assert_eq!(raw.skeleton, plain.skeleton);
    }
}

#[test]
fn files_of_others_are_read() {
    let raw = read(OTHERS).unwrap();
    assert_eq!(raw.skeleton.names(), ["hips", "the leg", "arm"]);
    assert_eq!(raw.skeleton.parents(), [None, Some(0), Some(0)]);
    assert_eq!((raw.unit, raw.up), (Some(Unit::Centimetre), Some(Axis::Z)));
    // The xformOps above rotate +Y to +Z, double every length and lift by 100.
    let upright = Rotation::from_rotation_x(std::f32::consts::FRAC_PI_2);
    assert!(raw.skeleton.rest_pose().locals[0].translation.distance(Vec3::new(0.0, 0.0, 200.0)) < 1e-4);
    assert!(raw.skeleton.rest_pose().locals[0].rotation.dot(upright).abs() > 0.999_999);
    assert!(raw.skeleton.rest_pose().locals[1].translation.distance(Vec3::new(0.0, -80.0, 0.0)) < 1e-4);
    let quarter = Rotation::from_rotation_z(std::f32::consts::FRAC_PI_2);
    assert!(raw.skeleton.rest_pose().locals[2].rotation.dot(quarter).abs() > 0.999_999);

    let take = &raw.takes[0];
    assert_eq!((take.name.as_str(), take.frames_per_second), ("Walk", 24.0));
    assert_eq!(take.rotations.len(), 3 * 3);
    let same = |frame: usize, joint: usize, expected: Rotation| {
        let got = take.rotations[frame * 3 + joint];
        assert!(got.dot(expected).abs() > 0.999_999, "{frame} {joint}: {got} {expected}");
    };
    same(0, 2, Rotation::IDENTITY);
    same(1, 2, Rotation::from_rotation_z(std::f32::consts::PI));
    same(2, 0, upright * Rotation::from_rotation_x(std::f32::consts::PI));
    // The leg is not animated and keeps its local rest transform; its parent is scaled by half.
    same(1, 1, Rotation::IDENTITY);
    let tracks: Vec<_> = take.tracks.iter().map(|t| (t.joint, t.values.clone())).collect();
    assert_eq!(tracks.iter().map(|t| t.0).collect::<Vec<_>>(), [0, 1, 2]);
    assert!(tracks[0].1[1].distance(Vec3::new(0.0, -8.0, 200.0)) < 1e-4, "{:?}", tracks[0].1);
    assert!(tracks[1].1[1].distance(Vec3::new(0.0, -40.0, 0.0)) < 1e-4, "{:?}", tracks[1].1);
}

#[test]
fn a_rate_that_is_asked_for_is_sampled_between_keys() {
    let options = ReadOptions { frames_per_second: Some(48.0), ..Default::default() };
    let raw = read_with(OTHERS.as_bytes(), &options).unwrap();
    let take = &raw.takes[0];
    assert_eq!((take.rotations.len(), take.frames_per_second), (5 * 3, 48.0));
    let quarter = Rotation::from_rotation_z(std::f32::consts::FRAC_PI_2);
    assert!(take.rotations[3 + 2].dot(quarter).abs() > 0.999_999);
}

#[test]
fn keys_far_apart_are_sampled_at_the_rate_of_time_codes() {
    assert_eq!(frame_rate(&[0.0, 1.25, 2.5], 30.0), 24.0);
    assert_eq!(frame_rate(&[0.0, 30.0, 60.0], 30.0), 30.0);
    assert_eq!(frame_rate(&[0.0, 1.0, 5.0], 30.0), 30.0);
    assert_eq!(frame_rate(&[4.0], 25.0), 25.0);
    assert_eq!(frame_rate(&[], 25.0), 25.0);
}

#[test]
fn ops_above_may_move() {
    let moving = OTHERS.replace(
        "double3 xformOp:translate = (0, 0, 100)",
        "double3 xformOp:translate.timeSamples = { 1: (0, 0, 100), 5: (40, 0, 100) }",
    );
    let take = &read(&moving).unwrap().takes[0];
    assert!((take.tracks[0].values[1].x - 20.0).abs() < 1e-4, "{:?}", take.tracks[0].values);
}

#[test]
fn names_what_is_wrong() {
    let many = format!("{}]", "\"a\", ".repeat(1_000_000));
    let deep = format!("#usda 1.0\n{}", "def \"a\" {\n".repeat(100_000));
    for (from, to, expected) in [
        ("#usda 1.0", "#usdb 1.0", "expected `#usda 1.0`"),
        ("SkelAnimation \"Walk\"", "Scope \"Walk\"", "has no SkelAnimation among"),
        ("def Skeleton", "def Scope", "has no Skeleton beside"),
        ("\"Hips/Leg\", \"Hips\", ", "\"Hips\", ", "restTransforms: expected 2 matrices, got 3"),
        ("\"Hips/Leg\", \"Hips\", ", "\"Hips\", \"Hips\", ", "a joint is listed twice"),
        (
            "[\"Hips/Arm\", \"Other\", \"Hips\"]",
            "[\"a\", \"b\", \"c\"]",
            "has no SkelAnimation that moves a joint",
        ),
        ("[\"Hips/Arm\", \"Other\", ", "[\"Hips/Arm\", ", "Walk.rotations at time code 1: expected 2 values"),
        ("3: [(0, 0, 0, 2)", "3: [(0, 0, nan, 2)", "Walk.rotations at time code 3: value 0: [0.0, "),
        ("5: [(20, 0, 0)", "5e99: [(20, 0, 0)", "expected at most 1048576 frames and"),
        ("(0, -40, 0, 1)", "(inf, -40, 0, 1)", "matrix 0: expected a matrix with an inverse"),
        ("timeCodesPerSecond = 48", "timeCodesPerSecond = 0", "expected a positive number, got 0"),
        ("xformOp:scale = (2, 2, 2)", "xformOp:scale = (2, 0, 2)", "expected a matrix with an inverse"),
        ("\"xformOp:scale\"]", "\"xformOp:shear\"]", "has no value, but xformOpOrder names it"),
        (OTHERS, &deep, "expected at most 256 nested brackets"),
        (
            "\"Hips/Leg\", \"Hips\", \"Hips/Arm\"]",
            &many,
            "Skel.joints: expected 1 to 4096 joints, got 1000000",
        ),
        ("\"Hips/Arm\", \"Other\", \"Hips\"]", &many, "Walk.joints: expected 1 to 4096 joints, got 1000000"),
        ("\"Hips/Leg\", \"Hips\", \"Hips/Arm\"]", "]", "Skel.joints: expected 1 to 4096 joints, got 0"),
        (
            "5: [(20, 0, 0), (7, 7, 7), (0, 50, 8)]",
            "5: []",
            "Walk.translations at time code 5: expected 3 values",
        ),
        (
            "5: [(20, 0, 0), (7, 7, 7)",
            "5: [(20, 0, 0), (7, 7, inf)",
            "Walk.translations at time code 5: value 1: [7.0, 7.0, inf] is not finite",
        ),
    ] {
        assert!(OTHERS.contains(from), "{from}");
        let error = read(&OTHERS.replacen(from, to, 1)).unwrap_err().to_string();
        assert!(error.contains(expected), "{to}: {error}");
    }
    let error = read_with(b"\xff\xfd", &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("not UTF-8 from byte 0"), "{error}");
}

#[test]
fn text_that_ends_too_early_is_an_error() {
    let whole = OTHERS.trim_end();
    assert!(read(whole).is_ok());
    for end in (0..whole.len()).step_by(7) {
        assert!(read(&whole[..end]).is_err(), "{end}");
    }
}

/// A root layer with this metadata, and this below it.
fn layer(metadata: &str, prims: &str) -> String {
    let own = "defaultPrim = \"World\"\n metersPerUnit = 0.01\n timeCodesPerSecond = 48\n upAxis = \"Z\"\n";
    format!("#usda 1.0\n(\n {own}{metadata}\n)\n{prims}")
}

/// The motion of `root.usda` beside these files.
fn composed(root: &str, others: &[(&str, &str)]) -> crate::Result<crate::format::Motion> {
    let folder = tempfile::tempdir().unwrap();
    let below = folder.path().join("scene");
    std::fs::create_dir_all(below.join("parts")).unwrap();
    for (name, text) in others {
        std::fs::write(below.join(name), text).unwrap();
    }
    std::fs::write(below.join("root.usda"), root).unwrap();
    crate::format::read_motion(below.join("root.usda"), &ReadOptions::default())
}

#[test]
fn layers_in_the_folder_are_composed() {
    let whole = OTHERS.replacen("(\n", "(\n defaultPrim = \"World\"\n", 1);
    let plain = composed(&whole, &[]).unwrap();
    assert!(plain.report.warnings.is_empty());
    let start = whole.find("            def SkelAnimation").unwrap();
    let animation = &whole[start..whole.rfind("        }\n    }").unwrap()];
    let without = whole.replace(animation, "");
    let over = format!("over \"World\" {{ over \"Man\" {{ over \"Skel\" {{\n{animation}\n}} }} }}");
    let variant = without.replace(
        "        def Skeleton \"Skel\" (",
        "        def Skeleton \"Skel\" (\n variants = { string move = \"walk\" }\n prepend variantSets = \"move\"\n",
    );
    let set =
        format!("            variantSet \"move\" = {{\n\"none\" {{ }}\n\"walk\" {{\n{animation}\n}} }}\n");
    let at = variant.rfind("        }\n    }").unwrap();
    let variant = format!("{}{set}{}", &variant[..at], &variant[at..]);
    let arc =
        |arc: &str| layer("", &format!("def \"World\" (\n prepend {arc} = @./parts/whole.usda@\n) {{ }}\n"));
    for (name, root, others) in [
        ("reference", arc("references"), vec![("parts/whole.usda", &whole)]),
        ("payload", arc("payload"), vec![("parts/whole.usda", &whole)]),
        (
            "sublayers",
            layer("subLayers = [@parts/move.usd@, @./parts/body.usda@]", ""),
            vec![("parts/move.usd", &layer("", &over)), ("parts/body.usda", &without)],
        ),
        ("variant", variant, vec![]),
    ] {
        let motion =
            composed(&root, &others.iter().map(|(n, t)| (*n, t.as_str())).collect::<Vec<_>>()).unwrap();
        assert!(motion.report.warnings.is_empty(), "{name}: {:?}", motion.report.warnings);
        assert_eq!(motion.clips.len(), plain.clips.len(), "{name}");
        for (clip, expected) in motion.clips.iter().zip(&plain.clips) {
            assert_eq!(clip.name(), expected.name(), "{name}");
            assert_eq!(clip.frame_count(), expected.frame_count(), "{name}");
            for frame in 0..clip.frame_count() {
                assert_eq!(clip.rotations(frame), expected.rotations(frame), "{name}");
            }
            assert_eq!(clip.translations(), expected.translations(), "{name}");
        }
    }
}

#[test]
fn what_is_not_composed_is_named() {
    let reference =
        |asset: &str| layer("", &format!("def \"World\" (\n prepend references = @{asset}@\n) {{ }}\n"));
    let error = composed(&reference("./missing.usda"), &[]).unwrap_err().to_string();
    assert!(error.contains("SkelAnimation") && error.contains("missing.usda"), "{error}");
    // A file elsewhere is not read, not even with a path that leads there.
    let whole = OTHERS.replacen("(\n", "(\n defaultPrim = \"World\"\n", 1);
    let error =
        composed(&reference("../outside.usda"), &[("../outside.usda", &whole)]).unwrap_err().to_string();
    assert!(error.contains("outside.usda") && error.contains("outside the folder"), "{error}");
    let more = whole.replace("def Xform \"World\"\n", "def Xform \"World\" (\n references = @set.usda@\n)\n");
    let motion = composed(&more, &[]).unwrap();
    assert!(motion.report.warnings[0].contains("left out") && motion.report.warnings[0].contains("set.usda"));
    // A layer that refers to itself, and one that is damaged.
    let error = composed(&reference("./root.usda"), &[]).unwrap_err().to_string();
    assert!(error.contains("SkelAnimation"), "{error}");
    let error = composed(&reference("./b.usda"), &[("b.usda", "#usda 1.0\n)")]).unwrap_err().to_string();
    assert!(error.contains("b.usda"), "{error}");
}

#[test]
fn value_clips_are_named() {
    let clips = "    def Skeleton \"Skel\" (\n clips = { dictionary default = { asset[] assetPaths = [@./walk.usd@]\n string primPath = \"/Skel\" } }\n";
    let plain = OTHERS.replace("    def Skeleton \"Skel\" (", clips);
    let arc = format!("{clips} inherits = </Pose>\n");
    let composed_too = OTHERS.replace("    def Skeleton \"Skel\" (", &arc) + "class \"Pose\" { }\n";
    for text in [plain, composed_too] {
        let motion = composed(&text, &[]).unwrap();
        let warnings = motion.report.warnings;
        assert_eq!(warnings, ["value clips are not read: /World/Man/Skel has them"], "{text}");
    }
    let without =
        layer("", "def \"A\" (\n clips = { dictionary default = { string primPath = \"/A\" } }\n) { }\n");
    let error = composed(&without, &[]).unwrap_err().to_string();
    assert!(error.contains("SkelAnimation") && error.contains("value clips are not read: /A"), "{error}");
}

#[test]
fn both_kinds_are_read_as_usd_and_names_of_files_beside_are_known() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("a.usd");
    std::fs::write(&file, format!("\u{feff}{OTHERS}")).unwrap();
    assert_eq!(crate::format::read_motion(&file, &ReadOptions::default()).unwrap().clips.len(), 1);
    let texture = "def \"A\" { asset skin = @./skin.png@ }\n";
    std::fs::write(&file, layer("subLayers = [@b.usda@]", texture)).unwrap();
    std::fs::write(folder.path().join("b.usda"), layer("", "")).unwrap();
    let beside = crate::format::files_beside(&file);
    let names: Vec<_> = beside.iter().filter_map(|path| path.file_name()?.to_str()).collect();
    assert_eq!(names, ["b.usda", "skin.png"]);
}

#[test]
fn the_bind_pose_goes_before_the_rest_transforms() {
    let turned = |rest: &str, bind: &str| {
        let text = format!(
            r#"#usda 1.0
def SkelRoot "Man"
{{
    def Skeleton "Skel"
    {{
        uniform token[] joints = ["Hips", "Hips/Leg"]
        {bind}
        uniform matrix4d[] restTransforms = [
            ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 1, 0, 1)), {rest}]
        rel skel:animationSource = </Man/Anim>
    }}
    def SkelAnimation "Anim"
    {{
        uniform token[] joints = ["Hips"]
        quatf[] rotations.timeSamples = {{ 0: [(1, 0, 0, 0)], 1: [(0, 1, 0, 0)] }}
    }}
}}
"#
        );
        let raw = read(&text).unwrap();
        raw.skeleton.rest_pose().locals[1].rotation.angle_between(Rotation::IDENTITY)
    };
    let bent = "((1, 0, 0, 0), (0, 0, 1, 0), (0, -1, 0, 0), (0, -0.5, 0, 1))";
    let bind = "uniform matrix4d[] bindTransforms = [
            ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 1, 0, 1)),
            ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0.5, 0, 1))]";
    assert!((turned(bent, "") - std::f32::consts::FRAC_PI_2).abs() < 1e-3);
    assert!(turned(bent, bind) < 1e-3);
}
