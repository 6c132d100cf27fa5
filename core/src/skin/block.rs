//! The surface in the layout of the kernels: blocks of four vertices, one component of all four in a SIMD register.
//!
//! Consecutive vertices mostly have about as many influences. A block has as many slots as its vertex with the most
//! influences needs, so four influences cost about 2.5 slots per vertex, and eight little more.

use glam::{Mat4, Vec3, Vec4};

use super::buffers::Target;
use crate::skeleton::Influences;
use crate::{Error, Result};

/// x, y and z of the four vertices of a block.
pub(super) type Lanes = [Vec4; 3];

/// Vertices in a block.
pub(super) const LANES: usize = 4;

/// Blocks in the unit of work of one thread: large enough to hide scheduling costs, small enough to balance the load.
const CHUNK_BLOCKS: usize = 256;

/// Vertices in such a chunk.
pub(super) const CHUNK_VERTICES: usize = CHUNK_BLOCKS * LANES;

/// All blocks of a surface. Lanes past the last vertex are zero.
#[derive(Clone, Debug)]
pub(super) struct Blocks {
    positions: Vec<Lanes>,
    normals: Vec<Lanes>,
    /// End of each block's slots in `weights` and `joints`.
    ends: Vec<u32>,
    weights: Vec<Vec4>,
    joints: Vec<[u16; LANES]>,
}

/// One block.
pub(super) struct Block<'a> {
    pub(super) positions: Lanes,
    pub(super) normals: Lanes,
    slots: &'a [Vec4],
    joints: &'a [[u16; LANES]],
}

impl Block<'_> {
    /// Weights and joints, slot by slot; a lane with fewer influences has weight 0.
    #[inline(always)]
    pub(super) fn slots(&self) -> impl Iterator<Item = (Vec4, [usize; LANES])> + '_ {
        self.slots.iter().zip(self.joints).map(|(weights, joints)| (*weights, joints.map(usize::from)))
    }
}

impl Blocks {
    /// Arrays must have one entry per vertex; the caller checks that.
    pub(super) fn new(
        positions: &[Vec3],
        normals: &[Vec3],
        influences: &Influences,
        joint_count: usize,
    ) -> Result<Self> {
        let mut blocks = Self {
            positions: positions.chunks(LANES).map(lanes).collect(),
            normals: normals.chunks(LANES).map(lanes).collect(),
            ends: Vec::new(),
            weights: Vec::new(),
            joints: Vec::new(),
        };
        let per_vertex = influences.per_vertex;
        let joints = influences.joints.chunks(LANES * per_vertex);
        for (b, (joints, weights)) in joints.zip(influences.weights.chunks(LANES * per_vertex)).enumerate() {
            let start = blocks.weights.len();
            for (lane, (joints, weights)) in
                joints.chunks(per_vertex).zip(weights.chunks(per_vertex)).enumerate()
            {
                let sum = checked_sum(LANES * b + lane, joints, weights, joint_count)?;
                let used = joints.iter().zip(weights).filter(|(_, w)| **w > 0.0);
                for (slot, (&joint, &weight)) in used.enumerate() {
                    if start + slot == blocks.weights.len() {
                        blocks.weights.push(Vec4::ZERO);
                        blocks.joints.push([0; LANES]);
                    }
                    blocks.weights[start + slot][lane] = (f64::from(weight) / sum) as f32;
                    blocks.joints[start + slot][lane] = joint;
                }
            }
            let end = u32::try_from(blocks.weights.len()).map_err(|_| too_many())?;
            blocks.ends.push(end);
        }
        Ok(blocks)
    }

    /// Units of work of [`CHUNK_VERTICES`] vertices each, the last one shorter.
    pub(super) fn chunks(&self) -> impl Iterator<Item = Chunk<'_>> {
        (0..self.positions.len()).step_by(CHUNK_BLOCKS).map(|first| Chunk { blocks: self, first })
    }
}

/// Checks a vertex's joints and weights and returns the sum of the weights.
fn checked_sum(vertex: usize, joints: &[u16], weights: &[f32], joint_count: usize) -> Result<f64> {
    let fail = |message: String| Err(Error::invalid("skin weights", format!("vertex {vertex}: {message}")));
    if let Some(joint) = joints.iter().find(|j| usize::from(**j) >= joint_count) {
        return fail(format!("expected joints below {joint_count}, got {joint}"));
    }
    let sum: f64 = weights.iter().map(|w| f64::from(*w)).sum();
    // Weights quantised to bytes are off by this much.
    if !(weights.iter().all(|w| *w >= 0.0) && (sum - 1.0).abs() <= 1e-2) {
        return fail(format!("expected weights from 0 with sum 1, got {weights:?}"));
    }
    Ok(sum)
}

fn too_many() -> Error {
    Error::invalid("skin weights", "expected at most 2³² influences".to_owned())
}

/// A run of blocks.
#[derive(Clone, Copy)]
pub(super) struct Chunk<'a> {
    blocks: &'a Blocks,
    first: usize,
}

impl Chunk<'_> {
    /// Runs `deform` on every block, with offsets added, and writes the results to the target.
    ///
    /// `offsets` has one entry per vertex of the chunk.
    #[inline(always)]
    pub(super) fn run(
        self,
        offsets: Option<&[Vec3]>,
        target: &mut Target<'_>,
        deform: impl Fn(&Block<'_>) -> (Lanes, Lanes),
    ) {
        let Self { blocks, first } = self;
        let last = blocks.positions.len().min(first + CHUNK_BLOCKS);
        let mut start = first.checked_sub(1).map_or(0, |before| blocks.ends[before] as usize);
        let surface = blocks.positions[first..last].iter().zip(&blocks.normals[first..last]);
        for (b, ((positions, normals), end)) in surface.zip(&blocks.ends[first..last]).enumerate() {
            let slots = start..*end as usize;
            start = slots.end;
            let mut block = Block {
                positions: *positions,
                normals: *normals,
                slots: &blocks.weights[slots.clone()],
                joints: &blocks.joints[slots],
            };
            if let Some(offsets) = offsets {
                let own = offsets.get(b * LANES..).unwrap_or_default();
                block.positions = add(block.positions, lanes(&own[..own.len().min(LANES)]));
            }
            let (positions, normals) = deform(&block);
            target.write(b * LANES, positions, normals);
        }
    }
}

/// Transposes at most four vectors to lanes.
fn lanes(vectors: &[Vec3]) -> Lanes {
    let mut lanes = [Vec4::ZERO; 3];
    for (i, vector) in vectors.iter().enumerate() {
        for (axis, lane) in lanes.iter_mut().enumerate() {
            lane[i] = vector[axis];
        }
    }
    lanes
}

/// The transpose: the first components of all four, the second ones, and so on.
#[inline(always)]
pub(super) fn transposed(rows: [Vec4; 4]) -> [Vec4; 4] {
    let columns = Mat4::from_cols(rows[0], rows[1], rows[2], rows[3]).transpose();
    [columns.x_axis, columns.y_axis, columns.z_axis, columns.w_axis]
}

#[inline(always)]
pub(super) fn add(a: Lanes, b: Lanes) -> Lanes {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn scaled(a: Lanes, by: Vec4) -> Lanes {
    [a[0] * by, a[1] * by, a[2] * by]
}

#[inline(always)]
pub(super) fn dot(a: Lanes, b: Lanes) -> Vec4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(super) fn cross(a: Lanes, b: Lanes) -> Lanes {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
