//! Reads characters from USD: the first animated skeleton, or else the first, with its meshes, materials and clips.
//!
//! What the writer stores beside USD's own attributes is
//! restored: display names, joint names, extras. Characters from other programs are read in the bind pose, without scale;
//! faces of more than four corners become triangle fans, materials that are not a UsdPreviewSurface become grey.

mod blend_shape;
mod material;
mod mesh;

use std::path::Path;
use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};
use openusd::sdf::{FieldKey, Path as PrimPath, Value};

use super::Result;
use super::document::layer::Layer;
use super::document::skeleton::{Joints, Skeleton};
use super::document::{Document, values};
use super::motion;
use super::write::EXTRAS;
use super::write::skeleton::BONE_LENGTHS;
use crate::clip::{Clip, TranslationTrack};
use crate::error::{Fault, ParserError, UsdError, Within};
use crate::format::limits::MAX_MESHES;
use crate::format::motion::raw::WeightTrack;
use crate::format::motion::{ReadOptions, clip_name, units_and_axes};
use crate::scene::titles::Titles;
use crate::scene::{MorphTrack, Scene};
use crate::skeleton::written::rounded;
use crate::skeleton::{JointTree, Pose};
use crate::space::{Axis, Unit};

/// A joint whose rest position is farther than this from its bind position, metres, gets a translation track.
const REST_TOLERANCE: f32 = 1e-6;

/// Reads only the meshes: skinned ones in the bind pose, the others where the file places them.
pub(super) fn meshes(document: &Document) -> Result<Scene> {
    let space = Space::read(&document.layer)?;
    let (mut scene, _) = still(document, &space, document.skeleton()?.as_ref())?;
    scene.remove_skin();
    Ok(scene)
}

/// Reads the whole character. Its clips are those of its skeleton; `path` names unnamed ones.
pub(super) fn scene(document: &Document, path: &Path) -> Result<Scene> {
    let space = Space::read(&document.layer)?;
    let skeleton = document.skeleton()?;
    let (mut scene, tokens) = still(document, &space, skeleton.as_ref())?;
    if let (Some(skeleton), false) = (&skeleton, document.animations.is_empty()) {
        let options = ReadOptions { unit: Some(space.unit), up: Some(space.up), ..ReadOptions::default() };
        let mut raw = motion::of_skeleton(document, skeleton, &clip_name(path), &options)?;
        for (clip, take) in (0u32..).zip(&mut raw.takes) {
            add_morph_tracks(&mut scene, clip, std::mem::take(&mut take.weights), &tokens);
        }
        let clips = units_and_axes::resolve(raw, &options).map_err(Box::new)?.clips;
        scene.clips = in_bind_pose(&scene, clips).map_err(Box::new)?;
    }
    scene.validate().map_err(Box::new)?;
    Ok(scene)
}

/// Adds a clip's weight tracks to all targets with their tokens; tracks that are always 0 are omitted.
fn add_morph_tracks(scene: &mut Scene, clip: u32, weights: Vec<WeightTrack>, tokens: &[Vec<String>]) {
    for WeightTrack { token, weights } in weights {
        if weights.iter().all(|weight| *weight == 0.0) {
            continue;
        }
        for (mesh, tokens) in (0u32..).zip(tokens) {
            for (target, _) in (0u32..).zip(tokens).filter(|(_, of_target)| **of_target == token) {
                scene.morph_tracks.push(MorphTrack { clip, mesh, target, weights: weights.clone() });
            }
        }
    }
}

/// Units and axes of a file.
struct Space {
    unit: Unit,
    up: Axis,
}

impl Space {
    fn read(layer: &Layer) -> Result<Self> {
        // USD's own default is the centimetre.
        let metres = layer.number("metersPerUnit")?.unwrap_or(0.01);
        let unit = Unit::from_metres(metres)
            .ok_or_else(|| UsdError::from(Fault::unexpected("a positive number", metres)))
            .within("metersPerUnit")?;
        let up = match layer.text(&PrimPath::abs_root(), "upAxis")?.as_deref() {
            Some("Z") => Axis::Z,
            _ => Axis::Y,
        };
        Ok(Self { unit, up })
    }

    /// From the file's space to ours.
    fn ours_from_file(&self) -> DAffine3 {
        let [x, y, z, w] = self.up.ours_from_file().to_array().map(f64::from);
        let turn = DQuat::from_xyzw(x, y, z, w).normalize();
        DAffine3::from_scale_rotation_translation(DVec3::splat(self.unit.metres()), turn, DVec3::ZERO)
    }
}

/// Everything but the clips; and for each mesh the tokens that identify its morph target weights.
fn still(
    document: &Document,
    space: &Space,
    skeleton: Option<&Skeleton>,
) -> Result<(Scene, Vec<Vec<String>>)> {
    let Document { layer, prims, meshes, missing, .. } = document;
    if let Some(missing) = missing.first() {
        // A character has no report that could say so.
        return Err(Fault::inconsistent(format_args!("cannot be read whole: {missing}")).into());
    }
    let ours_from_file = space.ours_from_file();
    if meshes.is_empty() || meshes.len() > MAX_MESHES {
        let found = format!("{} in {} prims", meshes.len(), prims.len());
        return Err(Fault::unexpected(format_args!("1 to {MAX_MESHES} meshes"), found).into());
    }

    let mut scene = Scene { name: "Character".into(), ..Scene::default() };
    if let Some(root) = layer.main_prim(prims)? {
        scene.name = title(layer, &root)?;
        if let Some(Value::Dictionary(data)) = layer.field(&root, FieldKey::CustomData.as_str())?
            && let Some(Value::String(text)) = data.get(EXTRAS)
        {
            let refused = |e: serde_json::Error| UsdError::from(ParserError::refused(e));
            scene.extras =
                serde_json::from_str(text).map_err(refused).within(format_args!("{root}: {EXTRAS}"))?;
        }
    }
    let skin = match skeleton {
        None => None,
        Some(skeleton) => {
            let Skeleton { prim, joints, above, .. } = skeleton;
            let above = ours_from_file * above.at_start()?;
            let bind = joints.bind_pose(layer, prim, &above)?;
            let lengths = bone_lengths(layer, prim, joints)?;
            scene.skeleton = Some(Arc::new(scene_skeleton(joints, &bind, lengths).map_err(Box::new)?));
            scene.pose = scene.read_as_posed().then(|| Pose { locals: joints.locals(&above) });
            Some(mesh::Skin { skeleton, above })
        }
    };
    let (mut materials, mut titles) = (material::Materials::default(), Titles::default());
    let mut tokens = Vec::with_capacity(meshes.len());
    for prim in meshes {
        let mut read = mesh::read(layer, prim, skin.as_ref(), &ours_from_file)?;
        read.mesh.name = titles.unique(&title(layer, prim)?);
        read.mesh.material = materials.of(layer, prim, read.double_sided)?;
        // In our own files the body is the first mesh already.
        scene.meshes.push(read.mesh);
        tokens.push(read.tokens);
    }
    scene.materials = materials.into_list();
    Ok((scene, tokens))
}

/// The joints in their bind pose, with unique names.
fn scene_skeleton(
    joints: &Joints,
    bind: &[DAffine3],
    lengths: Vec<Option<f32>>,
) -> crate::Result<crate::skeleton::Skeleton> {
    let mut titles = Titles::default();
    let names = joints.names.iter().map(|name| titles.unique(name)).collect();
    let tree = Arc::new(JointTree::new(names, joints.parents.clone())?);
    crate::skeleton::Skeleton::from_bind(tree, bind.iter().map(rounded).collect(), lengths)
}

/// Bone lengths, which only our own files state.
fn bone_lengths(layer: &Layer, prim: &PrimPath, joints: &Joints) -> Result<Vec<Option<f32>>> {
    let Some(value) = layer.default(prim, BONE_LENGTHS)? else { return Ok(vec![None; joints.names.len()]) };
    let lengths = values::rows::<1>(&value).unwrap_or_default();
    if lengths.len() != joints.places.len() {
        let expected = format!("{} numbers", joints.places.len());
        return Err(Fault::unexpected(expected, lengths.len()).into())
            .within(format_args!("{prim}.{BONE_LENGTHS}"));
    }
    let length = |place: &usize| (lengths[*place][0] >= 0.0).then_some(lengths[*place][0] as f32);
    Ok(joints.places.iter().map(length).collect())
}

/// The clips on the scene's skeleton, whose rest pose is the bind pose; other programs' rest poses may differ from it.
fn in_bind_pose(scene: &Scene, clips: Vec<Clip>) -> crate::Result<Vec<Clip>> {
    let rest = Arc::new(scene.skeleton_with_ends(str::to_owned)?);
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

/// A prim's display name, or else its name.
fn title(layer: &Layer, prim: &PrimPath) -> Result<String> {
    let shown = layer.text(prim, FieldKey::DisplayName.as_str())?.filter(|name| !name.is_empty());
    Ok(shown.unwrap_or_else(|| prim.name().unwrap_or("prim").to_owned()))
}

#[cfg(test)]
mod tests;
