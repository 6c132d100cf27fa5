//! glTF 2.0: `.glb`, and `.gltf` with its `.bin` beside it.
//!
//! What the files promise beyond the standard:
//! - **Vertex order.** The first `positions.len()` vertices of a mesh are the scene's vertices, in order, each with the
//!   texture coordinate of its first corner. Duplicates that texture seams need follow after them. The number is in
//!   `mesh.extras.anthronet.vertices`, and for the body also in the document's `extras.anthronet.vertices`.
//! - **Faces.** Quads become two triangles along the diagonal from corner 0 to corner 2, in order.
//! - **Skeleton.** Nodes `0..joints` are the joint tree, in the scene's order; then one node per mesh at the root of
//!   the scene, without a transform, the body first. All meshes share one skin whose `skeleton` is the root joint.
//!   The rest pose is the bind pose: inverse bind matrices are inverses of the *written* node transforms.
//! - **Weights** are `f32`, exact, their sum made 1 to the last bit that `f32` has; unused slots hold joint 0, weight 0.
//! - The same scene gives the same bytes.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use gltf_json::{
    Asset, Buffer, Extras, Index, Material, Mesh, Node, Scene as GltfScene, Skin, Value,
    accessor::Accessor,
    extensions::material::{IndexOfRefraction, Ior, Specular, SpecularFactor},
    extras::RawValue,
    material::{AlphaMode as GltfAlphaMode, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor},
    mesh::{Mode, Primitive, Semantic},
    scene::UnitQuaternion,
    validation::{Checked, USize64},
};
use serde_json::json;

use super::accessor::{DocumentBuilder, Usage};
use super::scene::{AlphaMode, Scene, SceneJoint, SceneMaterial, SceneMesh};
use crate::{Error, Result};

/// Default of KHR_materials_ior, which is not written.
const DEFAULT_IOR: f32 = 1.5;

/// A `.gltf` document and the buffer that lies beside it.
#[derive(Clone, Debug)]
pub struct GltfFiles {
    /// The document, UTF-8 JSON.
    pub json: Vec<u8>,
    /// The buffer, under the name that was asked for.
    pub bin: Vec<u8>,
}

/// The scene as one binary glTF file.
///
/// # Errors
/// [`Error::Invalid`] if the scene does not [validate](Scene::validate) or needs more than the 4 GiB of a `.glb`.
pub fn to_glb(scene: &Scene) -> Result<Vec<u8>> {
    let DocumentBuilder { root, bin } = document(scene, None)?;
    let mut json = gltf_json::serialize::to_vec(&root).map_err(json_fault)?;
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + bin.len();
    let too_long =
        |_| Error::invalid("scene", format!("a .glb holds at most 4 GiB, this needs {length} bytes"));
    let length = u32::try_from(length).map_err(too_long)?;

    let mut glb = Vec::with_capacity(length as usize);
    for word in [u32::from_le_bytes(*b"glTF"), 2, length] {
        glb.extend_from_slice(&word.to_le_bytes());
    }
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &bin)] {
        // Shorter than the whole, which fits.
        glb.extend_from_slice(&(chunk.len() as u32).to_le_bytes());
        glb.extend_from_slice(kind);
        glb.extend_from_slice(chunk);
    }
    Ok(glb)
}

/// The scene as a JSON document that refers to `bin_name`, a plain file name, and the content of that file.
///
/// # Errors
/// [`Error::Invalid`] if the scene does not [validate](Scene::validate).
pub fn to_gltf(scene: &Scene, bin_name: &str) -> Result<GltfFiles> {
    let DocumentBuilder { root, bin } = document(scene, Some(percent_encoded(bin_name)))?;
    let mut json = gltf_json::serialize::to_vec_pretty(&root).map_err(json_fault)?;
    json.push(b'\n');
    Ok(GltfFiles { json, bin })
}

fn document(scene: &Scene, buffer_uri: Option<String>) -> Result<DocumentBuilder> {
    scene.validate()?;
    let mut builder = DocumentBuilder::default();
    builder.root.asset = Asset {
        generator: Some(concat!("anthronet ", env!("CARGO_PKG_VERSION")).into()),
        ..Asset::default()
    };
    let skin = (!scene.joints.is_empty()).then(|| push_skeleton(&mut builder, scene));
    let joints = builder.root.nodes.len() as u32;
    for mesh in &scene.meshes {
        let mesh = push_mesh(&mut builder, mesh, scene.joints.len())?;
        let name = builder.root.meshes.get(mesh.value()).and_then(|m| m.name.clone());
        builder.root.push(Node { name, mesh: Some(mesh), skin, ..Node::default() });
    }
    builder.root.materials = scene.materials.iter().map(material).collect();
    builder.root.extensions_used = extensions_used(&scene.materials);

    let nodes = (0..u32::from(joints > 0)).chain(joints..builder.root.nodes.len() as u32);
    let nodes = nodes.map(Index::new).collect();
    let name = (!scene.name.is_empty()).then(|| scene.name.clone());
    builder.root.scene = Some(builder.root.push(GltfScene { extensions: None, extras: None, name, nodes }));
    builder.root.extras = document_extras(scene)?;
    builder.root.push(Buffer {
        byte_length: USize64::from(builder.bin.len()),
        name: None,
        uri: buffer_uri,
        extensions: None,
        extras: None,
    });
    Ok(builder)
}

/// The scene's extras with `anthronet.version` and `anthronet.vertices` (of the body) added.
fn document_extras(scene: &Scene) -> Result<Extras> {
    let mut extras = scene.extras.as_object().cloned().unwrap_or_default();
    let ours = extras.entry("anthronet").or_insert_with(|| json!({}));
    let Value::Object(ours) = ours else {
        return Err(Error::invalid("scene", "extras.anthronet must be an object"));
    };
    ours.insert("version".into(), env!("CARGO_PKG_VERSION").into());
    ours.insert("vertices".into(), scene.meshes.first().map_or(0, |m| m.positions.len()).into());
    raw(&Value::Object(extras))
}

/// Appends the joint nodes, which become nodes `0..joints`, and the skin over them.
fn push_skeleton(builder: &mut DocumentBuilder, scene: &Scene) -> Index<Skin> {
    let transforms = written_transforms(&scene.joints);
    let mut children = vec![Vec::new(); scene.joints.len()];
    for (i, joint) in (0u32..).zip(&scene.joints) {
        if let Some(siblings) = joint.parent.and_then(|parent| children.get_mut(parent as usize)) {
            siblings.push(Index::new(i));
        }
    }
    for ((joint, written), children) in scene.joints.iter().zip(&transforms).zip(children) {
        builder.root.push(Node {
            name: Some(joint.name.clone()),
            children: (!children.is_empty()).then_some(children),
            translation: Some(written.translation),
            rotation: (written.rotation != [0.0, 0.0, 0.0, 1.0]).then_some(UnitQuaternion(written.rotation)),
            ..Node::default()
        });
    }
    let inverse_bind = transforms.iter().map(|written| {
        let inverse = written.model_from_joint.inverse();
        let mut matrix = [0.0f32; 16];
        for (column, values) in [inverse.matrix3.x_axis, inverse.matrix3.y_axis, inverse.matrix3.z_axis]
            .into_iter()
            .chain([inverse.translation])
            .enumerate()
        {
            for (row, value) in values.to_array().into_iter().enumerate() {
                matrix[4 * column + row] = plain(value);
            }
        }
        matrix[15] = 1.0;
        matrix
    });
    let inverse_bind_matrices = Some(builder.push_accessor(inverse_bind, Usage::Other));
    builder.root.push(Skin {
        extensions: None,
        extras: None,
        inverse_bind_matrices,
        joints: (0..scene.joints.len() as u32).map(Index::new).collect(),
        name: (!scene.name.is_empty()).then(|| scene.name.clone()),
        skeleton: Some(Index::new(0)),
    })
}

/// A joint's node as it stands in the file.
struct WrittenTransform {
    translation: [f32; 3],
    /// Unit quaternion x, y, z, w.
    rotation: [f32; 4],
    /// Product of the written transforms from the root down.
    model_from_joint: DAffine3,
}

/// Splits every bind pose into a translation and a rotation below its parent. What rounding to `f32` moves a parent by,
/// its children take back, so that errors do not add up along a chain.
fn written_transforms(joints: &[SceneJoint]) -> Vec<WrittenTransform> {
    let mut written: Vec<WrittenTransform> = Vec::with_capacity(joints.len());
    for joint in joints {
        let m = joint.model_from_joint;
        let wanted = DAffine3 {
            matrix3: DMat3::from_cols(
                m.matrix3.x_axis.as_dvec3(),
                m.matrix3.y_axis.as_dvec3(),
                m.matrix3.z_axis.as_dvec3(),
            ),
            translation: m.translation.as_dvec3(),
        };
        let parent = joint
            .parent
            .and_then(|p| written.get(p as usize))
            .map_or(DAffine3::IDENTITY, |p| p.model_from_joint);
        let local = parent.inverse() * wanted;
        let rotation = DQuat::from_mat3(&local.matrix3).normalize();
        let rotation = if rotation.w < 0.0 { -rotation } else { rotation };
        let rotation = rotation.to_array().map(plain);
        let translation = local.translation.to_array().map(plain);
        let written_local = DAffine3::from_rotation_translation(
            DQuat::from_array(rotation.map(f64::from)),
            DVec3::from_array(translation.map(f64::from)),
        );
        written.push(WrittenTransform { translation, rotation, model_from_joint: parent * written_local });
    }
    written
}

/// To `f32`, without a negative zero.
fn plain(value: f64) -> f32 {
    value as f32 + 0.0
}

fn push_mesh(builder: &mut DocumentBuilder, mesh: &SceneMesh, joints: usize) -> Result<Index<Mesh>> {
    let split = SplitMesh::new(mesh);
    let source = || split.source.iter().map(|vertex| *vertex as usize);
    let positions: Vec<_> = source().map(|v| mesh.positions[v]).collect();
    let mut attributes = vec![(Semantic::Positions, builder.push_positions(&positions))];
    if !mesh.normals.is_empty() {
        let normals = builder.push_accessor(source().map(|v| mesh.normals[v]), Usage::Vertices);
        attributes.push((Semantic::Normals, normals));
    }
    if !mesh.uvs.is_empty() {
        // A vertex that no face uses has no texture coordinate of its own.
        let uvs = split.uvs.iter().map(|uv| mesh.uvs.get(*uv as usize).copied().unwrap_or_default());
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
    Ok(builder.root.push(Mesh {
        extensions: None,
        extras: raw(&json!({"anthronet": {"vertices": mesh.positions.len()}}))?,
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
            targets: None,
        }],
        weights: None,
    }))
}

fn push_indices(builder: &mut DocumentBuilder, split: &SplitMesh) -> Index<Accessor> {
    let corners = split.triangles.iter().flatten();
    // 65535 would be the highest index, which glTF forbids as it restarts a primitive.
    if split.source.len() < usize::from(u16::MAX) {
        builder.push_accessor(corners.map(|corner| [*corner as u16]), Usage::Indices)
    } else {
        builder.push_accessor(corners.map(|corner| [*corner]), Usage::Indices)
    }
}

/// Four slots of one vertex as they are written: joint 0 where the weight is 0, and the largest weight takes up what
/// rounding left of the sum.
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

/// A mesh whose vertices have one texture coordinate each.
struct SplitMesh {
    /// Scene vertex of every written vertex: `0..V`, then the duplicates.
    source: Vec<u32>,
    /// Texture coordinate index of every written vertex, or [`UNSEEN`].
    uvs: Vec<u32>,
    /// Written vertices of every triangle.
    triangles: Vec<[u32; 3]>,
}

const UNSEEN: u32 = u32::MAX;

impl SplitMesh {
    fn new(mesh: &SceneMesh) -> Self {
        let vertices = mesh.positions.len();
        let mut source: Vec<u32> = (0..vertices as u32).collect();
        let mut uvs = vec![UNSEEN; vertices];
        // The written copies of one scene vertex form a chain; they are few.
        let mut next_copy = vec![UNSEEN; vertices];
        let mut written = |(vertex, uv): (u32, u32)| {
            let mut copy = vertex as usize;
            loop {
                if uvs[copy] == UNSEEN {
                    uvs[copy] = uv;
                }
                let same = uvs[copy] == uv || mesh.uvs.get(uvs[copy] as usize) == mesh.uvs.get(uv as usize);
                if same {
                    return copy as u32;
                }
                if next_copy[copy] == UNSEEN {
                    let new = source.len() as u32;
                    next_copy[copy] = new;
                    source.push(vertex);
                    uvs.push(uv);
                    next_copy.push(UNSEEN);
                    return new;
                }
                copy = next_copy[copy] as usize;
            }
        };
        let triangles = mesh.triangulated().into_iter().map(|triangle| triangle.map(&mut written)).collect();
        Self { source, uvs, triangles }
    }
}

fn material(material: &SceneMaterial) -> Material {
    let ior =
        (material.ior != DEFAULT_IOR).then(|| Ior { ior: IndexOfRefraction(material.ior), ..Ior::default() });
    let specular = (material.specular != 1.0)
        .then(|| Specular { specular_factor: SpecularFactor(material.specular), ..Specular::default() });
    let extensions = (ior.is_some() || specular.is_some())
        .then(|| gltf_json::extensions::material::Material { ior, specular, ..Default::default() });
    Material {
        name: Some(material.name.clone()),
        alpha_mode: Checked::Valid(match material.alpha_mode {
            AlphaMode::Opaque => GltfAlphaMode::Opaque,
            AlphaMode::Blend => GltfAlphaMode::Blend,
        }),
        double_sided: material.double_sided,
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor(material.base_color),
            metallic_factor: StrengthFactor(material.metallic),
            roughness_factor: StrengthFactor(material.roughness),
            ..PbrMetallicRoughness::default()
        },
        extensions,
        ..Material::default()
    }
}

fn extensions_used(materials: &[SceneMaterial]) -> Vec<String> {
    let ior = materials.iter().any(|m| m.ior != DEFAULT_IOR).then(|| "KHR_materials_ior".to_owned());
    let specular = materials.iter().any(|m| m.specular != 1.0).then(|| "KHR_materials_specular".to_owned());
    ior.into_iter().chain(specular).collect()
}

fn raw(value: &Value) -> Result<Extras> {
    RawValue::from_string(value.to_string()).map(Some).map_err(json_fault)
}

#[expect(clippy::needless_pass_by_value, reason = "for map_err")]
fn json_fault(error: gltf_json::Error) -> Error {
    Error::invalid("scene", format!("cannot be written as JSON: {error}"))
}

/// A file name as a relative URI (RFC 3986): everything but unreserved characters as `%XX`.
fn percent_encoded(name: &str) -> String {
    use std::fmt::Write;
    name.bytes().fold(String::new(), |mut uri, byte| {
        if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            // Writing to a string cannot fail.
            let _ = write!(uri, "%{byte:02X}");
        }
        uri
    })
}

#[cfg(test)]
mod tests;
