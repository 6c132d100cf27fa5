//! Animations of the skeleton as clips: every joint sampled at the frames of one rate.
//!
//! Our own files say the rate and the number of frames in `animation.extras.anthronet`. For others the rate is the
//! lowest usual one on whose frames all keys lie, else [`FALLBACK_RATE`]. Key values on frames are taken as they are;
//! between keys the interpolation is the file's. Motion of what is no part of the skeleton is passed over.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3, Quat, Vec3};
use gltf_json::{
    Animation, Value,
    animation::{Interpolation, Property, Sampler},
    validation::Checked,
};

use super::Outcome;
use super::document::Document;
use super::skeleton::{Skeleton, chain_transform, named, to_local, written};
use crate::clip::{Clip, MAX_FRAMES, TranslationTrack};
use crate::pose::{Local, RestPose};

/// Rates to look for, the lowest first, frames a second.
const USUAL_RATES: [f64; 9] = [24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 90.0, 100.0, 120.0];
/// The rate at which keys that lie on no usual frames are sampled.
const FALLBACK_RATE: f64 = 60.0;
/// How far from a frame a key may lie to count as on it, in frames: what exporters' rounding of times leaves.
const FRAME_TOLERANCE: f64 = 5e-3;
/// How far scale may be from 1.
const SCALE_TOLERANCE: f32 = 1e-4;
/// Most keys and rotations of all clips of a document together.
const MAX_KEYS: usize = 1 << 25;

/// All animations that move a joint.
pub(super) fn clips(document: &Document, skeleton: &Skeleton) -> Outcome<Vec<Clip>> {
    if document.root.animations.is_empty() {
        return Ok(Vec::new());
    }
    let rest = RestPose::new(
        skeleton.joints.iter().map(|j| j.name.clone()).collect(),
        skeleton.joints.iter().map(|j| j.parent).collect(),
        skeleton.locals.clone(),
        vec![None; skeleton.joints.len()],
    );
    let rest = Arc::new(rest.map_err(|e| e.to_string())?);
    let mut motions = Vec::new();
    let mut left = MAX_KEYS;
    for (i, animation) in document.root.animations.iter().enumerate() {
        let fault = |m: String| format!("animations[{i}]: {m}");
        let Some(motion) = Motion::read(document, skeleton, animation, &mut left).map_err(fault)? else {
            continue;
        };
        let (frames, joints) = (motion.frames, skeleton.joints.len());
        let rotations = frames.checked_mul(joints).and_then(|rotations| left.checked_sub(rotations));
        left = rotations.ok_or_else(|| fault(format!("{frames} frames of {joints} joints are too many")))?;
        motions.push((i, animation, motion));
    }
    let mut names = super::character::Names::default();
    let mut clips = Vec::new();
    for (i, animation, motion) in motions {
        let name = names.unique(animation.name.as_deref().unwrap_or("Animation"));
        let clip = motion.clip(document, skeleton, &rest, name);
        clips.push(clip.map_err(|m| format!("animations[{i}]: {m}"))?);
    }
    Ok(clips)
}

/// Keys of one property of one node.
struct Track<const N: usize> {
    times: Arc<Vec<f64>>,
    /// One row per key; in-tangent, value and out-tangent for a cubic spline.
    values: Vec<[f32; N]>,
    interpolation: Interpolation,
}

#[derive(Default)]
struct NodeTracks {
    translation: Option<Track<3>>,
    rotation: Option<Track<4>>,
}

struct Motion {
    nodes: BTreeMap<usize, NodeTracks>,
    start: f64,
    rate: f64,
    frames: usize,
}

impl Motion {
    /// `None` if no joint moves.
    fn read(
        document: &Document,
        skeleton: &Skeleton,
        animation: &Animation,
        left: &mut usize,
    ) -> Outcome<Option<Self>> {
        let mut nodes: BTreeMap<usize, NodeTracks> = BTreeMap::new();
        for node in skeleton.chains.iter().flatten() {
            nodes.entry(*node).or_default();
        }
        let mut keys = Keys { document, times: BTreeMap::new(), left };
        for (c, channel) in animation.channels.iter().enumerate() {
            let fault = |m: String| format!("channels[{c}]: {m}");
            let node = channel.target.node.value();
            let Some(tracks) = nodes.get_mut(&node) else { continue };
            let sampler = animation.samplers.get(channel.sampler.value());
            let sampler = sampler.ok_or_else(|| fault("sampler does not exist".into()))?;
            let twice = || fault(format!("a second track of {}", named(document, node)));
            match channel.target.path {
                Checked::Valid(Property::Translation) => {
                    let track = keys.track(sampler).map_err(fault)?;
                    if tracks.translation.replace(track).is_some() {
                        return Err(twice());
                    }
                }
                Checked::Valid(Property::Rotation) => {
                    let track = keys.track(sampler).map_err(fault)?;
                    if tracks.rotation.replace(track).is_some() {
                        return Err(twice());
                    }
                }
                Checked::Valid(Property::Scale) => {
                    let track: Track<3> = keys.track(sampler).map_err(fault)?;
                    let scale = (0..track.times.len()).flat_map(|key| track.value(key));
                    if let Some(scale) = scale.into_iter().find(|s| (s - 1.0).abs() > SCALE_TOLERANCE) {
                        let node = named(document, node);
                        return Err(fault(format!("{node} is scaled by {scale}, expected a rigid skeleton")));
                    }
                }
                _ => {}
            }
        }
        let all = nodes.values().flat_map(|n| {
            let times = |t: Option<&Arc<Vec<f64>>>| t.cloned();
            [times(n.translation.as_ref().map(|t| &t.times)), times(n.rotation.as_ref().map(|t| &t.times))]
        });
        let all: Vec<Arc<Vec<f64>>> = all.flatten().collect();
        let start = all.iter().filter_map(|t| t.first()).copied().fold(f64::INFINITY, f64::min);
        let end = all.iter().filter_map(|t| t.last()).copied().fold(start, f64::max);
        if all.is_empty() {
            return Ok(None);
        }
        let (rate, frames) = match stated(animation) {
            Some((rate, frames)) => (rate, frames),
            None => {
                let on_frames = |rate: &f64| {
                    let mut times = keys.times.values().flat_map(|t| t.iter());
                    times.all(|t| {
                        let frame = (t - start) * rate;
                        (frame - frame.round()).abs() <= FRAME_TOLERANCE
                    })
                };
                let rate = USUAL_RATES.into_iter().find(on_frames).unwrap_or(FALLBACK_RATE);
                (rate, 1.0 + ((end - start) * rate).round())
            }
        };
        if !(1.0..=MAX_FRAMES as f64).contains(&frames) {
            return Err(format!("expected 1 to {MAX_FRAMES} frames, got {frames} at {rate} a second"));
        }
        Ok(Some(Self { nodes, start, rate, frames: frames as usize }))
    }

    fn clip(
        &self,
        document: &Document,
        skeleton: &Skeleton,
        rest: &Arc<RestPose>,
        name: String,
    ) -> Outcome<Clip> {
        let joints = skeleton.joints.len();
        let mut rotations = vec![Quat::IDENTITY; self.frames * joints];
        let mut translations = Vec::new();
        for (j, (chain, at_rest)) in skeleton.chains.iter().zip(&skeleton.locals).enumerate() {
            let still = chain.iter().all(|n| self.nodes.get(n).is_none_or(|t| t.is_still()));
            let locals: Vec<Local> = (0..if still { 1 } else { self.frames })
                .map(|frame| self.local(document, chain, frame))
                .collect::<Outcome<_>>()?;
            let local = |frame: usize| locals[frame.min(locals.len() - 1)];
            for frame in 0..self.frames {
                rotations[frame * joints + j] = local(frame).rotation;
            }
            if locals.iter().any(|l| l.translation != at_rest.translation) {
                let values = (0..self.frames).map(|frame| local(frame).translation).collect();
                translations.push(TranslationTrack { joint: j as u32, values });
            }
        }
        Clip::new(name, rest.clone(), self.rate, rotations, translations).map_err(|e| e.to_string())
    }

    /// A joint in its parent.
    fn local(&self, document: &Document, chain: &[usize], frame: usize) -> Outcome<Local> {
        let time = self.start + frame as f64 / self.rate;
        let near = FRAME_TOLERANCE / self.rate;
        let mut product: Option<DAffine3> = None;
        for (n, &node) in chain.iter().enumerate() {
            let tracks = self.nodes.get(&node);
            let rotation = tracks.and_then(|t| t.rotation.as_ref()).map(|t| t.rotation(time, near));
            let translation = tracks.and_then(|t| t.translation.as_ref()).map(|t| t.translation(time, near));
            let found = document.root.nodes.get(node);
            let at_rest = match found.and_then(written) {
                Some(node) => Local {
                    rotation: Quat::from_array(node.rotation),
                    translation: Vec3::from(node.translation),
                },
                None => to_local(&chain_transform(document, &chain[n..=n])?),
            };
            let local = Local {
                rotation: rotation.unwrap_or(at_rest.rotation),
                translation: translation.unwrap_or(at_rest.translation),
            };
            if chain.len() == 1 {
                // The file's numbers, without a detour.
                return Ok(local);
            }
            let q = local.rotation;
            let affine = DAffine3::from_rotation_translation(
                DQuat::from_array(q.to_array().map(f64::from)).normalize(),
                DVec3::from_array(local.translation.to_array().map(f64::from)),
            );
            product = Some(product.map_or(affine, |above| above * affine));
        }
        Ok(to_local(&product.unwrap_or(DAffine3::IDENTITY)))
    }
}

/// Rate and number of frames of our own files.
fn stated(animation: &Animation) -> Option<(f64, f64)> {
    let extras: Value = gltf_json::deserialize::from_str(animation.extras.as_ref()?.get()).ok()?;
    let ours = extras.get("anthronet")?;
    let number = |name| ours.get(name).and_then(Value::as_f64);
    Some((number("frames_per_second")?, number("frames")?))
}

/// Keys of an animation, their times read once.
struct Keys<'a> {
    document: &'a Document,
    times: BTreeMap<usize, Arc<Vec<f64>>>,
    /// How many more there may be.
    left: &'a mut usize,
}

impl Keys<'_> {
    fn track<const N: usize>(&mut self, sampler: &Sampler) -> Outcome<Track<N>> {
        let Checked::Valid(interpolation) = sampler.interpolation else {
            return Err("interpolation is none of LINEAR, STEP, CUBICSPLINE".into());
        };
        let times = match self.times.get(&sampler.input.value()) {
            Some(times) => times.clone(),
            None => {
                let times = self.document.numbers::<1>(sampler.input).map_err(|m| format!("input: {m}"))?;
                let times: Vec<f64> = times.iter().map(|[t]| f64::from(*t)).collect();
                if times.is_empty() {
                    return Err("input: is empty".into());
                }
                if let Some(key) = times.windows(2).position(|w| w[0] >= w[1]) {
                    return Err(format!("input: time {} does not come after time {key}", key + 1));
                }
                self.times.entry(sampler.input.value()).or_insert(Arc::new(times)).clone()
            }
        };
        let values = self.document.numbers::<N>(sampler.output).map_err(|m| format!("output: {m}"))?;
        let expected = times.len() * if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        if values.len() != expected {
            return Err(format!("output: expected {expected} values, got {}", values.len()));
        }
        *self.left = self.left.checked_sub(expected).ok_or_else(|| format!("more than {MAX_KEYS} keys"))?;
        Ok(Track { times, values, interpolation })
    }
}

impl NodeTracks {
    /// Whether there is one key at the most of each.
    fn is_still(&self) -> bool {
        self.translation.as_ref().is_none_or(|t| t.times.len() == 1)
            && self.rotation.as_ref().is_none_or(|t| t.times.len() == 1)
    }
}

impl<const N: usize> Track<N> {
    fn value(&self, key: usize) -> [f32; N] {
        let row = if self.interpolation == Interpolation::CubicSpline { 3 * key + 1 } else { key };
        self.values.get(row).copied().unwrap_or([0.0; N])
    }

    /// The value of the key at a time, or the keys before and after it and how far it is between them, 0 to 1.
    fn at(&self, time: f64, near: f64) -> std::result::Result<[f32; N], (usize, f32, f64)> {
        let after = self.times.partition_point(|key| *key < time - near);
        let last = self.times.len() - 1;
        if after > last {
            return Ok(self.value(last));
        }
        if after == 0 || self.times[after] <= time + near {
            return Ok(self.value(after));
        }
        let before = after - 1;
        let step = self.times[after] - self.times[before];
        match self.interpolation {
            Interpolation::Step => Ok(self.value(before)),
            _ => Err((before, ((time - self.times[before]) / step) as f32, step)),
        }
    }

    /// glTF 2.0, appendix C.3.
    fn cubic(&self, before: usize, t: f32, step: f64) -> [f32; N] {
        let row = |i: usize| self.values.get(i).copied().unwrap_or([0.0; N]);
        let step = step as f32;
        let (value, out_tangent) = (row(3 * before + 1), row(3 * before + 2));
        let (in_tangent, next) = (row(3 * before + 3), row(3 * before + 4));
        let (t2, t3) = (t * t, t * t * t);
        std::array::from_fn(|i| {
            (2.0 * t3 - 3.0 * t2 + 1.0) * value[i]
                + step * (t3 - 2.0 * t2 + t) * out_tangent[i]
                + (-2.0 * t3 + 3.0 * t2) * next[i]
                + step * (t3 - t2) * in_tangent[i]
        })
    }
}

impl Track<3> {
    fn translation(&self, time: f64, near: f64) -> Vec3 {
        match self.at(time, near) {
            Ok(value) => value.into(),
            Err((before, t, step)) if self.interpolation == Interpolation::CubicSpline => {
                self.cubic(before, t, step).into()
            }
            Err((before, t, _)) => Vec3::from(self.value(before)).lerp(self.value(before + 1).into(), t),
        }
    }
}

impl Track<4> {
    fn rotation(&self, time: f64, near: f64) -> Quat {
        match self.at(time, near) {
            Ok(value) => Quat::from_array(value),
            Err((before, t, step)) if self.interpolation == Interpolation::CubicSpline => {
                Quat::from_array(self.cubic(before, t, step))
            }
            Err((before, t, _)) => {
                let (a, b) = (Quat::from_array(self.value(before)), Quat::from_array(self.value(before + 1)));
                a.normalize().slerp(b.normalize(), t)
            }
        }
    }
}
