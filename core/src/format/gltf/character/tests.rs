use std::sync::LazyLock;

use proptest::prelude::*;
use serde_json::json;

use gltf_json::Value;

use super::super::meshes::tests::{changed_of, pointers};
use super::*;
use crate::format::gltf::{GltfOptions, to_glb, to_glb_with};
use crate::format::read_scene_from_bytes;
use crate::testing::scene::{arm, bent, bulging, joints, sleeve};

/// The arm with a moving clip and a still one.
static SCENE: LazyLock<Scene> = LazyLock::new(|| {
    let mut scene = arm(8);
    let clip = bent(&scene);
    let (rest, rotations) = (clip.skeleton().clone(), clip.rotations(1).to_vec());
    let still = crate::clip::Clip::new("still".into(), rest, 30.0, rotations.repeat(7), vec![]).unwrap();
    scene.clips = vec![clip, still];
    scene
});
static GLB: LazyLock<Vec<u8>> = LazyLock::new(|| to_glb(&SCENE).unwrap());
static COMPRESSED: LazyLock<Vec<u8>> =
    LazyLock::new(|| to_glb_with(&SCENE, &GltfOptions { compress: true }).unwrap());

fn read(bytes: &[u8]) -> crate::Result<Scene> {
    read_scene_from_bytes(bytes, "a.glb")
}

fn changed(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    changed_of(&GLB, change)
}

#[test]
fn written_again_a_file_is_the_same() {
    for influences in [4, 8] {
        for mut scene in [arm(influences), sleeve(influences, 400)] {
            scene.clips.push(bent(&scene));
            let first = to_glb(&scene).unwrap();
            assert!(to_glb(&read(&first).unwrap()).unwrap() == first);
        }
    }
    assert!(to_glb(&read(&GLB).unwrap()).unwrap() == *GLB);
}

fn morphing() -> Scene {
    let mut scene = arm(4);
    scene.clips.push(bent(&scene));
    bulging(scene)
}

#[test]
fn morph_targets_and_their_weights_come_back() {
    let scene = morphing();
    let first = to_glb(&scene).unwrap();
    let back = read(&first).unwrap();
    assert_eq!(back.meshes[2].morph_targets, scene.meshes[2].morph_targets);
    assert_eq!(back.morph_tracks, scene.morph_tracks);
    assert_eq!(back.clips[1].frame_count(), 3);
    assert!(to_glb(&back).unwrap() == first);
    let alone = crate::format::read_meshes_from_bytes(&first, "a.glb").unwrap();
    assert_eq!(alone.meshes[2].morph_targets, scene.meshes[2].morph_targets);

    let compressed = to_glb_with(&scene, &GltfOptions { compress: true }).unwrap();
    let back = read(&compressed).unwrap();
    assert_eq!(back.morph_tracks, scene.morph_tracks);
    for (a, b) in back.meshes[2].morph_targets.iter().zip(&scene.meshes[2].morph_targets) {
        let far = |a: &[[f32; 3]], b: &[[f32; 3]]| {
            a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        assert!(far(&a.positions, &b.positions) < 1e-7 && far(&a.normals, &b.normals) < 1e-4);
    }
}

#[test]
fn targets_of_others_are_sparse_nameless_and_animated_alone() {
    let glb = to_glb(&morphing()).unwrap();
    let others = changed_of(&glb, |json| {
        let mesh = &mut json["meshes"][2];
        mesh["extras"].as_object_mut().unwrap().remove("targetNames");
        let target = mesh["primitives"][0]["targets"][1]["POSITION"].as_u64().unwrap() as usize;
        mesh["primitives"][0]["targets"][0] = json!({});
        // The first elements of other buffer views: triangle corners as indices, positions as values.
        let indices = mesh["primitives"][0]["indices"].as_u64().unwrap() as usize;
        let positions = mesh["primitives"][0]["attributes"]["POSITION"].as_u64().unwrap() as usize;
        let view = |json: &Value, accessor: usize| json["accessors"][accessor]["bufferView"].clone();
        let (indices, values) = (view(json, indices), view(json, positions));
        let accessor = json["accessors"][target].as_object_mut().unwrap();
        accessor.remove("bufferView");
        accessor.insert(
            "sparse".into(),
            json!({
                "count": 2,
                "indices": {"bufferView": indices, "componentType": 5123},
                "values": {"bufferView": values, "byteOffset": 12},
            }),
        );
        // Only weights are animated, and nothing states the number of frames.
        let animation = json["animations"][1].as_object_mut().unwrap();
        animation.remove("extras");
        animation["channels"].as_array_mut().unwrap().remove(0);
        json["meshes"][2]["extras"] = Value::Null;
    });
    let scene = read(&others).unwrap();
    let targets = &scene.meshes[2].morph_targets;
    assert_eq!((targets[0].name.as_str(), targets[1].name.as_str()), ("target0", "target1"));
    assert!(targets[0].positions.iter().all(|offset| *offset == [0.0; 3]));
    let [first, second] = [1, 2].map(|v| morphing().meshes[2].positions[v]);
    assert_eq!(targets[1].positions[..3], [first, second, [0.0; 3]]);
    assert_eq!(scene.clips[1].frame_count(), 3);
    let track = scene.morph_tracks.last().unwrap();
    assert_eq!((track.clip, track.target, &track.weights[..]), (1, 1, &[0.0, 0.125, 0.25][..]));
}

#[test]
fn names_what_is_wrong_with_morph_targets() {
    type Case = (&'static str, fn(&mut Value));
    let cases: &[Case] = &[
        ("nodes[5].mesh: targets[0]: POSITION: expected 8 of them, got 7", |j| {
            let target = j["meshes"][2]["primitives"][0]["targets"][0]["POSITION"].as_u64().unwrap();
            j["accessors"][target as usize]["count"] = json!(7);
        }),
        ("targets[0]: NORMAL: accessor 999 does not exist", |j| {
            j["meshes"][2]["primitives"][0]["targets"][0]["NORMAL"] = json!(999);
        }),
        ("output: expected 6 weights of 2 targets for 3 keys, got 5", |j| {
            let channels = j["animations"][0]["channels"].as_array().unwrap();
            let sampler = channels.last().unwrap()["sampler"].as_u64().unwrap() as usize;
            let output = j["animations"][0]["samplers"][sampler]["output"].as_u64().unwrap() as usize;
            j["accessors"][output]["count"] = json!(5);
        }),
        ("vertices in all morph targets, got more", |j| {
            let targets = j["meshes"][2]["primitives"][0]["targets"].as_array_mut().unwrap();
            *targets = vec![json!({}); 5_000_000];
        }),
    ];
    let glb = to_glb(&morphing()).unwrap();
    for (expected, change) in cases {
        let message = read(&changed_of(&glb, change)).expect_err(expected).to_string();
        assert!(message.contains(expected), "`{expected}` in `{message}`");
    }
}

#[test]
fn a_scene_comes_back() {
    let read = read(&GLB).unwrap();
    assert_eq!((&read.name, &read.materials), (&SCENE.name, &SCENE.materials));
    assert_eq!(read.extras["asked"]["arm_length"], 0.6);
    for (read, written) in read.meshes.iter().zip(&SCENE.meshes) {
        assert_eq!(read.positions, written.positions);
        assert_eq!((&read.name, read.material), (&written.name, written.material));
        assert_eq!(read.normals, written.normals);
        assert_eq!(read.joint_weights, written.joint_weights);
        let corners = |mesh: &crate::scene::SceneMesh| {
            let uv = |c: (u32, u32)| (c.0, mesh.uvs.get(c.1 as usize).copied());
            mesh.triangulated().into_iter().flatten().map(uv).collect::<Vec<_>>()
        };
        assert_eq!(corners(read), corners(written));
    }
    for (read, written) in joints(&read).iter().zip(&joints(&SCENE)) {
        assert_eq!((&read.name, read.parent), (&written.name, written.parent));
        // The rounding of a matrix converted to an `f32` quaternion and back.
        assert!(read.model_from_joint.abs_diff_eq(written.model_from_joint, 3e-7));
    }
}

#[test]
fn clips_come_back() {
    let read = read(&GLB).unwrap();
    assert_eq!(read.clips.len(), 2);
    for (read, written) in read.clips.iter().zip(&SCENE.clips) {
        assert_eq!(read.name(), written.name());
        assert_eq!(read.frames_per_second(), written.frames_per_second());
        assert_eq!(read.frame_count(), written.frame_count());
        for frame in 0..written.frame_count() {
            for (j, (read, written)) in
                read.pose(frame).locals.iter().zip(written.pose(frame).locals).enumerate()
            {
                // Exact where a joint moves; at rest the node's own transform is used, a rounding away.
                assert!(read.rotation.abs_diff_eq(written.rotation, 5e-7), "frame {frame}, joint {j}");
                assert!(read.translation.abs_diff_eq(written.translation, 5e-7), "frame {frame}, joint {j}");
            }
        }
    }
    assert_eq!(read.clips[0].translations(), SCENE.clips[0].translations());
}

#[test]
fn compressed_numbers_come_back_as_near_as_promised() {
    assert!(COMPRESSED.len() < GLB.len() + 4000, "views of a few bytes have no use of it");
    let plain = read(&GLB).unwrap();
    let read = read(&COMPRESSED).unwrap();
    let worst = |a: &[f32], b: &[f32]| {
        assert_eq!(a.len(), b.len());
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    for (a, b) in read.meshes.iter().zip(&plain.meshes) {
        assert_eq!(a.joint_indices, b.joint_indices);
        // The codec may rotate the corners of a triangle.
        for (a, b) in a.triangles.positions.iter().zip(&b.triangles.positions) {
            assert!((0..3).any(|turn| [0, 1, 2].map(|i| a[(i + turn) % 3]) == *b));
        }
        assert!(worst(a.positions.as_flattened(), b.positions.as_flattened()) < 1e-6);
        assert!(worst(a.normals.as_flattened(), b.normals.as_flattened()) < 1e-4);
        assert!(worst(a.uvs.as_flattened(), b.uvs.as_flattened()) < 1.0 / 60_000.0);
        assert!(worst(&a.joint_weights, &b.joint_weights) < 1e-6);
    }
    assert_eq!(joints(&read), joints(&plain));
    for (a, b) in read.clips.iter().zip(&plain.clips) {
        for (a, b) in (0..3).map(|f| (a.pose(f), b.pose(f))) {
            for (a, b) in a.locals.iter().zip(&b.locals) {
                assert!(
                    a.rotation.abs_diff_eq(b.rotation, 1e-6)
                        && a.translation.abs_diff_eq(b.translation, 1e-6)
                );
            }
        }
    }
}

#[test]
fn others_lie_out_their_skeleton_in_other_ways() {
    // Joints in another order, a rotated node above the root and a node between two joints, neither of them a joint.
    let strange = changed(|json| {
        let nodes = json["nodes"].as_array_mut().unwrap();
        let turn = [0.0, 0.6, 0.0, 0.8];
        nodes.push(json!({"name": "Armature", "rotation": turn, "translation": [1, 0, 0], "children": [0]}));
        nodes.push(json!({"translation": [0, 0.25, 0], "children": [2]}));
        nodes[1]["children"] = json!([6]);
        json["skins"][0]["joints"] = json!([0, 2, 1]);
        json["skins"][0].as_object_mut().unwrap().remove("skeleton");
        json["scenes"][0]["nodes"] = json!([3, 4, 5]);
        json["animations"][0]["extras"] = Value::Null;
    });
    let scene = read(&strange).unwrap();
    let skeleton = scene.skeleton.as_ref().unwrap();
    assert_eq!(skeleton.names(), ["upper", "lower", "thumb"]);
    assert_eq!(skeleton.parents(), [None, Some(0), Some(1)]);
    let clip = &scene.clips[0];
    assert_eq!((clip.frame_count(), clip.frames_per_second()), (3, 25.0), "found by the keys' times");
    let above = glam::Affine3A::from_rotation_translation(
        crate::math::Rotation::from_xyzw(0.0, 0.6, 0.0, 0.8).into(),
        glam::Vec3::X,
    );
    let between = glam::Affine3A::from_translation(glam::Vec3::Y * 0.25);
    let [upper, lower, thumb] = [0, 1, 2].map(|j| SCENE.clips[0].pose(1).locals[j].to_affine());
    let expected = [above * upper, above * upper * lower, above * upper * lower * between * thumb];
    let found = clip.pose(1).model_from_joints(clip.skeleton().parents());
    for (found, expected) in found.iter().zip(expected) {
        assert!(found.to_affine().abs_diff_eq(expected, 1e-6), "{found:?} {expected:?}");
    }
}

#[test]
fn weights_of_others_are_put_in_order() {
    let mut bytes = GLB.clone();
    // The second ring's vertices: unsorted weights that sum to 1.5, the first joint once more in the last slot.
    let row = [0.5f32, 0.35, 0.15, 0.0].map(f32::to_le_bytes).concat();
    let rows: Vec<usize> = (0..bytes.len() - 16).filter(|at| bytes[*at..*at + 16] == row[..]).collect();
    assert_eq!(rows.len(), 6, "five and the copy of one");
    for at in rows {
        bytes[at..at + 16].copy_from_slice(&[0.25f32, 0.25, 0.75, 0.25].map(f32::to_le_bytes).concat());
    }
    let scene = read(&bytes).unwrap();
    assert_eq!(scene.meshes[0].joint_indices[40..44], [2, 0, 1, 0]);
    let third = |n: f32| n / 6.0;
    for (got, expected) in scene.meshes[0].joint_weights[40..44].iter().zip([3.0, 2.0, 1.0, 0.0].map(third)) {
        assert!((got - expected).abs() < 1e-7);
    }
}

#[test]
fn a_copy_that_is_none_is_told() {
    let mut bytes = GLB.clone();
    let first = SCENE.meshes[0].positions[0].map(f32::to_le_bytes).concat();
    let at = bytes.windows(12).position(|w| w == first).unwrap();
    bytes[at..at + 4].copy_from_slice(&0.2f32.to_le_bytes());
    let message = read(&bytes).unwrap_err().to_string();
    assert!(message.contains("vertex 15 is no copy of one of the first 15"), "{message}");
    let of_others = changed_of(&bytes, |json| json["meshes"][0]["extras"] = Value::Null);
    assert_eq!(read(&of_others).unwrap().meshes[0].positions.len(), 18);
}

#[test]
fn meshes_without_a_skin_hang_on_joints() {
    let hat = changed(|json| {
        json["nodes"][4] = json!({"mesh": 1, "name": "Nail", "translation": [0, 0, 0.5]});
        json["nodes"][2]["children"] = json!([4]);
        json["scenes"][0]["nodes"] = json!([0, 3]);
    });
    let scene = read(&hat).unwrap();
    assert_eq!((scene.meshes[1].joint_indices[0], scene.meshes[1].joint_weights[0]), (2, 1.0));
    let expected = joints(&SCENE)[2].model_from_joint.transform_point3(glam::vec3(0.6, 1.2, 0.6));
    assert!(glam::Vec3::from(scene.meshes[1].positions[0]).distance(expected) < 1e-6);
}

#[test]
fn says_what_is_wrong_and_where() {
    type Case = (&'static str, fn(&mut Value));
    let cases: &[Case] = &[
        ("several roots, nodes[0] `upper` and nodes[1] `lower`", |j| {
            j["nodes"][0]["children"] = json!([]);
        }),
        ("nodes[1] `lower`: expected a rotation and a translation, got scale (0.01)", |j| {
            j["nodes"][1]["scale"] = json!([0.01, 0.01, 0.01]);
        }),
        ("nodes[4] `Nail`: its mesh has no skin and is below no joint", |j| {
            j["nodes"][4].as_object_mut().unwrap().remove("skin");
        }),
        ("animations[0]: a second track of nodes[0] `upper`", |j| {
            let first = j["animations"][0]["channels"][0].clone();
            j["animations"][0]["channels"].as_array_mut().unwrap().insert(0, first);
        }),
        ("animations[0]: channels[0]: input: expected times of keys that rise", |j| {
            let time = j["animations"][0]["samplers"][0]["input"].as_u64().unwrap() as usize;
            let view = j["accessors"][time]["bufferView"].as_u64().unwrap() as usize;
            j["bufferViews"][view]["byteOffset"] = json!(0);
        }),
        ("output: accessor", |j| j["animations"][0]["samplers"][0]["output"] = json!(0)),
        ("output: expected 3 values for 3 keys, got 1", |j| {
            let output = j["animations"][0]["samplers"][0]["output"].as_u64().unwrap() as usize;
            j["accessors"][output]["count"] = json!(1);
        }),
        ("sampler 99 does not exist, there are 4", |j| {
            j["animations"][0]["channels"][0]["sampler"] = json!(99);
        }),
        ("expected 1 to 1048576 frames", |j| {
            j["animations"][0]["extras"]["anthronet"]["frames"] = json!(1e9);
        }),
        ("rotations in all clips, got 1048576 frames of 3 joints", |j| {
            for animation in j["animations"].as_array_mut().unwrap() {
                animation["extras"]["anthronet"]["frames"] = json!(1_048_576);
            }
            let again = vec![j["animations"][0].clone(); 20];
            j["animations"].as_array_mut().unwrap().extend(again);
        }),
        ("has no JOINTS_0 and WEIGHTS_0, but a skin", |j| {
            let attributes = j["meshes"][1]["primitives"][0]["attributes"].as_object_mut().unwrap();
            attributes.remove("JOINTS_0");
        }),
        ("skins[0]: has no joints", |j| j["skins"][0]["joints"] = json!([])),
        ("inverseBindMatrices: expected 3, one per joint, got 2", |j| {
            let matrices = j["skins"][0]["inverseBindMatrices"].as_u64().unwrap() as usize;
            j["accessors"][matrices]["count"] = json!(2);
        }),
        ("material 50 does not exist, there are 2", |j| {
            j["meshes"][0]["primitives"][0]["material"] = json!(50);
        }),
    ];
    for (expected, change) in cases {
        let message = read(&changed(change)).expect_err(expected).to_string();
        assert!(message.starts_with("a.glb: ") && message.contains(expected), "`{expected}` in `{message}`");
    }
}

#[test]
fn names_what_is_wrong_with_compression() {
    type Case = (&'static str, fn(&mut Value));
    let cases: &[Case] = &[
        ("bufferViews[0].extensions.EXT_meshopt_compression: buffer 7 does not exist", |e| {
            e["buffer"] = json!(7);
        }),
        ("truncated: expected 18446744073709551615 bytes", |e| e["byteLength"] = json!(u64::MAX)),
        ("expected at most 1073741824 bytes, got 18446744073709551615 elements", |e| {
            e["count"] = json!(u64::MAX);
        }),
        ("bytes, got a stream of", |e| e["count"] = json!(1_000_000)),
        ("is not supported", |e| e["byteStride"] = json!(5)),
        ("filter OCTAHEDRAL", |e| e["filter"] = json!("OCTAHEDRAL")),
        ("not a valid stream", |e| e["byteLength"] = json!(3)),
        ("mode NONSENSE", |e| e["mode"] = json!("NONSENSE")),
    ];
    for (expected, change) in cases {
        let bytes = changed_of(&COMPRESSED, |json| {
            change(&mut json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]);
        });
        let message = read(&bytes).expect_err(expected).to_string();
        assert!(message.contains(expected), "`{expected}` in `{message}`");
    }
}

#[test]
fn every_truncation_is_an_error() {
    for whole in [&*GLB, &*COMPRESSED] {
        for length in 0..whole.len() {
            let message = read(&whole[..length]).unwrap_err().to_string();
            assert!(message.starts_with("a.glb: "), "{message}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    /// No panic, endless loop or huge allocation, whichever bytes are damaged; and whatever is read can be written.
    #[test]
    fn flipped_bytes_do_no_harm(
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        compressed: bool,
    ) {
        let mut bytes = if compressed { COMPRESSED.clone() } else { GLB.clone() };
        for (at, value) in flips {
            *at.get_mut(&mut bytes) = value;
        }
        if let Ok(scene) = read(&bytes) {
            to_glb(&scene).unwrap();
        }
    }

    /// The same for the numbers in the JSON, as JSON with random flipped bytes seldom parses.
    #[test]
    fn changed_numbers_do_no_harm(at in any::<prop::sample::Index>(), compressed: bool, value in prop_oneof![
        Just(u64::MAX), Just(u64::from(u32::MAX)), Just(1 << 31), 0u64..200, any::<u64>()
    ]) {
        let _ = read(&changed_of(if compressed { &COMPRESSED } else { &GLB }, |json| {
            let mut numbers = Vec::new();
            pointers(json, String::new(), &mut numbers);
            *json.pointer_mut(at.get(numbers.as_slice()).as_str()).unwrap() = value.into();
        }));
    }
}
