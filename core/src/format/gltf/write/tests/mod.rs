//! These tests parse the written bytes by hand: reading them back with the crate's own importer would prove little.

mod motion;

use glam::{DAffine3, DMat4, DQuat, DVec3};
use serde_json::Value;

use super::*;
use crate::testing::scene::{Joint, arm, edit, joints, sleeve};

struct Parsed {
    json: Value,
    bin: Vec<u8>,
}

impl Parsed {
    fn glb(bytes: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!(&bytes[..4], b"glTF");
        assert_eq!((word(4), word(8)), (2, bytes.len()));
        let json_end = 20 + word(12);
        assert_eq!(&bytes[16..20], b"JSON");
        assert_eq!(&bytes[json_end + 4..json_end + 8], b"BIN\0");
        assert_eq!(json_end + 8 + word(json_end), bytes.len());
        assert!(json_end.is_multiple_of(4) && bytes.len().is_multiple_of(4));
        let json = serde_json::from_slice(&bytes[20..json_end]).unwrap();
        Self { json, bin: bytes[json_end + 8..].to_vec() }
    }

    fn size(&self, at: &str) -> usize {
        self.json.pointer(at).and_then(Value::as_u64).unwrap_or_else(|| panic!("no {at}")) as usize
    }

    /// All components of an accessor as numbers.
    fn accessor(&self, index: usize) -> Vec<f64> {
        let accessor = format!("/accessors/{index}");
        let width = match self.json.pointer(&format!("{accessor}/type")).unwrap().as_str().unwrap() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            other => panic!("{other}"),
        };
        let count = width * self.size(&format!("{accessor}/count"));
        let view = format!("/bufferViews/{}", self.size(&format!("{accessor}/bufferView")));
        let (start, bytes) =
            (self.size(&format!("{view}/byteOffset")), self.size(&format!("{view}/byteLength")));
        assert_eq!(start % 4, 0);
        let bytes = &self.bin[start..start + bytes];
        let numbers: Vec<f64> = match self.size(&format!("{accessor}/componentType")) {
            5121 => bytes.iter().map(|b| f64::from(*b)).collect(),
            5123 => {
                bytes.chunks_exact(2).map(|b| f64::from(u16::from_le_bytes(b.try_into().unwrap()))).collect()
            }
            5125 => {
                bytes.chunks_exact(4).map(|b| f64::from(u32::from_le_bytes(b.try_into().unwrap()))).collect()
            }
            5126 => {
                bytes.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap()))).collect()
            }
            other => panic!("{other}"),
        };
        assert_eq!(numbers.len(), count);
        numbers
    }

    fn attribute<const N: usize>(&self, mesh: usize, name: &str) -> Vec<[f64; N]> {
        let numbers = self.accessor(self.size(&format!("/meshes/{mesh}/primitives/0/attributes/{name}")));
        numbers.chunks_exact(N).map(|c| c.try_into().unwrap()).collect()
    }

    fn indices(&self, mesh: usize) -> Vec<usize> {
        let numbers = self.accessor(self.size(&format!("/meshes/{mesh}/primitives/0/indices")));
        numbers.iter().map(|v| *v as usize).collect()
    }

    /// Model-from-joint matrices, composed from the nodes as a viewer would.
    fn joints(&self) -> Vec<DMat4> {
        let numbers = |node: &Value, field: &str, default: &[f64]| -> Vec<f64> {
            let list = node.get(field).and_then(Value::as_array);
            list.map_or(default.to_vec(), |l| l.iter().map(|v| v.as_f64().unwrap()).collect())
        };
        let nodes = self.json["nodes"].as_array().unwrap();
        let mut world = vec![DMat4::NAN; nodes.len()];
        for (i, node) in nodes.iter().enumerate() {
            let parent =
                nodes.iter().position(|n| n["children"].as_array().is_some_and(|c| c.contains(&i.into())));
            let rotation = numbers(node, "rotation", &[0.0, 0.0, 0.0, 1.0]);
            let local = DMat4::from_rotation_translation(
                DQuat::from_slice(&rotation),
                DVec3::from_slice(&numbers(node, "translation", &[0.0; 3])),
            );
            world[i] = parent.map_or(DMat4::IDENTITY, |p| world[p]) * local;
        }
        world
    }
}

fn wide<const N: usize>(rows: &[[f32; N]]) -> Vec<[f64; N]> {
    rows.iter().map(|r| r.map(f64::from)).collect()
}

#[test]
fn the_first_vertices_are_the_scenes_and_the_seam_follows() {
    let scene = arm(4);
    let body = &scene.meshes[0];
    let file = Parsed::glb(&to_glb(&scene).unwrap());
    let positions = file.attribute::<3>(0, "POSITION");
    assert_eq!(positions[..15], wide(&body.positions));
    assert_eq!(positions[15..], [positions[0], positions[5], positions[10]], "one copy per ring");
    assert_eq!(file.attribute::<3>(0, "NORMAL")[..15], wide(&body.normals));
    let uvs = file.attribute::<2>(0, "TEXCOORD_0");
    assert_eq!(uvs[0], wide(&body.uvs)[0]);
    assert_eq!(uvs[15], wide(&body.uvs)[5], "the copy lies on the seam's other side");
    assert_eq!(file.size("/meshes/0/extras/anthronet/vertices"), 15);
    assert_eq!(file.size("/extras/anthronet/vertices"), 15);
    assert_eq!(file.json["extras"]["asked"]["arm_length"], 0.6);
    // The sleeve's first quad, then the one that closes the first ring using the copies.
    let indices = file.indices(0);
    assert_eq!(indices[..6], [0, 1, 6, 0, 6, 5]);
    assert_eq!(indices[24..30], [4, 15, 16, 4, 16, 9]);
    assert_eq!(indices.len(), 60);
}

#[test]
fn every_corner_keeps_its_position_and_texture_coordinate() {
    let scene = arm(4);
    let file = Parsed::glb(&to_glb(&scene).unwrap());
    let (positions, uvs) = (file.attribute::<3>(0, "POSITION"), file.attribute::<2>(0, "TEXCOORD_0"));
    let corners = scene.meshes[0].triangulated().into_iter().flatten();
    for (written, (position, uv)) in file.indices(0).into_iter().zip(corners) {
        assert_eq!(positions[written], scene.meshes[0].positions[position as usize].map(f64::from));
        assert_eq!(uvs[written], scene.meshes[0].uvs[uv as usize].map(f64::from));
    }
}

#[test]
fn rest_pose_is_the_bind_pose() {
    let scene = arm(8);
    let file = Parsed::glb(&to_glb(&scene).unwrap());
    let inverse_bind = file.accessor(file.size("/skins/0/inverseBindMatrices"));
    for ((i, world), inverse) in file.joints().iter().enumerate().zip(inverse_bind.chunks_exact(16)).take(3) {
        let product = *world * DMat4::from_cols_slice(inverse);
        // One rounding to f32 of matrix elements near 1.
        assert!(product.abs_diff_eq(DMat4::IDENTITY, 3e-7), "joint {i}: {product}");
        assert_eq!([inverse[3], inverse[7], inverse[11], inverse[15]], [0.0, 0.0, 0.0, 1.0]);
        let wanted = scene.skeleton.as_ref().unwrap().bind()[i];
        let wanted = DMat4::from_cols_array(&glam::Mat4::from(wanted).to_cols_array().map(f64::from));
        // The scene's rotation matrices are f32 themselves.
        assert!(world.abs_diff_eq(wanted, 3e-7), "joint {i}: {world} {wanted}");
    }
}

#[test]
fn skinned_vertices_stay_where_they_are_in_the_rest_pose() {
    let scene = arm(8);
    let file = Parsed::glb(&to_glb(&scene).unwrap());
    let inverse_bind = file.accessor(file.size("/skins/0/inverseBindMatrices"));
    let matrices: Vec<_> = file
        .joints()
        .iter()
        .zip(inverse_bind.chunks_exact(16))
        .map(|(w, i)| *w * DMat4::from_cols_slice(i))
        .collect();
    let positions = file.attribute::<3>(0, "POSITION");
    let sets = ["0", "1"].map(|set| {
        (file.attribute::<4>(0, &format!("JOINTS_{set}")), file.attribute::<4>(0, &format!("WEIGHTS_{set}")))
    });
    for (v, position) in positions.iter().enumerate() {
        let slots = sets.iter().flat_map(|(joints, weights)| joints[v].into_iter().zip(weights[v]));
        let moved: DVec3 = slots
            .map(|(joint, weight)| weight * matrices[joint as usize].transform_point3((*position).into()))
            .sum();
        assert!(moved.distance((*position).into()) < 1e-6, "vertex {v}");
    }
}

#[test]
fn weights_are_exact_sorted_and_unused_slots_are_clean() {
    for influences in [4, 8] {
        let mut scene = arm(influences);
        // More than rounding, less than validation rejects.
        scene.meshes[0].joint_weights[influences * 5] += 4e-6;
        let file = Parsed::glb(&to_glb(&scene).unwrap());
        let sets = influences / 4;
        for v in 0..18 {
            let slots: Vec<_> = (0..sets)
                .flat_map(|set| {
                    let joints = file.attribute::<4>(0, &format!("JOINTS_{set}"))[v];
                    joints.into_iter().zip(file.attribute::<4>(0, &format!("WEIGHTS_{set}"))[v])
                })
                .collect();
            assert_eq!(slots.len(), influences);
            let sum: f64 = slots.iter().map(|s| s.1).sum();
            // Half a unit in the last place of an f32 just below 1.
            assert!((sum - 1.0).abs() <= 3e-8, "{sum}");
            assert!(slots.windows(2).all(|w| w[0].1 >= w[1].1));
            assert!(slots.iter().all(|(joint, weight)| *weight > 0.0 || *joint == 0.0));
        }
    }
}

#[test]
fn the_nodes_are_laid_out_as_promised() {
    let json = Parsed::glb(&to_glb(&arm(4)).unwrap()).json;
    assert_eq!(json["asset"]["generator"], concat!("anthronet ", env!("CARGO_PKG_VERSION")));
    assert_eq!(json["scenes"][0]["nodes"], serde_json::json!([0, 3, 4]));
    assert_eq!(json["skins"].as_array().unwrap().len(), 1);
    assert_eq!(json["skins"][0]["joints"], serde_json::json!([0, 1, 2]));
    assert_eq!(json["skins"][0]["skeleton"], 0);
    let names: Vec<_> =
        json["nodes"].as_array().unwrap().iter().map(|n| n["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["upper", "lower", "thumb", "Sleeve", "Nail"]);
    assert_eq!(json["nodes"][3], serde_json::json!({"mesh": 0, "name": "Sleeve", "skin": 0}));
    assert_eq!(json["materials"][0]["extensions"]["KHR_materials_ior"]["ior"], 1.4);
    assert_eq!(json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"], 0.0);
    assert_eq!(json["extensionsUsed"], serde_json::json!(["KHR_materials_ior", "KHR_materials_specular"]));
    assert!(json.get("extensionsRequired").is_none());
}

#[test]
fn bounds_are_the_numbers_themselves() {
    let file = Parsed::glb(&to_glb(&arm(4)).unwrap());
    let positions = file.attribute::<3>(0, "POSITION");
    let accessor = file.size("/meshes/0/primitives/0/attributes/POSITION");
    for axis in 0..3 {
        let of = |bound: &str| file.json["accessors"][accessor][bound][axis].as_f64().unwrap();
        assert_eq!(of("min"), positions.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min));
        assert_eq!(of("max"), positions.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max));
    }
}

#[test]
fn indices_widen_when_they_must() {
    let component = |rings| {
        let file = Parsed::glb(&to_glb(&sleeve(4, rings)).unwrap());
        let accessor = file.size("/meshes/0/primitives/0/indices");
        let highest = file.indices(0).into_iter().max().unwrap();
        (file.size(&format!("/accessors/{accessor}/componentType")), highest)
    };
    // Six written vertices per ring.
    assert_eq!(component(10_922), (5123, 65_531));
    assert_eq!(component(10_923), (5125, 65_537));
}

#[test]
fn a_long_chain_of_joints_does_not_drift() {
    let mut scene = arm(4);
    let mut pose = DAffine3::IDENTITY;
    let chain = (0..200u32).map(|i| {
        let turn = DQuat::from_rotation_x(0.1) * DQuat::from_rotation_z(0.2 + f64::from(i));
        pose *= DAffine3::from_rotation_translation(turn, DVec3::new(0.01, 0.007, 0.003));
        let rotation = DQuat::from_mat3(&pose.matrix3).as_quat();
        Joint {
            bone_length: None,
            name: format!("chain {i}"),
            parent: Some(i),
            model_from_joint: glam::Affine3A::from_rotation_translation(rotation, pose.translation.as_vec3()),
        }
    });
    edit(&mut scene, |joints| {
        joints.truncate(1);
        joints.extend(chain);
        joints[0].model_from_joint = glam::Affine3A::IDENTITY;
        joints.swap(1, 2);
        joints[1].parent = Some(0);
        joints[2].parent = Some(0);
    });
    let file = Parsed::glb(&to_glb(&scene).unwrap());
    for (world, joint) in file.joints().iter().zip(&joints(&scene)) {
        let off = world.w_axis.truncate().distance(joint.model_from_joint.translation.as_dvec3());
        assert!(off < 2e-7, "{}: {off}", joint.name);
    }
}

#[test]
fn a_scene_without_joints_has_no_skin() {
    let mut scene = arm(4);
    scene.remove_skin();
    let json = Parsed::glb(&to_glb(&scene).unwrap()).json;
    assert!(json.get("skins").is_none());
    assert_eq!(json["scenes"][0]["nodes"], serde_json::json!([0, 1]));
}

#[test]
fn the_same_scene_gives_the_same_bytes() {
    assert_eq!(to_glb(&arm(8)).unwrap(), to_glb(&arm(8)).unwrap());
    let files = to_gltf(&arm(8), "a b.bin").unwrap();
    let glb = Parsed::glb(&to_glb(&arm(8)).unwrap());
    assert_eq!(files.bin, glb.bin);
    let mut json: Value = serde_json::from_slice(&files.json).unwrap();
    assert_eq!(json["buffers"][0]["uri"].take(), "a%20b.bin");
    json["buffers"][0].as_object_mut().unwrap().remove("uri");
    assert_eq!(json, glb.json);
}

#[test]
fn refuses_extras_that_it_would_have_to_overwrite() {
    let mut scene = arm(4);
    scene.extras = serde_json::json!({"anthronet": 3});
    assert!(to_glb(&scene).unwrap_err().to_string().contains("extras.anthronet"));
}
