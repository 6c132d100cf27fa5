//! Animations, VRM and compression in the written bytes, parsed by hand.

use std::sync::Arc;

use glam::Vec3;
use serde_json::json;

use super::super::*;
use super::Parsed;
use crate::clip::{Clip, TranslationTrack};
use crate::format::vrm::{VrmMeta, to_vrm, to_vrma};
use crate::math::Rotation;
use crate::skeleton::Skeleton;
use crate::skeleton::humanoid::{JointNames, humanoid_bones, renamed};
use crate::testing::scene::{Joint, arm, bent, edit, rename};

/// Tracks of an animation: node, path, times, values.
fn tracks(file: &Parsed, animation: usize) -> Vec<(usize, String, Vec<f64>, Vec<f64>)> {
    let at = format!("/animations/{animation}");
    let channels = file.json.pointer(&format!("{at}/channels")).unwrap().as_array().unwrap();
    let track = |channel: &Value| {
        let sampler = format!("{at}/samplers/{}", channel["sampler"]);
        let numbers = |field: &str| file.accessor(file.size(&format!("{sampler}/{field}")));
        let path = channel["target"]["path"].as_str().unwrap().to_owned();
        let node = channel["target"]["node"].as_u64().unwrap() as usize;
        (node, path, numbers("input"), numbers("output"))
    };
    channels.iter().map(track).collect()
}

fn rest(scene: &Scene) -> Arc<Skeleton> {
    bent(scene).skeleton().clone()
}

#[test]
fn tracks_are_the_clip() {
    let mut scene = arm(4);
    let clip = bent(&scene);
    scene.clips.push(clip.clone());
    let file = Parsed::glb(&to_glb(&scene).unwrap());
    assert_eq!(file.json["animations"][0]["name"], "bent");
    let extras = &file.json["animations"][0]["extras"]["anthronet"];
    assert_eq!(*extras, json!({"frames_per_second": 25.0, "frames": 3}));
    let tracks = tracks(&file, 0);
    let paths: Vec<_> = tracks.iter().map(|(node, path, ..)| (*node, path.as_str())).collect();
    assert_eq!(paths, [(0, "rotation"), (0, "translation"), (1, "rotation"), (2, "rotation")]);
    for (node, path, times, values) in tracks {
        assert_eq!(times, [0.0, 0.04, 0.08].map(|t| f64::from(t as f32)));
        let expected: Vec<f64> = (0..3)
            .flat_map(|frame| match path.as_str() {
                "rotation" => clip.rotations(frame)[node].to_array().to_vec(),
                _ => clip.pose(frame).locals[node].translation.to_array().to_vec(),
            })
            .map(f64::from)
            .collect();
        assert_eq!(values, expected);
    }
    let inputs: Vec<_> = (0..4).map(|s| file.size(&format!("/animations/0/samplers/{s}/input"))).collect();
    assert!(inputs.iter().all(|input| *input == inputs[0]), "one accessor of times");
    let times = &file.json["accessors"][inputs[0]];
    assert_eq!((&times["min"], &times["max"]), (&json!([0.0]), &json!([f64::from(0.08f32)])));
}

#[test]
fn what_keeps_still_has_one_key_and_what_rests_none() {
    let mut scene = arm(4);
    let rest = rest(&scene);
    let q: Vec<Rotation> = rest.rest_rotations().collect();
    // The root at rest, the next joint rotated but still, the last one moving.
    let rotations = (0..4).flat_map(|frame| {
        [q[0], q[1] * Rotation::from_rotation_x(0.5), q[2] * Rotation::from_rotation_y(0.1 * frame as f32)]
    });
    let shifted = rest.rest_pose().locals[1].translation + Vec3::Y * 0.01;
    let track = TranslationTrack { joint: 1, values: vec![shifted; 4] };
    scene.clips.push(Clip::new("a".into(), rest, 30.0, rotations.collect(), vec![track]).unwrap());
    let file = Parsed::glb(&to_glb(&scene).unwrap());
    let tracks = tracks(&file, 0);
    let keys: Vec<_> =
        tracks.iter().map(|(node, path, times, _)| (*node, path.as_str(), times.len())).collect();
    assert_eq!(keys, [(1, "rotation", 1), (1, "translation", 1), (2, "rotation", 4)]);
}

#[test]
fn a_clip_in_which_nothing_moves_lasts_as_long() {
    let mut scene = arm(4);
    let rest = rest(&scene);
    let rotations = rest.rest_rotations().collect::<Vec<_>>().repeat(31);
    scene.clips.push(Clip::new("rest".into(), rest.clone(), 30.0, rotations, vec![]).unwrap());
    let one = rest.rest_rotations().collect();
    scene.clips.push(Clip::new("one frame".into(), rest, 30.0, one, vec![]).unwrap());
    let file = Parsed::glb(&to_glb(&scene).unwrap());
    let lengths = [0, 1].map(|a| tracks(&file, a).iter().map(|t| *t.2.last().unwrap()).collect::<Vec<_>>());
    assert_eq!(lengths, [vec![1.0], vec![0.0]]);
}

/// A rig of joints with humanoid names in one naming scheme, on the meshes of the arm.
fn humanoid(names: JointNames) -> Scene {
    let mut scene = arm(4);
    let bones = humanoid_bones().iter().enumerate().skip(3);
    let bones = bones.map(|(i, bone)| Joint {
        bone_length: None,
        name: renamed(&bone.native, names).into_owned(),
        parent: Some(0),
        model_from_joint: glam::Affine3A::from_translation(Vec3::Y * i as f32),
    });
    edit(&mut scene, |joints| {
        joints.extend(bones);
        for (joint, bone) in joints.iter_mut().zip(humanoid_bones()).take(3) {
            joint.name = renamed(&bone.native, names).into_owned();
        }
    });
    scene
}

#[test]
fn a_vrm_says_who_made_it_and_where_its_bones_are() {
    for names in JointNames::ALL {
        let scene = humanoid(names);
        let meta = VrmMeta { version: "2".into(), ..VrmMeta::default() };
        let json = Parsed::glb(&to_vrm(&scene, &meta).unwrap()).json;
        let vrm = &json["extensions"]["VRMC_vrm"];
        assert_eq!(vrm["specVersion"], "1.0");
        assert_eq!((&vrm["meta"]["name"], &vrm["meta"]["version"]), (&json!("Arm"), &json!("2")));
        assert_eq!(vrm["meta"]["authors"], json!(["AnthroNet"]));
        assert_eq!(vrm["meta"]["licenseUrl"], "https://vrm.dev/licenses/1.0/");
        assert!(json["extensionsUsed"].as_array().unwrap().contains(&json!("VRMC_vrm")));
        let bones = vrm["humanoid"]["humanBones"].as_object().unwrap();
        assert_eq!(bones.len(), humanoid_bones().len());
        for bone in humanoid_bones() {
            let node = bones[&bone.vrm]["node"].as_u64().unwrap() as usize;
            assert_eq!(json["nodes"][node]["name"], *renamed(&bone.native, names));
        }
    }
}

#[test]
fn a_vrm_that_would_not_be_one_is_refused() {
    let meta = VrmMeta::default();
    let fails = |scene: &Scene, meta: &VrmMeta| to_vrm(scene, meta).unwrap_err().to_string();
    let mut scene = humanoid(JointNames::Native);
    assert!(fails(&scene, &VrmMeta { authors: vec![], ..meta.clone() }).contains("authors"));
    assert!(fails(&Scene { name: String::new(), ..scene.clone() }, &meta).contains("a name of the figure"));
    rename(&mut scene, |name| if name == "thigh_r" { "leg".into() } else { name.into() });
    assert!(fails(&scene, &meta).contains("requires the bone `rightUpperLeg`"));
    let mut moving = arm(4);
    moving.clips.push(bent(&moving));
    assert!(fails(&moving, &meta).contains("`bent`: a .vrm holds no motion"));
}

#[test]
fn a_vrma_holds_skeleton_and_clips_and_comes_back() {
    let mut scene = humanoid(JointNames::Mixamo);
    let fails = |scene: &Scene| to_vrma(scene).unwrap_err().to_string();
    assert!(fails(&scene).contains("expected at least one clip"));
    scene.clips.push(bent(&scene));
    let bytes = to_vrma(&scene).unwrap();
    let json = Parsed::glb(&bytes).json;
    let vrma = &json["extensions"]["VRMC_vrm_animation"];
    assert_eq!(vrma["specVersion"], "1.0");
    assert_eq!(vrma["humanoid"]["humanBones"].as_object().unwrap().len(), humanoid_bones().len());
    assert!(json["extensionsUsed"].as_array().unwrap().contains(&json!("VRMC_vrm_animation")));
    assert!(json["meshes"].is_null() && json["materials"].is_null());
    let motion = crate::format::read_motion_from_bytes(&bytes, "a.vrma", &Default::default()).unwrap();
    for (found, wanted) in motion.clips[0].rotations(1).iter().zip(scene.clips[0].rotations(1)) {
        assert!(found.angle_between(*wanted) < 1e-3);
    }
    assert_eq!(motion.clips[0].skeleton().humanoid().len(), humanoid_bones().len());
    rename(&mut scene, |name| if name.ends_with("RightUpLeg") { "leg".into() } else { name.into() });
    assert!(fails(&scene).contains("requires the bone `rightUpperLeg`"));
}

#[test]
fn a_compressed_file_says_so() {
    let mut scene = arm(4);
    scene.clips.push(bent(&scene));
    let plain = Parsed::glb(&to_glb(&scene).unwrap());
    let options = GltfOptions { compress: true };
    let bytes = to_glb_with(&scene, &options).unwrap();
    assert!(bytes == to_glb_with(&scene, &options).unwrap(), "the same bytes each time");
    let file = Parsed::glb(&bytes);
    assert_eq!(file.json["extensionsRequired"], json!(["EXT_meshopt_compression"]));
    assert_eq!(file.json["buffers"][1]["byteLength"], plain.json["buffers"][0]["byteLength"]);
    assert_eq!(file.json["buffers"][1]["extensions"]["EXT_meshopt_compression"]["fallback"], true);
    let views = file.json["bufferViews"].as_array().unwrap();
    assert_eq!(views.len(), plain.json["bufferViews"].as_array().unwrap().len());
    for (i, view) in views.iter().enumerate() {
        let extension = &view["extensions"]["EXT_meshopt_compression"];
        let number = |field: &str| extension[field].as_u64().unwrap();
        assert_eq!(view["buffer"], 1);
        assert_eq!(number("count") * number("byteStride"), view["byteLength"].as_u64().unwrap(), "view {i}");
        assert_eq!(number("byteOffset") % 4, 0);
        assert!(
            number("byteOffset") + number("byteLength")
                <= file.json["buffers"][0]["byteLength"].as_u64().unwrap()
        );
    }
}
