//! Linear blend skinning, as glTF 2.0 (§3.7.3.3), UsdSkel and Blender's Armature modifier define it.

use glam::{DMat3, Vec4};

use super::block::{Block, Lanes, dot, scaled, transposed};
use crate::math::RigidTransformF64;

/// The first three rows of a matrix.
pub(super) type Rows = [Vec4; 3];

/// The matrix of a joint's skinning transform.
pub(super) fn rows(motion: &RigidTransformF64) -> Rows {
    let rotation = DMat3::from_quat(motion.rotation);
    std::array::from_fn(|i| rotation.row(i).extend(motion.translation[i]).as_vec4())
}

/// Transforms positions by the blended matrix; normals by its linear part, then normalises them. All joint transforms are
/// rigid, hence no inverse transpose, as in UsdSkel with such joints and in shaders. A normal that blending cancels out is
/// zero.
#[inline(always)]
pub(super) fn deform(palette: &[Rows], block: &Block<'_>) -> (Lanes, Lanes) {
    let mut blended = [[Vec4::ZERO; 3]; 4];
    for (weights, joints) in block.slots() {
        for lane in 0..4 {
            let weight = Vec4::splat(weights[lane]);
            let rows = &palette[joints[lane]];
            for row in 0..3 {
                blended[lane][row] += rows[row] * weight;
            }
        }
    }
    let mut positions = [Vec4::ZERO; 3];
    let mut normals = [Vec4::ZERO; 3];
    for row in 0..3 {
        let [x, y, z, translation] = transposed(blended.map(|rows| rows[row]));
        positions[row] = dot([x, y, z], block.positions) + translation;
        normals[row] = dot([x, y, z], block.normals);
    }
    let squared = dot(normals, normals).max(Vec4::splat(f32::MIN_POSITIVE));
    // `Vec4::sqrt` is four scalar roots; this compiles to one instruction. IEEE 754 requires the same result.
    let length = Vec4::from_array(squared.to_array().map(f32::sqrt));
    (positions, scaled(normals, length.recip()))
}
