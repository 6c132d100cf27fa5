//! A document as a [`Scene`]: joints, meshes with texture coordinates and weights, materials, clips.

use glam::{Affine3A, Vec3};
use gltf_json::{
    Accessor, Index, Material, material::AlphaMode as GltfAlphaMode, mesh::Semantic, validation::Checked,
};

use super::skeleton::{Skeleton, hung_on};
use super::{Part, animation};
use crate::error::Outcome;
use crate::format::gltf::document::{Document, Tree};
use crate::scene::titles::Titles;
use crate::scene::{AlphaMode, Corners, Scene, SceneMaterial, SceneMesh};

/// How far weights may sum away from 1 to be taken as they are; those of others are made to.
const SUM_TOLERANCE: f64 = 1e-6;
/// How far a normal's length may be from 1 to be taken as it is.
const LENGTH_TOLERANCE: f32 = 1e-3;

pub(super) fn scene(document: &Document) -> Outcome<Scene> {
    let root = &document.root;
    let tree = document.tree()?;
    let skeleton = Skeleton::read(document, &tree)?;
    let (mut names, mut material_names) = (Titles::default(), Titles::default());
    let mut materials: Vec<SceneMaterial> =
        root.materials.iter().map(|m| material(m, &mut material_names)).collect();
    let without = materials.len() as u32;
    let world = document.world_from_nodes(&tree);
    let mut meshes = Vec::new();
    for part in document.parts()? {
        let node = part.node;
        let material = part.primitive.material.map_or(without, |m| m.value() as u32);
        let name = names.unique(&part.mesh.name);
        // Of a mesh without a skin, where it is in the scene.
        let mut mesh = mesh(document, skeleton.as_ref().map(|s| (s, &tree)), &world[node], part)
            .map_err(|m| format!("nodes[{node}].mesh: {m}"))?;
        (mesh.material, mesh.name) = (material, name);
        meshes.push(mesh);
    }
    if meshes.iter().any(|mesh| mesh.material == without) {
        materials.push(material(&Material::default(), &mut material_names));
    }
    let clips = match &skeleton {
        Some(skeleton) => animation::clips(document, skeleton)?,
        None => Vec::new(),
    };
    let name = root.scene.and_then(|s| root.get(s)).or(root.scenes.first()).and_then(|s| s.name.clone());
    let scene = Scene {
        name: name.unwrap_or_default(),
        joints: skeleton.map(|s| s.joints).unwrap_or_default(),
        meshes,
        materials,
        clips,
        extras: document.extras()?,
    };
    scene.validate().map_err(|e| e.to_string())?;
    Ok(scene)
}

fn material(material: &Material, names: &mut Titles) -> SceneMaterial {
    let pbr = &material.pbr_metallic_roughness;
    let extensions = material.extensions.as_ref();
    SceneMaterial {
        name: names.unique(material.name.as_deref().unwrap_or("Material")),
        base_color: pbr.base_color_factor.0,
        roughness: pbr.roughness_factor.0,
        metallic: pbr.metallic_factor.0,
        ior: extensions.and_then(|e| e.ior.as_ref()).map_or(1.5, |e| e.ior.0),
        specular: extensions.and_then(|e| e.specular.as_ref()).map_or(1.0, |e| e.specular_factor.0),
        alpha_mode: match material.alpha_mode {
            Checked::Valid(GltfAlphaMode::Blend) => AlphaMode::Blend,
            _ => AlphaMode::Opaque,
        },
        double_sided: material.double_sided,
    }
}

/// A mesh with an index space of its own for texture coordinates, in which every written vertex has one.
fn mesh(
    document: &Document,
    skeleton: Option<(&Skeleton, &Tree)>,
    world_from_node: &Affine3A,
    part: Part<'_>,
) -> Outcome<SceneMesh> {
    let Part { node, primitive, mesh: mut imported } = part;
    let vertices = imported.positions.len();
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
    let uvs = match attribute(Semantic::TexCoords(0)) {
        Some(accessor) => document.numbers::<2>(accessor).map_err(|m| format!("TEXCOORD_0: {m}"))?,
        None => Vec::new(),
    };
    if !uvs.is_empty() && uvs.len() != vertices {
        return Err(format!("TEXCOORD_0: expected {vertices} of them, got {}", uvs.len()));
    }
    let mut out = SceneMesh { uvs, ..SceneMesh::default() };
    match (skeleton, document.root.nodes[node].skin) {
        (Some((skeleton, _)), Some(skin)) => {
            weights(document, skeleton, skin.value(), &sets(&attribute), &mut out)?;
        }
        (Some((skeleton, tree)), None) => {
            let (joint, model_from_node) = hung_on(document, tree, skeleton, node)?;
            super::place(&mut imported, &model_from_node)?;
            out.influences_per_vertex = 4;
            out.joint_indices = [joint, 0, 0, 0].repeat(vertices);
            out.joint_weights = [1.0, 0.0, 0.0, 0.0].repeat(vertices);
        }
        (None, _) => super::place(&mut imported, world_from_node)?,
    }
    let slots = vertices * out.influences_per_vertex;
    if out.joint_indices.len() != slots {
        return Err(format!("JOINTS: expected {slots} slots, got {}", out.joint_indices.len()));
    }
    for normal in &mut imported.normals {
        if (normal.length() - 1.0).abs() > LENGTH_TOLERANCE {
            *normal = normal.normalize_or_zero();
        }
    }
    out.positions = imported.positions.iter().map(Vec3::to_array).collect();
    out.normals = imported.normals.iter().map(Vec3::to_array).collect();
    out.triangles = Corners {
        uvs: if out.uvs.is_empty() { Vec::new() } else { imported.triangles.clone() },
        positions: imported.triangles,
    };
    merge_copies(&mut out, imported.model_vertices)?;
    Ok(out)
}

/// Accessors of the sets of joints and weights.
type Sets = Vec<(Index<Accessor>, Index<Accessor>)>;

fn sets(attribute: &impl Fn(Semantic) -> Option<Index<Accessor>>) -> Sets {
    (0..)
        .map_while(|set| Some((attribute(Semantic::Joints(set))?, attribute(Semantic::Weights(set))?)))
        .collect()
}

/// Weights over the scene's joints: as they are where they are sorted and sum to 1, else sorted, at most eight, and
/// made to.
fn weights(
    document: &Document,
    skeleton: &Skeleton,
    skin: usize,
    sets: &[(Index<Accessor>, Index<Accessor>)],
    out: &mut SceneMesh,
) -> Outcome<()> {
    let skin = document.root.skins.get(skin).ok_or("skin does not exist")?;
    let places: Vec<u16> =
        skin.joints.iter().filter_map(|joint| skeleton.places.get(&joint.value())).copied().collect();
    if sets.is_empty() {
        return Err("has a skin, but no JOINTS_0 and WEIGHTS_0".into());
    }
    let mut rows: Vec<Vec<(u16, f32)>> = Vec::new();
    for (set, (joints, weights)) in sets.iter().enumerate() {
        let joints = document.quadruples(*joints).map_err(|m| format!("JOINTS_{set}: {m}"))?;
        let weights = document.numbers::<4>(*weights).map_err(|m| format!("WEIGHTS_{set}: {m}"))?;
        if joints.len() != weights.len() || (set > 0 && joints.len() != rows.len()) {
            return Err(format!(
                "JOINTS_{set}, WEIGHTS_{set}: {} and {} of them",
                joints.len(),
                weights.len()
            ));
        }
        rows.resize(joints.len(), Vec::new());
        for (v, (row, (joints, weights))) in rows.iter_mut().zip(joints.iter().zip(&weights)).enumerate() {
            for (joint, weight) in joints.iter().zip(weights) {
                if *weight < 0.0 {
                    return Err(format!("WEIGHTS_{set}: element {v} is negative"));
                }
                // What an unused slot says does not matter.
                if *weight > 0.0 {
                    let place = places.get(usize::from(*joint));
                    let place = place
                        .ok_or_else(|| format!("JOINTS_{set}: element {v} is {joint} of {}", places.len()))?;
                    match row.iter_mut().find(|(joint, _)| joint == place) {
                        Some((_, sum)) => *sum += weight,
                        None => row.push((*place, *weight)),
                    }
                }
            }
        }
    }
    out.influences_per_vertex = if sets.len() == 1 { 4 } else { 8 };
    for (v, row) in rows.iter_mut().enumerate() {
        row.sort_by(|a, b| b.1.total_cmp(&a.1));
        row.truncate(out.influences_per_vertex);
        let sum: f64 = row.iter().map(|(_, w)| f64::from(*w)).sum();
        if row.is_empty() || !sum.is_finite() {
            return Err(format!("WEIGHTS: those of vertex {v} sum to {sum}, expected 1"));
        }
        if (sum - 1.0).abs() > SUM_TOLERANCE {
            row.iter_mut().for_each(|(_, w)| *w = (f64::from(*w) / sum) as f32);
        }
        row.resize(out.influences_per_vertex, (0, 0.0));
        out.joint_indices.extend(row.iter().map(|(joint, _)| *joint));
        out.joint_weights.extend(row.iter().map(|(_, weight)| *weight));
    }
    Ok(())
}

/// Puts the copies that texture seams needed, which follow after the first `vertices`, back onto those that they are
/// copies of: the first with the same position, normal and weights. Texture coordinates stay.
fn merge_copies(mesh: &mut SceneMesh, vertices: usize) -> Outcome<()> {
    let written = mesh.positions.len();
    if vertices == written {
        return Ok(());
    }
    let bits = |v: usize| mesh.positions[v].map(f32::to_bits);
    let per_vertex = mesh.influences_per_vertex;
    let slots = |v: usize| v * per_vertex..(v + 1) * per_vertex;
    let same = |a: usize, b: usize| {
        bits(a) == bits(b)
            && mesh.normals.get(a) == mesh.normals.get(b)
            && mesh.joint_indices[slots(a)] == mesh.joint_indices[slots(b)]
            && mesh.joint_weights[slots(a)] == mesh.joint_weights[slots(b)]
    };
    let mut sorted: Vec<usize> = (0..vertices).collect();
    sorted.sort_by_key(|v| (bits(*v), *v));
    let mut source: Vec<u32> = (0..vertices as u32).collect();
    for copy in vertices..written {
        let first = sorted.partition_point(|v| bits(*v) < bits(copy));
        let candidates = sorted.get(first..).unwrap_or_default();
        let mut candidates = candidates.iter().take_while(|v| bits(**v) == bits(copy));
        let found = candidates.find(|v| same(**v, copy));
        let found =
            found.ok_or_else(|| format!("vertex {copy} is no copy of one of the first {vertices}"))?;
        source.push(*found as u32);
    }
    let corners = mesh.triangles.positions.iter_mut().flatten();
    corners.for_each(|corner| *corner = source.get(*corner as usize).copied().unwrap_or(*corner));
    mesh.positions.truncate(vertices);
    mesh.normals.truncate(vertices);
    mesh.joint_indices.truncate(vertices * per_vertex);
    mesh.joint_weights.truncate(vertices * per_vertex);
    Ok(())
}
