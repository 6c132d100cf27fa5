//! A glTF document and the bytes that it refers to. The JSON is read into `gltf-json`'s types; the data behind them is
//! fetched here, every offset and size checked against what is there, and not by a general loader, which trusts the
//! document.

mod meshopt;
mod offsets;
mod uri;

use std::path::Path;

use glam::{Affine3A, Mat4, Vec3};
use gltf_json::{
    Accessor, Index, Node, Root,
    accessor::{ComponentType, Type},
    validation::{Checked, USize64},
};

use crate::error::Outcome;
use crate::format::limits::MAX_ELEMENTS;
use crate::math::Rotation;
use crate::{Error, Result};

/// Required extensions that change no geometry.
const HARMLESS_EXTENSIONS: [&str; 3] = ["KHR_materials_", "KHR_texture_", "KHR_lights_"];

/// A document and its data.
pub(crate) struct Document {
    pub(crate) root: Root,
    buffers: Vec<Vec<u8>>,
    /// What compressed buffer views hold; `None` for the others.
    decoded: Vec<Option<Vec<u8>>>,
}

/// The nodes as trees.
pub(crate) struct Tree {
    pub(crate) parents: Vec<Option<usize>>,
    /// All nodes, each after its parent, and every subtree together.
    pub(crate) order: Vec<usize>,
}

impl Document {
    /// The document of a `.glb` or `.gltf`. Buffers of a `.gltf` are looked for beside `path`.
    pub(crate) fn open(bytes: &[u8], path: &Path) -> Result<Self> {
        let fault = |message: String| Error::file(path, message);
        let (json, chunk) =
            if bytes.starts_with(b"glTF") { split_glb(bytes).map_err(fault)? } else { (bytes, None) };
        let root: Root = gltf_json::deserialize::from_slice(json)
            .map_err(|e| fault(format!("is neither a binary glTF nor valid glTF JSON: {e}")))?;
        if !root.asset.version.starts_with("2.") {
            return Err(fault(format!("asset.version: expected 2.x, got `{}`", root.asset.version)));
        }
        let unknown = |name: &&String| {
            *name != meshopt::NAME && !HARMLESS_EXTENSIONS.iter().any(|prefix| name.starts_with(prefix))
        };
        if let Some(name) = root.extensions_required.iter().find(unknown) {
            return Err(fault(format!("extensionsRequired: {name} is not supported")));
        }
        let mut buffers = Vec::new();
        for (i, buffer) in root.buffers.iter().enumerate() {
            let data = match &buffer.uri {
                _ if meshopt::is_placeholder(buffer) => {
                    buffers.push(Vec::new());
                    continue;
                }
                Some(uri) => uri::load(uri, path)
                    .map_err(|e| e.unwrap_or_else(|m| fault(format!("buffers[{i}].uri: {m}"))))?,
                None => chunk.filter(|_| i == 0).map(<[u8]>::to_vec).ok_or_else(|| {
                    fault(format!("buffers[{i}]: expected a uri, as the file holds no binary chunk for it"))
                })?,
            };
            if (data.len() as u64) < buffer.byte_length.0 {
                let (expected, came) = (buffer.byte_length.0, data.len());
                return Err(fault(format!("buffers[{i}]: expected {expected} bytes, got {came}")));
            }
            buffers.push(data);
        }
        let decoded = meshopt::decode_views(&root, &buffers).map_err(fault)?;
        Ok(Self { root, buffers, decoded })
    }

    /// The nodes' hierarchy.
    pub(crate) fn tree(&self) -> Outcome<Tree> {
        let nodes = &self.root.nodes;
        let mut parents = vec![None; nodes.len()];
        for (i, node) in nodes.iter().enumerate() {
            for child in node.children.iter().flatten() {
                match parents.get_mut(child.value()) {
                    None => return Err(format!("nodes[{i}].children: {} of {}", child.value(), nodes.len())),
                    Some(Some(_)) => return Err(format!("nodes[{}] has two parents", child.value())),
                    Some(parent) => *parent = Some(i),
                }
            }
        }
        // From the roots down; what is never reached hangs in a ring.
        let mut order = Vec::with_capacity(nodes.len());
        let mut open: Vec<usize> = (0..nodes.len()).rev().filter(|i| parents[*i].is_none()).collect();
        while let Some(i) = open.pop() {
            order.push(i);
            open.extend(nodes[i].children.iter().flatten().rev().map(Index::value));
        }
        if order.len() < nodes.len() {
            let mut reached = vec![false; nodes.len()];
            order.iter().for_each(|i| reached[*i] = true);
            let ring = reached.iter().position(|reached| !reached).unwrap_or_default();
            return Err(format!("nodes[{ring}] is its own ancestor"));
        }
        Ok(Tree { parents, order })
    }

    /// The transform from every node's space to that of the scene.
    pub(crate) fn world_from_nodes(&self, tree: &Tree) -> Vec<Affine3A> {
        let mut world = vec![Affine3A::IDENTITY; self.root.nodes.len()];
        for &i in &tree.order {
            let parent = tree.parents[i].map_or(Affine3A::IDENTITY, |parent| world[parent]);
            world[i] = parent * local_transform(&self.root.nodes[i]);
        }
        world
    }

    /// An accessor of finite `f32` vectors.
    pub(crate) fn vectors(&self, index: Index<Accessor>) -> Outcome<Vec<Vec3>> {
        let (accessor, component) = self.accessor(index)?;
        if accessor.type_ != Checked::Valid(Type::Vec3) || component != ComponentType::F32 {
            return Err(format!("accessor {} is not of f32 vectors", index.value()));
        }
        let mut vectors = Vec::new();
        for (i, bytes) in self.elements(index, accessor, 12)?.enumerate() {
            let (numbers, _) = bytes.as_chunks::<4>();
            let vector = Vec3::from_slice(
                &[0, 1, 2].map(|axis| numbers.get(axis).map_or(f32::NAN, |b| f32::from_le_bytes(*b))),
            );
            if !vector.is_finite() {
                return Err(format!("element {i} is not finite: {vector}"));
            }
            vectors.push(vector);
        }
        Ok(vectors)
    }

    /// An accessor of finite rows of `N` numbers: `f32`, or integers that stand for fractions.
    pub(crate) fn numbers<const N: usize>(&self, index: Index<Accessor>) -> Outcome<Vec<[f32; N]>> {
        let (accessor, component) = self.accessor(index)?;
        let fraction = component != ComponentType::F32;
        if multiplicity(accessor) != Some(N) || fraction != accessor.normalized {
            let wanted = "numbers or normalised integers";
            return Err(format!("accessor {} is not of rows of {N} {wanted}", index.value()));
        }
        let size = component.size();
        let number = |bytes: &[u8]| match (component, bytes) {
            (ComponentType::F32, &[a, b, c, d]) => f32::from_le_bytes([a, b, c, d]),
            (ComponentType::U8, &[a]) => f32::from(a) / 255.0,
            (ComponentType::I8, &[a]) => (f32::from(a as i8) / 127.0).max(-1.0),
            (ComponentType::U16, &[a, b]) => f32::from(u16::from_le_bytes([a, b])) / 65535.0,
            (ComponentType::I16, &[a, b]) => (f32::from(i16::from_le_bytes([a, b])) / 32767.0).max(-1.0),
            _ => f32::NAN,
        };
        let mut rows = Vec::new();
        for (i, bytes) in self.elements(index, accessor, N * size)?.enumerate() {
            let row =
                std::array::from_fn(|n| number(bytes.get(n * size..(n + 1) * size).unwrap_or_default()));
            if !row.iter().all(|value| value.is_finite()) {
                return Err(format!("element {i} is not finite: {row:?}"));
            }
            rows.push(row);
        }
        Ok(rows)
    }

    /// An accessor of rows of four small unsigned integers.
    pub(crate) fn quadruples(&self, index: Index<Accessor>) -> Outcome<Vec<[u16; 4]>> {
        let (accessor, component) = self.accessor(index)?;
        let size = component.size();
        let unsigned = matches!(component, ComponentType::U8 | ComponentType::U16);
        if multiplicity(accessor) != Some(4) || !unsigned {
            return Err(format!("accessor {} is not of rows of four u8 or u16", index.value()));
        }
        let number = |bytes: &[u8]| bytes.iter().rev().fold(0, |word, byte| word << 8 | u16::from(*byte));
        let rows = self.elements(index, accessor, 4 * size)?;
        let row = |bytes: &[u8]| {
            std::array::from_fn(|n| number(bytes.get(n * size..(n + 1) * size).unwrap_or_default()))
        };
        Ok(rows.map(row).collect())
    }

    /// An accessor of indices, each below `limit`.
    pub(crate) fn indices(&self, index: Index<Accessor>, limit: usize) -> Outcome<Vec<u32>> {
        let (accessor, component) = self.accessor(index)?;
        let width = match component {
            ComponentType::U8 => 1,
            ComponentType::U16 => 2,
            ComponentType::U32 => 4,
            _ => 0,
        };
        if accessor.type_ != Checked::Valid(Type::Scalar) || width == 0 {
            return Err(format!("accessor {} is not of unsigned integers", index.value()));
        }
        let mut indices = Vec::new();
        for (i, bytes) in self.elements(index, accessor, width)?.enumerate() {
            let corner = bytes.iter().rev().fold(0u32, |word, byte| word << 8 | u32::from(*byte));
            if corner as usize >= limit {
                return Err(format!("element {i} is {corner}, of {limit} vertices"));
            }
            indices.push(corner);
        }
        Ok(indices)
    }

    pub(crate) fn accessor(&self, index: Index<Accessor>) -> Outcome<(&Accessor, ComponentType)> {
        let accessor: Option<&Accessor> = self.root.get(index);
        let accessor =
            accessor.ok_or_else(|| format!("accessor {} of {}", index.value(), self.root.accessors.len()))?;
        if accessor.sparse.is_some() {
            return Err(format!("accessor {} is sparse, which is not supported", index.value()));
        }
        match accessor.component_type {
            Checked::Valid(component) => Ok((accessor, component.0)),
            Checked::Invalid => Err(format!("accessor {} has an unknown component type", index.value())),
        }
    }

    /// The bytes of every element, `width` each, after checking that all of them are there.
    pub(crate) fn elements(
        &self,
        index: Index<Accessor>,
        accessor: &Accessor,
        width: usize,
    ) -> Outcome<impl Iterator<Item = &[u8]>> {
        let fault = |message: &str| format!("accessor {}: {message}", index.value());
        let size = |value: u64| usize::try_from(value).map_err(|_| fault("is too large"));
        let place = accessor.buffer_view.ok_or_else(|| fault("has no bufferView"))?;
        let view = self.root.get(place).ok_or_else(|| fault("bufferView does not exist"))?;
        let view = match self.decoded.get(place.value()) {
            Some(Some(decoded)) => decoded.as_slice(),
            _ => slice(&self.buffers, view.buffer.value(), view.byte_offset, view.byte_length)
                .map_err(|m| fault(&m))?,
        };
        let stride = self.stride(accessor).unwrap_or(width);
        if stride < width {
            return Err(fault("byteStride is smaller than an element"));
        }
        let (start, count) = (size(accessor.byte_offset.unwrap_or_default().0)?, size(accessor.count.0)?);
        if count > MAX_ELEMENTS * 3 {
            return Err(fault(&format!("count {count} is beyond {}", MAX_ELEMENTS * 3)));
        }
        // The last element need not fill its stride.
        let end = count
            .checked_sub(1)
            .and_then(|last| last.checked_mul(stride)?.checked_add(width)?.checked_add(start));
        if count > 0 && end.is_none_or(|end| end > view.len()) {
            return Err(fault(&format!(
                "count {count} reaches beyond the {} bytes of its bufferView",
                view.len()
            )));
        }
        Ok((0..count).map(move |i| {
            view.get(start + i * stride..).and_then(|rest| rest.get(..width)).unwrap_or_default()
        }))
    }

    fn stride(&self, accessor: &Accessor) -> Option<usize> {
        self.root.get(accessor.buffer_view?)?.byte_stride.map(|stride| stride.0)
    }
}

/// Numbers per element.
fn multiplicity(accessor: &Accessor) -> Option<usize> {
    match accessor.type_ {
        // Its columns are padded for small numbers, which nothing here reads.
        Checked::Valid(Type::Mat2 | Type::Mat3) | Checked::Invalid => None,
        Checked::Valid(kind) => Some(kind.multiplicity()),
    }
}

/// The bytes of a buffer that a view speaks of.
pub(crate) fn slice(
    buffers: &[Vec<u8>],
    buffer: usize,
    offset: Option<USize64>,
    length: USize64,
) -> Outcome<&[u8]> {
    let buffer = buffers.get(buffer).ok_or("buffer does not exist")?;
    let start = usize::try_from(offset.unwrap_or_default().0).unwrap_or(usize::MAX);
    let length = usize::try_from(length.0).unwrap_or(usize::MAX);
    let bytes = buffer.get(start..).and_then(|rest| rest.get(..length));
    bytes.ok_or_else(|| "bufferView reaches beyond its buffer".into())
}

/// A node's transform to its parent.
pub(crate) fn local_transform(node: &Node) -> Affine3A {
    if let Some(matrix) = node.matrix {
        return Affine3A::from_mat4(Mat4::from_cols_array(&matrix));
    }
    Affine3A::from_scale_rotation_translation(
        node.scale.map_or(Vec3::ONE, Vec3::from),
        node.rotation.map_or(Rotation::IDENTITY, |rotation| Rotation::from_array(rotation.0)).into(),
        node.translation.map_or(Vec3::ZERO, Vec3::from),
    )
}

/// The JSON and the binary chunk of a `.glb` (glTF 2.0, section 4.4).
fn split_glb(bytes: &[u8]) -> Outcome<(&[u8], Option<&[u8]>)> {
    let word = |at: usize| {
        let word = bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
        word.ok_or_else(|| format!("truncated: expected a header at byte {at} of {}", bytes.len()))
    };
    let (version, length) = (word(4)?, word(8)? as usize);
    if version != 2 {
        return Err(format!("expected binary glTF version 2, got {version}"));
    }
    if length > bytes.len() {
        return Err(format!("truncated: expected {length} bytes, got {}", bytes.len()));
    }
    let chunk = |at: usize| -> Outcome<(u32, &[u8])> {
        let (size, kind) = (word(at)? as usize, word(at + 4)?);
        let data = bytes.get(at + 8..).and_then(|rest| rest.get(..size)).ok_or_else(|| {
            format!("truncated: chunk at byte {at} should have {size} bytes, the file has {}", bytes.len())
        })?;
        Ok((kind, data))
    };
    let (kind, json) = chunk(12)?;
    if kind != u32::from_le_bytes(*b"JSON") {
        return Err(format!("expected the first chunk to be JSON, got kind {kind:#010x}"));
    }
    let mut at = 20 + json.len();
    while at < length {
        let (kind, data) = chunk(at)?;
        if kind == u32::from_le_bytes(*b"BIN\0") {
            return Ok((json, Some(data)));
        }
        // Chunks of unknown kind are to be skipped.
        at += 8 + data.len();
    }
    Ok((json, None))
}
