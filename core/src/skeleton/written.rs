//! A bind pose as files store it: relative to the parent, in `f32`.
//!
//! A bind pose is a matrix of `f32`, but a file stores a translation and a quaternion, so that writing and reading both
//! round. The transforms here are fixed points of writing and reading. Bodies have such joints from the start, so that
//! retargeting to a body and to its file gives the same result.

use glam::{Affine3A, DAffine3, DMat3, DQuat, Mat3A, Vec3};

use crate::math::{RigidTransform, Rotation};

/// Grid to which metres and components of quaternions are rounded, 2⁻²⁶: an eighth of the `f32` spacing above 1.
const GRID: f64 = 1.0 / 67_108_864.0;
/// Most iterations in search of a fixed point; nearly all transforms need two or three.
const MAX_ROUNDINGS: usize = 64;

/// A joint's transform relative to its parent as a file stores it.
fn stored(parent_from_joint: &DAffine3) -> RigidTransform {
    let rotation = DQuat::from_mat3(&parent_from_joint.matrix3).normalize();
    let rotation = if rotation.w < 0.0 { -rotation } else { rotation };
    RigidTransform {
        translation: Vec3::from_array(parent_from_joint.translation.to_array().map(on_grid)),
        rotation: Rotation::from_array(rotation.to_array().map(on_grid)),
    }
}

/// An order of transforms.
fn bits(transform: RigidTransform) -> ([u32; 3], [u32; 4]) {
    (transform.translation.to_array().map(f32::to_bits), transform.rotation.to_array().map(f32::to_bits))
}

/// A joint as a file stores it.
pub(crate) struct WrittenJoint {
    pub(crate) parent_from_joint: RigidTransform,
    /// Product of the stored transforms from the root down.
    pub(crate) model_from_joint: DAffine3,
}

/// Splits every bind pose into a translation and a rotation relative to its parent as stored, so that children compensate
/// for the rounding of their parents and errors do not accumulate along a chain.
pub(crate) fn written_joints(joints: impl Iterator<Item = (Option<u32>, Affine3A)>) -> Vec<WrittenJoint> {
    let mut written: Vec<WrittenJoint> = Vec::with_capacity(joints.size_hint().0);
    for (parent, model_from_joint) in joints {
        let parent =
            parent.and_then(|p| written.get(p as usize)).map_or(DAffine3::IDENTITY, |p| p.model_from_joint);
        let parent_from_joint = fixed_point(&parent, model_from_joint);
        let model_from_joint = parent * parent_from_joint.to_affine_f64();
        written.push(WrittenJoint { parent_from_joint, model_from_joint });
    }
    written
}

/// Rounds a bind pose so that writing it to a file and reading it changes nothing.
pub(super) fn round_to_file(parents: &[Option<u32>], bind: &mut [Affine3A]) {
    let written = written_joints(parents.iter().copied().zip(bind.iter().copied()));
    for (bind, written) in bind.iter_mut().zip(&written) {
        *bind = rounded(&written.model_from_joint);
    }
}

/// Writes and reads a bind pose by turns until the stored transform no longer changes, so that a file survives reading and
/// writing bit for bit. Where that ends in a cycle of several transforms, the first in the order of their bits is taken.
fn fixed_point(parent: &DAffine3, model_from_joint: Affine3A) -> RigidTransform {
    let joint_from_model = parent.inverse();
    let mut read = model_from_joint;
    let mut seen: Vec<RigidTransform> = Vec::new();
    loop {
        let node = stored(&(joint_from_model * widened(read)));
        if let Some(first) = seen.iter().position(|s| *s == node) {
            return seen[first..].iter().copied().min_by_key(|s| bits(*s)).unwrap_or(node);
        }
        if seen.len() == MAX_ROUNDINGS {
            return node;
        }
        seen.push(node);
        read = rounded(&(parent * node.to_affine_f64()));
    }
}

/// Rounds a bind pose to `f32`, as scenes hold it.
pub(crate) fn rounded(transform: &DAffine3) -> Affine3A {
    let m = transform.matrix3;
    let columns = [m.x_axis, m.y_axis, m.z_axis].map(|c| c.as_vec3().into());
    Affine3A {
        matrix3: Mat3A::from_cols(columns[0], columns[1], columns[2]),
        translation: transform.translation.as_vec3().into(),
    }
}

fn widened(transform: Affine3A) -> DAffine3 {
    let m = transform.matrix3;
    DAffine3 {
        matrix3: DMat3::from_cols(m.x_axis.as_dvec3(), m.y_axis.as_dvec3(), m.z_axis.as_dvec3()),
        translation: transform.translation.as_dvec3(),
    }
}

/// To `f32`, rounded to [`GRID`]: the finer digits of small numbers are lost in a bind pose, whose numbers are near 1, and
/// would differ each time.
fn on_grid(value: f64) -> f32 {
    plain((value / GRID).round() * GRID)
}

/// To `f32`, without a negative zero.
pub(crate) fn plain(value: f64) -> f32 {
    value as f32 + 0.0
}
