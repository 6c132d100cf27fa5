//! Clips as animations (glTF 2.0, section 3.11).
//!
//! Keys fall on frames: key `f` is at `f / frames per second`, rounded once to `f32`. All channels with a key in every
//! frame share one accessor of key times. A joint that does not move has one key, or none if it stays at rest.
//! Interpolation is LINEAR; quaternions have unit length and consistent signs. `animation.extras.anthronet` holds
//! `frames_per_second` and `frames`. The weights of a mesh's morph targets are one channel of its node, with a key in
//! every frame.

use glam::Vec3;
use gltf_json::{
    Accessor, Animation, Index, Value,
    animation::{Channel, Interpolation, Property, Sampler, Target},
    validation::Checked,
};
use serde_json::json;

use super::accessor::{DocumentBuilder, Usage};
use super::raw;
use crate::Result;
use crate::clip::Clip;
use crate::math::RigidTransform;
use crate::scene::Scene;

/// Largest difference from the rest pose, per quaternion component and in metres per translation component, for a joint
/// to count as at rest: the rounding of a pose computed another way, a thousandth of a millimetre at arm's length.
pub(super) const REST_TOLERANCE: f32 = 5e-7;

/// Appends a clip of the scene. Nodes `0..joints` are the joints, with the transforms `rests`, followed by one node per mesh.
pub(super) fn push(
    builder: &mut DocumentBuilder,
    scene: &Scene,
    place: usize,
    rests: &[RigidTransform],
) -> Result<()> {
    let clip = &scene.clips[place];
    let (frames, rate) = (clip.frame_count(), clip.frames_per_second());
    let mut rotations: Vec<Vec<[f32; 4]>> = (0..rests.len()).map(|j| joint_rotations(clip, j)).collect();
    let mut translations: Vec<Vec<[f32; 3]>> =
        (0..rests.len()).map(|j| joint_translations(clip, j)).collect();
    for (rest, track) in rests.iter().zip(&mut rotations) {
        let (own, opposite) = (rest.rotation.to_array(), (-rest.rotation).to_array());
        if track.iter().all(|q| near(q, &own) || near(q, &opposite)) {
            track.clear();
        }
        drop_repetition(track);
    }
    for (rest, track) in rests.iter().zip(&mut translations) {
        if track.iter().all(|t| near(t, &rest.translation.to_array())) {
            track.clear();
        }
        drop_repetition(track);
    }
    // A clip is as long as its longest track, so one track needs all keys even if nothing moves.
    let lasts = rotations.iter().any(|t| t.len() == frames) || translations.iter().any(|t| t.len() == frames);
    if let (false, Some(root)) = (lasts, rotations.first_mut()) {
        *root = joint_rotations(clip, 0);
    }

    let mut tracks = Tracks { builder, rate, frames, times: [None; 2], samplers: vec![], channels: vec![] };
    for (joint, (rotations, translations)) in (0u32..).zip(rotations.iter().zip(&translations)) {
        tracks.push(joint, Property::Rotation, rotations);
        tracks.push(joint, Property::Translation, translations);
    }
    for (mesh, weights) in (0u32..).zip(weights(scene, place)) {
        tracks.push(rests.len() as u32 + mesh, Property::MorphTargetWeights, &weights);
    }
    let (samplers, channels) = (tracks.samplers, tracks.channels);
    builder.root.push(Animation {
        extensions: None,
        extras: raw(&json!({"anthronet": {"frames_per_second": rate, "frames": frames}}))?,
        channels,
        name: Some(clip.name().to_owned()),
        samplers,
    });
    Ok(())
}

/// For each mesh, the weights of all its targets, frame by frame; empty if they are all 0.
fn weights(scene: &Scene, clip: usize) -> Vec<Vec<[f32; 1]>> {
    let frames = scene.clips[clip].frame_count();
    let mut weights = vec![Vec::new(); scene.meshes.len()];
    for track in scene.morph_tracks_of(clip) {
        let mesh = track.mesh as usize;
        let targets = scene.meshes[mesh].morph_targets.len();
        weights[mesh].resize(frames * targets, [0.0]);
        for (frame, weight) in track.weights.iter().enumerate() {
            weights[mesh][frame * targets + track.target as usize] = [*weight];
        }
    }
    for weights in weights.iter_mut().filter(|weights| weights.iter().all(|[weight]| *weight == 0.0)) {
        weights.clear();
    }
    weights
}

/// One rotation per frame.
fn joint_rotations(clip: &Clip, joint: usize) -> Vec<[f32; 4]> {
    (0..clip.frame_count()).filter_map(|f| clip.rotations(f).get(joint)).map(|r| r.to_array()).collect()
}

/// One translation per frame, or only the rest translation if the clip has no track for the joint.
fn joint_translations(clip: &Clip, joint: usize) -> Vec<[f32; 3]> {
    match clip.translations().iter().find(|track| track.joint as usize == joint) {
        Some(track) => track.values.iter().map(Vec3::to_array).collect(),
        None => clip
            .skeleton()
            .rest_pose()
            .locals
            .get(joint)
            .map(|l| l.translation.to_array())
            .into_iter()
            .collect(),
    }
}

/// Reduces a constant track to one key.
fn drop_repetition<const N: usize>(track: &mut Vec<[f32; N]>) {
    if track.windows(2).all(|w| w[0] == w[1]) {
        track.truncate(1);
    }
}

fn near<const N: usize>(a: &[f32; N], b: &[f32; N]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= REST_TOLERANCE)
}

/// An animation under construction.
struct Tracks<'a> {
    builder: &'a mut DocumentBuilder,
    rate: f64,
    frames: usize,
    /// Key times of a single key, and of all frames.
    times: [Option<Index<Accessor>>; 2],
    samplers: Vec<Sampler>,
    channels: Vec<Channel>,
}

impl Tracks<'_> {
    /// Adds a track of one value per frame (for weights, one per target and frame) or of a single value. Empty tracks
    /// are left out.
    fn push<const N: usize>(&mut self, node: u32, path: Property, keys: &[[f32; N]]) {
        if keys.is_empty() {
            return;
        }
        let frames = if path == Property::MorphTargetWeights { self.frames } else { keys.len() };
        let input = self.times(frames);
        let output = self.builder.push_accessor(keys.iter().copied(), Usage::Other);
        let sampler = Index::new(self.samplers.len() as u32);
        let interpolation = Checked::Valid(Interpolation::Linear);
        self.samplers.push(Sampler { extensions: None, extras: None, input, interpolation, output });
        let (node, path) = (Index::new(node), Checked::Valid(path));
        let target = Target { extensions: None, extras: None, node, path };
        self.channels.push(Channel { sampler, target, extensions: None, extras: None });
    }

    /// The accessor of the times of the first `keys` frames: one, or all.
    fn times(&mut self, keys: usize) -> Index<Accessor> {
        let (builder, rate) = (&mut *self.builder, self.rate);
        *self.times[usize::from(keys > 1)].get_or_insert_with(|| {
            let at = |frame: usize| (frame as f64 / rate) as f32;
            let index = builder.push_accessor((0..keys).map(|f| [at(f)]), Usage::Other);
            if let Some(accessor) = builder.root.accessors.get_mut(index.value()) {
                // As f64, so that the decimal number in the JSON equals the stored one exactly.
                let bound = |frame| Some(Value::from(vec![f64::from(at(frame))]));
                (accessor.min, accessor.max) = (bound(0), bound(keys - 1));
            }
            index
        })
    }
}
