use std::path::Path;

use glam::Vec3;
use serde_json::{Value, json};

use crate::format::{Found, Motion, ReadOptions, read_motion_from_bytes};
use crate::math::Rotation;
use crate::space::{Axis, Unit};

/// A buffer of numbers with its buffer views and accessors.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    fn add(&mut self, kind: &str, width: usize, numbers: &[f32]) -> usize {
        self.views
            .push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": 4 * numbers.len()}));
        let view = self.views.len() - 1;
        let count = numbers.len() / width;
        self.accessors.push(json!({"bufferView": view, "componentType": 5126, "count": count, "type": kind}));
        self.bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        self.accessors.len() - 1
    }
}

/// An armature scaled by 0.01, over hips at a height of 100 and a leg: the leg rotates about X, the hips rise.
fn small(times: &[f32]) -> (Value, Vec<u8>) {
    let mut buffer = Buffer::default();
    let time = buffer.add("SCALAR", 1, times);
    let last = (times.len() - 1).max(1) as f32;
    let turns: Vec<f32> =
        (0..times.len()).flat_map(|i| Rotation::from_rotation_x(i as f32 / last).to_array()).collect();
    let rotation = buffer.add("VEC4", 4, &turns);
    let steps: Vec<f32> = (0..times.len()).flat_map(|i| [0.0, 100.0 + 10.0 * i as f32, 0.0]).collect();
    let translation = buffer.add("VEC3", 3, &steps);
    let json = json!({
        "asset": {"version": "2.0"},
        "nodes": [
            {"name": "Armature", "scale": [0.01, 0.01, 0.01], "children": [2]},
            {"name": "Leg", "translation": [10, -5, 0]},
            {"name": "Hips", "translation": [0, 100, 0], "children": [1]},
        ],
        "skins": [{"joints": [1, 2]}],
        "animations": [{
            "name": "Walk",
            "samplers": [
                {"input": time, "output": rotation},
                {"input": time, "output": translation, "interpolation": "STEP"},
            ],
            "channels": [
                {"sampler": 0, "target": {"node": 1, "path": "rotation"}},
                {"sampler": 1, "target": {"node": 2, "path": "translation"}},
            ],
        }],
        "buffers": [{"byteLength": buffer.bytes.len()}],
        "bufferViews": buffer.views,
        "accessors": buffer.accessors,
    });
    (json, buffer.bytes)
}

fn glb((json, data): &(Value, Vec<u8>)) -> Vec<u8> {
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |length: usize| (length as u32).to_le_bytes();
    let length = word(12 + 8 + json.len() + 8 + data.len());
    let head = [b"glTF".as_slice(), &word(2), &length, &word(json.len()), b"JSON", &json];
    [head.concat(), word(data.len()).to_vec(), b"BIN\0".to_vec(), data.clone()].concat()
}

fn read(document: &(Value, Vec<u8>)) -> crate::Result<Motion> {
    read_motion_from_bytes(&glb(document), Path::new("a.glb"), &ReadOptions::default())
}

#[test]
fn joints_move_as_their_channels_say() {
    let motion = read(&small(&[0.5, 0.6, 0.7])).unwrap();
    let clip = &motion.clips[0];
    assert_eq!((clip.name(), clip.frame_count()), ("Walk", 3));
    assert_eq!((motion.report.frames_per_second, motion.report.rate_found), (10.0, Found::Detected));
    assert_eq!((motion.report.up, motion.report.up_found), (Axis::Y, Found::File));
    assert_eq!((motion.report.unit, motion.report.unit_found), (Unit::Metre, Found::File));
    assert_eq!(clip.skeleton().names(), ["Hips", "Leg"], "parents first");
    // The armature's scale is applied to the translations, without a warning.
    assert!(clip.skeleton().rest_pose().locals[1].translation.distance(Vec3::new(0.1, -0.05, 0.0)) < 1e-6);
    assert!(clip.pose(2).locals[0].translation.distance(Vec3::Y * 1.2) < 1e-6);
    assert!(clip.pose(1).locals[1].rotation.dot(Rotation::from_rotation_x(0.5)).abs() > 1.0 - 1e-6);
    assert!(motion.report.warnings.is_empty(), "{:?}", motion.report.warnings);
    assert_eq!(clip.translations().len(), 1);
}

#[test]
fn text_is_read_in_any_encoding() {
    let text = "\u{feff}{\"asset\": {\"version\": \"2.0\"}}";
    let utf16: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for bytes in [text.as_bytes(), &utf16] {
        let error = read_motion_from_bytes(bytes, Path::new("a.gltf"), &ReadOptions::default()).unwrap_err();
        assert!(error.to_string().contains("has no animation of nodes"), "{error}");
    }
}

#[test]
fn places_that_nobody_reaches_are_told() {
    let mut far = small(&[0.5, 0.6, 0.7]);
    far.0["nodes"][1]["translation"] = json!([4e27, 0, 0]);
    let error = read(&far).unwrap_err().to_string();
    assert!(error.contains("joint `Leg`, bone at rest: 4.000e25 is too large"), "{error}");
}

#[test]
fn the_rate_is_that_of_the_keys() {
    let rate = |times: &[f32]| {
        let report = read(&small(times)).unwrap().report;
        (report.frames_per_second, report.rate_found, report.warnings.len())
    };
    assert_eq!(rate(&[0.0, 1.0 / 60.0, 2.0 / 60.0, 7.0 / 60.0]), (60.0, Found::Detected, 0));
    assert_eq!(rate(&[0.0, 1.0, 1.0 + 1.0 / 5.0]), (25.0, Found::Detected, 0));
    assert_eq!(rate(&[0.0, 1.0, 2.7187]), (30.0, Found::Assumed, 1));

    let mut ours = small(&[0.0, 1.0]);
    ours.0["animations"][0]["extras"] = json!({"anthronet": {"frames_per_second": 48.0, "frames": 97}});
    let motion = read(&ours).unwrap();
    assert_eq!((motion.clips[0].frame_count(), motion.report.rate_found), (97, Found::File));
}

#[test]
fn steps_hold_lines_run_and_splines_curve() {
    let options = ReadOptions { frames_per_second: Some(40.0), ..Default::default() };
    let motion = read_motion_from_bytes(&glb(&small(&[0.0, 0.1])), Path::new("a.glb"), &options).unwrap();
    let clip = &motion.clips[0];
    let heights: Vec<f32> = (0..5).map(|f| clip.pose(f).locals[0].translation.y).collect();
    for (height, expected) in heights.iter().zip([1.0, 1.0, 1.0, 1.0, 1.1]) {
        assert!((height - expected).abs() < 1e-6, "{heights:?}");
    }
    assert!(clip.pose(1).locals[1].rotation.dot(Rotation::from_rotation_x(0.25)).abs() > 1.0 - 1e-6);

    // A quarter of the way from 100, slope 200 per second, to 110, slope 0: 1/64 · (54 · 100 + 10 · 110) + 0.1 · 9/64 · 200.
    let (mut json, mut data) = small(&[0.0, 0.1]);
    let keys: [f32; 18] = [0., 0., 0., 0., 100., 0., 0., 200., 0., 0., 0., 0., 0., 110., 0., 0., 0., 0.];
    let view = json["bufferViews"].as_array().unwrap().len();
    json["bufferViews"]
        .as_array_mut()
        .unwrap()
        .push(json!({"buffer": 0, "byteOffset": data.len(), "byteLength": 72}));
    json["accessors"][2] = json!({"bufferView": view, "componentType": 5126, "count": 6, "type": "VEC3"});
    json["animations"][0]["samplers"][1]["interpolation"] = json!("CUBICSPLINE");
    data.extend(keys.iter().flat_map(|x| x.to_le_bytes()));
    json["buffers"][0]["byteLength"] = json!(data.len());
    let motion = read_motion_from_bytes(&glb(&(json, data)), Path::new("a.glb"), &options).unwrap();
    let height = motion.clips[0].pose(1).locals[0].translation.y;
    let expected = 0.01 * ((54.0 * 100.0 + 10.0 * 110.0) / 64.0 + 0.1 * 9.0 / 64.0 * 200.0);
    assert!((height - expected).abs() < 1e-5, "{height} {expected}");
}

#[test]
fn without_a_skin_what_moves_is_a_joint() {
    let mut document = small(&[0.0, 0.1]);
    document.0.as_object_mut().unwrap().remove("skins");
    assert_eq!(read(&document).unwrap().clips[0].skeleton().names(), ["Hips", "Leg"]);
}

#[test]
fn scale_on_a_joint_is_folded_in_and_told() {
    let mut document = small(&[0.0, 0.1]);
    document.0["nodes"][2]["scale"] = json!([2, 2, 2]);
    document.0["nodes"][1]["name"] = json!("Hips");
    let motion = read(&document).unwrap();
    assert!(motion.clips[0].pose(0).locals[1].translation.distance(Vec3::new(0.2, -0.1, 0.0)) < 1e-6);
    let warnings = motion.report.warnings.join("\n");
    assert!(warnings.contains("joint `Hips` and perhaps others are scaled"), "{warnings}");
    assert!(warnings.contains("renamed to `Hips.1`"), "{warnings}");
}

#[test]
fn says_what_is_wrong_and_where() {
    type Case = (&'static str, fn(&mut Value));
    let cases: &[Case] = &[
        ("has no animation of nodes", |j| j["animations"] = json!([])),
        ("animations[0]: channels[0]: target: node 9 does not exist, there are 3", |j| {
            j["animations"][0]["channels"][0]["target"]["node"] = json!(9);
        }),
        ("channels[0]: sampler 7 does not exist, there are 2", |j| {
            j["animations"][0]["channels"][0]["sampler"] = json!(7);
        }),
        ("input: expected times of keys that rise", |j| {
            j["animations"][0]["samplers"][0]["input"] = json!(3);
        }),
        ("output: accessor 0: expected rows of 4", |j| {
            j["animations"][0]["samplers"][0]["output"] = json!(0);
        }),
        ("output: expected 6 values for 2 keys, got 2", |j| {
            j["animations"][0]["samplers"][0]["interpolation"] = json!("CUBICSPLINE");
        }),
        ("expected LINEAR, STEP or CUBICSPLINE", |j| {
            j["animations"][0]["samplers"][0]["interpolation"] = json!("WAVY");
        }),
        ("truncated: expected 1000000 elements", |j| j["accessors"][1]["count"] = json!(1_000_000)),
        (
            "channels[0]: input: accessor 0: expected at most 12582912 elements, got 18446744073709551615",
            |j| {
                j["accessors"][0]["count"] = json!(u64::MAX);
            },
        ),
        ("animations[0]: channels[0]: input: expected times of keys that rise", |j| {
            j["accessors"][0]["count"] = json!(0);
        }),
        ("animations[0]: channels[0]: output: expected 2 values for 2 keys, got 1", |j| {
            j["accessors"][1]["count"] = json!(1);
        }),
        ("animations[0]: channels[0]: output: ", |j| j["accessors"][1]["componentType"] = json!(5125)),
        ("expected at most 65536 nodes, got 1000003", |j| {
            let nodes = j["nodes"].as_array_mut().unwrap();
            nodes.extend((0..1_000_000).map(|_| json!({})));
        }),
        ("expected at most 4096 joints, got 5000", |j| {
            let nodes = j["nodes"].as_array_mut().unwrap();
            nodes.extend((3..5000).map(|_| json!({})));
            j["skins"][0]["joints"] = json!((0..5000).collect::<Vec<u32>>());
        }),
        ("skins[0].joints: node 8 does not exist, there are 3", |j| j["skins"][0]["joints"][0] = json!(8)),
        ("is its own ancestor", |j| j["nodes"][1]["children"] = json!([0])),
        ("expected at most 1048576 frames and", |j| {
            j["animations"][0]["extras"] = json!({"anthronet": {"frames_per_second": 30, "frames": 1e18}});
        }),
        ("a file beside or below the document", |j| j["buffers"][0]["uri"] = json!("../secret.bin")),
    ];
    for (expected, spoil) in cases {
        let (mut json, mut data) = small(&[0.0, 0.1]);
        // Two equal times, for the case of key times that do not increase.
        let view = json["bufferViews"].as_array().unwrap().len();
        json["bufferViews"]
            .as_array_mut()
            .unwrap()
            .push(json!({"buffer": 0, "byteOffset": data.len(), "byteLength": 8}));
        json["accessors"]
            .as_array_mut()
            .unwrap()
            .push(json!({"bufferView": view, "componentType": 5126, "count": 2, "type": "SCALAR"}));
        data.extend([0; 8]);
        json["buffers"][0]["byteLength"] = json!(data.len());
        spoil(&mut json);
        let error = read(&(json, data)).unwrap_err().to_string();
        assert!(error.contains(expected), "expected `{expected}`, got `{error}`");
    }
}

#[test]
fn numbers_that_are_none_are_found_where_they_are() {
    // Times, rotations, translations of two keys, in the order of the buffer.
    let cases = [
        (1, f32::NAN, "animations[0]: channels[0]: input: "),
        (2 + 1, f32::NAN, "animations[0]: channels[0]: output: "),
        (2 + 8 + 4, f32::INFINITY, "animations[0]: channels[1]: output: "),
    ];
    for (place, number, expected) in cases {
        let (json, mut data) = small(&[0.0, 0.1]);
        data[4 * place..4 * place + 4].copy_from_slice(&number.to_le_bytes());
        let error = read(&(json, data)).unwrap_err().to_string();
        assert!(error.contains(expected) && error.contains("finite"), "expected `{expected}`, got `{error}`");
    }
}

#[test]
fn damage_is_an_error_or_another_motion() {
    let bytes = glb(&small(&[0.0, 0.1]));
    let read = |bytes: &[u8]| read_motion_from_bytes(bytes, Path::new("a.glb"), &ReadOptions::default());
    for end in 0..bytes.len() {
        assert!(read(&bytes[..end]).is_err(), "{end}");
    }
    let mut good = 0;
    for at in 0..bytes.len() {
        for byte in [b'9', b'-', b'e', 0x7f, 0xff] {
            let mut bytes = bytes.clone();
            bytes[at] = byte;
            good += usize::from(read(&bytes).is_ok());
        }
    }
    assert!(good > 0, "a changed digit leaves a motion");
}

#[test]
fn what_motion_does_not_need_may_be_required_and_missing() {
    let (mut json, data) = small(&[0.0, 0.1]);
    let wanted = read(&(json.clone(), data.clone())).unwrap();
    let required =
        ["KHR_draco_mesh_compression", "EXT_texture_webp", "KHR_mesh_quantization", "XYZ_anything"];
    json["extensionsRequired"] = json!(required);
    json["meshes"] = json!([{"primitives": [{"attributes": {"POSITION": 3}}]}]);
    json["accessors"]
        .as_array_mut()
        .unwrap()
        .push(json!({"componentType": 5122, "count": 3, "type": "VEC3"}));
    let channels = json["animations"][0]["channels"].as_array_mut().unwrap();
    channels.push(json!({"sampler": 0, "target": {"path": "translation"}}));
    channels.push(
        json!({"sampler": 0, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {}}}}),
    );
    channels.push(json!({"sampler": 0, "target": {"node": 1, "path": "pointer"}}));
    let motion = read(&(json.clone(), data.clone())).unwrap();
    assert_eq!(motion.clips, wanted.clips);
    assert_eq!(
        motion.report.warnings.last().unwrap(),
        "3 channels of animations move no node: they are left out"
    );
    json["extensionsRequired"] = json!(["KHR_meshopt_compression"]);
    let error = read(&(json.clone(), data.clone())).unwrap_err().to_string();
    assert!(error.contains("KHR_meshopt_compression is not supported"), "{error}");
    json["extensionsRequired"] = json!([]);
    json["animations"][0]["samplers"] = json!(3);
    let error = read(&(json, data)).unwrap_err().to_string();
    assert!(error.contains("nor valid glTF JSON"), "{error}");
}

#[test]
fn the_bind_pose_goes_before_that_of_the_nodes() {
    let (mut json, mut data) = small(&[0.0, 0.1]);
    // The leg is turned in the pose that the nodes hold, and hangs straight in that of the skin.
    let bent = Rotation::from_rotation_x(0.4).to_array();
    json["nodes"][1]["rotation"] = json!(bent);
    let leg = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -0.1, -0.95, 0.0, 1.0f32];
    let hips = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0f32];
    let (view, accessor) =
        (json["bufferViews"].as_array().unwrap().len(), json["accessors"].as_array().unwrap().len());
    let place = json!({"buffer": 0, "byteOffset": data.len(), "byteLength": 128});
    json["bufferViews"].as_array_mut().unwrap().push(place);
    let matrices = json!({"bufferView": view, "componentType": 5126, "count": 2, "type": "MAT4"});
    json["accessors"].as_array_mut().unwrap().push(matrices);
    data.extend(leg.iter().chain(&hips).flat_map(|x| x.to_le_bytes()));
    json["buffers"][0]["byteLength"] = json!(data.len());
    let of_nodes = read(&(json.clone(), data.clone())).unwrap();
    json["skins"][0]["inverseBindMatrices"] = json!(accessor);
    let of_skin = read(&(json, data)).unwrap();
    for (motion, turn) in [(of_nodes, 0.4), (of_skin, 0.0)] {
        let rest = motion.clips[0].skeleton();
        let leg = rest.rest_pose().locals[rest.find("Leg").unwrap()].rotation;
        assert!((leg.angle_between(Rotation::IDENTITY) - turn).abs() < 1e-3, "{leg:?}");
    }
}

#[test]
fn tables_of_human_bones_are_read() {
    use crate::Side;
    use crate::skeleton::{RigJoint, SidedJoint};

    let table = |bones: Value| json!({"humanoid": {"humanBones": bones}});
    let new = table(json!({"hips": {"node": 2}, "leftUpperLeg": {"node": 1}, "tail": {"node": 0}}));
    let old =
        table(json!([{"bone": "hips", "node": 2}, {"bone": "leftUpperLeg", "node": 1}, {"bone": "jaw"}]));
    for (name, extension) in [("VRMC_vrm_animation", &new), ("VRMC_vrm", &new), ("VRM", &old)] {
        let (mut json, data) = small(&[0.0, 0.1]);
        json["extensions"] = json!({name: extension});
        let motion = read(&(json.clone(), data.clone())).unwrap();
        let rest = motion.clips[0].skeleton();
        let at =
            |joint: RigJoint| rest.humanoid().iter().find(|row| row.0 == joint).map(|row| row.1 as usize);
        assert_eq!(at(RigJoint::Pelvis), rest.find("Hips"), "{name}");
        assert_eq!(at(SidedJoint::Thigh.on(Side::Left)), rest.find("Leg"), "{name}");
        assert_eq!(rest.humanoid().len(), 2, "{name}");
        json["extensions"][name] = table(json!({"hips": {"node": 8}}));
        let error = read(&(json, data)).unwrap_err().to_string();
        assert!(error.contains("humanBones: hips: node 8 does not exist, there are 3"), "{error}");
    }
}
