//! Writes the joint tree as a Skeleton, with the clips below it.

use glam::{Affine3A, DAffine3, DMat3, DVec3};
use openusd::gf::Matrix4d;
use openusd::sdf::Value;

use super::layer::Layer;
use super::names::Names;
use super::{animation, blend_shape};
use crate::Result;
use crate::scene::Scene;
use crate::skeleton::{JointTree, Skeleton};

/// Custom attribute of the Skeleton: length of each joint's bone along its +Y axis, metres.
pub(crate) const BONE_LENGTHS: &str = "anthronet:boneLengths";

/// Writes the skeleton to this path, with its animations; `tokens` identify morph target weights.
pub(super) fn write(
    layer: &mut Layer,
    path: &str,
    skeleton: &Skeleton,
    scene: &Scene,
    tokens: &[Vec<String>],
) -> Result<()> {
    layer.prim(path, "Skel", "Skeleton")?;
    let joints = joint_tokens(skeleton.tree());
    let bind: Vec<DAffine3> = skeleton.bind().iter().map(in_double).collect();
    let bind_rest = skeleton.parents().iter().zip(&bind).map(|(parent, model_from_joint)| {
        let parent = parent.map(|p| bind[p as usize]);
        parent.map_or(*model_from_joint, |parent| parent.inverse() * *model_from_joint)
    });
    let rest: Vec<DAffine3> = match &scene.pose {
        Some(pose) => pose.locals.iter().map(|local| local.to_affine_f64()).collect(),
        None => bind_rest.collect(),
    };
    layer.uniform(path, "joints", "token[]", joints.clone())?;
    let names = skeleton.names().iter().map(String::as_str);
    layer.uniform(path, "jointNames", "token[]", Value::token_vec(names))?;
    // USD has no attribute for the end of a bone; a negative length means none.
    let lengths = (0..skeleton.len()).map(|joint| skeleton.bone_length(joint));
    if lengths.clone().any(|length| length.is_some()) {
        let lengths = lengths.map(|length| length.unwrap_or(-1.0)).collect();
        layer.custom(path, BONE_LENGTHS, "float[]", Value::FloatVec(lengths))?;
    }
    layer.uniform(path, "bindTransforms", "matrix4d[]", matrices(bind.iter().copied()))?;
    layer.uniform(path, "restTransforms", "matrix4d[]", matrices(rest.into_iter()))?;

    let Some(first) = scene.clips.first() else { return Ok(()) };
    let time_codes_per_second = first.frames_per_second();
    let mut names = Names::reserved(["Anim"]);
    for (i, clip) in scene.clips.iter().enumerate() {
        let name = if i == 0 { "Anim".to_owned() } else { names.unique(clip.name()) };
        let (path, pace) = (format!("{path}/{name}"), time_codes_per_second / clip.frames_per_second());
        animation::write(layer, &path, clip, &joints, pace)?;
        blend_shape::animate(layer, &path, (scene, i), tokens, pace)?;
    }
    layer.apply(path, "SkelBindingAPI")?;
    layer.relate(path, "skel:animationSource", &format!("{path}/Anim"))
}

/// The joints as paths from the root joint, such as `Root/pelvis/spine_01`.
///
/// Identifiers are unique in the whole tree, not only among siblings: programs name bones by the last element.
fn joint_tokens(joints: &JointTree) -> Value {
    let mut names = Names::default();
    let mut paths: Vec<String> = Vec::with_capacity(joints.len());
    for (name, parent) in joints.names().iter().zip(joints.parents()) {
        let name = names.unique(name);
        let parent = parent.and_then(|p| paths.get(p as usize));
        paths.push(parent.map_or(name.clone(), |parent| format!("{parent}/{name}")));
    }
    Value::token_vec(paths)
}

fn in_double(transform: &Affine3A) -> DAffine3 {
    let m = transform.matrix3.to_cols_array().map(f64::from);
    DAffine3 {
        matrix3: DMat3::from_cols_array(&m),
        translation: DVec3::from(transform.translation.to_array().map(f64::from)),
    }
}

/// USD stores matrices for row vectors row by row: the same sixteen numbers as the columns of a matrix for column vectors.
fn matrices(transforms: impl Iterator<Item = DAffine3>) -> Value {
    Value::Matrix4dVec(transforms.map(|t| Matrix4d(glam::DMat4::from(t).to_cols_array())).collect())
}
