//! The meshes of a document: triangles with `f32` positions, the default of every exporter. Sparse base geometry is
//! rejected with an error that says so.

mod copies;
mod material;
mod targets;
mod uvs;

use glam::{Affine3A, Vec3};
use gltf_json::{
    Accessor, Index, Value,
    mesh::{Mode, Primitive, Semantic},
    validation::Checked,
};

use self::copies::{merge, originals};
use self::targets::Targets;
use super::document::Document;
use crate::error::{Fault, GltfError, ParserError, Within};
use crate::format::gltf::Result;
use crate::format::limits::{MAX_ELEMENTS, MAX_MESHES};
use crate::scene::titles::Titles;
use crate::scene::{Corners, Scene, SceneMesh};

/// How far a normal's length may be from 1 before it is normalised.
const LENGTH_TOLERANCE: f32 = 1e-3;

/// The meshes alone: skinned ones first, in the bind pose, then the others where their nodes place them.
pub(super) fn scene(document: &Document) -> Result<Scene> {
    let world = document.world_from_nodes(&document.tree()?);
    let mut meshes = Vec::new();
    for Part { node, mut mesh, vertices, .. } in parts(document)? {
        // glTF 2.0, section 3.7.3.3: the transform of a skinned mesh's own node is ignored.
        let skinned = document.root.nodes[node].skin.is_some();
        if !skinned {
            place(&mut mesh, &world[node]).within(format_args!("nodes[{node}]"))?;
        }
        normalize_normals(&mut mesh);
        // If a tool has moved a copy away from its original, no vertices are merged.
        let bits = |v: usize| mesh.positions[v].map(f32::to_bits);
        if let Ok(originals) = originals(&mesh, vertices, |a, b| bits(a) == bits(b)) {
            merge(&mut mesh, vertices, &originals);
        }
        meshes.push((skinned, mesh));
    }
    // Stable, so each kind keeps its order.
    meshes.sort_by_key(|(skinned, _)| !skinned);
    with_materials(document, meshes.into_iter().map(|(_, mesh)| mesh).collect())
}

/// A scene of meshes whose materials are indices into the document's; one past the last means no material.
pub(super) fn with_materials(document: &Document, meshes: Vec<SceneMesh>) -> Result<Scene> {
    let root = &document.root;
    let mut names = Titles::default();
    let mut materials: Vec<_> = root.materials.iter().map(|m| material::read(m, &mut names)).collect();
    if meshes.iter().any(|mesh| mesh.material as usize == materials.len()) {
        materials.push(material::read(&gltf_json::Material::default(), &mut names));
    }
    let name = root.scene.and_then(|s| root.get(s)).or(root.scenes.first()).and_then(|s| s.name.clone());
    let extras = match &root.extras {
        Some(raw) => {
            let extras = gltf_json::deserialize::from_str(raw.get());
            extras.map_err(|e| GltfError::from(ParserError::refused(e))).within("extras")?
        }
        None => Value::Null,
    };
    Ok(Scene { name: name.unwrap_or_default(), meshes, materials, extras, ..Scene::default() })
}

/// A primitive as a mesh of its own.
pub(super) struct Part<'a> {
    /// The index of its node.
    pub(super) node: usize,
    pub(super) primitive: &'a Primitive,
    /// In the space of the mesh, with the file's vertices; its name is unique.
    pub(super) mesh: SceneMesh,
    /// How many of the first vertices belong to the model; the rest are copies made for texture seams. All of them if
    /// the file does not say.
    pub(super) vertices: usize,
}

/// The primitives of all nodes, in file order; at least one.
pub(super) fn parts(document: &Document) -> Result<Vec<Part<'_>>> {
    let root = &document.root;
    let (mut names, mut targets) = (Titles::default(), Targets::of(document));
    let mut parts = Vec::new();
    let (mut vertices, mut triangles) = (0, 0);
    for (node, of_node) in root.nodes.iter().enumerate() {
        let Some(index) = of_node.mesh else { continue };
        let Some(of_mesh) = root.get(index) else {
            return Err(Fault::dangling("mesh", index.value(), root.meshes.len()).into())
                .within(format_args!("nodes[{node}].mesh"));
        };
        for primitive in &of_mesh.primitives {
            let mut part = part(document, &mut targets, of_mesh, primitive, node)
                .within(format_args!("nodes[{node}].mesh"))?;
            let name = of_mesh.name.as_deref().or(of_node.name.as_deref()).unwrap_or_default();
            part.mesh.name = names.unique(name);
            vertices += part.mesh.positions.len();
            triangles += part.mesh.triangles.positions.len();
            if vertices.max(triangles) > MAX_ELEMENTS {
                let most = format!("{MAX_ELEMENTS} vertices and triangles in all");
                return Err(Fault::too_many(most, "more").into());
            }
            parts.push(part);
            if parts.len() > MAX_MESHES {
                return Err(Fault::too_many(format_args!("{MAX_MESHES} meshes"), "more").into());
            }
        }
    }
    if parts.is_empty() { Err(Fault::missing("mesh").into()) } else { Ok(parts) }
}

/// A primitive of a mesh at a node, without a name.
fn part<'a>(
    document: &'a Document,
    targets: &mut Targets,
    of_mesh: &'a gltf_json::Mesh,
    primitive: &'a Primitive,
    node: usize,
) -> Result<Part<'a>> {
    let mut mesh = surface(document, primitive)?;
    mesh.morph_targets = targets.read(of_mesh, primitive, &mesh)?;
    let vertices = model_vertices(of_mesh, mesh.positions.len())?;
    Ok(Part { node, primitive, mesh, vertices })
}

/// How many of the written vertices belong to the model, which our own files state.
fn model_vertices(mesh: &gltf_json::Mesh, written: usize) -> Result<usize> {
    let extras = mesh.extras.as_ref().and_then(|e| gltf_json::deserialize::from_str::<Value>(e.get()).ok());
    let stated = extras.and_then(|e| e.pointer("/anthronet/vertices").and_then(Value::as_u64));
    match stated.map(usize::try_from) {
        None => Ok(written),
        Some(Ok(stated)) if stated <= written => Ok(stated),
        Some(_) => Err(Fault::too_many(format_args!("{written} vertices"), "more").into())
            .within("extras.anthronet.vertices"),
    }
}

/// The accessor of an attribute of a primitive.
pub(super) fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<Index<Accessor>> {
    primitive.attributes.get(&Checked::Valid(semantic)).copied()
}

/// All but name and morph targets: positions, normals, texture coordinates, triangles, material index.
fn surface(document: &Document, primitive: &Primitive) -> Result<SceneMesh> {
    if primitive.mode != Checked::Valid(Mode::Triangles) {
        return Err(Fault::unsupported("a primitive of other than triangles").into());
    }
    let positions = attribute(primitive, Semantic::Positions).ok_or_else(|| Fault::missing("POSITION"))?;
    let positions = document.vectors(positions).within("POSITION")?;
    if positions.is_empty() {
        return Err(Fault::missing("vertices").into());
    }
    let normals = match attribute(primitive, Semantic::Normals) {
        Some(normals) => document.vectors(normals).within("NORMAL")?,
        None => Vec::new(),
    };
    if !normals.is_empty() && normals.len() != positions.len() {
        return Err(other_count(positions.len(), normals.len())).within("NORMAL");
    }
    let uvs = uvs::read(document, primitive, positions.len())?;
    let corners = match primitive.indices {
        Some(indices) => document.indices(indices, positions.len()).within("indices")?,
        None => (0..positions.len() as u32).collect(),
    };
    let (triangles, []) = corners.as_chunks::<3>() else {
        let found = format!("{} corners in all", corners.len());
        return Err(Fault::unexpected("three corners per triangle", found).into());
    };
    let materials = document.root.materials.len();
    let material = primitive.material.map_or(materials, |material| material.value());
    if primitive.material.is_some() && material >= materials {
        return Err(Fault::dangling("material", material, materials).into());
    }
    let uv_corners = if uvs.is_empty() { Vec::new() } else { triangles.to_vec() };
    Ok(SceneMesh {
        positions: positions.iter().map(Vec3::to_array).collect(),
        normals: normals.iter().map(Vec3::to_array).collect(),
        uvs,
        triangles: Corners { positions: triangles.to_vec(), uvs: uv_corners },
        material: material as u32,
        ..SceneMesh::default()
    })
}

/// The error for another number of normals or texture coordinates than of vertices.
fn other_count(vertices: usize, found: usize) -> GltfError {
    Fault::unexpected(format_args!("{vertices} of them"), found).into()
}

/// Applies the transform of its node to a mesh without a skin.
pub(super) fn place(mesh: &mut SceneMesh, world: &Affine3A) -> Result<()> {
    if *world == Affine3A::IDENTITY {
        return Ok(());
    }
    let inverse = world.matrix3.inverse();
    if !world.is_finite() || !inverse.is_finite() {
        return Err(Fault::unexpected("a transform with an inverse", world).into());
    }
    let normal_matrix = inverse.transpose();
    targets::place(mesh, world.matrix3, normal_matrix);
    for position in &mut mesh.positions {
        *position = world.transform_point3(Vec3::from_array(*position)).to_array();
    }
    for normal in &mut mesh.normals {
        *normal = (normal_matrix * Vec3::from_array(*normal)).normalize_or_zero().to_array();
    }
    let targets = mesh.morph_targets.iter().flat_map(|t| t.positions.iter().chain(&t.normals));
    if !mesh.positions.iter().chain(targets).flatten().all(|v| v.is_finite()) {
        return Err(Fault::not_finite("a vertex that its transform has moved", "it").into());
    }
    if world.matrix3.determinant() < 0.0 {
        let Corners { positions, uvs } = &mut mesh.triangles;
        positions.iter_mut().chain(uvs).for_each(|triangle| triangle.swap(1, 2));
    }
    Ok(())
}

/// Normalises normals whose length is clearly not 1.
pub(super) fn normalize_normals(mesh: &mut SceneMesh) {
    for normal in &mut mesh.normals {
        let vector = Vec3::from_array(*normal);
        if (vector.length() - 1.0).abs() > LENGTH_TOLERANCE {
            *normal = vector.normalize_or_zero().to_array();
        }
    }
}

/// Merges the copies made for texture seams into their originals, equal in all but texture coordinates.
pub(super) fn merge_copies(mesh: &mut SceneMesh, vertices: usize) -> Result<()> {
    let per_vertex = mesh.influences_per_vertex;
    let slots = |v: usize| v * per_vertex..(v + 1) * per_vertex;
    let same = |a: usize, b: usize| {
        let mut targets = mesh.morph_targets.iter();
        mesh.normals.get(a) == mesh.normals.get(b)
            && targets.all(|t| t.positions[a] == t.positions[b] && t.normals.get(a) == t.normals.get(b))
            && mesh.joint_indices[slots(a)] == mesh.joint_indices[slots(b)]
            && mesh.joint_weights[slots(a)] == mesh.joint_weights[slots(b)]
    };
    let originals = originals(mesh, vertices, same).map_err(|copy| {
        Fault::inconsistent(format_args!("vertex {copy} is no copy of one of the first {vertices}"))
    })?;
    merge(mesh, vertices, &originals);
    Ok(())
}

#[cfg(test)]
pub(super) mod tests;
