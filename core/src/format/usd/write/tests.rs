use openusd::gf::Vec3f;
use openusd::sdf::{AbstractData, Path};

use super::*;
use crate::skeleton::model_from_joints;
use crate::testing::scene::{arm, bent, bulging, edit};

fn moving(influences: usize) -> Scene {
    let mut scene = arm(influences);
    scene.clips = vec![bent(&scene)];
    scene
}

fn text(scene: &Scene) -> String {
    String::from_utf8(to_usda(scene).unwrap()).unwrap()
}

/// A field of the layer.
fn field(scene: &Scene, path: &str, field: &str) -> Option<Value> {
    let path = Path::new(path).unwrap();
    layer(scene).unwrap().data().try_field(&path, field).unwrap().map(std::borrow::Cow::into_owned)
}

#[test]
fn bytes_depend_on_the_scene_alone_and_a_package_is_aligned() {
    let scene = moving(4);
    let crate_file = to_usdc(&scene).unwrap();
    assert_eq!(crate_file, to_usdc(&scene).unwrap());
    assert_eq!(to_usda(&scene).unwrap(), to_usda(&scene).unwrap());
    let package = to_usdz(&scene).unwrap();
    // Zip local file header (APPNOTE 4.3.7): stored, dated at the start of zip's epoch.
    assert_eq!(package[8..14], [0, 0, 0, 0, 0x21, 0]);
    let length = |at: usize| usize::from(u16::from_le_bytes([package[at], package[at + 1]]));
    let start = 30 + length(26) + length(28);
    assert_eq!(start % 64, 0);
    assert_eq!(package[start..start + crate_file.len()], crate_file);
}

#[test]
fn the_layout() {
    for influences in [4, 8] {
        let text = text(&moving(influences));
        for expected in [
            "defaultPrim = \"Arm\"",
            "metersPerUnit = 1",
            "upAxis = \"Y\"",
            "startTimeCode = 0",
            "endTimeCode = 2",
            "timeCodesPerSecond = 25",
            "framesPerSecond = 25",
            "def SkelRoot \"Arm\"",
            "kind = \"component\"",
            "{\\\"asked\\\":{\\\"arm_length\\\":0.6}}",
            "[\"upper\", \"upper/lower\", \"upper/lower/thumb\"]",
            "rel skel:animationSource = </Arm/Skel/Anim>",
            "displayName = \"bent\"",
            "faceVertexCounts = [4, 4, 4",
            "faceVertexCounts = [3]",
            "primvars:st:indices = [0, 1, 7, 6",
            "rel material:binding = </Arm/mtl/Nail>",
            "inputs:opacity = 0.8999999",
            &format!("elementSize = {influences}"),
        ] {
            assert!(text.contains(expected), "{expected}");
        }
        assert!(!text.contains("varying rel"));
    }
}

#[test]
fn matrices_have_the_translation_in_the_last_row_and_quaternions_the_real_part_first() {
    let scene = moving(4);
    let Some(Value::Matrix4dVec(bind)) = field(&scene, "/Arm/Skel.bindTransforms", "default") else {
        panic!("no matrices");
    };
    let at = scene.skeleton.as_ref().unwrap().bind()[1];
    let t = at.translation.to_array().map(f64::from);
    assert_eq!(bind[1].0[12..15], t);
    assert_eq!(bind[1].0[..3], at.matrix3.x_axis.to_array().map(f64::from));
    let Some(Value::TimeSamples(samples)) = field(&scene, "/Arm/Skel/Anim.rotations", "timeSamples") else {
        panic!("no samples");
    };
    let Value::QuatfVec(rotations) = &samples[2].1 else { panic!("no quaternions") };
    let expected = scene.clips[0].rotations(2)[1];
    assert_eq!((rotations[1].w, rotations[1].x), (expected.w, expected.x));
}

#[test]
fn names_are_narrowed_and_kept() {
    let mut scene = moving(4);
    scene.name = "Ada 2".into();
    edit(&mut scene, |joints| joints[1].name = "mixamorig:Arm".into());
    scene.meshes[0].name = "Skel".into();
    scene.clips.push(bent(&scene).with_name("Anim"));
    let text = text(&scene);
    for expected in [
        "def SkelRoot \"Ada_2\"",
        "displayName = \"Ada 2\"",
        "[\"upper\", \"upper/mixamorig_Arm\"",
        "jointNames = [\"upper\", \"mixamorig:Arm\", \"thumb\"]",
        "def Mesh \"Skel_2\"",
        "def SkelAnimation \"Anim_2\"",
    ] {
        assert!(text.contains(expected), "{expected}");
    }
}

#[test]
fn extents_hold_the_skinned_vertices() {
    extents_hold(&moving(8));
}

#[test]
fn extents_hold_what_morph_targets_move() {
    let mut scene = bulging(moving(4));
    // Blow up the cushion far beyond the rest of the mesh.
    scene.meshes[2].morph_targets[0].positions[1] = [0.0, 3.0, 2.0];
    extents_hold(&scene);
}

fn extents_hold(scene: &Scene) {
    let Some(Value::TimeSamples(samples)) = field(scene, "/Arm.extent", "timeSamples") else {
        panic!("no samples");
    };
    let clip = &scene.clips[0];
    assert_eq!(samples.len(), clip.frame_count());
    for (frame, (time, value)) in samples.iter().enumerate() {
        assert_eq!(*time, frame as f64);
        let Value::Vec3fVec(extent) = value else { panic!("no vectors") };
        let inside = |p: glam::Vec3A| {
            let within = |n: f32, low: f32, high: f32| low <= n && n <= high;
            let [Vec3f { x: x0, y: y0, z: z0 }, Vec3f { x: x1, y: y1, z: z1 }] = extent[..] else {
                panic!("two corners")
            };
            within(p.x, x0, x1) && within(p.y, y0, y1) && within(p.z, z0, z1)
        };
        let mut joints = Vec::new();
        model_from_joints(clip.skeleton().parents(), &clip.pose(frame).locals, &mut joints);
        for (index, mesh) in scene.meshes.iter().enumerate() {
            for (vertex, position) in mesh.positions.iter().enumerate() {
                let mut position = glam::Vec3A::from(*position);
                for track in scene.morph_tracks_of(0).filter(|track| track.mesh as usize == index) {
                    let target = &mesh.morph_targets[track.target as usize];
                    position += glam::Vec3A::from(target.positions[vertex]) * track.weights[frame];
                }
                let moved = mesh.influences(vertex).filter(|slot| slot.1 > 0.0).map(|(joint, weight)| {
                    let bind = scene.skeleton.as_ref().unwrap().bind()[usize::from(joint)];
                    let matrix = joints[usize::from(joint)].to_affine() * bind.inverse();
                    matrix.transform_point3a(position) * weight
                });
                assert!(inside(moved.sum()), "frame {frame}, {} {vertex}", mesh.name);
            }
        }
    }
}

#[test]
fn targets_of_one_name_share_a_token_where_their_weights_are_the_same() {
    let mut scene = bulging(moving(4));
    let target = |vertices: usize| crate::scene::MorphTarget {
        name: "bulge".into(),
        positions: vec![[0.1; 3]; vertices],
        normals: Vec::new(),
    };
    scene.meshes[0].morph_targets = vec![target(15)];
    scene.meshes[1].morph_targets = vec![target(3)];
    let of_cushion = scene.morph_tracks[0].clone();
    scene.morph_tracks.insert(1, crate::scene::MorphTrack { mesh: 0, target: 0, ..of_cushion });
    let tokens: Vec<_> = blend_shape::tokens(&scene).concat();
    assert_eq!(tokens, ["bulge", "bulge_2", "bulge", "lean_1"]);
    let text = text(&scene);
    assert!(text.contains("blendShapes = [\"bulge\", \"lean_1\"]"), "{text}");
}

#[test]
fn a_repeated_corner_makes_a_triangle() {
    let mut scene = arm(4);
    scene.meshes[0].quads.positions[0] = [0, 1, 6, 6];
    scene.meshes[0].quads.positions[1] = [1, 2, 7, 1];
    let counts = field(&scene, "/Arm/Sleeve.faceVertexCounts", "default");
    let Some(Value::IntVec(counts)) = counts else { panic!("no counts") };
    assert_eq!(counts[..3], [3, 3, 4]);
    let corners = field(&scene, "/Arm/Sleeve.faceVertexIndices", "default");
    let Some(Value::IntVec(corners)) = corners else { panic!("no corners") };
    assert_eq!(corners[..6], [0, 1, 6, 2, 7, 1]);
}

#[test]
fn a_scene_that_is_invalid_is_refused() {
    let mut scene = moving(4);
    scene.meshes[0].positions[0][0] = f32::NAN;
    for write in [to_usda, to_usdc, to_usdz] {
        assert!(write(&scene).unwrap_err().to_string().contains("position 0 is not finite"));
    }
}
