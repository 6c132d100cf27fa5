//! Writes a character with morph targets, to be compared with other programs' results.
//!
//!     morph_dump FOLDER
//!
//! Writes `morph.glb`, `morph_meshopt.glb`, `morph.usda`, `morph.usdc`, `morph.vrm` (without motion), and
//! `morph.json` (targets, weights and morphed vertices) to FOLDER. `tests/morph_check.py` and `tests/morph_threejs.mjs`
//! read them.

use std::path::Path;
use std::sync::Arc;

use anthronet::clip::{Clip, builtin};
use anthronet::condition::Request;
use anthronet::format::{GltfOptions, WriteOptions, write_scene};
use anthronet::mesh::Lod;
use anthronet::model::Model;
use anthronet::scene::{MorphTarget, MorphTrack, Scene, SceneMesh, SceneOptions};
use serde_json::{Value, json};

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// Frames of the clip with all joints at rest.
const FRAMES: usize = 11;
const RATE: f64 = 30.0;
/// Number of meshes, from the first, that have morph targets.
const MORPHING: usize = 3;

fn main() -> Outcome {
    let Some(folder) = std::env::args_os().nth(1) else { return Err("usage: morph_dump FOLDER".into()) };
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    let mut scene = character()?;
    let plain = WriteOptions::default();
    let compressed = WriteOptions { gltf: GltfOptions { compress: true }, ..WriteOptions::default() };
    for (name, options) in [
        ("morph.glb", &plain),
        ("morph_meshopt.glb", &compressed),
        ("morph.usda", &plain),
        ("morph.usdc", &plain),
    ] {
        write_scene(&scene, folder.join(name), options)?;
    }
    std::fs::write(folder.join("morph.json"), expected(&scene).to_string())?;
    scene.clear_clips();
    write_scene(&scene, folder.join("morph.vrm"), &plain)?;
    Ok(())
}

/// A body with one target that is another body and one that lifts its left half. Two meshes of the eyes have a target of the
/// first's name: the weights of the second mesh's are equal to the body's, those of the first mesh's are not. The first clip
/// keeps the joints at rest.
fn character() -> Outcome<Scene> {
    let model = Model::embedded()?;
    let scene = |waist: f64| -> Outcome<Scene> {
        let request = Request::default().with("height", 1.7)?.with("waist_circumference", waist)?;
        let options = SceneOptions { lod: Lod::Lod3, ..SceneOptions::default() };
        Ok(Scene::from_body(&model.generate(&request)?, &options)?)
    };
    let (mut slim, heavy) = (scene(0.7)?, scene(1.0)?);
    for (mesh, other) in slim.meshes.iter_mut().zip(&heavy.meshes).take(MORPHING) {
        mesh.morph_targets.push(towards("heavier", mesh, other));
    }
    let body = &mut slim.meshes[0];
    let lifted = |p: &[f32; 3]| if p[0] > 0.0 { [0.0, 0.125, 0.0] } else { [0.0; 3] };
    body.morph_targets.push(MorphTarget {
        name: "left side up".into(),
        positions: body.positions.iter().map(lifted).collect(),
        normals: Vec::new(),
    });

    let rest = Arc::new(slim.skeleton_with_ends(str::to_owned)?);
    let at_rest: Vec<_> = rest.rest_rotations().collect();
    let still = Clip::new("still".into(), rest.clone(), RATE, at_rest.repeat(FRAMES), vec![])?;
    for clip in [still, builtin("wave", &rest)?] {
        let (place, frames) = (slim.clips.len() as u32, clip.frame_count());
        slim.add_clip(clip);
        let track = |mesh, target, weight: fn(f32) -> f32| {
            let at = |frame| weight(frame as f32 / (frames - 1) as f32);
            MorphTrack { clip: place, mesh, target, weights: (0..frames).map(at).collect() }
        };
        slim.morph_tracks.push(track(0, 0, |t| t));
        slim.morph_tracks.push(track(1, 0, |t| 1.0 - t));
        slim.morph_tracks.push(track(2, 0, |t| t));
        slim.morph_tracks.push(track(0, 1, |t| 4.0 * t * (1.0 - t)));
    }
    Ok(slim)
}

fn towards(name: &str, from: &SceneMesh, to: &SceneMesh) -> MorphTarget {
    let displacements = |from: &[[f32; 3]], to: &[[f32; 3]]| {
        from.iter().zip(to).map(|(a, b)| std::array::from_fn(|i| b[i] - a[i])).collect()
    };
    let (positions, normals) =
        (displacements(&from.positions, &to.positions), displacements(&from.normals, &to.normals));
    MorphTarget { name: name.into(), positions, normals }
}

/// The results that other programs are expected to get.
fn expected(scene: &Scene) -> Value {
    let meshes = scene.meshes.iter().take(MORPHING).enumerate().map(|(index, mesh)| {
        let weights = |clip: usize, target: usize| {
            let is =
                |t: &&MorphTrack| (t.clip, t.mesh, t.target) == (clip as u32, index as u32, target as u32);
            scene.morph_tracks.iter().find(is).map(|track| track.weights.clone())
        };
        let targets = mesh.morph_targets.iter().enumerate().map(|(target, shape)| {
            let of_clips: Vec<_> = (0..scene.clips.len()).map(|clip| weights(clip, target)).collect();
            // The name in USD, where one name has one track of weights; those of the second mesh differ.
            let token = shape.name.replace(' ', "_") + if index == 1 { "_2" } else { "" };
            json!({"name": shape.name, "token": token, "weights": of_clips})
        });
        // Over the first clip, which has the joints at rest.
        let frames = [0, FRAMES / 3, FRAMES - 1].map(|frame| {
            let place = |vertex: usize| {
                let mut at = mesh.positions[vertex].map(f64::from);
                for (target, shape) in mesh.morph_targets.iter().enumerate() {
                    let weight = weights(0, target).map_or(0.0, |weights| f64::from(weights[frame]));
                    let offset = shape.positions[vertex].map(f64::from);
                    at.iter_mut().zip(offset).for_each(|(at, offset)| *at += weight * offset);
                }
                at
            };
            json!({"frame": frame, "positions": (0..mesh.positions.len()).map(place).collect::<Vec<_>>()})
        });
        json!({"name": mesh.name, "targets": targets.collect::<Vec<_>>(), "morphed": frames})
    });
    let clips = scene.clips.iter().map(
        |clip| json!({"name": clip.name(), "frames": clip.frame_count(), "rate": clip.frames_per_second()}),
    );
    json!({"clips": clips.collect::<Vec<_>>(), "meshes": meshes.collect::<Vec<_>>()})
}
