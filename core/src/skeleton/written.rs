//! A bind pose as files hold it: below its parent, in `f32`.
//!
//! A bind pose is a matrix of `f32` and a file's joint is a translation and a quaternion, so that writing and reading
//! both round. What is here is what reading and writing again gives back: a body's joints are these from the start, and
//! a motion comes onto a person and onto the file of it alike.

use glam::{Affine3A, DAffine3, DMat3, DQuat, DVec3, Mat3A};

/// Finest step of metres and of components of quaternions, 2⁻²⁶: a quarter of the rounding of `f32` near 1.
const GRID: f64 = 1.0 / 67_108_864.0;
/// Roundings after which a transform stops being rounded further; nearly all settle in two or three.
const MAX_ROUNDINGS: usize = 64;

/// A joint in its parent.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct ParentFromJoint {
    pub(crate) translation: [f32; 3],
    /// Unit quaternion x, y, z, w.
    pub(crate) rotation: [f32; 4],
}

impl ParentFromJoint {
    pub(crate) fn to_affine(self) -> DAffine3 {
        DAffine3::from_rotation_translation(
            DQuat::from_array(self.rotation.map(f64::from)),
            DVec3::from_array(self.translation.map(f64::from)),
        )
    }

    fn of(parent_from_joint: &DAffine3) -> Self {
        let rotation = DQuat::from_mat3(&parent_from_joint.matrix3).normalize();
        let rotation = if rotation.w < 0.0 { -rotation } else { rotation };
        Self {
            translation: parent_from_joint.translation.to_array().map(on_grid),
            rotation: rotation.to_array().map(on_grid),
        }
    }

    fn bits(self) -> ([u32; 3], [u32; 4]) {
        (self.translation.map(f32::to_bits), self.rotation.map(f32::to_bits))
    }
}

/// A joint as it stands in a file.
pub(crate) struct WrittenJoint {
    pub(crate) parent_from_joint: ParentFromJoint,
    /// Product of the written transforms from the root down.
    pub(crate) model_from_joint: DAffine3,
}

/// Splits every bind pose into a translation and a rotation below its parent. What rounding to `f32` moves a parent by,
/// its children take back, so that errors do not add up along a chain.
pub(crate) fn written_joints(joints: impl Iterator<Item = (Option<u32>, Affine3A)>) -> Vec<WrittenJoint> {
    let mut written: Vec<WrittenJoint> = Vec::with_capacity(joints.size_hint().0);
    for (parent, model_from_joint) in joints {
        let parent =
            parent.and_then(|p| written.get(p as usize)).map_or(DAffine3::IDENTITY, |p| p.model_from_joint);
        let parent_from_joint = settled(&parent, model_from_joint);
        let model_from_joint = parent * parent_from_joint.to_affine();
        written.push(WrittenJoint { parent_from_joint, model_from_joint });
    }
    written
}

/// Rounds a bind pose to what a file gives back of it.
pub(super) fn round_to_file(parents: &[Option<u32>], bind: &mut [Affine3A]) {
    let written = written_joints(parents.iter().copied().zip(bind.iter().copied()));
    for (bind, written) in bind.iter_mut().zip(&written) {
        *bind = rounded(&written.model_from_joint);
    }
}

/// The transform that writing and reading by turns ends up with. A bind pose is a matrix of `f32` and a node is
/// not, so either step rounds; written is what reading and writing again gives back, that a file survives it bit for
/// bit. Where the two steps take turns between several transforms, the first in the order of their bits is taken.
fn settled(parent: &DAffine3, model_from_joint: Affine3A) -> ParentFromJoint {
    let joint_from_model = parent.inverse();
    let mut wanted = model_from_joint;
    let mut seen: Vec<ParentFromJoint> = Vec::new();
    loop {
        let node = ParentFromJoint::of(&(joint_from_model * widened(wanted)));
        if let Some(first) = seen.iter().position(|s| *s == node) {
            return seen[first..].iter().copied().min_by_key(|s| s.bits()).unwrap_or(node);
        }
        if seen.len() == MAX_ROUNDINGS {
            return node;
        }
        seen.push(node);
        wanted = rounded(&(parent * node.to_affine()));
    }
}

/// A bind pose as the scene holds it.
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

/// To `f32`, without the digits of small numbers that a bind pose, whose numbers are near 1, knows nothing of: they
/// would be others each time.
fn on_grid(value: f64) -> f32 {
    plain((value / GRID).round() * GRID)
}

/// To `f32`, without a negative zero.
pub(crate) fn plain(value: f64) -> f32 {
    value as f32 + 0.0
}
