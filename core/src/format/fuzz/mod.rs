//! Mutated files of every format: see [`crate::testing::fuzz`].

mod inputs;

use std::sync::Arc;

use self::inputs::{arm, glb, npz_of_a_motion, person, usdz, written};
use super::fbx::{binary::binary, tests::SMALL as FBX};
use super::motion::units_and_axes::tests::person as bvh_person;
use super::usd::motion::tests::OTHERS as USD;
use super::{
    Format, Purpose, ReadOptions, read_meshes_from_bytes, read_motion_from_bytes, read_scene_from_bytes,
    write_scene_to_bytes,
};
use crate::retarget::{JointMap, RetargetOptions, read_overrides, retarget};
use crate::scene::Scene;
use crate::skeleton::Skeleton;
use crate::space::Axis;
use crate::testing::bodies::bodies;
use crate::testing::fuzz::{Input, fuzz};

/// Reads a file for every purpose that its format serves, and takes on what was read.
fn read_file(bytes: &[u8], path: &str, body: &Arc<Skeleton>) -> bool {
    let format = Format::of_extension(path.rsplit('.').next().unwrap()).unwrap();
    let mut understood = false;
    if format.serves(Purpose::ReadMotion)
        && let Ok(motion) = read_motion_from_bytes(bytes, path, &ReadOptions::default())
    {
        understood = true;
        if let Ok((clips, _)) = retarget(&motion.clips, body, &RetargetOptions::default()) {
            assert_eq!(clips.len(), motion.clips.len());
        }
    }
    if format.serves(Purpose::ReadScene)
        && let Ok(scene) = read_scene_from_bytes(bytes, path)
    {
        understood = true;
        scene.validate().unwrap();
        write_scene_to_bytes(&scene, Format::Glb, &Default::default()).unwrap();
    }
    if format.serves(Purpose::ReadMeshes) {
        understood |= read_meshes_from_bytes(bytes, path).is_ok();
    }
    understood
}

fn fuzz_files(inputs: Vec<Input>) {
    let body = Arc::clone(&bodies()[0].1);
    fuzz(inputs, move |bytes, path| read_file(bytes, path, &body));
}

#[test]
fn bvh() {
    fuzz_files(vec![Input::plain("a.bvh", bvh_person(0.01, Axis::Y))]);
}

#[test]
fn fbx() {
    fuzz_files(vec![Input::plain("a.fbx", FBX), Input::plain("a.fbx", binary(FBX))]);
}

#[test]
fn gltf() {
    let still = Scene { clips: Vec::new(), ..person() };
    let inputs = vec![
        glb("a.glb", &written(&person(), Format::Glb)),
        glb("a.glb", &written(&arm(), Format::Glb)),
        glb("a.vrma", &written(&person(), Format::Vrma)),
        glb("a.vrm", &written(&still, Format::Vrm)),
    ];
    fuzz_files(inputs);
}

#[test]
fn usd_text() {
    let arm = written(&arm(), Format::Usda);
    fuzz_files(vec![Input::plain("a.usda", USD), Input::plain("a.usda", arm)]);
}

#[test]
fn usd_crate() {
    let scenes = [person(), arm()];
    fuzz_files(scenes.map(|scene| Input::plain("a.usdc", written(&scene, Format::Usdc))).into());
}

#[test]
fn usd_package() {
    fuzz_files(vec![usdz(written(&arm(), Format::Usdc))]);
}

#[test]
fn npz() {
    fuzz_files(vec![npz_of_a_motion()]);
}

#[test]
fn obj() {
    fuzz_files(vec![Input::plain("a.obj", written(&arm(), Format::Obj))]);
}

#[test]
fn mapping() {
    let json = r#"{"upperarm_l": "upperarm_r", "head": null, "spine_01": "Spine02", "thigh_l": "thigh_l"}"#;
    let body = Arc::clone(&bodies()[0].1);
    fuzz(vec![Input::plain("mapping.json", json)], move |bytes, path| {
        let Ok(text) = std::str::from_utf8(bytes) else { return false };
        let mapping = read_overrides(text, path.as_ref());
        mapping.is_ok_and(|mapping| JointMap::find(&body, &mapping).is_ok() || !mapping.is_empty())
    });
}
