//! Characters from USD: the first skeleton that is animated, or the first at all, with its meshes, materials and clips.
//!
//! One layer is read; what it refers to in other files is not. What `export::usd` keeps beside USD's own words comes
//! back: display names, joint names, extras. Characters of other programs come in the bind pose, without scale; faces
//! of more than four corners as fans of triangles, materials that are no UsdPreviewSurface in grey.

mod material;
mod mesh;

use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};
use openusd::sdf::{FieldKey, Path as PrimPath, Value};

use crate::clip::{Clip, TranslationTrack};
use crate::error::Outcome;
use crate::format::ReadOptions;
use crate::format::meshes::{ImportedMesh, ImportedScene, MAX_MESHES};
use crate::format::motion::from_bytes as clips_from_bytes;
use crate::format::usd::document::Layer;
use crate::format::usd::skeleton::{Joints, chosen};
use crate::format::usd::values;
use crate::format::usd::write::EXTRAS;
use crate::format::usd::write::skeleton::BONE_LENGTHS;
use crate::format::usd::xform::Xforms;
use crate::scene::titles::Titles;
use crate::scene::{Scene, SceneJoint};
use crate::skeleton::written::rounded;
use crate::space::{Axis, Unit};
use crate::{Error, Result};

/// Where a rest pose leaves the bind pose by so many metres, a clip says where its joints are.
const REST_TOLERANCE: f32 = 1e-6;

/// Reads the meshes alone, as triangles.
///
/// # Errors
/// As [`scene_from_bytes`].
pub fn from_bytes(bytes: &[u8], path: &Path) -> Result<ImportedScene> {
    let scene = scene_from_bytes(bytes, path)?;
    let mesh = |mesh: &crate::scene::SceneMesh| ImportedMesh {
        name: mesh.name.clone(),
        positions: mesh.positions.iter().map(|p| (*p).into()).collect(),
        model_vertices: mesh.positions.len(),
        triangles: mesh.triangulated().iter().map(|t| t.map(|corner| corner.0)).collect(),
        normals: mesh.normals.iter().map(|n| (*n).into()).collect(),
        base_color: scene.materials.get(mesh.material as usize).map_or([1.0; 4], |m| m.base_color),
        skinned: mesh.influences_per_vertex > 0,
    };
    Ok(ImportedScene {
        meshes: scene.meshes.iter().map(mesh).collect(),
        extras: scene.extras.clone(),
        joint_names: scene.joints.iter().map(|joint| joint.name.clone()).collect(),
    })
}

/// Reads the whole character of a `.usda`, `.usdc` or `.usdz` that is already in memory.
///
/// # Errors
/// [`Error::File`] says which prim or attribute is wrong, what was expected and what came.
pub fn scene_from_bytes(bytes: &[u8], path: &Path) -> Result<Scene> {
    let fault = |message: String| Error::file(path, message);
    let (mut scene, space) = character(bytes).map_err(fault)?;
    if space.animated && !scene.joints.is_empty() {
        let options = ReadOptions { unit: Some(space.unit), up: Some(space.up), frames_per_second: None };
        let motion = clips_from_bytes(bytes, path, &options)?;
        scene.clips = in_bind_pose(&scene, motion.clips)?;
    }
    scene.validate().map_err(|error| fault(error.to_string()))?;
    Ok(scene)
}

/// Units and axes of a file, and whether anything moves.
struct Space {
    unit: Unit,
    up: Axis,
    animated: bool,
}

impl Space {
    fn read(layer: &Layer) -> Outcome<Self> {
        // USD's own default is the centimetre.
        let metres = layer.number("metersPerUnit")?.unwrap_or(0.01);
        let unit = Unit::of_metres(metres)
            .ok_or_else(|| format!("metersPerUnit: expected a positive number, got {metres}"))?;
        let up = match layer.text(&PrimPath::abs_root(), "upAxis")?.as_deref() {
            Some("Z") => Axis::Z,
            _ => Axis::Y,
        };
        Ok(Self { unit, up, animated: false })
    }

    /// Our space from the file's.
    fn ours_from_file(&self) -> DAffine3 {
        let [x, y, z, w] = self.up.ours_from_file().to_array().map(f64::from);
        let turn = DQuat::from_xyzw(x, y, z, w).normalize();
        DAffine3::from_scale_rotation_translation(DVec3::splat(self.unit.metres()), turn, DVec3::ZERO)
    }
}

/// Everything but the clips.
fn character(bytes: &[u8]) -> Outcome<(Scene, Space)> {
    let layer = Layer::open(bytes)?;
    let prims = layer.prims()?;
    let mut space = Space::read(&layer)?;
    let ours_from_file = space.ours_from_file();
    let (mut skeletons, mut meshes) = (Vec::new(), Vec::new());
    for prim in &prims {
        match layer.type_name(prim)?.as_str() {
            "Skeleton" => skeletons.push(prim),
            "Mesh" => meshes.push(prim),
            "SkelAnimation" => space.animated = true,
            _ => {}
        }
    }
    if meshes.is_empty() || meshes.len() > MAX_MESHES {
        return Err(format!(
            "expected 1 to {MAX_MESHES} meshes, found {} in {} prims",
            meshes.len(),
            prims.len()
        ));
    }

    let mut scene = Scene { name: "Character".into(), ..Scene::default() };
    if let Some(root) = layer.main_prim(&prims)? {
        scene.name = title(&layer, &root)?;
        if let Some(Value::Dictionary(data)) = layer.field(&root, FieldKey::CustomData.as_str())?
            && let Some(Value::String(text)) = data.get(EXTRAS)
        {
            scene.extras = serde_json::from_str(text).map_err(|e| format!("{root}: {EXTRAS}: {e}"))?;
        }
    }
    let skeleton = match chosen(&layer, &skeletons)? {
        None => None,
        Some((prim, _)) => {
            let joints = Joints::read(&layer, prim)?;
            let above = ours_from_file * Xforms::read(&layer, prim)?.at_start()?;
            let bind = joints.bind_pose(&layer, prim, &above)?;
            scene.joints = scene_joints(&joints, &bind);
            bone_lengths(&layer, prim, &joints, &mut scene.joints)?;
            Some(mesh::Skeleton { prim: prim.clone(), above, joints })
        }
    };
    let (mut materials, mut titles) = (material::Materials::default(), Titles::default());
    for prim in meshes {
        let mut read = mesh::read(&layer, prim, skeleton.as_ref(), &ours_from_file)?;
        read.mesh.name = titles.unique(&title(&layer, prim)?);
        read.mesh.material = materials.of(&layer, prim, read.double_sided)?;
        scene.meshes.push(read.mesh);
    }
    // The body of our own files is the first already.
    scene.materials = materials.into_list();
    Ok((scene, space))
}

fn scene_joints(joints: &Joints, bind: &[DAffine3]) -> Vec<SceneJoint> {
    let mut titles = Titles::default();
    let parts = joints.names.iter().zip(&joints.parents).zip(bind);
    parts
        .map(|((name, parent), bind)| SceneJoint {
            name: titles.unique(name),
            parent: *parent,
            model_from_joint: rounded(bind),
            bone_length: None,
        })
        .collect()
}

/// What our own files say of the lengths of bones.
fn bone_lengths(
    layer: &Layer,
    prim: &PrimPath,
    joints: &Joints,
    scene_joints: &mut [SceneJoint],
) -> Outcome<()> {
    let Some(value) = layer.default(prim, BONE_LENGTHS)? else { return Ok(()) };
    let lengths = values::rows::<1>(&value).unwrap_or_default();
    if lengths.len() != joints.places.len() {
        let (expected, got) = (joints.places.len(), lengths.len());
        return Err(format!("{prim}.{BONE_LENGTHS}: expected {expected} numbers, got {got}"));
    }
    for (joint, place) in scene_joints.iter_mut().zip(&joints.places) {
        let [length] = lengths[*place];
        joint.bone_length = (length >= 0.0).then_some(length as f32);
    }
    Ok(())
}

/// The clips over the scene's own joints, which rest in the bind pose; files of others rest where they like.
fn in_bind_pose(scene: &Scene, clips: Vec<Clip>) -> Result<Vec<Clip>> {
    let rest = Arc::new(scene.skeleton(str::to_owned)?);
    let mut titles = Titles::default();
    let mut out: Vec<Clip> = Vec::with_capacity(clips.len());
    for clip in clips {
        let frames = clip.frame_count();
        let rotations = (0..frames).flat_map(|frame| clip.rotations(frame).iter().copied()).collect();
        let mut tracks = clip.translations().to_vec();
        let both = clip.skeleton().rest_pose().locals.iter().zip(&rest.rest_pose().locals);
        for (joint, (own, bind)) in both.enumerate() {
            let moves = tracks.iter().any(|track| track.joint as usize == joint);
            if !moves && own.translation.distance(bind.translation) > REST_TOLERANCE {
                tracks.push(TranslationTrack { joint: joint as u32, values: vec![own.translation; frames] });
            }
        }
        let name = titles.unique(clip.name());
        out.push(Clip::new(name, rest.clone(), clip.frames_per_second(), rotations, tracks)?);
    }
    Ok(out)
}

/// A prim's display name, else its name.
fn title(layer: &Layer, prim: &PrimPath) -> Outcome<String> {
    let shown = layer.text(prim, FieldKey::DisplayName.as_str())?.filter(|name| !name.is_empty());
    Ok(shown.unwrap_or_else(|| prim.name().unwrap_or("prim").to_owned()))
}

#[cfg(test)]
mod tests;
