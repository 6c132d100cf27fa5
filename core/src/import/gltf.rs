//! glTF 2.0, binary or JSON: triangles with `f32` positions, as every exporter writes them by default.
//!
//! Compressed, quantised and sparse geometry is refused by name. The JSON is read into `gltf-json`'s types; the data
//! behind them is fetched here, with every offset checked, and not by a general loader, which trusts the document.

use std::path::{Component as PathComponent, Path};

use glam::{Affine3A, Mat4, Quat, Vec3};
use gltf_json::{
    Accessor, Index, Node, Root, Value,
    accessor::{ComponentType, Type},
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};

use super::{ImportedMesh, ImportedScene, MAX_ELEMENTS, MAX_MESHES};
use crate::{Error, Result};

/// What is wrong with a document; the path is added at the end.
type Outcome<T> = std::result::Result<T, String>;

/// Required extensions that change no geometry.
const HARMLESS_EXTENSIONS: [&str; 3] = ["KHR_materials_", "KHR_texture_", "KHR_lights_"];

/// Reads a `.glb` or `.gltf` that is already in memory. Buffers of a `.gltf` are looked for beside `path`.
///
/// # Errors
/// [`Error::File`] says what is wrong and where; [`Error::Io`] for a buffer that cannot be read.
pub fn from_bytes(bytes: &[u8], path: &Path) -> Result<ImportedScene> {
    let fault = |message: String| Error::file(path, message);
    let (json, chunk) =
        if bytes.starts_with(b"glTF") { split_glb(bytes).map_err(fault)? } else { (bytes, None) };
    let root: Root = gltf_json::deserialize::from_slice(json)
        .map_err(|e| fault(format!("is neither a binary glTF nor valid glTF JSON: {e}")))?;
    if !root.asset.version.starts_with("2.") {
        return Err(fault(format!("asset.version: expected 2.x, got `{}`", root.asset.version)));
    }
    let geometry = |name: &&String| !HARMLESS_EXTENSIONS.iter().any(|prefix| name.starts_with(prefix));
    if let Some(name) = root.extensions_required.iter().find(geometry) {
        return Err(fault(format!("extensionsRequired: {name} is not supported")));
    }
    let mut buffers = Vec::new();
    for (i, buffer) in root.buffers.iter().enumerate() {
        let data = match &buffer.uri {
            Some(uri) => load_uri(uri, path)
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
    Document { root: &root, buffers }.scene().map_err(fault)
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

/// Content of a buffer's URI: base64 data, or a file beside or below the document.
fn load_uri(uri: &str, document: &Path) -> std::result::Result<Vec<u8>, std::result::Result<Error, String>> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, base64) = data.split_once(";base64,").ok_or(Err("expected base64 data".to_owned()))?;
        return base64_decoded(base64).ok_or(Err("expected base64 data, got other characters".into()));
    }
    let relative = percent_decoded(uri).ok_or_else(|| Err(format!("`{uri}` is not valid Unicode")))?;
    let relative = Path::new(&relative);
    if uri.contains(':')
        || !relative.components().all(|c| matches!(c, PathComponent::Normal(_) | PathComponent::CurDir))
    {
        return Err(Err(format!("expected a file beside or below the document, got `{uri}`")));
    }
    super::read(&document.with_file_name("").join(relative)).map_err(Ok)
}

fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, tail @ ..] = rest {
        let escaped = (*first == b'%').then(|| tail.get(..2)).flatten();
        let escaped = escaped
            .and_then(|hex| std::str::from_utf8(hex).ok())
            .and_then(|hex| u8::from_str_radix(hex, 16).ok());
        bytes.push(escaped.unwrap_or(*first));
        rest = if escaped.is_some() { &tail[2..] } else { tail };
    }
    String::from_utf8(bytes).ok()
}

/// RFC 4648, section 4; padding is optional.
fn base64_decoded(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for group in text.chunks(4) {
        let mut word = 0u32;
        for character in group {
            let value = match character {
                b'A'..=b'Z' => character - b'A',
                b'a'..=b'z' => character - b'a' + 26,
                b'0'..=b'9' => character - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                _ => return None,
            };
            word = word << 6 | u32::from(value);
        }
        let [_, decoded @ ..] = (word << (6 * (4 - group.len()))).to_be_bytes();
        bytes.extend_from_slice(decoded.get(..(group.len() * 6) / 8)?);
    }
    Some(bytes)
}

struct Document<'a> {
    root: &'a Root,
    buffers: Vec<Vec<u8>>,
}

impl Document<'_> {
    fn scene(&self) -> Outcome<ImportedScene> {
        let world = self.world_from_nodes()?;
        let mut meshes = Vec::new();
        let (mut vertices, mut triangles) = (0, 0);
        for (i, node) in self.root.nodes.iter().enumerate() {
            let Some(mesh) = node.mesh else { continue };
            let Some(mesh) = self.root.get(mesh) else {
                return Err(format!("nodes[{i}].mesh: {} of {}", mesh.value(), self.root.meshes.len()));
            };
            for primitive in &mesh.primitives {
                let mut imported = self.primitive(primitive).map_err(|m| format!("nodes[{i}].mesh: {m}"))?;
                imported.name = mesh.name.clone().or_else(|| node.name.clone()).unwrap_or_default();
                imported.skinned = node.skin.is_some();
                let stated = mesh
                    .extras
                    .as_ref()
                    .and_then(|e| gltf_json::deserialize::from_str::<Value>(e.get()).ok());
                let stated = stated.and_then(|e| e.pointer("/anthronet/vertices").and_then(Value::as_u64));
                imported.model_vertices = match stated.map(usize::try_from) {
                    None => imported.positions.len(),
                    Some(Ok(stated)) if stated <= imported.positions.len() => stated,
                    Some(_) => {
                        return Err(format!(
                            "nodes[{i}].mesh: extras.anthronet.vertices exceeds the vertices"
                        ));
                    }
                };
                // glTF 2.0, section 3.7.3.3: the transform of a skinned mesh's own node is ignored.
                if let (false, Some(world)) = (imported.skinned, world.get(i)) {
                    place(&mut imported, world).map_err(|m| format!("nodes[{i}]: {m}"))?;
                }
                vertices += imported.positions.len();
                triangles += imported.triangles.len();
                if vertices.max(triangles) > MAX_ELEMENTS {
                    return Err(format!("expected at most {MAX_ELEMENTS} vertices and triangles in all"));
                }
                meshes.push(imported);
                if meshes.len() > MAX_MESHES {
                    return Err(format!("expected at most {MAX_MESHES} meshes"));
                }
            }
        }
        if meshes.is_empty() {
            return Err("holds no mesh".into());
        }
        // Stable, so each kind keeps its order.
        meshes.sort_by_key(|mesh| !mesh.skinned);
        let extras = match &self.root.extras {
            Some(raw) => gltf_json::deserialize::from_str(raw.get()).map_err(|e| format!("extras: {e}"))?,
            None => Value::Null,
        };
        Ok(ImportedScene { meshes, extras, joint_names: self.joint_names()? })
    }

    fn joint_names(&self) -> Outcome<Vec<String>> {
        let Some(skin) = self.root.skins.first() else { return Ok(Vec::new()) };
        let name = |joint: &Index<Node>| {
            let node = self.root.get(*joint);
            let node = node
                .ok_or_else(|| format!("skins[0].joints: {} of {}", joint.value(), self.root.nodes.len()))?;
            Ok(node.name.clone().unwrap_or_else(|| format!("node {}", joint.value())))
        };
        skin.joints.iter().map(name).collect()
    }

    /// The transform from every node's space to that of the scene.
    fn world_from_nodes(&self) -> Outcome<Vec<Affine3A>> {
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
        let mut world = vec![None; nodes.len()];
        let mut open: Vec<usize> = (0..nodes.len()).filter(|i| parents[*i].is_none()).collect();
        while let Some(i) = open.pop() {
            let parent = parents[i].and_then(|parent: usize| world[parent]).unwrap_or(Affine3A::IDENTITY);
            world[i] = Some(parent * local_transform(&nodes[i]));
            open.extend(nodes[i].children.iter().flatten().map(Index::value));
        }
        let ring = world.iter().position(Option::is_none);
        ring.map_or(Ok(()), |i| Err(format!("nodes[{i}] is its own ancestor")))?;
        Ok(world.into_iter().flatten().collect())
    }

    fn primitive(&self, primitive: &Primitive) -> Outcome<ImportedMesh> {
        if primitive.mode != Checked::Valid(Mode::Triangles) {
            return Err("expected triangles, got another kind of primitive".into());
        }
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let positions = attribute(Semantic::Positions).ok_or("has no POSITION")?;
        let positions = self.vectors(positions).map_err(|m| format!("POSITION: {m}"))?;
        if positions.is_empty() {
            return Err("POSITION: is empty".into());
        }
        let normals = match attribute(Semantic::Normals) {
            Some(normals) => self.vectors(normals).map_err(|m| format!("NORMAL: {m}"))?,
            None => Vec::new(),
        };
        if !normals.is_empty() && normals.len() != positions.len() {
            return Err(format!("NORMAL: expected {} of them, got {}", positions.len(), normals.len()));
        }
        let corners = match primitive.indices {
            Some(indices) => self.indices(indices, positions.len()).map_err(|m| format!("indices: {m}"))?,
            None => (0..positions.len() as u32).collect(),
        };
        let (triangles, []) = corners.as_chunks::<3>() else {
            return Err(format!("expected three corners per triangle, got {} corners in all", corners.len()));
        };
        let base_color = match primitive.material {
            Some(material) => {
                let found = self.root.get(material);
                let found = found.ok_or_else(|| {
                    format!("material {} of {}", material.value(), self.root.materials.len())
                })?;
                found.pbr_metallic_roughness.base_color_factor.0
            }
            None => [1.0; 4],
        };
        Ok(ImportedMesh {
            name: String::new(),
            model_vertices: positions.len(),
            triangles: triangles.to_vec(),
            positions,
            normals,
            base_color,
            skinned: false,
        })
    }

    /// An accessor of finite `f32` vectors.
    fn vectors(&self, index: Index<Accessor>) -> Outcome<Vec<Vec3>> {
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

    /// An accessor of indices, each below `limit`.
    fn indices(&self, index: Index<Accessor>, limit: usize) -> Outcome<Vec<u32>> {
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

    fn accessor(&self, index: Index<Accessor>) -> Outcome<(&Accessor, ComponentType)> {
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
    fn elements(
        &self,
        index: Index<Accessor>,
        accessor: &Accessor,
        width: usize,
    ) -> Outcome<impl Iterator<Item = &[u8]>> {
        let fault = |message: &str| format!("accessor {}: {message}", index.value());
        let view = accessor.buffer_view.ok_or_else(|| fault("has no bufferView"))?;
        let view = self.root.get(view).ok_or_else(|| fault("bufferView does not exist"))?;
        let buffer = self.buffers.get(view.buffer.value()).ok_or_else(|| fault("buffer does not exist"))?;
        let size = |value: u64| usize::try_from(value).map_err(|_| fault("is too large"));
        let view_start = size(view.byte_offset.unwrap_or_default().0)?;
        let view = buffer.get(view_start..).and_then(|rest| rest.get(..size(view.byte_length.0).ok()?));
        let view = view.ok_or_else(|| fault("bufferView reaches beyond its buffer"))?;
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

fn local_transform(node: &Node) -> Affine3A {
    if let Some(matrix) = node.matrix {
        return Affine3A::from_mat4(Mat4::from_cols_array(&matrix));
    }
    Affine3A::from_scale_rotation_translation(
        node.scale.map_or(Vec3::ONE, Vec3::from),
        node.rotation.map_or(Quat::IDENTITY, |rotation| Quat::from_array(rotation.0)),
        node.translation.map_or(Vec3::ZERO, Vec3::from),
    )
}

/// Moves a mesh without a skin to where its node puts it.
fn place(mesh: &mut ImportedMesh, world: &Affine3A) -> Outcome<()> {
    if *world == Affine3A::IDENTITY {
        return Ok(());
    }
    let inverse = world.matrix3.inverse();
    if !world.is_finite() || !inverse.is_finite() {
        return Err("its transform is not finite or flattens space".into());
    }
    let normal_matrix = inverse.transpose();
    mesh.positions.iter_mut().for_each(|p| *p = world.transform_point3(*p));
    mesh.normals.iter_mut().for_each(|n| *n = (normal_matrix * *n).normalize_or_zero());
    if !mesh.positions.iter().all(|p| p.is_finite()) {
        return Err("its transform moves vertices to infinity".into());
    }
    if world.matrix3.determinant() < 0.0 {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
