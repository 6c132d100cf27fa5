//! Decodes EXT_meshopt_compression with the reference implementation's decoder, which is made for untrusted input.

use gltf_json::{Buffer, Root, validation::USize64};
use serde::Deserialize;

use super::slice;
use crate::error::{Fault, GltfError, ParserError, Within};
use crate::format::gltf::Result;

pub(crate) const NAME: &str = "EXT_meshopt_compression";

/// Limit on the decoded bytes of all buffer views of a document.
const MAX_BYTES: usize = 1 << 30;
/// Upper bound of the codec's compression ratio, headers aside.
const MAX_RATIO: usize = 256;

/// The extension of a buffer view.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Compressed {
    buffer: usize,
    #[serde(default)]
    byte_offset: u64,
    byte_length: u64,
    byte_stride: usize,
    count: usize,
    mode: String,
    #[serde(default)]
    filter: Option<String>,
}

/// Whether a buffer is only a placeholder for decoded buffer views.
pub(crate) fn is_placeholder(buffer: &Buffer) -> bool {
    let extension = buffer.extensions.as_ref().and_then(|e| e.others.get(NAME));
    buffer.uri.is_none() && extension.is_some()
}

/// The decoded bytes of every compressed buffer view; `None` for the others.
pub(crate) fn decode_views(root: &Root, buffers: &[Vec<u8>]) -> Result<Vec<Option<Vec<u8>>>> {
    let mut left = MAX_BYTES;
    let mut views = Vec::new();
    for (i, view) in root.buffer_views.iter().enumerate() {
        let extension = view.extensions.as_ref().and_then(|e| e.others.get(NAME));
        let decoded = extension.map(|json| {
            let compressed = Compressed::deserialize(json).map_err(|e| ParserError::refused(e).into());
            compressed
                .and_then(|compressed| decode(&compressed, buffers, left))
                .within(format_args!("bufferViews[{i}].extensions.{NAME}"))
        });
        let decoded = decoded.transpose()?;
        left -= decoded.as_ref().map_or(0, Vec::len);
        views.push(decoded);
    }
    Ok(views)
}

fn decode(view: &Compressed, buffers: &[Vec<u8>], most: usize) -> Result<Vec<u8>> {
    let (offset, length) = (Some(USize64(view.byte_offset)), USize64(view.byte_length));
    let encoded = slice(buffers, view.buffer, offset, length)?;
    let &Compressed { count, byte_stride: stride, .. } = view;
    let size = count.checked_mul(stride).filter(|size| *size <= most);
    let size = size.ok_or_else(|| {
        Fault::too_many(format_args!("{most} bytes"), format_args!("{count} elements of {stride} bytes"))
    })?;
    if size / MAX_RATIO > encoded.len() {
        let found = format!("a stream of {}", encoded.len());
        return Err(Fault::truncated(format_args!("{size} bytes"), found).into());
    }
    let bad = |error: meshopt::Error| {
        let stream = format!("the {} bytes are not a valid stream of {}", encoded.len(), view.mode);
        GltfError::from(ParserError::refused(format_args!("{stream}: {error}")))
    };
    let filter = view.filter.as_deref().unwrap_or("NONE");
    if !matches!((filter, view.mode.as_str()), ("NONE", _) | ("EXPONENTIAL", "ATTRIBUTES")) {
        return Err(Fault::unsupported(format_args!("filter {filter} of mode {}", view.mode)).into());
    }
    match (view.mode.as_str(), stride) {
        ("TRIANGLES", 2 | 4) if count % 3 != 0 => {
            Err(Fault::unexpected("three corners per triangle", format_args!("{count} in all")).into())
        }
        ("TRIANGLES", 2) => meshopt::decode_index_buffer::<u16>(encoded, count).map_err(bad).map(le_u16),
        ("TRIANGLES", 4) => meshopt::decode_index_buffer::<u32>(encoded, count).map_err(bad).map(le_u32),
        ("INDICES", 2) => meshopt::decode_index_sequence::<u16>(encoded, count).map_err(bad).map(le_u16),
        ("INDICES", 4) => meshopt::decode_index_sequence::<u32>(encoded, count).map_err(bad).map(le_u32),
        ("ATTRIBUTES", 4) => vertices::<1>(encoded, count, filter).map_err(bad),
        ("ATTRIBUTES", 8) => vertices::<2>(encoded, count, filter).map_err(bad),
        ("ATTRIBUTES", 12) => vertices::<3>(encoded, count, filter).map_err(bad),
        ("ATTRIBUTES", 16) => vertices::<4>(encoded, count, filter).map_err(bad),
        ("ATTRIBUTES", 64) => vertices::<16>(encoded, count, filter).map_err(bad),
        (mode, _) => {
            Err(Fault::unsupported(format_args!("mode {mode} with a byteStride of {stride}")).into())
        }
    }
}

/// Elements of `N` 32-bit words, whose bytes have the same order in memory as in the file.
fn vertices<const N: usize>(encoded: &[u8], count: usize, filter: &str) -> meshopt::Result<Vec<u8>>
where
    [u32; N]: Default + bytemuck::Pod,
{
    let mut rows = meshopt::decode_vertex_buffer::<[u32; N]>(encoded, count)?;
    if filter == "EXPONENTIAL" {
        meshopt::decode_filter_exp(&mut rows);
    }
    Ok(bytemuck::cast_slice(&rows).to_vec())
}

#[expect(clippy::needless_pass_by_value, reason = "for map")]
fn le_u16(indices: Vec<u16>) -> Vec<u8> {
    indices.iter().flat_map(|i| i.to_le_bytes()).collect()
}

#[expect(clippy::needless_pass_by_value, reason = "for map")]
fn le_u32(indices: Vec<u32>) -> Vec<u8> {
    indices.iter().flat_map(|i| i.to_le_bytes()).collect()
}
