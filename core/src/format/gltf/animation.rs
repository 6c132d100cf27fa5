//! Animation channels: the keys of one property of one node, their interpolation (glTF 2.0, sections 3.11 and C) and
//! the frames they fall on. What they move, a bare skeleton or a whole character, is up to the callers.

use gltf_json::animation::{Interpolation, Property, Sampler};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Animation, Index, Value};

use glam::DQuat;

use crate::error::{Fault, Within};
use crate::format::gltf::Result;
use crate::format::gltf::document::Document;
use crate::format::motion::{Found, raw::snapped_rate};

/// The frame rate for keys that fit no usual rate.
pub(super) const FALLBACK_RATE: f64 = 30.0;
/// Rates to try, lowest first.
const USUAL_RATES: [f64; 9] = [24.0, 25.0, 30.0, 48.0, 50.0, 60.0, 90.0, 100.0, 120.0];
/// How far from a frame a key may be to count as on it, in frames: allows for rounded times.
pub(super) const ON_FRAME: f64 = 5e-3;
/// Limit on the numbers of all keys of a document.
pub(super) const MAX_NUMBERS: usize = 1 << 26;

/// The times of keys, and the interpolation between them.
pub(super) struct Keys {
    /// In seconds, strictly increasing, at least one.
    pub(super) times: Vec<f64>,
    pub(super) interpolation: Interpolation,
}

/// The position of a time among keys.
pub(super) enum Place {
    /// On this key, or clamped to it as the first or last.
    At(usize),
    /// Between this key and the next: the fraction of the interval, and its length in seconds.
    After(usize, f64, f64),
}

impl Keys {
    /// The keys of a sampler, and the accessor of its output.
    pub(super) fn read(
        document: &Document,
        animation: &Animation,
        sampler: Index<Sampler>,
    ) -> Result<(Self, Index<Accessor>)> {
        let of_sampler = animation.samplers.get(sampler.value());
        let sampler = of_sampler
            .ok_or_else(|| Fault::dangling("sampler", sampler.value(), animation.samplers.len()))?;
        let Checked::Valid(interpolation) = sampler.interpolation else {
            return Err(Fault::unexpected("LINEAR, STEP or CUBICSPLINE", "another").into())
                .within("interpolation");
        };
        let times = document.numbers::<1>(sampler.input).within("input")?;
        let times: Vec<f64> = times.iter().map(|[time]| f64::from(*time)).collect();
        if times.is_empty() || !times.windows(2).all(|pair| pair[0] < pair[1]) {
            return Err(Fault::unexpected("times of keys that rise", "others").into()).within("input");
        }
        Ok((Self { times, interpolation }, sampler.output))
    }

    /// Values per key: in-tangent, value and out-tangent, or the value alone.
    pub(super) fn each(&self) -> usize {
        if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 }
    }

    /// The index of a key's value among the values.
    pub(super) fn value_at(&self, key: usize) -> usize {
        if self.interpolation == Interpolation::CubicSpline { 3 * key + 1 } else { key }
    }

    /// The position of a time. A key within `near` seconds counts as reached.
    pub(super) fn place(&self, time: f64, near: f64) -> Place {
        let times = &self.times;
        let next = times.partition_point(|t| *t <= time + near);
        let on_key = next > 0 && time - times[next - 1] <= near;
        if next == 0 || next == times.len() || on_key {
            return Place::At(next.saturating_sub(1));
        }
        let span = times[next] - times[next - 1];
        Place::After(next - 1, (time - times[next - 1]) / span, span)
    }
}

/// Cubic Hermite interpolation from a value and its out-tangent to the next in-tangent and value (section C.5).
pub(super) fn hermite(t: f64, span: f64, [from, out, into, to]: [f64; 4]) -> f64 {
    let (t2, t3) = (t * t, t * t * t);
    (2.0 * t3 - 3.0 * t2 + 1.0) * from
        + span * (t3 - 2.0 * t2 + t) * out
        + (3.0 * t2 - 2.0 * t3) * to
        + span * (t3 - t2) * into
}

/// Keys of one property of one node.
pub(super) struct Track {
    pub(super) node: usize,
    pub(super) property: Property,
    pub(super) keys: Keys,
    /// Values, or per key in-tangent, value and out-tangent; the fourth component is used by rotations only.
    values: Vec<[f32; 4]>,
}

/// The tracks of an animation that move nodes; weights of morph targets are left out. `left` is the document's
/// remaining budget of numbers.
pub(super) fn read(document: &Document, animation: &Animation, left: &mut usize) -> Result<Vec<Track>> {
    let mut tracks = Vec::<Track>::new();
    for (i, channel) in animation.channels.iter().enumerate() {
        let Checked::Valid(property) = channel.target.path else { continue };
        if property == Property::MorphTargetWeights {
            continue;
        }
        let track = read_channel(document, animation, i, property).within(format_args!("channels[{i}]"))?;
        *left = left.checked_sub(4 * track.values.len()).ok_or_else(too_many_numbers)?;
        tracks.push(track);
    }
    Ok(tracks)
}

/// The fault for a document with more than [`MAX_NUMBERS`] numbers of keys.
pub(super) fn too_many_numbers() -> Fault {
    Fault::too_many(format_args!("{MAX_NUMBERS} numbers of keys"), "more")
}

fn read_channel(document: &Document, animation: &Animation, i: usize, property: Property) -> Result<Track> {
    let channel = &animation.channels[i];
    let (node, nodes) = (channel.target.node.value(), document.root.nodes.len());
    if node >= nodes {
        return Err(Fault::dangling("node", node, nodes).into()).within("target");
    }
    let (keys, output) = Keys::read(document, animation, channel.sampler)?;
    let values: Result<Vec<[f32; 4]>> = match property {
        Property::Rotation => document.numbers::<4>(output),
        _ => document.numbers::<3>(output).map(|v| v.into_iter().map(|[x, y, z]| [x, y, z, 0.0]).collect()),
    };
    let values = values.within("output")?;
    let (count, expected) = (keys.times.len(), keys.each() * keys.times.len());
    if values.len() != expected {
        let expected = format!("{expected} values for {count} keys");
        return Err(Fault::unexpected(expected, values.len()).into()).within("output");
    }
    Ok(Track { node, property, keys, values })
}

impl Track {
    /// The value of every key; the fourth component is used by rotations only.
    pub(super) fn key_values(&self) -> impl Iterator<Item = [f32; 4]> + '_ {
        (0..self.keys.times.len()).map(|key| self.values[self.keys.value_at(key)])
    }

    /// Whether it has a single key.
    pub(super) fn is_still(&self) -> bool {
        self.keys.times.len() == 1
    }

    /// The value of the property at a time, held before the first key and after the last. On a key, or within `near`
    /// seconds of one, it is the file's own numbers.
    pub(super) fn value(&self, time: f64, near: f64) -> [f64; 4] {
        let value = |i: usize| self.values[i].map(f64::from);
        let key = |i: usize| value(self.keys.value_at(i));
        let (i, t, span) = match self.keys.place(time, near) {
            Place::At(i) => return key(i),
            Place::After(i, t, span) => (i, t, span),
        };
        let (from, to) = (key(i), key(i + 1));
        match self.keys.interpolation {
            Interpolation::Step => from,
            Interpolation::Linear if self.property == Property::Rotation => {
                unit(DQuat::from_array(from)).slerp(unit(DQuat::from_array(to)), t).to_array()
            }
            Interpolation::Linear => std::array::from_fn(|n| from[n] + (to[n] - from[n]) * t),
            Interpolation::CubicSpline => {
                let (out, into) = (value(3 * i + 2), value(3 * i + 3));
                std::array::from_fn(|n| hermite(t, span, [from[n], out[n], into[n], to[n]]))
            }
        }
    }
}

/// Normalises a quaternion; the identity if it is too short.
pub(super) fn unit(q: DQuat) -> DQuat {
    let length = q.length();
    if length > 1e-6 { q * (1.0 / length) } else { DQuat::IDENTITY }
}

/// The time span and rate at which an animation is sampled.
pub(super) struct Timing {
    /// Seconds.
    pub(super) start: f64,
    /// Seconds.
    pub(super) end: f64,
    /// Frames a second.
    pub(super) rate: f64,
    /// Where the rate comes from.
    pub(super) found: Found,
    /// Number of frames, meant to be whole; not checked.
    pub(super) frames: f64,
}

impl Timing {
    /// From the first key to the last, or as long as our own files state; at the requested rate, else the stated one,
    /// else one at which all keys fall on frames, else [`FALLBACK_RATE`].
    pub(super) fn of(animation: &Animation, keys: &[&Keys], asked: Option<f64>) -> Self {
        let stated = stated(animation);
        let (start, end) = stated.map_or_else(|| span(keys), |(rate, frames)| (0.0, (frames - 1.0) / rate));
        let timing =
            |rate: f64, found| Self { start, end, rate, found, frames: 1.0 + ((end - start) * rate).round() };
        match (asked, stated) {
            (Some(rate), _) => timing(rate, Found::Asked),
            (None, Some((rate, frames))) => Self { frames, ..timing(rate, Found::File) },
            (None, None) => match rate(keys) {
                Some(rate) => timing(rate, Found::Detected),
                None => timing(FALLBACK_RATE, Found::Assumed),
            },
        }
    }
}

/// Frame rate and number of frames from the extras of our own files, which leave out redundant keys.
fn stated(animation: &Animation) -> Option<(f64, f64)> {
    let extras: Value = gltf_json::deserialize::from_str(animation.extras.as_ref()?.get()).ok()?;
    let number = |key: &str| extras.get("anthronet")?.get(key)?.as_f64();
    let (rate, frames) = (number("frames_per_second")?, number("frames")?);
    ((0.1..=1000.0).contains(&rate) && frames >= 1.0).then_some((rate, frames))
}

/// Times of the first and the last of all keys.
fn span(keys: &[&Keys]) -> (f64, f64) {
    let firsts = keys.iter().filter_map(|keys| keys.times.first());
    let lasts = keys.iter().filter_map(|keys| keys.times.last());
    (firsts.copied().fold(f64::INFINITY, f64::min), lasts.copied().fold(f64::NEG_INFINITY, f64::max))
}

/// The rate at which all keys fall on frames: that of the shortest interval, else the lowest usual one.
fn rate(keys: &[&Keys]) -> Option<f64> {
    let (start, _) = span(keys);
    let steps = keys.iter().flat_map(|keys| keys.times.windows(2).map(|pair| pair[1] - pair[0]));
    let shortest = steps.fold(f64::INFINITY, f64::min);
    // Keys further apart are poses to interpolate between, not frames.
    let even = Some(snapped_rate(1.0 / shortest)).filter(|rate| (10.0..=1000.0).contains(rate));
    even.into_iter().chain(USUAL_RATES).find(|rate| {
        keys.iter().flat_map(|keys| &keys.times).all(|time| {
            let frames = (time - start) * rate;
            (frames - frames.round()).abs() < ON_FRAME
        })
    })
}
