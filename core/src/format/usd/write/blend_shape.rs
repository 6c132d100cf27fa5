//! Writes morph targets as BlendShapes below their meshes, and their weights to the SkelAnimations (openusd.org, "UsdSkel:
//! Schemas In-Depth").
//!
//! A weight is identified by a token, which names the same shape in the mesh's `skel:blendShapes` and in the animation's
//! `blendShapes`. Targets with the same name share a token if their weights are equal in all clips, such as those of a face
//! and its teeth; otherwise each has its own token. Programs show tokens as names.

use std::collections::BTreeSet;

use openusd::gf::Vec3f;
use openusd::sdf::{FieldKey, Value, Variability};

use super::layer::Layer;
use super::names::Names;
use crate::Result;
use crate::scene::{MorphTarget, MorphTrack, Scene, SceneMesh};

/// For each mesh of a scene, a token for each target.
pub(super) fn tokens(scene: &Scene) -> Vec<Vec<String>> {
    let mut names = Names::default();
    // For every target so far: its name, weight tracks and token.
    let mut given: Vec<(&str, Vec<&MorphTrack>, String)> = Vec::new();
    let mut tokens = Vec::with_capacity(scene.meshes.len());
    for (index, mesh) in scene.meshes.iter().enumerate() {
        let mut of_mesh: Vec<String> = Vec::with_capacity(mesh.morph_targets.len());
        for (target, MorphTarget { name, .. }) in mesh.morph_targets.iter().enumerate() {
            let tracks = tracks(scene, index, target);
            let same = |a: &[&MorphTrack]| {
                a.len() == tracks.len()
                    && a.iter().zip(&tracks).all(|(a, b)| (a.clip, &a.weights) == (b.clip, &b.weights))
            };
            let shared = given.iter().find(|(of, weights, _)| of == name && same(weights));
            let token = shared.map_or_else(|| names.unique(name), |(_, _, token)| token.clone());
            given.push((name, tracks, token.clone()));
            of_mesh.push(token);
        }
        tokens.push(of_mesh);
    }
    tokens
}

/// The tracks of a target in the order of the clips, without those that are always 0.
fn tracks(scene: &Scene, mesh: usize, target: usize) -> Vec<&MorphTrack> {
    let is = |track: &&MorphTrack| {
        (track.mesh as usize, track.target as usize) == (mesh, target)
            && track.weights.iter().any(|weight| *weight != 0.0)
    };
    let mut tracks: Vec<&MorphTrack> = scene.morph_tracks.iter().filter(is).collect();
    tracks.sort_by_key(|track| track.clip);
    tracks
}

/// Writes the targets of the mesh at this path, which may already have a skin.
pub(super) fn write(layer: &mut Layer, path: &str, mesh: &SceneMesh, tokens: &[String]) -> Result<()> {
    if mesh.morph_targets.is_empty() {
        return Ok(());
    }
    if mesh.influences_per_vertex == 0 {
        layer.apply(path, "SkelBindingAPI")?;
    }
    let mut names = Names::default();
    let paths: Vec<String> =
        mesh.morph_targets.iter().map(|t| format!("{path}/{}", names.unique(&t.name))).collect();
    layer.uniform(
        path,
        "skel:blendShapes",
        "token[]",
        Value::token_vec(tokens.iter().map(String::as_str)),
    )?;
    layer.relate_all(path, "skel:blendShapeTargets", &paths)?;
    mesh.morph_targets.iter().zip(&paths).try_for_each(|(target, path)| shape(layer, path, target))
}

/// Writes the offsets, only of vertices whose position or normal changes.
fn shape(layer: &mut Layer, path: &str, target: &MorphTarget) -> Result<()> {
    layer.prim(path, &target.name, "BlendShape")?;
    let stays = |vertex: &usize| {
        let zero = |offsets: &[[f32; 3]]| offsets.get(*vertex).is_none_or(|offset| *offset == [0.0; 3]);
        zero(&target.positions) && zero(&target.normals)
    };
    let mut moved: Vec<usize> = (0..target.positions.len()).filter(|vertex| !stays(vertex)).collect();
    if moved.is_empty() {
        // An empty index list would mean all vertices.
        moved.push(0);
    }
    let offsets = |rows: &[[f32; 3]]| {
        Value::Vec3fVec(
            moved.iter().filter_map(|v| rows.get(*v)).map(|offset| Vec3f::from(*offset)).collect(),
        )
    };
    layer.uniform(path, "offsets", "vector3f[]", offsets(&target.positions))?;
    if !target.normals.is_empty() {
        layer.uniform(path, "normalOffsets", "vector3f[]", offsets(&target.normals))?;
    }
    let indices = moved.iter().map(|vertex| *vertex as i32).collect();
    layer.uniform(path, "pointIndices", "int[]", Value::IntVec(indices)).map(drop)
}

/// Writes the weights of a clip to its SkelAnimation; omitted ones are 0. `pace` is the number of time codes per frame.
pub(super) fn animate(
    layer: &mut Layer,
    path: &str,
    (scene, clip): (&Scene, usize),
    tokens: &[Vec<String>],
    pace: f64,
) -> Result<()> {
    let mut seen = BTreeSet::new();
    let tracks = scene
        .morph_tracks_of(clip)
        .map(|track| (tokens[track.mesh as usize][track.target as usize].as_str(), &track.weights));
    let tracks: Vec<_> = tracks.filter(|(token, _)| seen.insert(*token)).collect();
    if tracks.is_empty() {
        return Ok(());
    }
    let names = tracks.iter().map(|(token, _)| *token);
    layer.uniform(path, "blendShapes", "token[]", Value::token_vec(names))?;
    let weights = layer.declare(path, "blendShapeWeights", "float[]", Variability::Varying, None)?;
    let sample = |frame: usize| {
        let weights = tracks.iter().map(|(_, weights)| weights[frame]).collect();
        (frame as f64 * pace, Value::FloatVec(weights))
    };
    let samples = (0..scene.clips[clip].frame_count()).map(sample).collect();
    layer.set(&weights, FieldKey::TimeSamples, Value::TimeSamples(samples))
}
