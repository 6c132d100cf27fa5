//! glTF 2.0, binary or JSON: triangles with `f32` positions, as every exporter writes them by default.
//!
//! EXT_meshopt_compression is undone; quantised and sparse geometry is refused by name.

mod animation;
mod character;
mod skeleton;

use std::path::Path;

use glam::Affine3A;
use gltf_json::{
    Index, Node, Value,
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};

use crate::error::Outcome;
use crate::format::gltf::document::Document;
use crate::format::input::MAX_ELEMENTS;
use crate::format::meshes::{ImportedMesh, ImportedScene, MAX_MESHES};
use crate::scene::Scene;
use crate::{Error, Result};

/// Reads a `.glb` or `.gltf` that is already in memory. Buffers of a `.gltf` are looked for beside `path`.
///
/// # Errors
/// [`Error::File`] says what is wrong and where; [`Error::Io`] for a buffer that cannot be read.
pub fn from_bytes(bytes: &[u8], path: &Path) -> Result<ImportedScene> {
    Document::open(bytes, path)?.imported().map_err(|message| Error::file(path, message))
}

/// Reads a `.glb`, `.vrm` or `.gltf` that is already in memory with its skin, joints, materials and clips; see
/// [`open_scene`](super::scene::open_scene).
///
/// # Errors
/// As [`from_bytes`], and as [`open_scene`](super::scene::open_scene).
pub fn scene_from_bytes(bytes: &[u8], path: &Path) -> Result<Scene> {
    character::scene(&Document::open(bytes, path)?).map_err(|message| Error::file(path, message))
}

/// A primitive as a mesh of its own, in the space of the mesh.
struct Part<'a> {
    node: usize,
    primitive: &'a Primitive,
    mesh: ImportedMesh,
}

impl Document {
    fn imported(&self) -> Outcome<ImportedScene> {
        let world = self.world_from_nodes(&self.tree()?);
        let mut meshes = Vec::new();
        for Part { node, mut mesh, .. } in self.parts()? {
            // glTF 2.0, section 3.7.3.3: the transform of a skinned mesh's own node is ignored.
            if let (false, Some(world)) = (mesh.skinned, world.get(node)) {
                place(&mut mesh, world).map_err(|m| format!("nodes[{node}]: {m}"))?;
            }
            meshes.push(mesh);
        }
        // Stable, so each kind keeps its order.
        meshes.sort_by_key(|mesh| !mesh.skinned);
        Ok(ImportedScene { meshes, extras: self.extras()?, joint_names: self.joint_names()? })
    }

    /// The primitives of all nodes, in the file's order; at least one.
    fn parts(&self) -> Outcome<Vec<Part<'_>>> {
        let mut parts = Vec::new();
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
                vertices += imported.positions.len();
                triangles += imported.triangles.len();
                if vertices.max(triangles) > MAX_ELEMENTS {
                    return Err(format!("expected at most {MAX_ELEMENTS} vertices and triangles in all"));
                }
                parts.push(Part { node: i, primitive, mesh: imported });
                if parts.len() > MAX_MESHES {
                    return Err(format!("expected at most {MAX_MESHES} meshes"));
                }
            }
        }
        if parts.is_empty() { Err("holds no mesh".into()) } else { Ok(parts) }
    }

    fn extras(&self) -> Outcome<Value> {
        match &self.root.extras {
            Some(raw) => gltf_json::deserialize::from_str(raw.get()).map_err(|e| format!("extras: {e}")),
            None => Ok(Value::Null),
        }
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
mod scene_tests;
#[cfg(test)]
mod tests;
