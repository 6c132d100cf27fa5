//! Offsets of morph targets: accessors of vectors that may say only which of them are not zero (glTF 2.0, section 3.6.2.3).

use gltf_json::accessor::sparse::Sparse;
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index};

use super::{Document, slice};
use crate::error::Outcome;
use crate::format::limits::MAX_ELEMENTS;

impl Document {
    /// An accessor of `count` finite `f32` vectors, dense or sparse.
    pub(in crate::format::gltf) fn offsets(
        &self,
        index: Index<Accessor>,
        count: usize,
    ) -> Outcome<Vec<[f32; 3]>> {
        let accessor: Option<&Accessor> = self.root.get(index);
        let accessor = accessor.ok_or_else(|| format!("accessor {} does not exist", index.value()))?;
        if accessor.count.0 != count as u64 {
            return Err(format!("expected {count} of them, got {}", accessor.count.0));
        }
        let rows = match &accessor.sparse {
            None => return Ok(self.vectors(index)?.iter().map(glam::Vec3::to_array).collect()),
            Some(sparse) => self.sparse(accessor, sparse, count),
        };
        rows.map_err(|message| format!("accessor {}: {message}", index.value()))
    }

    fn sparse(&self, accessor: &Accessor, sparse: &Sparse, count: usize) -> Outcome<Vec<[f32; 3]>> {
        let is_f32 = matches!(accessor.component_type, Checked::Valid(c) if c.0 == ComponentType::F32);
        if accessor.type_ != Checked::Valid(Type::Vec3) || !is_f32 {
            return Err("is not of f32 vectors".into());
        }
        // Those that are not named have to be zero: a base of others is unheard of among offsets.
        if accessor.buffer_view.is_some() {
            return Err("is sparse over a buffer view, which is not supported".into());
        }
        let width = match sparse.indices.component_type {
            Checked::Valid(kind) => kind.0.size(),
            Checked::Invalid => return Err("sparse.indices have an unknown component type".into()),
        };
        let named = usize::try_from(sparse.count.0).ok().filter(|named| *named <= count.min(MAX_ELEMENTS));
        let named = named.ok_or_else(|| format!("sparse.count: {} of {count}", sparse.count.0))?;
        let (indices, values) = (&sparse.indices, &sparse.values);
        let places = self.bytes(indices.buffer_view.value(), indices.byte_offset.0, named * width);
        let places = places.map_err(|m| format!("sparse.indices: {m}"))?;
        let values = self.bytes(values.buffer_view.value(), values.byte_offset.0, named * 12);
        let values = values.map_err(|m| format!("sparse.values: {m}"))?;
        let mut rows = vec![[0.0; 3]; count];
        for (place, value) in places.chunks_exact(width).zip(values.as_chunks::<12>().0) {
            let place = place.iter().rev().fold(0_usize, |word, byte| word << 8 | usize::from(*byte));
            let (numbers, _) = value.as_chunks::<4>();
            let row: [f32; 3] = std::array::from_fn(|axis| f32::from_le_bytes(numbers[axis]));
            if !row.iter().all(|v| v.is_finite()) {
                return Err(format!("element {place} is not finite: {row:?}"));
            }
            *rows.get_mut(place).ok_or_else(|| format!("sparse.indices: {place} of {count}"))? = row;
        }
        Ok(rows)
    }

    /// So many bytes of a buffer view from an offset.
    fn bytes(&self, view: usize, offset: u64, length: usize) -> Outcome<&[u8]> {
        let found = self.root.buffer_views.get(view).ok_or("bufferView does not exist")?;
        let bytes = match self.decoded.get(view) {
            Some(Some(decoded)) => decoded.as_slice(),
            _ => slice(&self.buffers, found.buffer.value(), found.byte_offset, found.byte_length)?,
        };
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let bytes = bytes.get(start..).and_then(|rest| rest.get(..length));
        bytes.ok_or_else(|| "reaches beyond its bufferView".into())
    }
}
