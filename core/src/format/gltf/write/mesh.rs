//! Meshes: vertices with one texture coordinate each, triangles, weights (glTF 2.0, section 3.7).

use gltf_json::{
    Index, Mesh,
    accessor::Accessor,
    mesh::{Mode, MorphTarget, Primitive, Semantic},
    validation::Checked,
};
use serde_json::json;

use super::accessor::{DocumentBuilder, Usage};
use super::raw;
use crate::Result;
use crate::scene::SceneMesh;
use crate::scene::SplitMesh;

/// Appends a mesh of one primitive.
pub(super) fn push(builder: &mut DocumentBuilder, mesh: &SceneMesh, joints: usize) -> Result<Index<Mesh>> {
    let split = SplitMesh::new(mesh);
    let source = || split.source.iter().map(|vertex| *vertex as usize);
    let positions: Vec<_> = source().map(|v| mesh.positions[v]).collect();
    let mut attributes = vec![(Semantic::Positions, builder.push_positions(&positions))];
    if !mesh.normals.is_empty() {
        let normals = builder.push_accessor(source().map(|v| mesh.normals[v]), Usage::Vertices);
        attributes.push((Semantic::Normals, normals));
    }
    if !mesh.uvs.is_empty() {
        let uvs = split.uvs(mesh);
        attributes.push((Semantic::TexCoords(0), builder.push_accessor(uvs, Usage::Vertices)));
    }
    for set in 0..mesh.influences_per_vertex / 4 {
        let slots = || source().map(|v| written_slots(mesh, v, set));
        let joint_accessor = if joints <= 256 {
            builder.push_accessor(slots().map(|s| s.map(|(joint, _)| joint as u8)), Usage::Vertices)
        } else {
            builder.push_accessor(slots().map(|s| s.map(|(joint, _)| joint)), Usage::Vertices)
        };
        let weight_accessor =
            builder.push_accessor(slots().map(|s| s.map(|(_, weight)| weight)), Usage::Vertices);
        attributes.push((Semantic::Joints(set as u32), joint_accessor));
        attributes.push((Semantic::Weights(set as u32), weight_accessor));
    }
    let indices = push_indices(builder, &split);
    let targets = push_targets(builder, mesh, &split);
    let mut extras = json!({"anthronet": {"vertices": mesh.positions.len()}});
    if !mesh.morph_targets.is_empty() {
        extras["targetNames"] = mesh.morph_targets.iter().map(|target| target.name.as_str()).collect();
    }
    Ok(builder.root.push(Mesh {
        extensions: None,
        extras: raw(&extras)?,
        name: Some(mesh.name.clone()),
        primitives: vec![Primitive {
            attributes: attributes
                .into_iter()
                .map(|(name, accessor)| (Checked::Valid(name), accessor))
                .collect(),
            extensions: None,
            extras: None,
            indices: Some(indices),
            material: Some(Index::new(mesh.material)),
            mode: Checked::Valid(Mode::Triangles),
            targets,
        }],
        weights: (!mesh.morph_targets.is_empty()).then(|| vec![0.0; mesh.morph_targets.len()]),
    }))
}

/// The offsets of every morph target; `None` for a mesh without targets.
fn push_targets(
    builder: &mut DocumentBuilder,
    mesh: &SceneMesh,
    split: &SplitMesh,
) -> Option<Vec<MorphTarget>> {
    let of_written = |rows: &[[f32; 3]]| -> Vec<[f32; 3]> {
        split.source.iter().filter_map(|vertex| rows.get(*vertex as usize).copied()).collect()
    };
    let target = |target: &crate::scene::MorphTarget| MorphTarget {
        positions: Some(builder.push_positions(&of_written(&target.positions))),
        normals: (!target.normals.is_empty())
            .then(|| builder.push_accessor(of_written(&target.normals), Usage::Vertices)),
        tangents: None,
    };
    let targets: Vec<MorphTarget> = mesh.morph_targets.iter().map(target).collect();
    (!targets.is_empty()).then_some(targets)
}

fn push_indices(builder: &mut DocumentBuilder, split: &SplitMesh) -> Index<Accessor> {
    let corners = split.triangles.iter().flatten();
    // Index 65535 is the primitive restart value, which glTF forbids.
    if split.source.len() < usize::from(u16::MAX) {
        builder.push_accessor(corners.map(|corner| [*corner as u16]), Usage::Indices)
    } else {
        builder.push_accessor(corners.map(|corner| [*corner]), Usage::Indices)
    }
}

/// Four slots of one vertex as written: joint 0 where the weight is 0, and the largest weight absorbs the rounding of
/// the sum.
fn written_slots(mesh: &SceneMesh, vertex: usize, set: usize) -> [(u16, f32); 4] {
    let mut slots = [(0, 0.0); 8];
    for (slot, influence) in slots.iter_mut().zip(mesh.influences(vertex)) {
        if influence.1 > 0.0 {
            *slot = influence;
        }
    }
    let others: f64 = slots[1..].iter().map(|(_, weight)| f64::from(*weight)).sum();
    slots[0].1 = (1.0 - others) as f32;
    std::array::from_fn(|i| slots[4 * set + i])
}
