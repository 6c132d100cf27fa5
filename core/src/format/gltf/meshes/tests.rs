use std::sync::LazyLock;

use glam::Vec3;
use proptest::prelude::*;
use serde_json::json;

use super::*;
use crate::format::gltf::{to_glb, to_gltf};
use crate::format::{WriteOptions, read_meshes, read_meshes_from_bytes, write_scene};
use crate::testing::scene::{arm, sleeve};

static GLB: LazyLock<Vec<u8>> = LazyLock::new(|| to_glb(&arm(4)).unwrap());

fn read(bytes: &[u8]) -> crate::Result<Scene> {
    read_meshes_from_bytes(bytes, "a.glb")
}

/// The arm with its JSON changed.
fn changed(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    changed_of(&GLB, change)
}

pub(in crate::format::gltf) fn changed_of(original: &[u8], change: impl FnOnce(&mut Value)) -> Vec<u8> {
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
    assert!(scene.skeleton.is_none() && scene.clips.is_empty());
    assert_eq!(scene.extras["asked"]["arm_length"], 0.6);
    let body = &scene.meshes[0];
    assert_eq!((body.name.as_str(), body.influences_per_vertex), ("Sleeve", 0));
    // The copies at the texture seam are merged.
    assert_eq!((&body.positions, &body.normals), (&written.meshes[0].positions, &written.meshes[0].normals));
    let corners = |mesh: &SceneMesh| mesh.triangulated().iter().flatten().map(|c| c.0).collect::<Vec<_>>();
    assert_eq!(corners(body), corners(&written.meshes[0]));
    let nail = &scene.meshes[1];
    assert_eq!(scene.materials[nail.material as usize].base_color, [0.8, 0.6, 0.55, 0.9]);
}

#[test]
fn reads_a_gltf_with_its_buffer_beside_it_or_inside() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("my ärm.gltf");
    write_scene(&arm(4), &path, &WriteOptions::default()).unwrap();
    assert_eq!(read_meshes(&path).unwrap(), read(&GLB).unwrap());

    let files = to_gltf(&arm(4), "x.bin").unwrap();
    let mut json: Value = serde_json::from_slice(&files.json).unwrap();
    json["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{}", base64(&files.bin)).into();
    assert_eq!(read(json.to_string().as_bytes()).unwrap(), read(&GLB).unwrap());

    std::fs::remove_file(folder.path().join("my ärm.bin")).unwrap();
    let message = read_meshes(&path).unwrap_err().to_string();
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
    let root = arm(4).skeleton.unwrap().bind()[0];
    for (moved, still) in scene.meshes[1].positions.iter().zip(&still.meshes[1].positions) {
        let expected = root.transform_point3(Vec3::from(*still) * Vec3::new(-2.0, 2.0, 2.0));
        assert!(Vec3::from(*moved).distance(expected) < 1e-6);
    }
    assert_eq!(scene.meshes[1].triangles.positions, [[0, 2, 1]], "a mirror turns faces over");
}

#[test]
fn texture_coordinates_are_those_of_the_base_colour() {
    let uvs = |texture: Value, of_primitive: &[&str]| -> crate::Result<Vec<[f32; 2]>> {
        let glb = changed(|json| {
            json["extensionsRequired"] = json!(["KHR_texture_transform", "KHR_texture_basisu"]);
            let primitive = &mut json["meshes"][0]["primitives"][0];
            let set = primitive["attributes"].as_object_mut().unwrap().remove("TEXCOORD_0").unwrap();
            for name in of_primitive {
                primitive["attributes"][name] = set.clone();
            }
            let material = primitive["material"].as_u64().unwrap() as usize;
            json["materials"][material]["pbrMetallicRoughness"]["baseColorTexture"] = texture;
        });
        Ok(read(&glb)?.meshes.swap_remove(0).uvs)
    };
    let moved = |texture: Value, of_primitive: &[&str]| uvs(texture, of_primitive).unwrap();
    let transform =
        |transform: Value| json!({"index": 0, "extensions": {"KHR_texture_transform": transform}});
    let still = moved(Value::Null, &["TEXCOORD_0"]);
    assert!(still.iter().any(|[u, v]| u != v && *v != 0.0), "nothing to tell u and v apart");
    assert_eq!(moved(transform(json!({})), &["TEXCOORD_0"]), still);
    assert_eq!(moved(json!({"index": 0, "texCoord": 1}), &["TEXCOORD_1"]), still);
    assert!(moved(json!({"index": 0, "texCoord": 1}), &["TEXCOORD_0"]).is_empty());
    assert_eq!(moved(transform(json!({"texCoord": 2})), &["TEXCOORD_2"]), still);

    // The example of the extension: the lower left quarter of the image, rotated clockwise by a right angle.
    let quarter = json!({"offset": [0, 1], "rotation": std::f32::consts::FRAC_PI_2, "scale": [0.5, 0.5]});
    for ([u, v], [x, y]) in still.iter().zip(moved(transform(quarter), &["TEXCOORD_0"])) {
        let expected = Vec3::new(0.5 * v, 1.0 - 0.5 * u, 0.0);
        assert!(expected.distance(Vec3::new(x, y, 0.0)) < 1e-6, "({u}, {v}) to ({x}, {y})");
    }
    // Scaled before it is rotated.
    let stretched = json!({"rotation": std::f32::consts::FRAC_PI_2, "scale": [3, 1]});
    for ([u, v], [x, y]) in still.iter().zip(moved(transform(stretched), &["TEXCOORD_0"])) {
        assert!(
            Vec3::new(*v, -3.0 * u, 0.0).distance(Vec3::new(x, y, 0.0)) < 1e-6,
            "({u}, {v}) to ({x}, {y})"
        );
    }

    let far = transform(json!({"scale": [3e38, 3e38], "offset": [3e38, 3e38]}));
    let message = uvs(far, &["TEXCOORD_0"]).unwrap_err().to_string();
    assert!(message.contains("TEXCOORD_0: KHR_texture_transform: element "), "{message}");
}

#[test]
fn images_of_other_kinds_may_be_required() {
    for name in ["EXT_texture_webp", "EXT_texture_avif", "KHR_texture_basisu", "MSFT_texture_dds"] {
        let glb = changed(|json| {
            json["extensionsRequired"] = json!([name]);
            json["images"] = json!([{"uri": "skin.webp", "mimeType": "image/webp"}]);
            json["textures"] = json!([{"extensions": {name: {"source": 0}}}]);
            json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
        });
        let scene = crate::format::read_scene_from_bytes(&glb, "a.glb").unwrap();
        assert_eq!(scene.meshes[0].positions, read(&glb).unwrap().meshes[0].positions, "{name}");
        assert_eq!(scene.materials[0].base_color, read(&GLB).unwrap().materials[0].base_color, "{name}");
    }
}

#[test]
fn says_what_is_wrong_and_where() {
    type Case = (&'static str, fn(&mut Value));
    let cases: &[Case] = &[
        ("asset.version: expected 2.x, got `1.0`", |j| j["asset"]["version"] = json!("1.0")),
        ("KHR_draco_mesh_compression is not supported", |j| {
            j["extensionsRequired"] = json!(["EXT_meshopt_compression", "KHR_draco_mesh_compression"]);
        }),
        ("buffers[0]: truncated: expected 99999999 bytes", |j| {
            j["buffers"][0]["byteLength"] = json!(99_999_999);
        }),
        ("expected a file beside or below", |j| j["buffers"][0]["uri"] = json!("../../etc/passwd")),
        ("expected a file beside or below", |j| j["buffers"][0]["uri"] = json!("%2Fetc/passwd")),
        ("expected a file beside or below", |j| j["buffers"][0]["uri"] = json!("file:///etc/passwd")),
        ("expected base64", |j| j["buffers"][0]["uri"] = json!("data:x;base64,$$$$")),
        ("expected at most 12582912 elements, got 1000000000", |j| {
            set_all(j, "accessors", "count", &json!(1_000_000_000));
        }),
        ("truncated: expected 40000 elements, got the", |j| set_all(j, "accessors", "count", &json!(40_000))),
        ("truncated", |j| set_all(j, "accessors", "byteOffset", &json!(u64::MAX))),
        ("from byte 18446744073709551615, got a buffer of", |j| {
            set_all(j, "bufferViews", "byteOffset", &json!(u64::MAX));
        }),
        ("truncated: expected 18446744073709551615 bytes of a bufferView", |j| {
            set_all(j, "bufferViews", "byteLength", &json!(u64::MAX));
        }),
        ("truncated", |j| set_all(j, "bufferViews", "byteStride", &json!(u64::MAX))),
        ("expected a byteStride of at least 12, got 0", |j| {
            set_all(j, "bufferViews", "byteStride", &json!(0));
        }),
        ("buffer 7 does not exist, there are 1", |j| set_all(j, "bufferViews", "buffer", &json!(7))),
        ("bufferView 99 does not exist", |j| set_all(j, "accessors", "bufferView", &json!(99))),
        ("has no bufferView", |j| set_all(j, "accessors", "bufferView", &Value::Null)),
        ("expected f32 vectors, got Vec3 of U16", |j| set_all(j, "accessors", "componentType", &json!(5123))),
        ("expected a componentType of glTF 2.0", |j| set_all(j, "accessors", "componentType", &json!(1))),
        ("POSITION: accessor 999 does not exist", |j| {
            j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(999);
        }),
        ("has no POSITION", |j| j["meshes"][0]["primitives"][0]["attributes"] = json!({})),
        ("a primitive of other than triangles is not supported", |j| {
            j["meshes"][0]["primitives"][0]["mode"] = json!(1);
        }),
        ("expected three corners", |j| {
            j["meshes"][1]["primitives"][0].as_object_mut().unwrap().remove("indices");
            let position =
                j["meshes"][1]["primitives"][0]["attributes"]["POSITION"].as_u64().unwrap() as usize;
            j["accessors"][position]["count"] = json!(2);
        }),
        ("does not exist, there are 3", |j| {
            let body = j["meshes"][0]["primitives"][0]["indices"].clone();
            j["meshes"][1]["primitives"][0]["indices"] = body;
        }),
        ("material 50 does not exist, there are 2", |j| {
            j["meshes"][0]["primitives"][0]["material"] = json!(50);
        }),
        ("nodes[3].mesh: mesh 5 does not exist, there are 2", |j| j["nodes"][3]["mesh"] = json!(5)),
        ("nodes[4].children: node 77 does not exist, there are 5", |j| {
            j["nodes"][4]["children"] = json!([77]);
        }),
        ("nodes[1]: has two parents", |j| j["nodes"][4]["children"] = json!([1])),
        ("is its own ancestor", |j| j["nodes"][2]["children"] = json!([0])),
        ("nodes[1]: is its own ancestor", |j| {
            // Below the cycle of 1 and 2 hangs 0.
            j["nodes"][0]["children"] = json!([]);
            j["nodes"][1]["children"] = json!([0, 2]);
            j["nodes"][2]["children"] = json!([1]);
        }),
        ("nodes[4]: expected a transform with an inverse", |j| {
            j["nodes"][4] = json!({"mesh": 1, "scale": [0, 0, 0]});
        }),
        ("extras.anthronet.vertices: expected at most 18 vertices", |j| {
            j["meshes"][0]["extras"]["anthronet"]["vertices"] = json!(19);
        }),
        ("has no mesh", |j| {
            j["nodes"].as_array_mut().unwrap().truncate(3);
            j["scenes"][0]["nodes"] = json!([0]);
        }),
    ];
    for (expected, change) in cases {
        let message = read(&changed(change)).expect_err(expected).to_string();
        assert!(message.starts_with("a.glb: ") && message.contains(expected), "`{expected}` in `{message}`");
    }
}

fn set_all(json: &mut Value, list: &str, field: &str, value: &Value) {
    for item in json[list].as_array_mut().unwrap() {
        item[field] = value.clone();
    }
}

/// Some tools move vertices, or give the copies at a seam normals of their own.
#[test]
fn copies_are_told_by_their_place_and_vertices_that_are_none_stay() {
    let place = |bytes: &[u8], row: [f32; 3]| {
        let row = row.map(f32::to_le_bytes).concat();
        let found: Vec<usize> = (0..bytes.len() - 12).filter(|at| bytes[*at..*at + 12] == row[..]).collect();
        (found[0], found[1])
    };
    let arm = arm(4);
    let mut other_normal = GLB.clone();
    let (_, copy) = place(&GLB, arm.meshes[0].normals[0]);
    other_normal[copy..copy + 12].copy_from_slice(&[0.0f32, 1.0, 0.0].map(f32::to_le_bytes).concat());
    assert_eq!(read(&other_normal).unwrap().meshes[0].positions, arm.meshes[0].positions);

    let mut moved = GLB.clone();
    let (_, copy) = place(&GLB, arm.meshes[0].positions[0]);
    moved[copy..copy + 4].copy_from_slice(&0.2f32.to_le_bytes());
    let mesh = read(&moved).unwrap().meshes.swap_remove(0);
    assert_eq!((mesh.positions.len(), mesh.positions[15][0]), (18, 0.2));
}

#[test]
fn names_numbers_that_are_not_finite() {
    let mut bytes = GLB.clone();
    let first = arm(4).meshes[0].positions[0].map(f32::to_le_bytes).concat();
    let at = bytes.windows(12).position(|w| w == first).unwrap();
    bytes[at + 4..at + 8].copy_from_slice(&f32::NAN.to_le_bytes());
    let message = read(&bytes).unwrap_err().to_string();
    assert!(message.contains("POSITION: element 0: ") && message.contains("is not finite"), "{message}");
}

#[test]
fn many_nodes_cannot_blow_one_mesh_up() {
    let instances = |count: usize| {
        move |json: &mut Value| {
            json["nodes"].as_array_mut().unwrap().extend(vec![json!({"mesh": 0, "skin": 0}); count]);
        }
    };
    let message = read(&changed(instances(70_000))).unwrap_err().to_string();
    assert!(message.contains("expected at most 65536 meshes"), "{message}");
    let large = to_glb(&sleeve(4, 10_000)).unwrap();
    let message = read(&changed_of(&large, instances(1_000))).unwrap_err().to_string();
    assert!(message.contains("expected at most 4194304 vertices"), "{message}");
}

#[test]
fn every_truncation_is_an_error() {
    for length in 0..GLB.len() {
        let message = read(&GLB[..length]).unwrap_err().to_string();
        assert!(message.starts_with("a.glb: "), "{message}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// No panic, endless loop or huge allocation, whichever bytes are damaged.
    #[test]
    fn flipped_bytes_do_no_harm(flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8)) {
        let mut bytes = GLB.clone();
        for (at, value) in flips {
            *at.get_mut(&mut bytes) = value;
        }
        let _ = read(&bytes);
    }

    /// The same for the numbers in the JSON, as JSON with random flipped bytes seldom parses.
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

pub(in crate::format::gltf) fn pointers(value: &Value, at: String, numbers: &mut Vec<String>) {
    match value {
        Value::Number(_) => numbers.push(at),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, v)| pointers(v, format!("{at}/{i}"), numbers));
        }
        Value::Object(map) => map.iter().for_each(|(k, v)| pointers(v, format!("{at}/{k}"), numbers)),
        _ => {}
    }
}
