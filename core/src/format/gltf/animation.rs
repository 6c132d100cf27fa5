//! Animations: keys of one property of one node, how they are interpolated (glTF 2.0, sections 3.11 and C), and the frames
//! that they lie on. What moves with them, a skeleton of any kind or a character, is for the readers of those.

use gltf_json::animation::{Interpolation, Property};
use gltf_json::validation::Checked;
use gltf_json::{Animation, Value};

use glam::DQuat;

use crate::error::Outcome;
use crate::format::gltf::document::Document;
use crate::format::motion::{Found, raw::snapped_rate};

/// The rate for keys that lie on the frames of no usual rate.
pub(super) const FALLBACK_RATE: f64 = 30.0;
/// Rates to look for, the lowest first.
const USUAL_RATES: [f64; 9] = [24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 90.0, 100.0, 120.0];
/// How far from a frame a key may be to count as on it, in frames: what rounding of times leaves.
pub(super) const ON_FRAME: f64 = 5e-3;
/// Most numbers of all keys of a document.
pub(super) const MAX_NUMBERS: usize = 1 << 26;

/// Keys of one property of one node.
pub(super) struct Track {
    pub(super) node: usize,
    pub(super) property: Property,
    interpolation: Interpolation,
    /// Seconds, rising.
    times: Vec<f64>,
    /// Values, or in-tangent, value and out-tangent of each key; the fourth number is of rotations alone.
    values: Vec<[f32; 4]>,
}

/// The tracks of an animation that move nodes; weights of blend shapes are passed over. `left` is how many numbers the
/// document may still have.
pub(super) fn read(document: &Document, animation: &Animation, left: &mut usize) -> Outcome<Vec<Track>> {
    let mut tracks = Vec::<Track>::new();
    for (i, channel) in animation.channels.iter().enumerate() {
        let Checked::Valid(property) = channel.target.path else { continue };
        if property == Property::MorphTargetWeights {
            continue;
        }
        let track =
            read_channel(document, animation, i, property).map_err(|e| format!("channels[{i}]: {e}"))?;
        *left = left
            .checked_sub(4 * track.values.len())
            .ok_or_else(|| format!("more than {MAX_NUMBERS} numbers of keys"))?;
        tracks.push(track);
    }
    Ok(tracks)
}

fn read_channel(document: &Document, animation: &Animation, i: usize, property: Property) -> Outcome<Track> {
    let channel = &animation.channels[i];
    let (node, nodes) = (channel.target.node.value(), document.root.nodes.len());
    if node >= nodes {
        return Err(format!("target.node: {node} of {nodes}"));
    }
    let sampler = animation.samplers.get(channel.sampler.value());
    let sampler = sampler
        .ok_or_else(|| format!("sampler {} of {}", channel.sampler.value(), animation.samplers.len()))?;
    let Checked::Valid(interpolation) = sampler.interpolation else {
        return Err("interpolation: expected LINEAR, STEP or CUBICSPLINE".to_owned());
    };
    let times = document.numbers::<1>(sampler.input).map_err(|e| format!("input: {e}"))?;
    let times: Vec<f64> = times.iter().map(|[time]| f64::from(*time)).collect();
    if times.is_empty() || !times.windows(2).all(|pair| pair[0] < pair[1]) {
        return Err("input: expected times of keys that rise".to_owned());
    }
    let values: Outcome<Vec<[f32; 4]>> = match property {
        Property::Rotation => document.numbers::<4>(sampler.output),
        _ => document
            .numbers::<3>(sampler.output)
            .map(|v| v.into_iter().map(|[x, y, z]| [x, y, z, 0.0]).collect()),
    };
    let values = values.map_err(|e| format!("output: {e}"))?;
    let each = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    if values.len() != each * times.len() {
        return Err(format!(
            "output: expected {} values for {} keys, got {}",
            each * times.len(),
            times.len(),
            values.len()
        ));
    }
    Ok(Track { node, property, interpolation, times, values })
}

impl Track {
    /// The value of every key; the fourth number is of rotations alone.
    pub(super) fn keys(&self) -> impl Iterator<Item = [f32; 4]> + '_ {
        (0..self.times.len()).map(|i| self.key(i))
    }

    fn key(&self, i: usize) -> [f32; 4] {
        self.values[if self.interpolation == Interpolation::CubicSpline { 3 * i + 1 } else { i }]
    }

    /// Whether it has a single key.
    pub(super) fn is_still(&self) -> bool {
        self.times.len() == 1
    }

    /// What the property is at a time; before the first key and after the last it is held. On a key, and up to `near` seconds
    /// away from one, it is the file's own numbers.
    pub(super) fn value(&self, time: f64, near: f64) -> [f64; 4] {
        let key = |i: usize| self.key(i).map(f64::from);
        let next = self.times.partition_point(|t| *t <= time + near);
        let on_key = next > 0 && time - self.times[next - 1] <= near;
        if next == 0 || next == self.times.len() || on_key {
            return key(next.saturating_sub(1));
        }
        let (from, to) = (key(next - 1), key(next));
        let span = self.times[next] - self.times[next - 1];
        let t = (time - self.times[next - 1]) / span;
        match self.interpolation {
            Interpolation::Step => from,
            Interpolation::Linear if self.property == Property::Rotation => {
                unit(DQuat::from_array(from)).slerp(unit(DQuat::from_array(to)), t).to_array()
            }
            Interpolation::Linear => std::array::from_fn(|i| from[i] + (to[i] - from[i]) * t),
            Interpolation::CubicSpline => {
                let tangent = |i: usize| self.values[i].map(f64::from);
                let (out, into) = (tangent(3 * (next - 1) + 2), tangent(3 * next));
                let (t2, t3) = (t * t, t * t * t);
                std::array::from_fn(|i| {
                    (2.0 * t3 - 3.0 * t2 + 1.0) * from[i]
                        + span * (t3 - 2.0 * t2 + t) * out[i]
                        + (3.0 * t2 - 2.0 * t3) * to[i]
                        + span * (t3 - t2) * into[i]
                })
            }
        }
    }
}

/// A rotation of unit length; none for what is too short.
pub(super) fn unit(q: DQuat) -> DQuat {
    let length = q.length();
    if length > 1e-6 { q * (1.0 / length) } else { DQuat::IDENTITY }
}

/// When an animation is sampled.
pub(super) struct Timing {
    /// Seconds.
    pub(super) start: f64,
    /// Seconds.
    pub(super) end: f64,
    /// Frames a second.
    pub(super) rate: f64,
    /// Where the rate is from.
    pub(super) found: Found,
    /// How many frames, a whole number; not checked.
    pub(super) frames: f64,
}

impl Timing {
    /// From the first key to the last, or as long as our own files say; at the rate that is asked for, else that our own
    /// files say, else that on whose frames all keys lie, else [`FALLBACK_RATE`].
    pub(super) fn of(animation: &Animation, tracks: &[Track], asked: Option<f64>) -> Self {
        let told = told(animation);
        let (start, end) = told.map_or_else(|| span(tracks), |(rate, frames)| (0.0, (frames - 1.0) / rate));
        let timing =
            |rate: f64, found| Self { start, end, rate, found, frames: 1.0 + ((end - start) * rate).round() };
        match (asked, told) {
            (Some(rate), _) => timing(rate, Found::Asked),
            (None, Some((rate, frames))) => Self { frames, ..timing(rate, Found::File) },
            (None, None) => match rate(tracks) {
                Some(rate) => timing(rate, Found::Detected),
                None => timing(FALLBACK_RATE, Found::Assumed),
            },
        }
    }
}

/// Rate and number of frames, which our own files say: keys that change nothing are left out of them.
fn told(animation: &Animation) -> Option<(f64, f64)> {
    let extras: Value = gltf_json::deserialize::from_str(animation.extras.as_ref()?.get()).ok()?;
    let number = |key: &str| extras.get("anthronet")?.get(key)?.as_f64();
    let (rate, frames) = (number("frames_per_second")?, number("frames")?);
    ((0.1..=1000.0).contains(&rate) && frames >= 1.0).then_some((rate, frames))
}

/// From the first to the last key of all.
fn span(tracks: &[Track]) -> (f64, f64) {
    let firsts = tracks.iter().filter_map(|track| track.times.first());
    let lasts = tracks.iter().filter_map(|track| track.times.last());
    (firsts.copied().fold(f64::INFINITY, f64::min), lasts.copied().fold(f64::NEG_INFINITY, f64::max))
}

/// The rate on whose frames all keys lie: that of evenly spaced keys, else the lowest usual one.
fn rate(tracks: &[Track]) -> Option<f64> {
    let (start, _) = span(tracks);
    let steps = tracks.iter().flat_map(|track| track.times.windows(2).map(|pair| pair[1] - pair[0]));
    let shortest = steps.fold(f64::INFINITY, f64::min);
    // Slower keys are poses to interpolate, not frames.
    let even = Some(snapped_rate(1.0 / shortest)).filter(|rate| (10.0..=1000.0).contains(rate));
    even.into_iter().chain(USUAL_RATES).find(|rate| {
        tracks.iter().flat_map(|track| &track.times).all(|time| {
            let frames = (time - start) * rate;
            (frames - frames.round()).abs() < ON_FRAME
        })
    })
}
