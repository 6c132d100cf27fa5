//! glTF 2.0: `.glb`, and `.gltf` with its `.bin` beside it.
//!
//! What the files guarantee beyond the standard:
//! - **Vertex order.** The first `positions.len()` vertices of a mesh are the scene's vertices, in order, each with the
//!   texture coordinate of its first corner. Duplicates needed at texture seams follow. The number is in
//!   `mesh.extras.anthronet.vertices`, and for the body also in the document's `extras.anthronet.vertices`.
//! - **Faces.** Quads become two triangles along the diagonal from corner 0 to corner 2, in order.
//! - **Skeleton.** Nodes `0..joints` are the joint tree, in the scene's order, followed by one node per mesh at the
//!   root of the scene, without a transform, the body first. All meshes share one skin whose `skeleton` is the root
//!   joint. The rest pose is the bind pose: inverse bind matrices are inverses of the *written* node transforms. In a scene
//!   with a pose the nodes of the joints have that instead, the inverse bind matrices stay those of the bind pose, and
//!   `extras.anthronet.posed` is true.
//! - **Morph targets** are dense, and copies at texture seams move with their originals. Their names are in
//!   `mesh.extras.targetNames`; the default weights are all 0.
//! - **Weights** are exact `f32`, adjusted to sum to 1 within `f32` precision; unused slots hold joint 0, weight 0.
//! - **Clips** are animations of the joint nodes, with all keys on frames; see `animation.rs`.
//! - The same scene gives the same bytes, and so does the scene that [`read_scene`](crate::format::read_scene) reads
//!   from a file that is neither compressed nor posed.

mod accessor;
mod animation;
mod compress;
mod material;
mod mesh;
pub(crate) mod skeleton;

use gltf::binary::{Glb, Header};
use gltf_json::{
    Asset, Buffer, Extras, Index, Node, Scene as GltfScene, Value, extras::RawValue, validation::USize64,
};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use serde_json::json;

use crate::scene::Scene;
use crate::skeleton::written::written_joints;
use crate::{Error, Result};
use accessor::DocumentBuilder;

/// All but the unreserved characters of URIs (RFC 3986, section 2.3).
const RESERVED: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_').remove(b'~');

/// Options for writing a scene as glTF.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GltfOptions {
    /// Whether to use EXT_meshopt_compression, which a reader must support to open the file. It rounds positions and
    /// translations by less than a micrometre, components of rotations and weights by less than a millionth, those of
    /// normals by less than a ten-thousandth, and texture coordinates by less than a sixty-thousandth of the image. A
    /// triangle may start at another of its corners, so the diagonals of quads can no longer be identified.
    pub compress: bool,
}

/// A `.gltf` document and the buffer beside it.
#[derive(Clone, Debug)]
pub struct GltfFiles {
    /// The document, UTF-8 JSON.
    pub json: Vec<u8>,
    /// The content of the buffer, a file of the requested name.
    pub bin: Vec<u8>,
}

/// The scene as one binary glTF file.
///
/// # Errors
/// [`Error::Invalid`] if the scene does not [validate](Scene::validate) or needs more than the 4 GiB of a `.glb`.
pub fn to_glb(scene: &Scene) -> Result<Vec<u8>> {
    to_glb_with(scene, &GltfOptions::default())
}

/// The scene as one binary glTF file, with the given options.
///
/// # Errors
/// As [`to_glb`].
pub fn to_glb_with(scene: &Scene, options: &GltfOptions) -> Result<Vec<u8>> {
    glb(finished(document(scene)?, options, None)?)
}

/// The binary container (glTF 2.0, section 4.4).
pub(crate) fn glb(builder: DocumentBuilder) -> Result<Vec<u8>> {
    let DocumentBuilder { root, bin } = builder;
    let json = gltf_json::serialize::to_vec(&root).map_err(json_fault)?;
    // The crate writes the length itself, and does not check that it fits.
    let length = 12 + 8 + json.len().next_multiple_of(4) + 8 + bin.len().next_multiple_of(4);
    let too_long =
        || Error::invalid("scene", format!("a .glb holds at most 4 GiB, this needs {length} bytes"));
    let header =
        Header { magic: *b"glTF", version: 2, length: u32::try_from(length).map_err(|_| too_long())? };
    let glb = Glb { header, json: json.into(), bin: Some(bin.into()) };
    glb.to_vec().map_err(|error| Error::invalid("scene", format!("cannot be written as a .glb: {error}")))
}

/// The scene as a JSON document that refers to `bin_name`, a plain file name, and the content of that file.
///
/// # Errors
/// [`Error::Invalid`] if the scene does not [validate](Scene::validate).
pub fn to_gltf(scene: &Scene, bin_name: &str) -> Result<GltfFiles> {
    to_gltf_with(scene, bin_name, &GltfOptions::default())
}

/// The scene as a JSON document and its buffer, with the given options.
///
/// # Errors
/// As [`to_gltf`].
pub fn to_gltf_with(scene: &Scene, bin_name: &str, options: &GltfOptions) -> Result<GltfFiles> {
    let builder =
        finished(document(scene)?, options, Some(utf8_percent_encode(bin_name, RESERVED).to_string()))?;
    let DocumentBuilder { root, bin } = builder;
    let mut json = gltf_json::serialize::to_vec_pretty(&root).map_err(json_fault)?;
    json.push(b'\n');
    Ok(GltfFiles { json, bin })
}

/// The whole document but its `buffers`.
pub(crate) fn document(scene: &Scene) -> Result<DocumentBuilder> {
    scene.validate()?;
    document_of(scene)
}

/// The document of the scene's skeleton and clips alone.
pub(crate) fn document_of_motion(scene: &Scene) -> Result<DocumentBuilder> {
    scene.validate()?;
    let Scene { name, skeleton, clips, extras, .. } = scene.clone();
    document_of(&Scene { name, skeleton, clips, extras, ..Scene::default() })
}

/// [`document`] of a scene that has been validated.
fn document_of(scene: &Scene) -> Result<DocumentBuilder> {
    let mut builder = DocumentBuilder::default();
    builder.root.asset = Asset {
        generator: Some(concat!("anthronet ", env!("CARGO_PKG_VERSION")).into()),
        ..Asset::default()
    };
    let (nodes, skin) = match &scene.skeleton {
        None => (Vec::new(), None),
        Some(skeleton) => {
            let joints = skeleton.parents().iter().copied().zip(skeleton.bind().iter().copied());
            let transforms = written_joints(joints);
            let nodes = skeleton::nodes(&transforms, scene.pose.as_ref());
            let skin = skeleton::push(&mut builder, (&scene.name, skeleton), &transforms, &nodes)?;
            (nodes, Some(skin))
        }
    };
    let joints = builder.root.nodes.len() as u32;
    for mesh in &scene.meshes {
        let mesh = mesh::push(&mut builder, mesh, scene.joint_count())?;
        let name = builder.root.meshes.get(mesh.value()).and_then(|m| m.name.clone());
        builder.root.push(Node { name, mesh: Some(mesh), skin, ..Node::default() });
    }
    for clip in 0..scene.clips.len() {
        animation::push(&mut builder, scene, clip, &nodes)?;
    }
    builder.root.materials = scene.materials.iter().map(material::material).collect();
    builder.root.extensions_used = material::extensions_used(&scene.materials);

    let nodes = (0..u32::from(joints > 0)).chain(joints..builder.root.nodes.len() as u32);
    let nodes = nodes.map(Index::new).collect();
    let name = (!scene.name.is_empty()).then(|| scene.name.clone());
    builder.root.scene = Some(builder.root.push(GltfScene { extensions: None, extras: None, name, nodes }));
    builder.root.extras = document_extras(scene)?;
    Ok(builder)
}

/// The document with its buffer, compressed if requested.
pub(crate) fn finished(
    mut builder: DocumentBuilder,
    options: &GltfOptions,
    uri: Option<String>,
) -> Result<DocumentBuilder> {
    let raw_bytes = builder.bin.len();
    if options.compress {
        compress::compress(&mut builder)?;
    }
    let byte_length = USize64::from(builder.bin.len());
    builder.root.push(Buffer { byte_length, name: None, uri, extensions: None, extras: None });
    if options.compress {
        builder.root.push(compress::placeholder(raw_bytes));
    }
    Ok(builder)
}

/// The scene's extras with `anthronet.version` and `anthronet.vertices` (of the body) added.
fn document_extras(scene: &Scene) -> Result<Extras> {
    let mut extras = match scene.written_extras() {
        Value::Object(extras) => extras,
        _ => serde_json::Map::new(),
    };
    let ours = extras.entry("anthronet").or_insert_with(|| json!({}));
    let Value::Object(ours) = ours else {
        return Err(Error::invalid("scene", "extras.anthronet must be an object"));
    };
    ours.insert("version".into(), env!("CARGO_PKG_VERSION").into());
    ours.insert("vertices".into(), scene.meshes.first().map_or(0, |m| m.positions.len()).into());
    raw(&Value::Object(extras))
}

fn raw(value: &Value) -> Result<Extras> {
    RawValue::from_string(value.to_string()).map(Some).map_err(json_fault)
}

#[expect(clippy::needless_pass_by_value, reason = "for map_err")]
fn json_fault(error: gltf_json::Error) -> Error {
    Error::invalid("scene", format!("cannot be written as JSON: {error}"))
}

#[cfg(test)]
mod tests;
