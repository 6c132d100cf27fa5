use std::{path::Path, sync::LazyLock};

use glam::Vec3;
use proptest::prelude::*;
use serde_json::json;

use super::*;
use crate::format::gltf::{to_glb, to_gltf};
use crate::format::write_scene;
use crate::testing::scene::{arm, sleeve};

static GLB: LazyLock<Vec<u8>> = LazyLock::new(|| to_glb(&arm(4)).unwrap());

fn read(bytes: &[u8]) -> std::result::Result<ImportedScene, String> {
    from_bytes(bytes, Path::new("a.glb")).map_err(|e| e.to_string())
}

/// The arm with its JSON changed.
fn changed(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    changed_of(&GLB, change)
}

pub(super) fn changed_of(original: &[u8], change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let json_end = 20 + u32::from_le_bytes(original[12..16].try_into().unwrap()) as usize;
    let mut json: Value = serde_json::from_slice(&original[20..json_end]).unwrap();
    change(&mut json);
    let mut text = serde_json::to_vec(&json).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut glb = original[..12].to_vec();
    glb.extend((text.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(text);
    glb.extend(&original[json_end..]);
    let length = glb.len() as u32;
    glb[8..12].copy_from_slice(&length.to_le_bytes());
    glb
}

#[test]
fn reads_back_what_was_written() {
    let written = arm(4);
    let scene = read(&GLB).unwrap();
    assert_eq!(scene.joint_names, ["upper", "lower", "thumb"]);
    assert_eq!(scene.extras["asked"]["arm_length"], 0.6);
    let body = &scene.meshes[0];
    assert_eq!((body.name.as_str(), body.skinned, body.model_vertices), ("Sleeve", true, 15));
    let expected: Vec<_> = written.meshes[0].positions.iter().map(|p| Vec3::from(*p)).collect();
    assert_eq!(body.positions[..15], expected);
    assert_eq!((body.positions.len(), body.normals.len()), (18, 18));
    let corners = written.meshes[0].triangulated().into_iter().flatten();
    for (read, written) in body.triangles.iter().flatten().zip(corners) {
        assert_eq!(body.positions[*read as usize], expected[written.0 as usize]);
    }
    assert_eq!(scene.meshes[1].base_color, [0.8, 0.6, 0.55, 0.9]);
}

#[test]
fn reads_a_gltf_with_its_buffer_beside_it_or_inside() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("my ärm.gltf");
    write_scene(&arm(4), &path).unwrap();
    assert_eq!(crate::format::meshes::open(&path).unwrap(), read(&GLB).unwrap());

    let files = to_gltf(&arm(4), "x.bin").unwrap();
    let mut json: Value = serde_json::from_slice(&files.json).unwrap();
    json["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{}", base64(&files.bin)).into();
    assert_eq!(read(json.to_string().as_bytes()).unwrap(), read(&GLB).unwrap());

    std::fs::remove_file(folder.path().join("my ärm.bin")).unwrap();
    let message = crate::format::meshes::open(&path).unwrap_err().to_string();
    assert!(message.contains("my ärm.bin: cannot read"), "{message}");
}

fn base64(bytes: &[u8]) -> String {
    const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let word = (0..3).fold(0u32, |w, i| w << 8 | u32::from(*group.get(i).unwrap_or(&0)));
        for i in 0..4 {
            let character = char::from(ALPHABET[(word >> (18 - 6 * i) & 63) as usize]);
            text.push(if i <= group.len() { character } else { '=' });
        }
    }
    text
}

#[test]
fn nodes_move_meshes_without_a_skin_only() {
    let moved = changed(|json| {
        json["nodes"][3]["translation"] = json!([9, 9, 9]);
        json["nodes"][4] = json!({"mesh": 1, "scale": [-2, 2, 2]});
        json["nodes"][0]["children"].as_array_mut().unwrap().push(json!(4));
        json["scenes"][0]["nodes"] = json!([0, 3]);
    });
    let scene = read(&moved).unwrap();
    let still = read(&GLB).unwrap();
    assert_eq!(scene.meshes[0], still.meshes[0]);
    let root = arm(4).joints[0].model_from_joint;
    for (moved, still) in scene.meshes[1].positions.iter().zip(&still.meshes[1].positions) {
        let expected = root.transform_point3(*still * Vec3::new(-2.0, 2.0, 2.0));
        assert!(moved.distance(expected) < 1e-6);
    }
    assert_eq!(scene.meshes[1].triangles, [[0, 2, 1]], "a mirror turns faces over");
}

#[test]
fn says_what_is_wrong_and_where() {
    type Case = (&'static str, fn(&mut Value));
    let cases: &[Case] = &[
        ("asset.version: expected 2.x, got `1.0`", |j| j["asset"]["version"] = json!("1.0")),
        ("KHR_draco_mesh_compression is not supported", |j| {
            j["extensionsRequired"] = json!(["EXT_meshopt_compression", "KHR_draco_mesh_compression"]);
        }),
        ("buffers[0]: expected 99999999 bytes", |j| j["buffers"][0]["byteLength"] = json!(99_999_999)),
        ("expected a file beside or below", |j| j["buffers"][0]["uri"] = json!("../../etc/passwd")),
        ("expected a file beside or below", |j| j["buffers"][0]["uri"] = json!("%2Fetc/passwd")),
        ("expected a file beside or below", |j| j["buffers"][0]["uri"] = json!("file:///etc/passwd")),
        ("expected base64", |j| j["buffers"][0]["uri"] = json!("data:x;base64,$$$$")),
        ("count 1000000000 is beyond", |j| set_all(j, "accessors", "count", &json!(1_000_000_000))),
        ("count 40000 reaches beyond", |j| set_all(j, "accessors", "count", &json!(40_000))),
        ("reaches beyond", |j| set_all(j, "accessors", "byteOffset", &json!(u64::MAX))),
        ("reaches beyond", |j| set_all(j, "bufferViews", "byteOffset", &json!(u64::MAX))),
        ("reaches beyond its buffer", |j| set_all(j, "bufferViews", "byteLength", &json!(u64::MAX))),
        ("reaches beyond", |j| set_all(j, "bufferViews", "byteStride", &json!(u64::MAX))),
        ("byteStride is smaller", |j| set_all(j, "bufferViews", "byteStride", &json!(0))),
        ("buffer does not exist", |j| set_all(j, "bufferViews", "buffer", &json!(7))),
        ("bufferView does not exist", |j| set_all(j, "accessors", "bufferView", &json!(99))),
        ("has no bufferView", |j| set_all(j, "accessors", "bufferView", &Value::Null)),
        ("is not of f32 vectors", |j| set_all(j, "accessors", "componentType", &json!(5123))),
        ("unknown component type", |j| set_all(j, "accessors", "componentType", &json!(1))),
        ("POSITION: accessor 999 of", |j| {
            j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(999);
        }),
        ("has no POSITION", |j| j["meshes"][0]["primitives"][0]["attributes"] = json!({})),
        ("expected triangles", |j| j["meshes"][0]["primitives"][0]["mode"] = json!(1)),
        ("expected three corners", |j| {
            j["meshes"][1]["primitives"][0].as_object_mut().unwrap().remove("indices");
            let position =
                j["meshes"][1]["primitives"][0]["attributes"]["POSITION"].as_u64().unwrap() as usize;
            j["accessors"][position]["count"] = json!(2);
        }),
        ("of 3 vertices", |j| {
            let body = j["meshes"][0]["primitives"][0]["indices"].clone();
            j["meshes"][1]["primitives"][0]["indices"] = body;
        }),
        ("material 50 of 2", |j| j["meshes"][0]["primitives"][0]["material"] = json!(50)),
        ("nodes[3].mesh: 5 of 2", |j| j["nodes"][3]["mesh"] = json!(5)),
        ("nodes[4].children: 77 of 5", |j| j["nodes"][4]["children"] = json!([77])),
        ("nodes[1] has two parents", |j| j["nodes"][4]["children"] = json!([1])),
        ("is its own ancestor", |j| j["nodes"][2]["children"] = json!([0])),
        ("skins[0].joints: 44 of 5", |j| j["skins"][0]["joints"] = json!([0, 44])),
        ("flattens space", |j| {
            j["nodes"][4] = json!({"mesh": 1, "scale": [0, 0, 0]});
        }),
        ("extras.anthronet.vertices exceeds", |j| {
            j["meshes"][0]["extras"]["anthronet"]["vertices"] = json!(19);
        }),
        ("holds no mesh", |j| {
            j["nodes"].as_array_mut().unwrap().truncate(3);
            j["scenes"][0]["nodes"] = json!([0]);
        }),
    ];
    for (expected, change) in cases {
        let message = read(&changed(change)).expect_err(expected);
        assert!(message.starts_with("a.glb: ") && message.contains(expected), "`{expected}` in `{message}`");
    }
}

fn set_all(json: &mut Value, list: &str, field: &str, value: &Value) {
    for item in json[list].as_array_mut().unwrap() {
        item[field] = value.clone();
    }
}

#[test]
fn names_numbers_that_are_not_finite() {
    let mut bytes = GLB.clone();
    let first = arm(4).meshes[0].positions[0].map(f32::to_le_bytes).concat();
    let at = bytes.windows(12).position(|w| w == first).unwrap();
    bytes[at + 4..at + 8].copy_from_slice(&f32::NAN.to_le_bytes());
    let message = read(&bytes).unwrap_err();
    assert!(message.contains("POSITION: element 0 is not finite"), "{message}");
}

#[test]
fn many_nodes_cannot_blow_one_mesh_up() {
    let instances = |count: usize| {
        move |json: &mut Value| {
            json["nodes"].as_array_mut().unwrap().extend(vec![json!({"mesh": 0, "skin": 0}); count]);
        }
    };
    let message = read(&changed(instances(70_000))).unwrap_err();
    assert!(message.contains("expected at most 65536 meshes"), "{message}");
    let large = to_glb(&sleeve(4, 10_000)).unwrap();
    let message = read(&changed_of(&large, instances(1_000))).unwrap_err();
    assert!(message.contains("expected at most 4194304 vertices"), "{message}");
}

#[test]
fn every_truncation_is_told() {
    for length in 0..GLB.len() {
        let message = read(&GLB[..length]).unwrap_err();
        assert!(message.starts_with("a.glb: "), "{message}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// No panic, no endless loop, no huge allocation, whatever bytes are wrong.
    #[test]
    fn flipped_bytes_do_no_harm(flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8)) {
        let mut bytes = GLB.clone();
        for (at, value) in flips {
            *at.get_mut(&mut bytes) = value;
        }
        let _ = read(&bytes);
    }

    /// The same aimed at the numbers of the JSON, where flips of random bytes seldom parse.
    #[test]
    fn changed_numbers_do_no_harm(at in any::<prop::sample::Index>(), value in prop_oneof![
        Just(u64::MAX), Just(u64::from(u32::MAX)), Just(1 << 31), 0u64..200, any::<u64>()
    ]) {
        let _ = read(&changed(|json| {
            let mut numbers = Vec::new();
            pointers(json, String::new(), &mut numbers);
            *json.pointer_mut(at.get(numbers.as_slice()).as_str()).unwrap() = value.into();
        }));
    }
}

pub(super) fn pointers(value: &Value, at: String, numbers: &mut Vec<String>) {
    match value {
        Value::Number(_) => numbers.push(at),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, v)| pointers(v, format!("{at}/{i}"), numbers));
        }
        Value::Object(map) => map.iter().for_each(|(k, v)| pointers(v, format!("{at}/{k}"), numbers)),
        _ => {}
    }
}
