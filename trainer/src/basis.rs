//! The shape space: principal components of T-posed cages, and everything else as a linear map of them.
//!
//! The components are found by randomised subspace iteration (Halko, Martinsson and Tropp 2011) on training
//! bodies. Accessories and joints follow by least squares on the same coefficients.

use anthronet::mesh::Topology;
use anthronet::random::Random;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use glam::Vec3;
use rayon::prelude::*;

use crate::assets::CAGE_VERTICES;
use crate::corpus::{Corpus, Split};
use crate::generator::QuadraticForm;
use crate::{Error, Result};

/// Number of components. 300 leave 0.06 mm; measures need as many (100 cost 0.7 mm per measure).
pub const COMPONENTS: usize = 300;
/// Training bodies that the components are found on.
const FITTED_ON: usize = 7_000;
const OVERSAMPLING: usize = 40;
const POWER_ITERATIONS: usize = 2;

/// The shape space in single precision, before it is packed into the model file.
pub struct Basis {
    /// Mean body: all points of [`crate::assets::Assets`], coordinate by coordinate.
    pub mean: Vec<f32>,
    /// One row of [`COMPONENTS`] per coordinate of `mean`; the cage's rows are orthonormal columns.
    pub rows: Mat<f32>,
    /// Standard deviation of each coefficient over training bodies, metres.
    pub std: Vec<f64>,
}

impl Basis {
    /// Fits the basis to training bodies.
    ///
    /// # Errors
    /// When a factorisation fails, which would mean degenerate bodies.
    pub fn fit(corpus: &Corpus, progress: &dyn Fn(&str)) -> Result<Self> {
        progress("drawing bodies for the basis");
        let numbers: Vec<u64> = (0..).filter(|n| Split::of(*n) == Split::Train).take(FITTED_ON).collect();
        let coordinates = 3 * corpus.assets.point_count();
        let bodies: Vec<Vec<f32>> =
            numbers.par_iter().map(|&n| flatten(&corpus.specimen(n).points)).collect();
        let mut mean = vec![0.0_f64; coordinates];
        for body in &bodies {
            for (m, x) in mean.iter_mut().zip(body) {
                *m += f64::from(*x) / bodies.len() as f64;
            }
        }
        let mean: Vec<f32> = mean.iter().map(|m| *m as f32).collect();
        let cage = 3 * CAGE_VERTICES;
        let all = Mat::from_fn(coordinates, bodies.len(), |i, j| bodies[j][i] - mean[i]);
        drop(bodies);
        let x = all.as_ref().subrows(0, cage);

        progress("principal components");
        let rank = COMPONENTS + OVERSAMPLING;
        let mut rng = Random::new(11, 0);
        let mut sample = Mat::from_fn(x.ncols(), rank, |_, _| {
            // Uniform noise spans as well as normal noise and needs no transcendental function.
            rng.uniform() as f32 - 0.5
        });
        let mut range = (x * &sample).qr().compute_thin_Q();
        for _ in 0..POWER_ITERATIONS {
            sample = (x.transpose() * &range).qr().compute_thin_Q();
            range = (x * &sample).qr().compute_thin_Q();
        }
        let inside = range.transpose() * x;
        let gram: Mat<f64> = {
            let inside = Mat::from_fn(inside.nrows(), inside.ncols(), |i, j| f64::from(inside[(i, j)]));
            &inside * inside.transpose()
        };
        let eigen = gram
            .self_adjoint_eigen(Side::Lower)
            .map_err(|e| Error::Invalid(format!("basis: eigenvalues: {e:?}")))?;
        // Eigenvalues ascend; take the last ones, largest first, with a fixed sign.
        let order: Vec<usize> = (0..rank).rev().take(COMPONENTS).collect();
        let rotation = Mat::from_fn(rank, COMPONENTS, |i, j| eigen.U()[(i, order[j])] as f32);
        let mut components = &range * &rotation;
        for j in 0..COMPONENTS {
            let biggest = (0..cage)
                .map(|i| components[(i, j)])
                .fold(0.0_f32, |m, v| if v.abs() > m.abs() { v } else { m });
            if biggest < 0.0 {
                components.col_mut(j).iter_mut().for_each(|v| *v = -*v);
            }
        }

        progress("accessories and joints");
        let coefficients = components.transpose() * x; // (K, N)
        let others = all.as_ref().subrows(cage, coordinates - cage); // (M, N)
        let c64 = Mat::from_fn(COMPONENTS, coefficients.ncols(), |i, j| f64::from(coefficients[(i, j)]));
        let normal = &c64 * c64.transpose();
        let mixed = {
            let m = others * coefficients.transpose(); // (M, K)
            Mat::from_fn(COMPONENTS, m.nrows(), |i, j| f64::from(m[(j, i)]))
        };
        let map = normal
            .llt(Side::Lower)
            .map_err(|e| Error::Invalid(format!("basis: normal equations: {e:?}")))?
            .solve(&mixed); // (K, M)
        let rows = Mat::from_fn(coordinates, COMPONENTS, |i, j| {
            if i < cage { components[(i, j)] } else { map[(j, i - cage)] as f32 }
        });
        let n = coefficients.ncols() as f64;
        let std = (0..COMPONENTS).map(|i| (normal[(i, i)] / n).sqrt()).collect();
        Ok(Self { mean, rows, std })
    }

    /// Coefficients of bodies, one column each, from their points' coordinates, one column each.
    pub fn project(&self, bodies: &[Vec<f32>]) -> Mat<f32> {
        let cage = 3 * CAGE_VERTICES;
        let x = Mat::from_fn(cage, bodies.len(), |i, j| bodies[j][i] - self.mean[i]);
        self.rows.as_ref().subrows(0, cage).transpose() * &x
    }

    /// All coordinates from coefficients.
    pub fn expand(&self, coefficients: &[f32]) -> Vec<f32> {
        let c = Mat::from_fn(COMPONENTS, 1, |i, _| coefficients[i]);
        let x = &self.rows * &c;
        (0..self.mean.len()).map(|i| self.mean[i] + x[(i, 0)]).collect()
    }
}

/// Points as coordinates.
pub fn flatten(points: &[Vec3]) -> Vec<f32> {
    points.iter().flat_map(|p| p.to_array()).collect()
}

/// The paper's Laplacian loss (equation "laplacian") of the decoded cage as a quadratic form of coefficients.
///
/// The cotangent weights are those of the mean body, so the loss is exactly quadratic; each unordered pair of
/// neighbours counts twice, as in the paper's sum over rings. The sum is divided by the cage's 3V coordinates, a mean as
/// the reconstruction loss is, m².
pub fn laplacian(basis: &Basis, cage: &Topology) -> QuadraticForm {
    let at = |v: u32| {
        let i = 3 * v as usize;
        Vec3::new(basis.mean[i], basis.mean[i + 1], basis.mean[i + 2]).as_dvec3()
    };
    let mut weights: std::collections::BTreeMap<[u32; 2], f64> = Default::default();
    for &[a, b, c, d] in &cage.quads {
        for triangle in [[a, b, c], [a, c, d]] {
            for k in 0..3 {
                let (p, q, r) = (triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3]);
                let (u, v) = (at(p) - at(r), at(q) - at(r));
                let cotangent = u.dot(v) / u.cross(v).length().max(1e-12);
                *weights.entry([p.min(q), p.max(q)]).or_insert(0.0) += 0.5 * cotangent;
            }
        }
    }
    let pairs: Vec<([u32; 2], f64)> = weights.into_iter().collect();
    let k = basis.rows.ncols();
    let scaled = |pair: &([u32; 2], f64), axis: usize, j: usize| {
        let ([p, q], w) = *pair;
        let row = |v: u32| f64::from(basis.rows[(3 * v as usize + axis, j)]);
        w * (row(p) - row(q))
    };
    let differences = Mat::from_fn(3 * pairs.len(), k, |i, j| scaled(&pairs[i / 3], i % 3, j));
    let at_mean = Mat::from_fn(3 * pairs.len(), 1, |i, _| {
        let ([p, q], w) = pairs[i / 3];
        w * (at(p) - at(q))[i % 3]
    });
    let matrix = differences.transpose() * &differences;
    let vector = differences.transpose() * &at_mean;
    let constant: f64 = (0..at_mean.nrows()).map(|i| at_mean[(i, 0)] * at_mean[(i, 0)]).sum();
    let coordinates = 3.0 * cage.vertex_count as f64;
    QuadraticForm {
        matrix: (0..k * k).map(|i| 2.0 * matrix[(i / k, i % k)] / coordinates).collect(),
        vector: (0..k).map(|i| 4.0 * vector[(i, 0)] / coordinates).collect(),
        constant: 2.0 * constant / coordinates,
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// A cube of unit sides with its corners moved at random, as a basis of `components` random directions.
    fn cube(components: usize) -> (Basis, Topology) {
        let quads = vec![[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let mut random = Random::new(3, 0);
        let mean =
            (0..24).map(|i| (((i / 3) >> (i % 3)) & 1) as f32 + 0.2 * random.uniform() as f32).collect();
        let rows = Mat::from_fn(24, components, |_, _| random.uniform() as f32 - 0.5);
        let cage = Topology { vertex_count: 8, quads, uvs: vec![[0.0; 2]], quad_uvs: vec![[0; 4]; 6] };
        (Basis { mean, rows, std: vec![1.0; components] }, cage)
    }

    /// The paper's sum, vertex by vertex over its ring, on the decoded points themselves.
    fn brute_force(basis: &Basis, cage: &Topology, coefficients: &[f64]) -> f64 {
        let mean =
            |v: u32| DVec3::from_array(std::array::from_fn(|a| f64::from(basis.mean[3 * v as usize + a])));
        let moved = |v: u32| {
            let row = |a: usize| 3 * v as usize + a;
            let offset = |a: usize| -> f64 {
                coefficients.iter().enumerate().map(|(k, c)| c * f64::from(basis.rows[(row(a), k)])).sum()
            };
            mean(v) + DVec3::from_array(std::array::from_fn(offset))
        };
        let triangles: Vec<[u32; 3]> =
            cage.quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let mut sum = 0.0;
        for i in 0..cage.vertex_count as u32 {
            for j in (0..cage.vertex_count as u32).filter(|&j| j != i) {
                // Half of the cotangents of the angles opposite to the edge, zero where there is no edge.
                let opposite = triangles.iter().filter(|t| t.contains(&i) && t.contains(&j));
                let weight: f64 = opposite
                    .filter_map(|t| t.iter().find(|&&v| v != i && v != j))
                    .map(|&k| (mean(i) - mean(k)).angle_between(mean(j) - mean(k)).tan().recip() / 2.0)
                    .sum();
                sum += (weight * (moved(i) - moved(j))).length_squared();
            }
        }
        sum / (3.0 * cage.vertex_count as f64)
    }

    #[test]
    fn the_laplacian_form_is_the_sum_over_rings() {
        let (basis, cage) = cube(5);
        let form = laplacian(&basis, &cage);
        for c in [[0.0; 5], [0.3, -0.1, 0.0, 0.7, 0.2], [1.0, 2.0, -3.0, 0.5, -0.4]] {
            let quadratic: f64 = (0..25).map(|i| form.matrix[i] * c[i / 5] * c[i % 5]).sum::<f64>()
                + form.vector.iter().zip(&c).map(|(v, c)| v * c).sum::<f64>()
                + form.constant;
            let expected = brute_force(&basis, &cage, &c);
            assert!((quadratic / expected - 1.0).abs() < 1e-9, "{quadratic} {expected}");
        }
    }

    #[test]
    fn coordinates_keep_their_order() {
        assert_eq!(flatten(&[Vec3::new(1.0, 2.0, 3.0), Vec3::X]), [1.0, 2.0, 3.0, 1.0, 0.0, 0.0]);
    }
}
