use std::path::Path;

use super::super::{to_usda, to_usdc, to_usdz};
use super::*;
use crate::format::{read_meshes_from_bytes, read_motion_from_bytes, read_scene_from_bytes};
use crate::testing::scene::{arm, bent, bulging, joints};

fn moving(influences: usize) -> Scene {
    let mut scene = arm(influences);
    scene.clips = vec![bent(&scene), bent(&scene).with_name("2nd: bent")];
    scene
}

type Writer = fn(&Scene) -> crate::Result<Vec<u8>>;
const WRITERS: [(&str, Writer); 3] = [("a.usda", to_usda), ("a.usdc", to_usdc), ("a.usdz", to_usdz)];

#[test]
fn a_character_of_ours_comes_back() {
    for influences in [4, 8] {
        let scene = moving(influences);
        for (name, write) in WRITERS {
            let back = read_scene_from_bytes(&write(&scene).unwrap(), Path::new(name)).unwrap();
            assert_eq!((&back.name, &back.extras), (&scene.name, &scene.extras), "{name}");
            assert_eq!(back.materials, scene.materials, "{name}");
            for (b, s) in joints(&back).iter().zip(&joints(&scene)) {
                assert_eq!((&b.name, b.parent), (&s.name, s.parent));
                assert!(b.model_from_joint.abs_diff_eq(s.model_from_joint, 1e-6), "{name}");
            }
            for (b, s) in back.meshes.iter().zip(&scene.meshes) {
                assert_eq!((&b.name, &b.positions), (&s.name, &s.positions), "{name}");
                assert_eq!((&b.quads, &b.triangles), (&s.quads, &s.triangles), "{name}");
                assert_eq!((b.material, &b.joint_weights), (s.material, &s.joint_weights), "{name}");
                let off = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
                assert!(off(b.uvs.as_flattened(), s.uvs.as_flattened()), "{name}");
                assert!(off(b.normals.as_flattened(), s.normals.as_flattened()), "{name}");
                for vertex in 0..s.positions.len() {
                    let used = |m: &crate::scene::SceneMesh| {
                        m.influences(vertex).filter(|slot| slot.1 > 0.0).collect::<Vec<_>>()
                    };
                    assert_eq!(used(b), used(s), "{name}");
                }
            }
            assert_eq!(back.clips.len(), 2);
            for (b, s) in back.clips.iter().zip(&scene.clips) {
                assert_eq!((b.name(), b.frames_per_second()), (s.name(), s.frames_per_second()), "{name}");
                assert_eq!(b.frame_count(), s.frame_count());
                for frame in 0..s.frame_count() {
                    for (b, s) in b.pose(frame).locals.iter().zip(&s.pose(frame).locals) {
                        assert!(b.rotation.angle_between(s.rotation) < 2e-3, "{name} {frame}");
                        assert!(b.translation.distance(s.translation) < 1e-6, "{name} {frame}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_scene_without_joints_comes_back() {
    let mut scene = arm(4);
    scene.remove_skin();
    let bytes = to_usdc(&scene).unwrap();
    let back = read_scene_from_bytes(&bytes, "a.usdc").unwrap();
    assert_eq!((back.joint_count(), back.meshes.len()), (0, 2));
    assert_eq!(back.meshes[0].triangulated().len(), 20);
    assert_eq!(read_meshes_from_bytes(&bytes, "a.usdc").unwrap(), back);
}

#[test]
fn meshes_alone_are_those_of_the_character_and_do_without_clips() {
    let bytes = to_usda(&moving(4)).unwrap();
    let whole = read_scene_from_bytes(&bytes, "a.usda").unwrap();
    let spoiled =
        String::from_utf8(bytes).unwrap().replace("timeCodesPerSecond = 25", "timeCodesPerSecond = 0");
    let meshes = read_meshes_from_bytes(spoiled.as_bytes(), "a.usda").unwrap();
    assert!(read_scene_from_bytes(spoiled.as_bytes(), "a.usda").is_err());
    assert!(meshes.skeleton.is_none() && meshes.clips.is_empty());
    assert_eq!((&meshes.materials, &meshes.extras), (&whole.materials, &whole.extras));
    for (alone, of_whole) in meshes.meshes.iter().zip(&whole.meshes) {
        assert_eq!((&alone.positions, &alone.normals), (&of_whole.positions, &of_whole.normals));
        assert_eq!(
            (&alone.quads, &alone.triangles, &alone.uvs),
            (&of_whole.quads, &of_whole.triangles, &of_whole.uvs)
        );
        assert!(alone.joint_indices.is_empty() && alone.influences_per_vertex == 0);
    }
}

#[test]
fn morph_targets_and_their_weights_come_back() {
    let scene = bulging(moving(8));
    for (name, write) in WRITERS {
        let back = read_scene_from_bytes(&write(&scene).unwrap(), name).unwrap();
        for (b, s) in back.meshes[2].morph_targets.iter().zip(&scene.meshes[2].morph_targets) {
            assert_eq!(b, s, "{name}");
        }
        assert_eq!(back.morph_tracks, scene.morph_tracks, "{name}");
    }
}

#[test]
fn blend_shapes_of_others_are_dense_turned_and_of_one_token() {
    let mut scene = bulging(moving(4));
    scene.meshes[1].morph_targets = vec![crate::scene::MorphTarget {
        name: "bulge".into(),
        positions: vec![[0.0; 3], [0.0, 0.0, 0.5], [0.0; 3]],
        normals: Vec::new(),
    }];
    let text = String::from_utf8(to_usda(&scene).unwrap()).unwrap();
    // The nail comes first and has the plain token, the cushion a numbered one.
    assert!(text.contains("skel:blendShapes = [\"bulge_2\", \"lean_1\"]"), "{text}");
    let others = text.replace("bulge_2", "bulge").replace("upAxis = \"Y\"", "upAxis = \"Z\"");
    let others = others.replacen("uniform int[] pointIndices = [1]", "", 1).replacen(
        "(0.0, 0.0, 0.5)]",
        "(0, 0, 0), (0, 0, 0.5), (0, 0, 0)]",
        1,
    );
    let back = read_scene_from_bytes(others.as_bytes(), "a.usda").unwrap();
    let offset = back.meshes[1].morph_targets[0].positions[1];
    assert!(glam::Vec3::from(offset).distance(glam::Vec3::Y * 0.5) < 1e-6, "{offset:?}");
    let of_first: Vec<_> =
        back.morph_tracks.iter().filter(|t| t.clip == 0).map(|t| (t.mesh, t.target)).collect();
    assert_eq!(of_first, [(1, 0), (2, 0), (2, 1)]);
}

#[test]
fn names_what_is_wrong_with_blend_shapes() {
    let text = String::from_utf8(to_usda(&bulging(moving(4))).unwrap()).unwrap();
    for (from, to, expected) in [
        (
            "pointIndices = [0, 1, 2, 4]",
            "pointIndices = [0, 1, 2, 6]",
            "bulge.pointIndices: expected places among 6",
        ),
        ("pointIndices = [3, 5]", "pointIndices = [3]", "lean_1.offsets: expected 1 vectors, got 2"),
        ("vector3f[] offsets", "vector3f[] shifts", "bulge.offsets: has no value"),
        (
            "skel:blendShapes = [\"bulge\", ",
            "skel:blendShapes = [",
            "blendShapeTargets: expected 1, one per token, got 2",
        ),
    ] {
        assert!(text.contains(from), "{from} in {text}");
        let error =
            read_scene_from_bytes(text.replacen(from, to, 1).as_bytes(), "a.usda").unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn names_what_is_wrong() {
    let text = String::from_utf8(to_usda(&moving(4)).unwrap()).unwrap();
    for (from, to, expected) in [
        ("point3f[] points", "point3f[] spots", "Sleeve.points: has no value"),
        ("int[] faceVertexCounts = [4", "int[] faceVertexCounts = [5", "faceVertexCounts adds up to"),
        ("int[] faceVertexIndices = [0", "int[] faceVertexIndices = [99", "places among 15 points"),
        ("metersPerUnit = 1", "metersPerUnit = 0", "metersPerUnit: expected a positive number, got 0"),
        ("def SkelRoot", "over SkelRoot", "expected 1 to"),
    ] {
        assert!(text.contains(from), "{from}");
        let spoiled = text.replacen(from, to, 1);
        let error = read_scene_from_bytes(spoiled.as_bytes(), Path::new("a.usda")).unwrap_err().to_string();
        assert!(error.starts_with("a.usda: ") && error.contains(expected), "{error}");
    }
}

/// Damaged files give errors or, where a number is damaged, other numbers, but never a panic.
#[test]
fn damage_is_an_error() {
    for (name, write) in WRITERS {
        let whole = write(&moving(4)).unwrap();
        let path = Path::new(name);
        for end in (0..whole.len()).step_by(whole.len() / 60) {
            let error = read_scene_from_bytes(&whole[..end], path);
            assert!(error.is_err(), "{name} cut at {end}");
        }
        let mut seed = 7_u64;
        for _ in 0..300 {
            let mut bytes = whole.clone();
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let at = (seed >> 33) as usize % bytes.len();
            bytes[at] ^= 1 << (seed >> 61);
            let _ = read_scene_from_bytes(&bytes, path);
            let _ = read_motion_from_bytes(&bytes, path, &ReadOptions::default());
        }
    }
}
