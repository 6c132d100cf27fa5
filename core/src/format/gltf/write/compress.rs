//! EXT_meshopt_compression, with the reference implementation's encoder.
//!
//! Every buffer view is encoded separately. Floating-point geometry and motion go through the EXPONENTIAL filter:
//! integers times one power of two per component, still `f32` for readers, so that no other extension is needed. Key
//! times, morph target weights, inverse bind matrices and joint indices stay exact. Triangles keep their order, but the
//! codec may rotate the corners of a triangle. The views refer to a placeholder buffer: a reader needs the extension.

use gltf_json::{
    Buffer, Index, Value,
    animation::Property,
    buffer::Target,
    extensions,
    mesh::Semantic,
    validation::{Checked, USize64},
};
use meshopt::EncodeExpMode;
use serde_json::{Map, json};

use super::accessor::DocumentBuilder;
use crate::{Error, Result};

const NAME: &str = "EXT_meshopt_compression";

/// Bits of the signed mantissa; the largest value of a component uses them all: up to 2 m, a step is 2⁻²⁰ m.
const POSITION_BITS: i32 = 22;
/// Steps of 2⁻²⁰.
const UNIT_BITS: i32 = 22;
/// Steps of 2⁻¹³.
const NORMAL_BITS: i32 = 15;
/// Steps of 2⁻¹⁵.
const TEXTURE_BITS: i32 = 17;

/// Encodes all buffer views into the builder's buffer, which becomes buffer 0; [`placeholder`] must be buffer 1.
pub(super) fn compress(builder: &mut DocumentBuilder) -> Result<()> {
    let bits = filter_bits(builder);
    let mut compressed = Vec::new();
    for (i, bits) in bits.into_iter().enumerate() {
        let Some(accessor) = builder.root.accessors.get_mut(i) else { continue };
        let view = accessor.buffer_view.and_then(|view| builder.root.buffer_views.get_mut(view.value()));
        let Some(view) = view else { continue };
        let start = view.byte_offset.unwrap_or_default().0 as usize;
        let bytes = builder.bin.get(start..start + view.byte_length.0 as usize).unwrap_or_default();
        let count = accessor.count.0 as usize;
        let stride = bytes.len() / count.max(1);
        let indices = view.target == Some(Checked::Valid(Target::ElementArrayBuffer));
        let mut bounds = None;
        let encoded = match (indices, stride, bits) {
            (true, ..) => {
                let wide = bytes
                    .chunks_exact(stride)
                    .map(|b| b.iter().rev().fold(0u32, |word, byte| word << 8 | u32::from(*byte)));
                let wide: Vec<u32> = wide.collect();
                let vertices = wide.iter().max().map_or(0, |v| *v as usize + 1);
                meshopt::encode_index_buffer(&wide, vertices).map_err(fault)?
            }
            (_, 8, Some(bits)) => filtered::<2>(bytes, bits, &mut bounds)?,
            (_, 12, Some(bits)) => filtered::<3>(bytes, bits, &mut bounds)?,
            (_, 16, Some(bits)) => filtered::<4>(bytes, bits, &mut bounds)?,
            (_, 4, _) => exact::<4>(bytes)?,
            (_, 8, _) => exact::<8>(bytes)?,
            (_, 16, _) => exact::<16>(bytes)?,
            (_, 64, _) => exact::<64>(bytes)?,
            _ => return Err(Error::invalid("scene", format!("accessor {i}: {stride} bytes an element"))),
        };
        if let (Some((min, max)), true) = (bounds, accessor.min.is_some()) {
            (accessor.min, accessor.max) = (Some(min), Some(max));
        }
        let mut extension = json!({
            "buffer": 0,
            "byteOffset": compressed.len(),
            "byteLength": encoded.len(),
            "byteStride": stride,
            "count": count,
            "mode": if indices { "TRIANGLES" } else { "ATTRIBUTES" },
        });
        if bits.is_some() {
            extension["filter"] = "EXPONENTIAL".into();
        }
        view.buffer = Index::new(1);
        let others = Map::from_iter([(NAME.to_owned(), extension)]);
        view.extensions = Some(extensions::buffer::View { others });
        compressed.extend(encoded);
        compressed.resize(compressed.len().next_multiple_of(4), 0);
    }
    builder.bin = compressed;
    builder.root.extensions_used.insert(0, NAME.into());
    builder.root.extensions_required.push(NAME.into());
    Ok(())
}

/// The placeholder buffer that the views refer to, which a reader fills by decoding.
pub(super) fn placeholder(byte_length: usize) -> Buffer {
    let others = Map::from_iter([(NAME.to_owned(), json!({"fallback": true}))]);
    Buffer {
        byte_length: USize64::from(byte_length),
        name: None,
        uri: None,
        extensions: Some(extensions::buffer::Buffer { others }),
        extras: None,
    }
}

/// Bits to which each accessor's numbers are rounded; `None` keeps them exact.
fn filter_bits(builder: &DocumentBuilder) -> Vec<Option<i32>> {
    let root = &builder.root;
    let mut bits = vec![None; root.accessors.len()];
    for primitive in root.meshes.iter().flat_map(|m| &m.primitives) {
        for (semantic, accessor) in &primitive.attributes {
            if let Some(bits) = bits.get_mut(accessor.value()) {
                *bits = match semantic {
                    Checked::Valid(Semantic::Positions) => Some(POSITION_BITS),
                    Checked::Valid(Semantic::Normals) => Some(NORMAL_BITS),
                    Checked::Valid(Semantic::TexCoords(_)) => Some(TEXTURE_BITS),
                    Checked::Valid(Semantic::Weights(_)) => Some(UNIT_BITS),
                    _ => None,
                };
            }
        }
        for target in primitive.targets.iter().flatten() {
            for (accessor, rounded_to) in [(target.positions, POSITION_BITS), (target.normals, NORMAL_BITS)] {
                if let Some(bits) = accessor.and_then(|accessor| bits.get_mut(accessor.value())) {
                    *bits = Some(rounded_to);
                }
            }
        }
    }
    for animation in &root.animations {
        for channel in &animation.channels {
            let sampler = animation.samplers.get(channel.sampler.value());
            if let Some(bits) = sampler.and_then(|s| bits.get_mut(s.output.value())) {
                *bits = match channel.target.path {
                    Checked::Valid(Property::Rotation) => Some(UNIT_BITS),
                    // Few numbers, in rows that the filter does not support.
                    Checked::Valid(Property::MorphTargetWeights) => None,
                    _ => Some(POSITION_BITS),
                };
            }
        }
    }
    bits
}

/// Encodes rows of `N` bytes unchanged.
fn exact<const N: usize>(bytes: &[u8]) -> Result<Vec<u8>> {
    let (rows, _) = bytes.as_chunks::<N>();
    encode_vertices(rows)
}

/// Encodes rows of `N` numbers, rounded; `bounds` gets the minimum and maximum of each component after decoding.
fn filtered<const N: usize>(bytes: &[u8], bits: i32, bounds: &mut Option<(Value, Value)>) -> Result<Vec<u8>> {
    let numbers: Vec<f32> = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
    let (rows, _) = numbers.as_chunks::<N>();
    let rounded = meshopt::encode_filter_exp(rows, bits, EncodeExpMode::SharedComponent);
    let encoded = encode_vertices(&rounded)?;
    let mut decoded = rounded;
    meshopt::decode_filter_exp(&mut decoded);
    let bound = |pick: fn(f32, f32) -> f32| {
        let rows = decoded.iter().map(|row| row.map(f32::from_bits));
        let bound = rows.reduce(|a, b| std::array::from_fn(|i| pick(a[i], b[i]))).unwrap_or([0.0; N]);
        Value::from(bound.map(f64::from).to_vec())
    };
    *bounds = Some((bound(f32::min), bound(f32::max)));
    Ok(encoded)
}

fn encode_vertices<T>(rows: &[T]) -> Result<Vec<u8>> {
    // The extension supports version 0 only.
    meshopt::encode_vertex_buffer_level(rows, 2, Some(0)).map_err(fault)
}

#[expect(clippy::needless_pass_by_value, reason = "for map_err")]
fn fault(error: meshopt::Error) -> Error {
    Error::invalid("scene", format!("cannot be compressed: {error}"))
}
