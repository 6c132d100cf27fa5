//! VRM 1.0: a `.vrm` is a `.glb` with the extension VRMC_vrm, which states the author of the character and the nodes that
//! are the bones of a humanoid (github.com/vrm-c/vrm-specification, `VRMC_vrm-1.0`).
//!
//! Our bind pose is the T-pose facing +Z that the specification requires, so a scene with a pose is refused. Models contain no animation: a scene with clips
//! is refused, as motion belongs in a separate `.vrma` (`VRMC_vrm_animation-1.0`): skeleton and clips with the same table of
//! bones, without meshes. Motion of a `.vrm` is read all the same, as other programs leave animations in it.

use gltf_json::{Value, extensions};
use serde_json::{Map, json};

use super::gltf;
use super::gltf::write::{GltfOptions, document, document_of_motion, finished, glb};
use super::kind::{Description, Holds, Write};
use crate::scene::Scene;
use crate::skeleton::humanoid::{HumanoidBone, humanoid_bones};
use crate::{Error, Result};

const NAME: &str = "VRMC_vrm";
const ANIMATION: &str = "VRMC_vrm_animation";

/// Read as the glTF that it is.
pub(super) const VRM: Description = Description {
    extension: "vrm",
    title: "VRM 1.0",
    holds: Holds { meshes: true, skeleton: true, clips: false },
    write: Some(Write::Alone(|scene, options| to_vrm(scene, &options.vrm))),
    ..gltf::GLB
};

pub(super) const VRMA: Description = Description {
    extension: "vrma",
    title: "VRM Animation 1.0",
    holds: Holds { meshes: false, skeleton: true, clips: true },
    read_scene: None,
    read_meshes: None,
    write: Some(Write::Alone(|scene, _| to_vrma(scene))),
    ..gltf::GLB
};

/// Author and licence of a character.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VrmMeta {
    /// Title of the character; the scene's name if empty.
    pub name: String,
    /// Version of the character, in any form; omitted if empty.
    pub version: String,
    /// Its authors, at least one.
    pub authors: Vec<String>,
    /// Licence URL of the character, which must be the one that VRM 1.0 defines.
    pub license_url: String,
    /// Whether everybody may use, modify and redistribute the character, also commercially. If not, the file has VRM's
    /// defaults: use by its author only, and not commercially.
    pub free: bool,
}

impl Default for VrmMeta {
    /// A free character by AnthroNet.
    fn default() -> Self {
        Self {
            name: String::new(),
            version: String::new(),
            authors: vec!["AnthroNet".into()],
            license_url: "https://vrm.dev/licenses/1.0/".into(),
            free: true,
        }
    }
}

/// The scene as a VRM 1.0 model. Joints may be named in any vocabulary of
/// [`JointNames`](crate::skeleton::humanoid::JointNames).
///
/// # Errors
/// [`Error::Invalid`] as for [`to_glb`](crate::format::gltf::to_glb); for a scene with clips, with a pose or without a bone
/// that VRM requires; for a character without an author or with an empty name.
pub fn to_vrm(scene: &Scene, meta: &VrmMeta) -> Result<Vec<u8>> {
    refuse_pose(scene, "vrm")?;
    if let Some(clip) = scene.clips.first() {
        let message = format!("`{}`: a .vrm holds no motion, write it to a .glb", clip.name());
        return Err(Error::invalid("clip", message));
    }
    let mut builder = document(scene)?;
    let extension = json!({
        "specVersion": "1.0",
        "meta": meta_json(scene, meta)?,
        "humanoid": {"humanBones": human_bones(scene)?},
    });
    let others = Map::from_iter([(NAME.to_owned(), extension)]);
    builder.root.extensions = Some(extensions::Root { others });
    builder.root.extensions_used.push(NAME.into());
    glb(finished(builder, &GltfOptions::default(), None)?)
}

/// The skeleton and the clips of a scene as VRM Animation 1.0, of which players use the first clip. Joints may be named in any
/// vocabulary of [`JointNames`](crate::skeleton::humanoid::JointNames).
///
/// # Errors
/// [`Error::Invalid`] as for [`to_glb`](crate::format::gltf::to_glb); for a scene without a clip, with a pose or without a bone
/// that VRM requires.
pub fn to_vrma(scene: &Scene) -> Result<Vec<u8>> {
    refuse_pose(scene, "vrma")?;
    if scene.clips.is_empty() {
        return Err(Error::invalid("clip", "a .vrma holds a motion, expected at least one clip, got none"));
    }
    let mut builder = document_of_motion(scene)?;
    let extension = json!({"specVersion": "1.0", "humanoid": {"humanBones": human_bones(scene)?}});
    let others = Map::from_iter([(ANIMATION.to_owned(), extension)]);
    builder.root.extensions = Some(extensions::Root { others });
    builder.root.extensions_used.push(ANIMATION.into());
    glb(finished(builder, &GltfOptions::default(), None)?)
}

/// Both specifications demand that the joints rest in the T-pose.
fn refuse_pose(scene: &Scene, extension: &str) -> Result<()> {
    match scene.pose {
        Some(_) => {
            let message =
                format!("a .{extension} must rest in the T-pose, write the posed character to a .glb");
            Err(Error::invalid("pose", message))
        }
        None => Ok(()),
    }
}

fn meta_json(scene: &Scene, meta: &VrmMeta) -> Result<Value> {
    let name = if meta.name.is_empty() { &scene.name } else { &meta.name };
    if name.is_empty() {
        return Err(Error::invalid("VRM", "expected a name of the figure, got none"));
    }
    if meta.authors.is_empty() || meta.authors.iter().any(String::is_empty) {
        return Err(Error::invalid(
            "VRM",
            "expected the names of one or more authors, got none or an empty one",
        ));
    }
    let mut json = json!({"name": name, "authors": meta.authors, "licenseUrl": meta.license_url});
    if !meta.version.is_empty() {
        json["version"] = meta.version.as_str().into();
    }
    if meta.free {
        json["avatarPermission"] = "everyone".into();
        json["commercialUsage"] = "corporation".into();
        json["creditNotation"] = "unnecessary".into();
        json["allowRedistribution"] = true.into();
        json["modification"] = "allowModificationRedistribution".into();
    }
    Ok(json)
}

/// `humanBones`: all humanoid bones found among the joints.
fn human_bones(scene: &Scene) -> Result<Value> {
    let find = |bone: &HumanoidBone| {
        let names = [&bone.native, &bone.vrm, &bone.unity, &bone.mixamo, &bone.blender];
        names.into_iter().find_map(|name| scene.skeleton.as_ref()?.find(name))
    };
    let mut bones = Map::new();
    for bone in humanoid_bones() {
        match find(bone) {
            Some(node) => drop(bones.insert(bone.vrm.clone(), json!({"node": node}))),
            None if bone.required => {
                let message = format!("requires the bone `{}`, no joint is it", bone.vrm);
                return Err(Error::invalid("VRM", message));
            }
            None => {}
        }
    }
    Ok(Value::Object(bones))
}
