//! A glTF document and the data it refers to. The JSON is parsed into `gltf-json`'s types; the data is read here, with
//! every offset and size checked, and not by a general loader, which trusts the document.

mod meshopt;
mod offsets;
pub(crate) mod uri;

use std::path::Path;

use glam::{Affine3A, Mat4, Vec3};
use gltf_json::{
    Accessor, Index, Node, Root, Value,
    accessor::{ComponentType, Type},
    validation::{Checked, USize64},
};

use self::uri::Source;
use crate::Error;
use crate::error::{GltfError, Within};
use crate::format::gltf::Result;
use crate::format::limits::MAX_ELEMENTS;
use crate::format::{Fault, disk};
use crate::math::Rotation;
use crate::text;

/// Prefixes of required extensions of which everything that a scene holds is read, as it has neither images nor lights:
/// `EXT_texture_webp`, `EXT_texture_avif`, `KHR_texture_basisu` and the like are kinds of images.
const READ_EXTENSIONS: [&str; 6] =
    [meshopt::NAME, "KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_dds", "KHR_lights_"];

/// What a document is read for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    /// Nodes, skins and animations; meshes and images are not looked at, so that the file may need extensions for them.
    Motion,
    /// All of it.
    Everything,
}

/// A document and its data.
pub(crate) struct Document {
    pub(crate) root: Root,
    buffers: Vec<Vec<u8>>,
    /// The decoded bytes of compressed buffer views; `None` for the others.
    decoded: Vec<Option<Vec<u8>>>,
    /// The number of animation channels that move no node, which are left out.
    pub(crate) idle_channels: usize,
}

/// The node hierarchy, one or more trees.
pub(crate) struct Tree {
    pub(crate) parents: Vec<Option<usize>>,
    /// All nodes in depth-first order: parents first, every subtree contiguous.
    pub(crate) order: Vec<usize>,
}

impl Document {
    /// The document of a `.glb` or `.gltf`. Buffers of a `.gltf` are looked for beside `path`.
    pub(crate) fn open(bytes: &[u8], path: &Path, content: Content) -> crate::Result<Self> {
        let fault = |error: GltfError| Error::file(path, error);
        let Parsed { root, chunk, idle_channels } = parse(bytes, content).map_err(fault)?;
        let mut buffers = Vec::new();
        for (i, buffer) in root.buffers.iter().enumerate() {
            if meshopt::is_placeholder(buffer) {
                buffers.push(Vec::new());
                continue;
            }
            let source = match &buffer.uri {
                Some(uri) => uri::source(uri, path).within("uri"),
                None => match chunk.filter(|_| i == 0) {
                    Some(chunk) => Ok(Source::Data(chunk.to_vec())),
                    None => Err(Fault::missing("uri, and the file no binary chunk for it").into()),
                },
            };
            let source = source.within(format_args!("buffers[{i}]")).map_err(fault)?;
            let data = match source {
                Source::Data(data) => data,
                Source::File(path) => disk::read(&path)?,
            };
            let expected = buffer.byte_length.0;
            if (data.len() as u64) < expected {
                let short = Fault::truncated(format_args!("{expected} bytes"), data.len());
                return Err(short.into()).within(format_args!("buffers[{i}]")).map_err(fault);
            }
            buffers.push(data);
        }
        let decoded = meshopt::decode_views(&root, &buffers).map_err(fault)?;
        Ok(Self { root, buffers, decoded, idle_channels })
    }

    /// The node hierarchy.
    pub(crate) fn tree(&self) -> Result<Tree> {
        let nodes = &self.root.nodes;
        let mut parents = vec![None; nodes.len()];
        for (i, node) in nodes.iter().enumerate() {
            for child in node.children.iter().flatten() {
                match parents.get_mut(child.value()) {
                    None => {
                        return Err(Fault::dangling("node", child.value(), nodes.len()).into())
                            .within(format_args!("nodes[{i}].children"));
                    }
                    Some(Some(_)) => {
                        return Err(Fault::inconsistent("has two parents").into())
                            .within(format_args!("nodes[{}]", child.value()));
                    }
                    Some(parent) => *parent = Some(i),
                }
            }
        }
        // From the roots down; a node that is never reached is on a cycle or below one.
        let mut order = Vec::with_capacity(nodes.len());
        let mut open: Vec<usize> = (0..nodes.len()).rev().filter(|i| parents[*i].is_none()).collect();
        while let Some(i) = open.pop() {
            order.push(i);
            open.extend(nodes[i].children.iter().flatten().rev().map(Index::value));
        }
        if order.len() < nodes.len() {
            let mut reached = vec![false; nodes.len()];
            order.iter().for_each(|i| reached[*i] = true);
            let mut node = reached.iter().position(|reached| !reached).unwrap_or_default();
            // There is no root above it, so that as many steps up as there are nodes end on a cycle.
            for _ in 0..nodes.len() {
                node = parents[node].unwrap_or(node);
            }
            return Err(Fault::inconsistent("is its own ancestor").into())
                .within(format_args!("nodes[{node}]"));
        }
        Ok(Tree { parents, order })
    }

    /// The transform from every node's space to scene space.
    pub(crate) fn world_from_nodes(&self, tree: &Tree) -> Vec<Affine3A> {
        let mut world = vec![Affine3A::IDENTITY; self.root.nodes.len()];
        for &i in &tree.order {
            let parent = tree.parents[i].map_or(Affine3A::IDENTITY, |parent| world[parent]);
            world[i] = parent * local_transform(&self.root.nodes[i]);
        }
        world
    }

    /// An accessor of finite `f32` vectors.
    pub(crate) fn vectors(&self, index: Index<Accessor>) -> Result<Vec<Vec3>> {
        let (accessor, component) = self.accessor(index)?;
        if accessor.type_ != Checked::Valid(Type::Vec3) || component != ComponentType::F32 {
            return Err(wrong_type("f32 vectors", accessor, component)).within(named(index));
        }
        let mut vectors = Vec::new();
        for (i, bytes) in self.elements(index, accessor, 12)?.enumerate() {
            let (numbers, _) = bytes.as_chunks::<4>();
            let vector = Vec3::from_slice(
                &[0, 1, 2].map(|axis| numbers.get(axis).map_or(f32::NAN, |b| f32::from_le_bytes(*b))),
            );
            if !vector.is_finite() {
                return Err(Fault::not_finite(format_args!("element {i}"), vector).into());
            }
            vectors.push(vector);
        }
        Ok(vectors)
    }

    /// An accessor of finite rows of `N` numbers: `f32`, or normalised integers.
    pub(crate) fn numbers<const N: usize>(&self, index: Index<Accessor>) -> Result<Vec<[f32; N]>> {
        let (accessor, component) = self.accessor(index)?;
        let fraction = component != ComponentType::F32;
        if multiplicity(accessor) != Some(N) || fraction != accessor.normalized {
            let expected = format!("rows of {N} numbers or normalised integers");
            return Err(wrong_type(&expected, accessor, component)).within(named(index));
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
                return Err(Fault::not_finite(format_args!("element {i}"), format_args!("{row:?}")).into());
            }
            rows.push(row);
        }
        Ok(rows)
    }

    /// An accessor of rows of four `u8` or `u16`.
    pub(crate) fn quadruples(&self, index: Index<Accessor>) -> Result<Vec<[u16; 4]>> {
        let (accessor, component) = self.accessor(index)?;
        let size = component.size();
        let unsigned = matches!(component, ComponentType::U8 | ComponentType::U16);
        if multiplicity(accessor) != Some(4) || !unsigned {
            return Err(wrong_type("rows of four u8 or u16", accessor, component)).within(named(index));
        }
        let number = |bytes: &[u8]| bytes.iter().rev().fold(0, |word, byte| word << 8 | u16::from(*byte));
        let rows = self.elements(index, accessor, 4 * size)?;
        let row = |bytes: &[u8]| {
            std::array::from_fn(|n| number(bytes.get(n * size..(n + 1) * size).unwrap_or_default()))
        };
        Ok(rows.map(row).collect())
    }

    /// An accessor of indices, each below `limit`.
    pub(crate) fn indices(&self, index: Index<Accessor>, limit: usize) -> Result<Vec<u32>> {
        let (accessor, component) = self.accessor(index)?;
        let width = match component {
            ComponentType::U8 => 1,
            ComponentType::U16 => 2,
            ComponentType::U32 => 4,
            _ => 0,
        };
        if accessor.type_ != Checked::Valid(Type::Scalar) || width == 0 {
            return Err(wrong_type("unsigned integers", accessor, component)).within(named(index));
        }
        let mut indices = Vec::new();
        for (i, bytes) in self.elements(index, accessor, width)?.enumerate() {
            let corner = bytes.iter().rev().fold(0u32, |word, byte| word << 8 | u32::from(*byte));
            if corner as usize >= limit {
                return Err(Fault::dangling("vertex", corner as usize, limit).into())
                    .within(format_args!("element {i}"));
            }
            indices.push(corner);
        }
        Ok(indices)
    }

    pub(crate) fn accessor(&self, index: Index<Accessor>) -> Result<(&Accessor, ComponentType)> {
        let accessor: Option<&Accessor> = self.root.get(index);
        let accessor =
            accessor.ok_or_else(|| Fault::dangling("accessor", index.value(), self.root.accessors.len()))?;
        if accessor.sparse.is_some() {
            return Err(Fault::unsupported("sparse").into()).within(named(index));
        }
        match accessor.component_type {
            Checked::Valid(component) => Ok((accessor, component.0)),
            Checked::Invalid => Err(unknown_component()).within(named(index)),
        }
    }

    /// The bytes of every element, `width` each, after checking that all are within the buffer view.
    pub(crate) fn elements(
        &self,
        index: Index<Accessor>,
        accessor: &Accessor,
        width: usize,
    ) -> Result<impl Iterator<Item = &[u8]>> {
        self.elements_of(accessor, width).within(named(index))
    }

    fn elements_of(&self, accessor: &Accessor, width: usize) -> Result<impl Iterator<Item = &[u8]>> {
        let view = accessor.buffer_view.ok_or_else(|| Fault::missing("bufferView"))?;
        let view = self.view(view.value())?;
        let stride = self.stride(accessor).unwrap_or(width);
        if stride < width {
            return Err(Fault::unexpected(format_args!("a byteStride of at least {width}"), stride).into());
        }
        // A value too large for `usize` is past the end of any buffer view.
        let size = |value: u64| usize::try_from(value).unwrap_or(usize::MAX);
        let (start, count) = (size(accessor.byte_offset.unwrap_or_default().0), size(accessor.count.0));
        if count > MAX_ELEMENTS * 3 {
            return Err(Fault::too_many(format_args!("{} elements", MAX_ELEMENTS * 3), count).into());
        }
        // The last element need not fill its stride.
        let end = count
            .checked_sub(1)
            .and_then(|last| last.checked_mul(stride)?.checked_add(width)?.checked_add(start));
        if count > 0 && end.is_none_or(|end| end > view.len()) {
            let expected = format!("{count} elements");
            let found = format!("the {} bytes of the bufferView", view.len());
            return Err(Fault::truncated(expected, found).into());
        }
        Ok((0..count).map(move |i| {
            view.get(start + i * stride..).and_then(|rest| rest.get(..width)).unwrap_or_default()
        }))
    }

    /// The bytes of a buffer view, decoded where it is compressed.
    fn view(&self, index: usize) -> Result<&[u8]> {
        let views = &self.root.buffer_views;
        let view = views.get(index).ok_or_else(|| Fault::dangling("bufferView", index, views.len()))?;
        match self.decoded.get(index) {
            Some(Some(decoded)) => Ok(decoded),
            _ => slice(&self.buffers, view.buffer.value(), view.byte_offset, view.byte_length),
        }
    }

    fn stride(&self, accessor: &Accessor) -> Option<usize> {
        self.root.get(accessor.buffer_view?)?.byte_stride.map(|stride| stride.0)
    }
}

/// Components per element.
fn multiplicity(accessor: &Accessor) -> Option<usize> {
    match accessor.type_ {
        // Their columns are padded for 8- and 16-bit components; nothing here reads them.
        Checked::Valid(Type::Mat2 | Type::Mat3) | Checked::Invalid => None,
        Checked::Valid(kind) => Some(kind.multiplicity()),
    }
}

/// The bytes of a buffer view.
pub(crate) fn slice(
    buffers: &[Vec<u8>],
    buffer: usize,
    offset: Option<USize64>,
    length: USize64,
) -> Result<&[u8]> {
    let buffer = buffers.get(buffer).ok_or_else(|| Fault::dangling("buffer", buffer, buffers.len()))?;
    let start = usize::try_from(offset.unwrap_or_default().0).unwrap_or(usize::MAX);
    let length = usize::try_from(length.0).unwrap_or(usize::MAX);
    let bytes = buffer.get(start..).and_then(|rest| rest.get(..length));
    bytes.ok_or_else(|| {
        let found = format!("a buffer of {}", buffer.len());
        Fault::truncated(format_args!("{length} bytes of a bufferView from byte {start}"), found).into()
    })
}

/// How error messages name an accessor.
fn named(index: Index<Accessor>) -> impl std::fmt::Display {
    format!("accessor {}", index.value())
}

/// The error for an accessor of the wrong type.
fn wrong_type(expected: &str, accessor: &Accessor, component: ComponentType) -> GltfError {
    let shape = match accessor.type_ {
        Checked::Valid(shape) => format!("{shape:?}"),
        Checked::Invalid => "an unknown type".to_owned(),
    };
    Fault::unexpected(expected, format_args!("{shape} of {component:?}")).into()
}

fn unknown_component() -> GltfError {
    Fault::unexpected("a componentType of glTF 2.0", "another").into()
}

/// The transform from a node's space to its parent's.
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

/// The JSON of a file, its version and required extensions checked, and the binary chunk of a `.glb`.
struct Parsed<'a> {
    root: Root,
    chunk: Option<&'a [u8]>,
    idle_channels: usize,
}

fn parse(bytes: &[u8], content: Content) -> Result<Parsed<'_>> {
    let (json, chunk) = if bytes.starts_with(b"glTF") { split_glb(bytes)? } else { (bytes, None) };
    let json = text::decode(json)?;
    let (root, idle_channels) = match gltf_json::deserialize::from_slice::<Root>(&json) {
        Ok(root) => (root, 0),
        Err(error) => without_idle_channels(&json).ok_or(error)?,
    };
    if !root.asset.version.starts_with("2.") {
        let found = format!("`{}`", root.asset.version);
        return Err(Fault::unexpected("2.x", found).into()).within("asset.version");
    }
    let unknown = |name: &&String| match content {
        // Only other codings of buffers hide what moves.
        Content::Motion => name.contains("meshopt") && *name != meshopt::NAME,
        Content::Everything => !READ_EXTENSIONS.iter().any(|prefix| name.starts_with(prefix)),
    };
    match root.extensions_required.iter().find(unknown) {
        Some(name) => Err(Fault::unsupported(name).into()).within("extensionsRequired"),
        None => Ok(Parsed { root, chunk, idle_channels }),
    }
}

/// The URIs of buffers and images, as far as the JSON can be read.
pub(crate) fn uris(bytes: &[u8]) -> Vec<String> {
    let json = if bytes.starts_with(b"glTF") { split_glb(bytes).map(|(json, _)| json) } else { Ok(bytes) };
    let json: Value = json.ok().and_then(|json| serde_json::from_slice(json).ok()).unwrap_or_default();
    let lists = ["buffers", "images"].map(|list| json[list].as_array());
    let uris = lists.into_iter().flatten().flatten().filter_map(|item| item["uri"].as_str());
    uris.map(str::to_owned).collect()
}

/// A document without the animation channels that have no node, and their number: the standard allows them, the types of
/// `gltf-json` do not. `None` if it has none or is wrong in another way.
fn without_idle_channels(json: &[u8]) -> Option<(Root, usize)> {
    let mut document: Value = gltf_json::deserialize::from_slice(json).ok()?;
    let mut left_out = 0;
    for animation in document.get_mut("animations")?.as_array_mut()? {
        let channels = animation.get_mut("channels")?.as_array_mut()?;
        let count = channels.len();
        channels
            .retain(|channel| channel.pointer("/target").is_none_or(|target| target.get("node").is_some()));
        left_out += count - channels.len();
    }
    let root = gltf_json::deserialize::from_value(document).ok()?;
    (left_out > 0).then_some((root, left_out))
}

/// The JSON and the binary chunk of a `.glb` (glTF 2.0, section 4.4). The crate `gltf` is not used: it rejects chunks
/// of unknown type, computes with unchecked lengths, and does not say where a truncated file ends.
fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>)> {
    let word = |at: usize| {
        let word = bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
        word.ok_or_else(|| {
            Fault::truncated(format_args!("a header at byte {at}"), format_args!("{} bytes", bytes.len()))
        })
    };
    let (version, length) = (word(4)?, word(8)? as usize);
    if version != 2 {
        return Err(Fault::unexpected("binary glTF version 2", version).into());
    }
    if length > bytes.len() {
        return Err(Fault::truncated(format_args!("{length} bytes"), bytes.len()).into());
    }
    let chunk = |at: usize| -> Result<(u32, &[u8])> {
        let (size, kind) = (word(at)? as usize, word(at + 4)?);
        let data = bytes.get(at + 8..).and_then(|rest| rest.get(..size)).ok_or_else(|| {
            let expected = format!("a chunk of {size} bytes at byte {at}");
            Fault::truncated(expected, format_args!("a file of {}", bytes.len()))
        })?;
        Ok((kind, data))
    };
    let (kind, json) = chunk(12)?;
    if kind != u32::from_le_bytes(*b"JSON") {
        let found = format!("one of kind {kind:#010x}");
        return Err(Fault::unexpected("a first chunk of JSON", found).into());
    }
    let mut at = 20 + json.len();
    while at < length {
        let (kind, data) = chunk(at)?;
        if kind == u32::from_le_bytes(*b"BIN\0") {
            return Ok((json, Some(data)));
        }
        // Chunks of unknown type must be skipped.
        at += 8 + data.len();
    }
    Ok((json, None))
}
