//! Skin weights: how much each vertex follows each joint.

use crate::mesh::Subdivision;
use crate::{Error, Result};

/// Any number of joints with weights per vertex; the weights of a vertex sum to one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkinWeights {
    offsets: Vec<u32>,
    joints: Vec<u16>,
    weights: Vec<f32>,
}

/// A fixed number of influences per vertex, as files and engines use them.
///
/// Vertex by vertex, weights descending and summing to one; an unused slot has joint 0 and weight 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Influences {
    /// Influences per vertex.
    pub per_vertex: usize,
    /// Joint indices, `per_vertex` for each vertex.
    pub joints: Vec<u16>,
    /// Weights, `per_vertex` for each vertex.
    pub weights: Vec<f32>,
}

impl SkinWeights {
    /// From compressed sparse rows, one per vertex: the entries of vertex v are `offsets[v]..offsets[v + 1]` of `joints` and
    /// `weights`. Each row is normalised.
    ///
    /// # Errors
    /// [`Error::Invalid`] when rows are inconsistent, a joint is not below `joint_count`, a weight is negative or not
    /// finite, or the weights of a vertex sum to zero.
    pub fn new(
        offsets: Vec<u32>,
        joints: Vec<u16>,
        mut weights: Vec<f32>,
        joint_count: usize,
    ) -> Result<Self> {
        let fail = |message: String| Err(Error::invalid("skin weights", message));
        let rows_fit = offsets.first() == Some(&0)
            && offsets.windows(2).all(|w| w[0] <= w[1])
            && offsets.last().is_some_and(|&n| n as usize == joints.len())
            && joints.len() == weights.len();
        if !rows_fit {
            return fail("rows do not fit together".into());
        }
        if let Some(j) = joints.iter().find(|j| usize::from(**j) >= joint_count) {
            return fail(format!("joint {j} of {joint_count}"));
        }
        for (v, row) in offsets.windows(2).enumerate() {
            let row = &mut weights[row[0] as usize..row[1] as usize];
            let sum: f32 = row.iter().sum();
            if !(row.iter().all(|w| *w >= 0.0) && sum > 0.0 && sum.is_finite()) {
                return fail(format!("vertex {v}: weights {row:?}"));
            }
            row.iter_mut().for_each(|w| *w /= sum);
        }
        Ok(Self { offsets, joints, weights })
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Whether there are no vertices.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Joints and weights of a vertex; empty for a vertex that does not exist.
    pub fn of(&self, vertex: usize) -> impl Iterator<Item = (u16, f32)> + '_ {
        let range = match self.offsets.get(vertex..vertex + 2) {
            Some(row) => row[0] as usize..row[1] as usize,
            None => 0..0,
        };
        self.joints[range.clone()].iter().copied().zip(self.weights[range].iter().copied())
    }

    /// The weights of a range of vertices.
    pub fn rows(&self, vertices: std::ops::Range<usize>) -> Self {
        self.collect(vertices)
    }

    /// The weights of the given vertices, in their order.
    pub fn select(&self, vertices: &[u32]) -> Self {
        self.collect(vertices.iter().map(|v| *v as usize))
    }

    fn collect(&self, vertices: impl Iterator<Item = usize>) -> Self {
        let mut out = Self { offsets: vec![0], ..Self::default() };
        for v in vertices {
            for (j, w) in self.of(v) {
                out.joints.push(j);
                out.weights.push(w);
            }
            out.offsets.push(out.joints.len() as u32);
        }
        out
    }

    /// Weights of the refined surface: each joint's weight is subdivided by the stencils that subdivide positions.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the number of vertices is not that of the subdivision's cage.
    pub fn refine(&self, subdivision: &Subdivision) -> Result<Self> {
        let cage = subdivision.refined().vertex_count
            - subdivision.edges().len()
            - subdivision.refined().quads.len() / 4;
        if self.len() != cage {
            return Err(Error::invalid(
                "skin weights",
                format!("expected {cage} vertices, got {}", self.len()),
            ));
        }
        let joint_count = self.joints.iter().max().map_or(0, |j| usize::from(*j) + 1);
        let mut out = Self { offsets: vec![0], ..Self::default() };
        for vertex in 0..subdivision.refined().vertex_count {
            for (joint, weight) in self.refined_row(subdivision, vertex) {
                out.joints.push(joint);
                out.weights.push(weight);
            }
            out.offsets.push(out.joints.len() as u32);
        }
        Self::new(out.offsets, out.joints, out.weights, joint_count)
    }

    /// Joints and weights of one vertex of the refined surface, as [`refine`](Self::refine) gives them: joints ascending, weights
    /// summing to one.
    pub fn refined(&self, subdivision: &Subdivision, vertex: usize) -> Vec<(u16, f32)> {
        let mut row = self.refined_row(subdivision, vertex);
        let sum: f32 = row.iter().map(|r| r.1).sum();
        for (_, weight) in &mut row {
            *weight /= sum;
        }
        row
    }

    /// The same before it is normalised.
    fn refined_row(&self, subdivision: &Subdivision, vertex: usize) -> Vec<(u16, f32)> {
        let mut sums: Vec<(u16, f32)> = Vec::new();
        for (cage, share) in subdivision.stencil(vertex) {
            for (joint, weight) in self.of(cage as usize) {
                match sums.iter_mut().find(|sum| sum.0 == joint) {
                    Some(sum) => sum.1 += weight * share,
                    None => sums.push((joint, weight * share)),
                }
            }
        }
        sums.sort_unstable_by_key(|sum| sum.0);
        // Vertex points have small negative stencil weights where few faces meet.
        sums.retain(|(_, weight)| *weight > 1e-6);
        sums
    }

    /// The strongest influences of each vertex, normalised.
    ///
    /// # Errors
    /// [`Error::Request`] when `per_vertex` is neither 4 nor 8.
    pub fn influences(&self, per_vertex: usize) -> Result<Influences> {
        if per_vertex != 4 && per_vertex != 8 {
            return Err(Error::request("influences", format!("expected 4 or 8, got {per_vertex}")));
        }
        let mut out = Influences {
            per_vertex,
            joints: Vec::with_capacity(per_vertex * self.len()),
            weights: Vec::with_capacity(per_vertex * self.len()),
        };
        let mut row: Vec<(u16, f32)> = Vec::new();
        for v in 0..self.len() {
            row.clear();
            row.extend(self.of(v));
            row.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
            row.truncate(per_vertex);
            let sum: f32 = row.iter().map(|r| r.1).sum();
            for slot in 0..per_vertex {
                let (joint, weight) = row.get(slot).copied().unwrap_or((0, 0.0));
                out.joints.push(joint);
                out.weights.push(weight / sum);
            }
        }
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn broken_rows_are_refused() {
        let new = |o: &[u32], j: &[u16], w: &[f32]| SkinWeights::new(o.into(), j.into(), w.into(), 3);
        assert!(new(&[0, 1], &[2], &[2.0]).is_ok());
        assert!(new(&[0, 1], &[3], &[1.0]).is_err());
        assert!(new(&[0, 2], &[0], &[1.0]).is_err());
        assert!(new(&[0, 1], &[0], &[f32::NAN]).is_err());
        assert!(new(&[0, 1], &[0], &[-1.0]).is_err());
        assert!(new(&[0, 0], &[], &[]).is_err());
        assert!(new(&[], &[], &[]).is_err());
        assert!(new(&[0, 1], &[0], &[1.0]).unwrap().influences(5).is_err());
    }

    proptest! {
        #[test]
        fn influences_are_sorted_normalised_and_padded(
            rows in prop::collection::vec(prop::collection::vec((0_u16..40, 0.01_f32..1.0), 1..12), 1..20),
            eight in any::<bool>(),
        ) {
            let mut offsets = vec![0];
            let (mut joints, mut weights) = (vec![], vec![]);
            for row in &rows {
                for &(j, w) in row {
                    joints.push(j);
                    weights.push(w);
                }
                offsets.push(joints.len() as u32);
            }
            let n = if eight { 8 } else { 4 };
            let out = SkinWeights::new(offsets, joints, weights, 40).unwrap().influences(n).unwrap();
            for v in 0..rows.len() {
                let w = &out.weights[v * n..(v + 1) * n];
                // Tolerance: n roundings of f32.
                prop_assert!((w.iter().sum::<f32>() - 1.0).abs() < 1e-6);
                prop_assert!(w.windows(2).all(|p| p[0] >= p[1]));
                for (slot, w) in w.iter().enumerate() {
                    prop_assert!(*w > 0.0 || out.joints[v * n + slot] == 0);
                }
            }
        }
    }
}
