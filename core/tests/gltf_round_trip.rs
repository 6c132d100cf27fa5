//! Bodies to glTF and back.

use anthronet::clip::Clip;
use anthronet::condition::Request;
use anthronet::format::gltf::to_glb;
use anthronet::format::read_scene_from_bytes;
use anthronet::math::Rotation;
use anthronet::mesh::Lod;
use anthronet::model::Model;
use anthronet::scene::{Scene, SceneOptions};

#[test]
fn a_body_in_motion_written_again_is_the_same_file() {
    let model = Model::from_environment().unwrap();
    for (seed, lod) in [(1, Lod::Lod1), (2, Lod::Lod2), (3, Lod::Lod2), (4, Lod::Lod3), (5, Lod::Lod3)] {
        let sex = if seed % 2 == 0 { "male" } else { "female" };
        let request = Request::from_json(&format!(r#"{{"sex":"{sex}","seed":{seed}}}"#)).unwrap();
        let body = model.generate(&request).unwrap();
        let mut scene = Scene::from_body(&body, &SceneOptions { lod, ..SceneOptions::default() }).unwrap();
        let rest = body.skeleton().clone();
        let turns = (0..4).flat_map(|frame| {
            let angle = |j: usize| if j.is_multiple_of(3) { 0.0 } else { 0.01 * (frame * j) as f32 };
            rest.rest_rotations()
                .enumerate()
                .map(move |(j, q)| q * Rotation::from_rotation_x(angle(j)))
                .collect::<Vec<_>>()
        });
        let turns = turns.collect();
        scene.clips.push(Clip::new("turn".into(), rest, 30.0, turns, vec![]).unwrap());
        let first = to_glb(&scene).unwrap();
        let read = read_scene_from_bytes(&first, "a.glb").unwrap();
        assert!(to_glb(&read).unwrap() == first, "seed {seed}");
        for (read, written) in read.meshes.iter().zip(&scene.meshes) {
            assert_eq!(read.positions, written.positions, "{}", written.name);
            assert_eq!(read.joint_weights.len(), written.joint_weights.len());
        }
    }
}
