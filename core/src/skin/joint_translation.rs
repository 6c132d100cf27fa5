//! The paper's own skinning formula (section on deep mesh rigging, skinning and posing): transforms made of joint
//! positions only, with offsets from a network.
//!
//! T_j = [1 θ_j; 0 1] contains no rotation, so a vertex moves by the weighted mean of its joints' displacements. The paper
//! prints T_j(θ) T_j(θ̄)⁻¹, with θ the bind pose and θ̄ the current one, which moves vertices the wrong way, and omits the
//! sum over joints; its text implies Σ_j w_j T_j(θ̄) T_j(θ)⁻¹, which is implemented here. It is exact where joints only
//! translate. Where a bone rotates, the vertices around it do not rotate with it and are centimetres off, which the offsets
//! have to correct entirely; the normals stay those of the bind pose.

use glam::Vec4;

use super::block::{Block, Lanes, add, transposed};

/// `palette`: posed minus bind position of each joint, metres; w unused.
#[inline(always)]
pub(super) fn deform(palette: &[Vec4], block: &Block<'_>) -> (Lanes, Lanes) {
    let mut moved = [Vec4::ZERO; 4];
    for (weights, joints) in block.slots() {
        for lane in 0..4 {
            moved[lane] += palette[joints[lane]] * Vec4::splat(weights[lane]);
        }
    }
    let [x, y, z, _] = transposed(moved);
    (add(block.positions, [x, y, z]), block.normals)
}
