//! A document as a complete [`Scene`]: skeleton, meshes and clips.

mod clips;
pub(in crate::format::gltf) mod skeleton;

use gltf_json::{
    Accessor, Index,
    mesh::{Primitive, Semantic},
};

use self::clips::NodeWeights;
use self::skeleton::{JointNodes, joint_above};
use super::document::{Document, Tree};
use super::meshes::{Part, attribute, merge_copies, normalize_normals, parts, place, with_materials};
use crate::error::{Fault, Within};
use crate::format::gltf::Result;
use crate::scene::{MorphTrack, Scene, SceneMesh};
use crate::skeleton::Pose;

/// How far from 1 weights may sum before they are normalised.
const SUM_TOLERANCE: f64 = 1e-6;

/// Joints, meshes with texture coordinates and weights, materials, clips.
pub(super) fn scene(document: &Document) -> Result<Scene> {
    let tree = document.tree()?;
    let skeleton = JointNodes::read(document, &tree)?;
    let world = document.world_from_nodes(&tree);
    let (mut meshes, mut nodes) = (Vec::new(), Vec::new());
    for part in parts(document)? {
        let node = part.node;
        let mesh = match &skeleton {
            Some(skeleton) => skinned(document, skeleton, &tree, part),
            // Placed where it is in the scene.
            None => still(part, &world[node]),
        };
        meshes.push(mesh.within(format_args!("nodes[{node}].mesh"))?);
        nodes.push(node);
    }
    let mut scene = with_materials(document, meshes)?;
    if let Some(skeleton) = skeleton {
        for (clip, read) in (0u32..).zip(clips::read(document, &skeleton)?) {
            scene.clips.push(read.clip);
            add_morph_tracks(&mut scene, clip, read.weights, &nodes);
        }
        scene.pose = scene.read_as_posed().then_some(Pose { locals: skeleton.nodes });
        scene.skeleton = Some(skeleton.skeleton);
    }
    scene.validate().map_err(Box::new)?;
    Ok(scene)
}

/// Adds the weights over a clip to the meshes of their nodes; targets whose weights are all 0 are left out.
fn add_morph_tracks(scene: &mut Scene, clip: u32, weights: Vec<NodeWeights>, nodes: &[usize]) {
    for NodeWeights { node, of_targets } in weights {
        for (mesh, _) in (0u32..).zip(nodes).filter(|(_, of_mesh)| **of_mesh == node) {
            // The primitives of a mesh must have the same targets; in an invalid file they may not.
            let targets = scene.meshes[mesh as usize].morph_targets.len();
            for (target, weights) in (0u32..).zip(&of_targets).take(targets) {
                if weights.iter().any(|weight| *weight != 0.0) {
                    scene.morph_tracks.push(MorphTrack { clip, mesh, target, weights: weights.clone() });
                }
            }
        }
    }
}

fn still(part: Part<'_>, world_from_node: &glam::Affine3A) -> Result<SceneMesh> {
    let Part { mut mesh, vertices, .. } = part;
    place(&mut mesh, world_from_node)?;
    normalize_normals(&mut mesh);
    merge_copies(&mut mesh, vertices)?;
    Ok(mesh)
}

/// A mesh with the weights of its skin, or, without a skin, one bound to the joint above it.
fn skinned(document: &Document, skeleton: &JointNodes, tree: &Tree, part: Part<'_>) -> Result<SceneMesh> {
    let Part { node, primitive, mut mesh, vertices } = part;
    let written = mesh.positions.len();
    match document.root.nodes[node].skin {
        Some(skin) => weights(document, skeleton, skin.value(), &sets(primitive), &mut mesh)?,
        None => {
            let (joint, model_from_node) = joint_above(document, tree, skeleton, node)?;
            place(&mut mesh, &model_from_node)?;
            mesh.influences_per_vertex = 4;
            mesh.joint_indices = [joint, 0, 0, 0].repeat(written);
            mesh.joint_weights = [1.0, 0.0, 0.0, 0.0].repeat(written);
        }
    }
    let slots = written * mesh.influences_per_vertex;
    if mesh.joint_indices.len() != slots {
        let found = mesh.joint_indices.len();
        return Err(Fault::unexpected(format_args!("{slots} slots"), found).into()).within("JOINTS");
    }
    normalize_normals(&mut mesh);
    merge_copies(&mut mesh, vertices)?;
    Ok(mesh)
}

/// The accessors of each set of joints and weights.
type Sets = Vec<(Index<Accessor>, Index<Accessor>)>;

fn sets(primitive: &Primitive) -> Sets {
    let set = |set: u32| {
        let of = |semantic| attribute(primitive, semantic);
        Some((of(Semantic::Joints(set))?, of(Semantic::Weights(set))?))
    };
    (0..).map_while(set).collect()
}

/// Weights over the scene's joints: repeated joints merged, sorted, at most four or eight, and normalised unless they
/// already sum to 1.
fn weights(
    document: &Document,
    skeleton: &JointNodes,
    skin: usize,
    sets: &[(Index<Accessor>, Index<Accessor>)],
    out: &mut SceneMesh,
) -> Result<()> {
    let skin = document.root.skins.get(skin);
    let skin = skin.ok_or_else(|| Fault::missing("skin that exists"))?;
    let places: Vec<u16> =
        skin.joints.iter().filter_map(|joint| skeleton.places.get(&joint.value())).copied().collect();
    if sets.is_empty() {
        return Err(Fault::missing("JOINTS_0 and WEIGHTS_0, but a skin").into());
    }
    let mut rows: Vec<Vec<(u16, f32)>> = Vec::new();
    for (set, (joints, weights)) in sets.iter().enumerate() {
        let joints = document.quadruples(*joints).within(format_args!("JOINTS_{set}"))?;
        let weights = document.numbers::<4>(*weights).within(format_args!("WEIGHTS_{set}"))?;
        if joints.len() != weights.len() || (set > 0 && joints.len() != rows.len()) {
            let found = format!("{} and {}", joints.len(), weights.len());
            return Err(Fault::unexpected("as many as vertices", found).into())
                .within(format_args!("JOINTS_{set}, WEIGHTS_{set}"));
        }
        rows.resize(joints.len(), Vec::new());
        for (v, (row, (joints, weights))) in rows.iter_mut().zip(joints.iter().zip(&weights)).enumerate() {
            for (joint, weight) in joints.iter().zip(weights) {
                if *weight < 0.0 {
                    return Err(Fault::unexpected("weights of at least 0", weight).into())
                        .within(format_args!("WEIGHTS_{set}: element {v}"));
                }
                // The joint of an unused slot does not matter.
                if *weight > 0.0 {
                    let place = places.get(usize::from(*joint));
                    let Some(place) = place else {
                        return Err(Fault::dangling("joint", usize::from(*joint), places.len()).into())
                            .within(format_args!("JOINTS_{set}: element {v}"));
                    };
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
            return Err(Fault::unexpected("a sum of 1", sum).into())
                .within(format_args!("WEIGHTS: vertex {v}"));
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

#[cfg(test)]
mod tests;
