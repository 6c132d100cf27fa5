//! Writes USD with UsdSkel, as text (`.usda`), as a crate file (`.usdc`) and as a package of one (`.usdz`).
//!
//! One layer, in metres, +Y up, laid out as in the UsdSkel documentation (openusd.org, "UsdSkel: Schemas In-Depth"):
//!
//! ```text
//! /Character           SkelRoot, kind = component, extent (with samples over the first clip)
//!   /Skel              Skeleton: joints, bindTransforms, restTransforms, jointNames
//!     /Anim            SkelAnimation of the first clip, bound to the skeleton
//!     /<clip>          SkelAnimation of each further clip, not bound
//!   /<mesh>            Mesh: skin, normals per vertex, primvars:st per corner, material
//!     /<target>        BlendShape of a morph target; its weights are in the SkelAnimations
//!   /mtl/<material>    Material with a UsdPreviewSurface
//! ```
//!
//! Names that are not USD identifiers are converted to such, and the original is kept: of prims in `displayName`, of joints
//! in the skeleton's `jointNames`. Bone lengths are in its `anthronet:boneLengths`. The scene's extras are JSON text in the
//! root's `customData`, under `anthronetExtras`. The rest transforms of a scene with a pose are that pose, which viewers show
//! unless an animation is bound, and the extras say so. A character without joints is an `Xform` with meshes only.
//!
//! Time codes are frames of the first clip; further clips with another rate keep their duration. The bytes depend only on
//! the scene: no file contains a timestamp.

mod animation;
mod blend_shape;
mod extent;
mod layer;
mod material;
mod mesh;
pub(crate) mod names;
pub(crate) mod skeleton;

use std::collections::HashMap;
use std::io::Cursor;

use openusd::sdf::{FieldKey, Value};
use openusd::{usda, usdc, usdz};

use self::layer::{Layer, fault};
use self::names::Names;
use crate::Result;
use crate::scene::Scene;

/// Key in the root prim's `customData` for the scene's extras, as JSON.
pub(crate) const EXTRAS: &str = "anthronetExtras";
/// Key in a material's `customData` for its specular strength, which UsdPreviewSurface does not have.
pub(crate) const SPECULAR: &str = "anthronetSpecular";
/// The layer's name inside a package.
const PACKAGED_LAYER: &str = "character.usdc";

/// The scene as text.
///
/// # Errors
/// [`Error::Invalid`](crate::Error::Invalid) when the scene does not [validate](Scene::validate).
pub fn to_usda(scene: &Scene) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    usda::TextWriter::write(layer(scene)?.data(), &mut bytes).map_err(fault)?;
    Ok(bytes)
}

/// The scene as a crate file, USD's binary encoding.
///
/// # Errors
/// As [`to_usda`].
pub fn to_usdc(scene: &Scene) -> Result<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    usdc::CrateWriter::write(layer(scene)?.data(), &mut bytes).map_err(fault)?;
    Ok(bytes.into_inner())
}

/// The scene as a package: a zip archive that holds the crate file uncompressed, aligned to 64 bytes.
///
/// # Errors
/// As [`to_usda`].
pub fn to_usdz(scene: &Scene) -> Result<Vec<u8>> {
    let mut archive = usdz::ArchiveWriter::new(Cursor::new(Vec::new()));
    archive.add_layer(PACKAGED_LAYER, &to_usdc(scene)?).map_err(fault)?;
    Ok(archive.finish().map_err(fault)?.into_inner())
}

/// The complete layer of a scene, which is validated first.
fn layer(scene: &Scene) -> Result<Layer> {
    scene.validate()?;
    let mut layer = Layer::default();
    let root = format!("/{}", names::identifier(&scene.name));
    let skinned = scene.skeleton.is_some();
    layer.prim(&root, &scene.name, if skinned { "SkelRoot" } else { "Xform" })?;
    layer.set(&root, FieldKey::Kind, Value::token("component"))?;
    let extras = scene.written_extras();
    if !extras.is_null() {
        let extras = Value::String(extras.to_string());
        layer.set(
            &root,
            FieldKey::CustomData,
            Value::Dictionary(HashMap::from([(EXTRAS.into(), extras)])),
        )?;
    }
    layer_metadata(&mut layer, &root, scene)?;

    let mut names = Names::reserved(["Skel", "mtl"]);
    let tokens = blend_shape::tokens(scene);
    if let Some(skeleton) = &scene.skeleton {
        extent::write(&mut layer, &root, scene)?;
        skeleton::write(&mut layer, &format!("{root}/Skel"), skeleton, scene, &tokens)?;
    }
    let materials = material::paths(&format!("{root}/mtl"), &scene.materials);
    for (mesh, tokens) in scene.meshes.iter().zip(&tokens) {
        let path = format!("{root}/{}", names.unique(&mesh.name));
        let skeleton = skinned.then(|| format!("{root}/Skel"));
        let material = mesh.material as usize;
        let binding = mesh::Binding {
            skeleton: skeleton.as_deref(),
            material: &materials[material],
            double_sided: scene.materials[material].double_sided,
        };
        mesh::write(&mut layer, &path, mesh, &binding)?;
        blend_shape::write(&mut layer, &path, mesh, tokens)?;
    }
    layer.prim(&format!("{root}/mtl"), "mtl", "Scope")?;
    for (path, material) in materials.iter().zip(&scene.materials) {
        material::write(&mut layer, path, material)?;
    }
    Ok(layer)
}

fn layer_metadata(layer: &mut Layer, root: &str, scene: &Scene) -> Result<()> {
    layer.set("/", FieldKey::DefaultPrim, Value::token(root.trim_start_matches('/')))?;
    layer.set("/", "metersPerUnit", Value::Double(1.0))?;
    layer.set("/", "upAxis", Value::token("Y"))?;
    if let Some(clip) = scene.clips.first() {
        layer.set("/", FieldKey::StartTimeCode, Value::Double(0.0))?;
        layer.set("/", FieldKey::EndTimeCode, Value::Double((clip.frame_count() - 1) as f64))?;
        // One time code is one frame; set both, so that viewers that read only one play at the right speed.
        for rate in [FieldKey::TimeCodesPerSecond, FieldKey::FramesPerSecond] {
            layer.set("/", rate, Value::Double(clip.frames_per_second()))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
