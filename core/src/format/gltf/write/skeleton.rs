//! The joint tree as nodes, and the skin over them (glTF 2.0, sections 3.5 and 3.7.3).

use glam::Vec3;
use gltf_json::{Index, Node, Skin, scene::UnitQuaternion};
use serde_json::json;

use super::accessor::{DocumentBuilder, Usage};
use super::animation::REST_TOLERANCE;
use super::raw;
use crate::Result;
use crate::math::{RigidTransform, Rotation, unit};
use crate::skeleton::written::{WrittenJoint, plain};
use crate::skeleton::{Pose, Skeleton};

/// The transforms of the joint nodes: those of the bind pose, or of the pose where it moves a joint.
pub(super) fn nodes(transforms: &[WrittenJoint], pose: Option<&Pose>) -> Vec<RigidTransform> {
    let bind = transforms.iter().map(|written| written.parent_from_joint);
    let Some(pose) = pose else { return bind.collect() };
    let unmoved = |bind: &RigidTransform, posed: &RigidTransform| {
        bind.translation.abs_diff_eq(posed.translation, REST_TOLERANCE)
            && (bind.rotation.abs_diff_eq(posed.rotation, REST_TOLERANCE)
                || bind.rotation.abs_diff_eq(-posed.rotation, REST_TOLERANCE))
    };
    bind.zip(&pose.locals)
        .map(|(bind, posed)| if unmoved(&bind, posed) { bind } else { normalized(posed) })
        .collect()
}

/// With a rotation of unit length to the last digit, and without negative zeros.
fn normalized(transform: &RigidTransform) -> RigidTransform {
    let plain = |v: f32| v + 0.0;
    RigidTransform {
        rotation: Rotation::from_array(unit(transform.rotation).to_array().map(plain)),
        translation: Vec3::from_array(transform.translation.to_array().map(plain)),
    }
}

/// Appends the joint nodes, which become nodes `0..joints`, and the skin over them. A node's `extras.anthronet` holds
/// the length of the joint's bone, for which glTF has no field.
pub(super) fn push(
    builder: &mut DocumentBuilder,
    (name, skeleton): (&str, &Skeleton),
    transforms: &[WrittenJoint],
    nodes: &[RigidTransform],
) -> Result<Index<Skin>> {
    let mut children = vec![Vec::new(); skeleton.len()];
    for (i, parent) in (0u32..).zip(skeleton.parents()) {
        if let Some(siblings) = parent.and_then(|parent| children.get_mut(parent as usize)) {
            siblings.push(Index::new(i));
        }
    }
    let joints = skeleton.names().iter().zip(nodes).zip(children);
    for (joint, ((name, node), children)) in joints.enumerate() {
        let RigidTransform { translation, rotation } = *node;
        let length = |metres: f32| json!({"anthronet": {"bone_length": f64::from(metres)}});
        builder.root.push(Node {
            name: Some(name.clone()),
            children: (!children.is_empty()).then_some(children),
            translation: Some(translation.to_array()),
            rotation: (rotation != Rotation::IDENTITY).then_some(UnitQuaternion(rotation.to_array())),
            extras: skeleton.bone_length(joint).map_or(Ok(None), |metres| raw(&length(metres)))?,
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
    Ok(builder.root.push(Skin {
        extensions: None,
        extras: None,
        inverse_bind_matrices,
        joints: (0..skeleton.len() as u32).map(Index::new).collect(),
        name: (!name.is_empty()).then(|| name.to_owned()),
        skeleton: Some(Index::new(0)),
    }))
}
