//! Writes one mesh: faces unchanged, normals per vertex, texture coordinates per corner, skin and material.

use openusd::gf::{Matrix4d, Vec2f, Vec3f};
use openusd::sdf::Value;

use super::extent;
use super::layer::Layer;
use crate::Result;
use crate::scene::SceneMesh;
use crate::scene::flip_v;

/// The skeleton and material to which a mesh is bound.
pub(super) struct Binding<'a> {
    /// Path of the skeleton; `None` for a mesh without a skin.
    pub(super) skeleton: Option<&'a str>,
    /// Path of the material.
    pub(super) material: &'a str,
    /// Whether back faces are drawn; USD stores this on the mesh.
    pub(super) double_sided: bool,
}

/// Writes the mesh to this path.
pub(super) fn write(layer: &mut Layer, path: &str, mesh: &SceneMesh, binding: &Binding) -> Result<()> {
    layer.prim(path, &mesh.name, "Mesh")?;
    let (counts, corners, uvs) = faces(mesh);
    layer.attribute(path, "extent", "float3[]", extent::of_mesh(mesh))?;
    layer.attribute(path, "faceVertexCounts", "int[]", Value::IntVec(counts))?;
    layer.attribute(path, "faceVertexIndices", "int[]", Value::IntVec(corners))?;
    layer.attribute(path, "points", "point3f[]", vectors(&mesh.positions))?;
    if !mesh.normals.is_empty() {
        let normals = layer.attribute(path, "normals", "normal3f[]", vectors(&mesh.normals))?;
        interpolate(layer, &normals, "vertex")?;
    }
    if !mesh.uvs.is_empty() {
        // USD's v points upwards.
        let st = mesh.uvs.iter().map(|uv| Vec2f::from(flip_v(*uv))).collect();
        let st = layer.attribute(path, "primvars:st", "texCoord2f[]", Value::Vec2fVec(st))?;
        interpolate(layer, &st, "faceVarying")?;
        layer.attribute(path, "primvars:st:indices", "int[]", Value::IntVec(uvs))?;
    }
    layer.attribute(path, "doubleSided", "bool", Value::Bool(binding.double_sided)).map(drop)?;
    // The surface is subdivided already: viewers must not subdivide it again.
    layer.uniform(path, "subdivisionScheme", "token", Value::token("none"))?;
    layer.apply(path, "MaterialBindingAPI")?;
    layer.relate(path, "material:binding", binding.material)?;
    binding.skeleton.map_or(Ok(()), |skeleton| skin(layer, path, mesh, skeleton))
}

fn skin(layer: &mut Layer, path: &str, mesh: &SceneMesh, skeleton: &str) -> Result<()> {
    layer.apply(path, "SkelBindingAPI")?;
    layer.relate(path, "skel:skeleton", skeleton)?;
    let identity = Matrix4d(glam::DMat4::IDENTITY.to_cols_array());
    layer.attribute(path, "primvars:skel:geomBindTransform", "matrix4d", Value::Matrix4d(identity))?;
    // The index of an unused slot is irrelevant but must be valid.
    let joint = |(joint, weight): (&u16, &f32)| if *weight > 0.0 { i32::from(*joint) } else { 0 };
    let joints = mesh.joint_indices.iter().zip(&mesh.joint_weights).map(joint).collect();
    let weights = mesh.joint_weights.clone();
    for (name, type_name, value) in [
        ("primvars:skel:jointIndices", "int[]", Value::IntVec(joints)),
        ("primvars:skel:jointWeights", "float[]", Value::FloatVec(weights)),
    ] {
        let attribute = layer.attribute(path, name, type_name, value)?;
        interpolate(layer, &attribute, "vertex")?;
        layer.set(&attribute, "elementSize", Value::Int(mesh.influences_per_vertex as i32))?;
    }
    Ok(())
}

/// Number of corners per face, and vertex and texture coordinate index per corner: the quads, then the triangles.
fn faces(mesh: &SceneMesh) -> (Vec<i32>, Vec<i32>, Vec<i32>) {
    let corners = 4 * mesh.quads.positions.len() + 3 * mesh.triangles.positions.len();
    let mut counts = Vec::with_capacity(mesh.quads.positions.len() + mesh.triangles.positions.len());
    let (mut vertices, mut uvs) = (Vec::with_capacity(corners), Vec::with_capacity(corners));
    let mut face = |corners: &[(u32, u32)]| {
        let before = vertices.len();
        for (i, (vertex, uv)) in corners.iter().enumerate() {
            // A quad with a corner that repeats the one before it becomes a triangle.
            if corners[(i + corners.len() - 1) % corners.len()].0 != *vertex {
                vertices.push(*vertex as i32);
                uvs.push(*uv as i32);
            }
        }
        match vertices.len() - before {
            count @ 3.. => counts.push(count as i32),
            _ => {
                vertices.truncate(before);
                uvs.truncate(before);
            }
        }
    };
    mesh.quads.iter().for_each(|corners| face(&corners));
    mesh.triangles.iter().for_each(|corners| face(&corners));
    if mesh.uvs.is_empty() {
        uvs.clear();
    }
    (counts, vertices, uvs)
}

fn interpolate(layer: &mut Layer, attribute: &str, interpolation: &str) -> Result<()> {
    layer.set(attribute, "interpolation", Value::token(interpolation))
}

fn vectors(vectors: &[[f32; 3]]) -> Value {
    Value::Vec3fVec(vectors.iter().map(|v| Vec3f::from(*v)).collect())
}
