//! Offsets of morph targets: accessors of vectors, which may be sparse (glTF 2.0, section 3.6.2.3).

use gltf_json::accessor::sparse::Sparse;
use gltf_json::accessor::{ComponentType, Type};
use gltf_json::validation::Checked;
use gltf_json::{Accessor, Index};

use super::{Document, named, unknown_component, wrong_type};
use crate::error::{Fault, Within};
use crate::format::gltf::Result;
use crate::format::limits::MAX_ELEMENTS;

impl Document {
    /// An accessor of `count` finite `f32` vectors, dense or sparse.
    pub(in crate::format::gltf) fn offsets(
        &self,
        index: Index<Accessor>,
        count: usize,
    ) -> Result<Vec<[f32; 3]>> {
        let accessor: Option<&Accessor> = self.root.get(index);
        let accessor =
            accessor.ok_or_else(|| Fault::dangling("accessor", index.value(), self.root.accessors.len()))?;
        if accessor.count.0 != count as u64 {
            return Err(Fault::unexpected(format_args!("{count} of them"), accessor.count.0).into());
        }
        match &accessor.sparse {
            None => Ok(self.vectors(index)?.iter().map(glam::Vec3::to_array).collect()),
            Some(sparse) => self.sparse(accessor, sparse, count).within(named(index)),
        }
    }

    fn sparse(&self, accessor: &Accessor, sparse: &Sparse, count: usize) -> Result<Vec<[f32; 3]>> {
        let Checked::Valid(component) = accessor.component_type else { return Err(unknown_component()) };
        if accessor.type_ != Checked::Valid(Type::Vec3) || component.0 != ComponentType::F32 {
            return Err(wrong_type("f32 vectors", accessor, component.0));
        }
        // Elements that are not listed must be zero: sparse offsets over a dense base do not occur in practice.
        if accessor.buffer_view.is_some() {
            return Err(Fault::unsupported("sparse over a bufferView").into());
        }
        let width = match sparse.indices.component_type {
            Checked::Valid(kind) => kind.0.size(),
            Checked::Invalid => return Err(unknown_component()).within("sparse.indices"),
        };
        let named = usize::try_from(sparse.count.0).ok().filter(|named| *named <= count.min(MAX_ELEMENTS));
        let named = named.ok_or_else(|| Fault::too_many(format_args!("{count} elements"), sparse.count.0))?;
        let (indices, values) = (&sparse.indices, &sparse.values);
        let places = self
            .bytes(indices.buffer_view.value(), indices.byte_offset.0, named * width)
            .within("sparse.indices")?;
        let values = self
            .bytes(values.buffer_view.value(), values.byte_offset.0, named * 12)
            .within("sparse.values")?;
        let mut rows = vec![[0.0; 3]; count];
        for (place, value) in places.chunks_exact(width).zip(values.as_chunks::<12>().0) {
            let place = place.iter().rev().fold(0_usize, |word, byte| word << 8 | usize::from(*byte));
            let (numbers, _) = value.as_chunks::<4>();
            let row: [f32; 3] = std::array::from_fn(|axis| f32::from_le_bytes(numbers[axis]));
            if !row.iter().all(|v| v.is_finite()) {
                let element = format!("element {place}");
                return Err(Fault::not_finite(element, format_args!("{row:?}")).into());
            }
            *rows.get_mut(place).ok_or_else(|| Fault::dangling("element", place, count))? = row;
        }
        Ok(rows)
    }

    /// `length` bytes of a buffer view from an offset.
    fn bytes(&self, view: usize, offset: u64, length: usize) -> Result<&[u8]> {
        let view = self.view(view)?;
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let bytes = view.get(start..).and_then(|rest| rest.get(..length));
        bytes.ok_or_else(|| {
            let found = format!("a bufferView of {}", view.len());
            Fault::truncated(format_args!("{length} bytes from byte {start}"), found).into()
        })
    }
}
