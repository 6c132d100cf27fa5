//! Random values of local sliders that bend the skin little.
//!
//! Sliders that were drawn independently make rings: a waist pulled in between a chest and hips that are not. People's shapes are
//! smooth, so sliders are drawn together from a normal distribution whose precision is that of each slider's own spread plus
//! the bending that they cause together: the squared Laplacian of the displacement, relative to the length of the edges, summed
//! over the cage.

use anthronet::mesh::Topology;
use anthronet::random::Random;
use faer::linalg::solvers::{DenseSolveCore, Solve};
use faer::{Mat, Side};
use glam::{DVec3, Vec3};

use crate::assets::{Modifier, TargetSet};
use crate::{Error, Result};

/// Draws beyond so many standard deviations are cut off there.
const FURTHEST: f64 = 2.5;

/// The bending of the skin by sliders: bᵀ of two displacements, per 1000 vertices' worth of relative bending.
pub struct Bending {
    neighbours: Vec<Vec<u32>>,
    /// One over the mean length of a vertex's edges, 1/m.
    per_length: Vec<f64>,
}

impl Bending {
    /// For displacements of this cage, whose vertices at rest are `rest` (metres).
    pub fn new(cage: &Topology, rest: &[Vec3]) -> Self {
        let mut neighbours = vec![Vec::new(); cage.vertex_count];
        for &[a, b, c, d] in &cage.quads {
            for [p, q] in [[a, b], [b, c], [c, d], [d, a]] {
                neighbours[p as usize].push(q);
                neighbours[q as usize].push(p);
            }
        }
        for around in &mut neighbours {
            around.sort_unstable();
            around.dedup();
        }
        let per_length = neighbours.iter().enumerate().map(|(v, around)| {
            let lengths = around.iter().map(|&n| f64::from(rest[v].distance(rest[n as usize])));
            around.len() as f64 / lengths.sum::<f64>().max(1e-9)
        });
        Self { per_length: per_length.collect(), neighbours }
    }

    /// The relative bending of each vertex under a slider at 1, both sides together.
    fn of(&self, targets: &TargetSet, modifier: &Modifier) -> Vec<DVec3> {
        let mut moved = vec![DVec3::ZERO; self.neighbours.len()];
        for pair in &modifier.pairs {
            let found: Vec<(usize, f64)> = pair
                .iter()
                .zip([-1.0, 1.0])
                .filter_map(|(target, sign)| target.map(|target| (target, sign)))
                .collect();
            for &(target, sign) in &found {
                let target = targets.get(target);
                for (&p, delta) in target.points.iter().zip(&target.deltas) {
                    if let Some(moved) = moved.get_mut(p as usize) {
                        *moved += delta.as_dvec3() * (sign / found.len() as f64);
                    }
                }
            }
        }
        self.neighbours
            .iter()
            .zip(&self.per_length)
            .enumerate()
            .map(|(v, (around, per_length))| {
                let mean = around.iter().map(|&n| moved[n as usize]).sum::<DVec3>() / around.len() as f64;
                (moved[v] - mean) * *per_length
            })
            .collect()
    }
}

/// A group of sliders that are drawn together.
pub struct SmoothDraws {
    /// Their precision: inverse covariance.
    pub precision: Mat<f64>,
    /// Cholesky factor of the covariance.
    factor: Mat<f64>,
}

impl SmoothDraws {
    /// For sliders with these spreads (standard deviations of each alone, without any price on bending).
    ///
    /// # Errors
    /// [`Error::Invalid`] when the precision is not positive definite.
    pub fn new(
        bending: &Bending,
        targets: &TargetSet,
        sliders: &[(&Modifier, f64)],
        stiffness: f64,
    ) -> Result<Self> {
        let bent: Vec<Vec<DVec3>> =
            sliders.iter().map(|(modifier, _)| bending.of(targets, modifier)).collect();
        let n = sliders.len();
        let precision = Mat::from_fn(n, n, |i, j| {
            let together: f64 = bent[i].iter().zip(&bent[j]).map(|(a, b)| a.dot(*b)).sum();
            let own = if i == j { 1.0 / (sliders[i].1 * sliders[i].1) } else { 0.0 };
            own + stiffness * together
        });
        let invalid = |e: &dyn std::fmt::Debug| Error::Invalid(format!("smoothness of sliders: {e:?}"));
        let covariance = precision.llt(Side::Lower).map_err(|e| invalid(&e))?.inverse();
        let factor = covariance.llt(Side::Lower).map_err(|e| invalid(&e))?;
        Ok(Self { precision, factor: factor.L().to_owned() })
    }

    /// A draw around zero.
    pub fn draw(&self, random: &mut Random) -> Vec<f64> {
        let normals: Vec<f64> =
            (0..self.factor.nrows()).map(|_| random.normal().clamp(-FURTHEST, FURTHEST)).collect();
        (0..normals.len()).map(|i| (0..=i).map(|k| self.factor[(i, k)] * normals[k]).sum()).collect()
    }
}

/// The x of least (r + J x)ᵀ W (r + J x) + (x₀ + x)ᵀ P (x₀ + x) with x₀ + x within ±`box_of`, by coordinate descent.
pub fn bounded_step(
    jacobian: &Mat<f64>,
    weights: &Mat<f64>,
    residual: &[f64],
    precision: &Mat<f64>,
    start: &[f64],
    bounds: &[[f64; 2]],
) -> Vec<f64> {
    let (m, n) = (jacobian.nrows(), jacobian.ncols());
    let weighted = weights * jacobian;
    let hessian = jacobian.transpose() * &weighted + precision;
    let r = Mat::from_fn(m, 1, |i, _| residual[i]);
    let x0 = Mat::from_fn(n, 1, |i, _| start[i]);
    let gradient = weighted.transpose() * &r + precision * &x0;
    let mut gradient: Vec<f64> = (0..n).map(|i| gradient[(i, 0)]).collect();
    let mut step = vec![0.0; n];
    for _ in 0..4_000 {
        let mut largest = 0.0_f64;
        for i in 0..n {
            let [low, high] = bounds[i];
            let wanted = step[i] - gradient[i] / hessian[(i, i)];
            let change = wanted.clamp(low - start[i], high - start[i]) - step[i];
            if change != 0.0 {
                step[i] += change;
                for (k, g) in gradient.iter_mut().enumerate() {
                    *g += hessian[(k, i)] * change;
                }
                largest = largest.max(change.abs());
            }
        }
        if largest < 1e-7 {
            break;
        }
    }
    step
}

/// Inverse of a positive definite matrix.
///
/// # Errors
/// [`Error::Invalid`] for another one.
pub fn inverse(matrix: &Mat<f64>) -> Result<Mat<f64>> {
    let factor = matrix.llt(Side::Lower).map_err(|e| Error::Invalid(format!("inverse: {e:?}")))?;
    Ok(factor.solve(Mat::<f64>::identity(matrix.nrows(), matrix.nrows())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bounded_step_is_the_best_within_its_bounds() {
        // One residual that both variables lower, the first twice as much; it is held at its bound.
        let jacobian = Mat::from_fn(1, 2, |_, j| [2.0, 1.0][j]);
        let one = Mat::from_fn(1, 1, |_, _| 1.0);
        let small = Mat::from_fn(2, 2, |i, j| if i == j { 1e-6 } else { 0.0 });
        let step = bounded_step(&jacobian, &one, &[-2.0], &small, &[0.0, 0.0], &[[-0.5, 0.5], [-5.0, 5.0]]);
        assert!((step[0] - 0.5).abs() < 1e-5 && (step[1] - 1.0).abs() < 1e-4, "{step:?}");
        // With a price both share by their effect.
        let price = Mat::from_fn(2, 2, |i, j| if i == j { 1.0 } else { 0.0 });
        let free = [[-5.0, 5.0]; 2];
        let step = bounded_step(&jacobian, &one, &[-2.0], &price, &[0.0, 0.0], &free);
        assert!((step[0] - 2.0 / 3.0).abs() < 1e-5 && (step[1] - 1.0 / 3.0).abs() < 1e-5, "{step:?}");
    }
}
