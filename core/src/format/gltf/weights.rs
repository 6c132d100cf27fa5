//! Keys of the weights of a node's morph targets (glTF 2.0, section 3.11).

use gltf_json::animation::{Interpolation, Property, Sampler};
use gltf_json::validation::Checked;
use gltf_json::{Animation, Index};

use super::animation::{Keys, Place, hermite, too_many_numbers};
use super::document::Document;
use crate::error::{Fault, Within};
use crate::format::gltf::Result;

/// Keys of the morph target weights of one node.
pub(super) struct WeightKeys {
    pub(super) node: usize,
    /// How many morph targets the node's mesh has, at least one.
    pub(super) targets: usize,
    pub(super) keys: Keys,
    /// Per key, one weight for each target; for splines, those of in-tangent, value and out-tangent in turn.
    values: Vec<f32>,
}

/// The weight channels of an animation. `left` is the document's remaining budget of numbers.
pub(super) fn read(document: &Document, animation: &Animation, left: &mut usize) -> Result<Vec<WeightKeys>> {
    let mut read = Vec::new();
    for (i, channel) in animation.channels.iter().enumerate() {
        if channel.target.path != Checked::Valid(Property::MorphTargetWeights) {
            continue;
        }
        let node = channel.target.node.value();
        let of_mesh = document.root.nodes.get(node).and_then(|node| document.root.get(node.mesh?));
        let primitive = of_mesh.and_then(|mesh| mesh.primitives.first());
        let targets = primitive.and_then(|primitive| primitive.targets.as_ref()).map_or(0, Vec::len);
        if targets == 0 {
            // Weights without targets have no effect.
            continue;
        }
        let track = read_channel(document, animation, channel.sampler, targets);
        let (keys, values) = track.within(format_args!("channels[{i}]"))?;
        *left = left.checked_sub(values.len()).ok_or_else(too_many_numbers)?;
        read.push(WeightKeys { node, targets, keys, values });
    }
    Ok(read)
}

/// Keys and weights of a sampler for a mesh with this many targets.
fn read_channel(
    document: &Document,
    animation: &Animation,
    sampler: Index<Sampler>,
    targets: usize,
) -> Result<(Keys, Vec<f32>)> {
    let (keys, output) = Keys::read(document, animation, sampler)?;
    let values = document.numbers::<1>(output).within("output")?;
    let expected = keys.each() * keys.times.len() * targets;
    if values.len() != expected {
        let expected = format!("{expected} weights of {targets} targets for {} keys", keys.times.len());
        return Err(Fault::unexpected(expected, values.len()).into()).within("output");
    }
    Ok((keys, values.into_iter().flatten().collect()))
}

impl WeightKeys {
    /// The weight of a target at a time; on a key, or within `near` seconds of one, the file's own number.
    pub(super) fn value(&self, target: usize, time: f64, near: f64) -> f32 {
        let value = |i: usize| self.values[i * self.targets + target];
        let key = |i: usize| value(self.keys.value_at(i));
        let (i, t, span) = match self.keys.place(time, near) {
            Place::At(i) => return key(i),
            Place::After(i, t, span) => (i, t, span),
        };
        let (from, to) = (f64::from(key(i)), f64::from(key(i + 1)));
        let between = match self.keys.interpolation {
            Interpolation::Step => from,
            Interpolation::Linear => from + (to - from) * t,
            Interpolation::CubicSpline => {
                let [out, into] = [3 * i + 2, 3 * i + 3].map(|i| f64::from(value(i)));
                hermite(t, span, [from, out, into, to])
            }
        };
        between as f32
    }
}
