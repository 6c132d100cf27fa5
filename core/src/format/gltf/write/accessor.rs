//! A glTF document under construction: the JSON root and its one binary buffer (glTF 2.0, section 3.6).

use gltf_json::{
    Accessor, Index, Root,
    accessor::{ComponentType, GenericComponentType, Type},
    buffer::{Target, View},
    validation::{Checked, USize64},
};

/// What a buffer view is used for, which glTF records as its target.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Usage {
    /// One element per vertex.
    Vertices,
    /// Triangle corners.
    Indices,
    /// Neither, such as inverse bind matrices.
    Other,
}

/// A component type of accessors.
pub(crate) trait Component: Copy {
    const TYPE: ComponentType;
    fn put(self, out: &mut Vec<u8>);
}

macro_rules! component {
    ($($number:ty => $name:ident),*) => {$(
        impl Component for $number {
            const TYPE: ComponentType = ComponentType::$name;
            fn put(self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_le_bytes());
            }
        }
    )*};
}
component!(u8 => U8, u16 => U16, u32 => U32, f32 => F32);

/// The document so far. Every accessor gets a buffer view of its own, tightly packed and 4-byte aligned.
#[derive(Default)]
pub(crate) struct DocumentBuilder {
    pub(crate) root: Root,
    pub(crate) bin: Vec<u8>,
}

impl DocumentBuilder {
    /// Appends `rows` of `N` components as an accessor: a scalar, vector or 4×4 matrix for `N` = 1, 2 to 4 or 16.
    pub(crate) fn push_accessor<T: Component, const N: usize>(
        &mut self,
        rows: impl IntoIterator<Item = [T; N]>,
        usage: Usage,
    ) -> Index<Accessor> {
        // The previous view ends on a multiple of four.
        let start = self.bin.len();
        for row in rows {
            row.into_iter().for_each(|component| component.put(&mut self.bin));
        }
        let bytes = self.bin.len() - start;
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let view = self.root.push(View {
            buffer: Index::new(0),
            byte_length: USize64::from(bytes),
            byte_offset: Some(USize64::from(start)),
            byte_stride: None,
            name: None,
            target: match usage {
                Usage::Vertices => Some(Checked::Valid(Target::ArrayBuffer)),
                Usage::Indices => Some(Checked::Valid(Target::ElementArrayBuffer)),
                Usage::Other => None,
            },
            extensions: None,
            extras: None,
        });
        self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(bytes / (N * size_of::<T>())),
            component_type: Checked::Valid(GenericComponentType(T::TYPE)),
            extensions: None,
            extras: None,
            type_: Checked::Valid(match N {
                1 => Type::Scalar,
                2 => Type::Vec2,
                3 => Type::Vec3,
                4 => Type::Vec4,
                _ => Type::Mat4,
            }),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
        })
    }

    /// Appends vertex positions with the bounds that glTF requires of them.
    pub(crate) fn push_positions(&mut self, rows: &[[f32; 3]]) -> Index<Accessor> {
        let index = self.push_accessor(rows.iter().copied(), Usage::Vertices);
        let bound = |pick: fn(f32, f32) -> f32| {
            let first = rows.first().copied().unwrap_or_default();
            let bound = rows.iter().fold(first, |a, b| std::array::from_fn(|axis| pick(a[axis], b[axis])));
            // As f64, so that the decimal number in the JSON equals the stored one exactly.
            gltf_json::Value::from(bound.map(f64::from).to_vec())
        };
        let (min, max) = (bound(f32::min), bound(f32::max));
        if let Some(accessor) = self.root.accessors.get_mut(index.value()) {
            (accessor.min, accessor.max) = (Some(min), Some(max));
        }
        index
    }
}
