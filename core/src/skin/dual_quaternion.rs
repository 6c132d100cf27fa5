//! Dual quaternion linear blending (Kavan, Collins, Žára, O'Sullivan, *Geometric Skinning with Approximate Dual
//! Quaternion Blending*, 2008), as in Blender's Armature modifier with *Preserve Volume*.
//!
//! q and −q are the same rotation but blend differently. As in Blender, each joint's sign is chosen to agree with the sum
//! of the joints before it, in the order of the vertex's influences: strongest first.

use glam::Vec4;

use super::block::{Block, Lanes, add, cross, dot, scaled, transposed};
use crate::math::RigidTransformF64;

/// Real and dual part, x, y, z, w each.
pub(super) type DualQuaternion = [Vec4; 2];

/// The dual quaternion of a joint's motion.
pub(super) fn dual_quaternion(motion: &RigidTransformF64) -> DualQuaternion {
    let translation = glam::DQuat::from_vec4(motion.translation.extend(0.0));
    let dual = glam::DVec4::from(translation * motion.rotation) * 0.5;
    [glam::DVec4::from(motion.rotation).as_vec4(), dual.as_vec4()]
}

/// Applies the normalised blend, which is a rigid transform, so unit normals stay unit normals.
#[inline(always)]
pub(super) fn deform(palette: &[DualQuaternion], block: &Block<'_>) -> (Lanes, Lanes) {
    let mut real = [Vec4::ZERO; 4];
    let mut dual = [Vec4::ZERO; 4];
    for (weights, joints) in block.slots() {
        let own = joints.map(|joint| palette[joint]);
        let own_real = transposed(own.map(|q| q[0]));
        let own_dual = transposed(own.map(|q| q[1]));
        let agreement =
            real[0] * own_real[0] + real[1] * own_real[1] + real[2] * own_real[2] + real[3] * own_real[3];
        let weights = Vec4::select(agreement.cmplt(Vec4::ZERO), -weights, weights);
        for i in 0..4 {
            real[i] += own_real[i] * weights;
            dual[i] += own_dual[i] * weights;
        }
    }
    let ([x, y, z, w], [dual_x, dual_y, dual_z, dual_w]) = (real, dual);
    let (axis, dual_axis) = ([x, y, z], [dual_x, dual_y, dual_z]);
    // Lanes past the last vertex have a blend of zero.
    let squared = (dot(axis, axis) + w * w).max(Vec4::splat(f32::MIN_POSITIVE));
    let twice = Vec4::splat(2.0) / squared;
    let rotated = |v: Lanes| {
        let turn = add(cross(axis, v), scaled(v, w));
        add(v, scaled(cross(axis, turn), twice))
    };
    // 2 · dual · conjugate(real), vector part.
    let moved = add(add(scaled(dual_axis, w), scaled(axis, -dual_w)), cross(axis, dual_axis));
    (add(rotated(block.positions), scaled(moved, twice)), rotated(block.normals))
}
