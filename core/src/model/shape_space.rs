//! The shape space: a body's points as the mean plus a weighted sum of principal components, x = mean + B c.
//!
//! The first components are stored as half floats, the rest quantised to bytes with one scale each: a third of the size for
//! 0.03 mm of vertex error. Everything downstream, the exact solve included, uses the quantised components, so quantisation
//! costs no accuracy of measures.

use glam::Vec3;
use multiversion::multiversion;

use crate::{Error, Result};

/// Mean and quantised components over the coordinates of cage and accessories, in model space with the pelvis at the origin.
#[derive(Clone, Debug)]
pub struct ShapeSpace {
    mean: Vec<f32>,
    /// First components, one row of `mean.len()` numbers each, metre per metre.
    fine: Vec<f32>,
    /// Remaining components, rows as in `fine`, to be multiplied by `scales`.
    coarse: Vec<i8>,
    /// One per coarse component, metre per metre.
    scales: Vec<f32>,
    /// Standard deviation of each coefficient, metres.
    std: Vec<f64>,
}

/// Number of coordinates that are summed at a time, so that the sums stay in the L1 cache.
const BLOCK: usize = 4_096;

impl ShapeSpace {
    /// From arrays: `mean` has three coordinates (metres) per point, `fine` and `coarse` one row of that length per component,
    /// `scales` one number per coarse component, `std` one standard deviation (metres) per component.
    ///
    /// # Errors
    /// [`Error::Invalid`] when sizes disagree or a number is not finite.
    pub fn new(
        mean: Vec<f32>,
        fine: Vec<f32>,
        coarse: Vec<i8>,
        scales: Vec<f32>,
        std: Vec<f64>,
    ) -> Result<Self> {
        let n = mean.len();
        let fits = n > 0
            && n.is_multiple_of(3)
            && fine.len().is_multiple_of(n)
            && coarse.len() == n * scales.len()
            && fine.len() / n + scales.len() == std.len();
        if !fits {
            return Err(Error::invalid(
                "shape space",
                format!(
                    "{n} coordinates, {} fine and {} coarse numbers, {} scales and {} deviations do not fit",
                    fine.len(),
                    coarse.len(),
                    scales.len(),
                    std.len()
                ),
            ));
        }
        let finite = mean.iter().chain(&fine).chain(&scales).all(|x| x.is_finite())
            && std.iter().all(|s| s.is_finite() && *s >= 0.0);
        if !finite {
            return Err(Error::invalid("shape space", "expected finite numbers"));
        }
        Ok(Self { mean, fine, coarse, scales, std })
    }

    /// Number of components.
    pub fn components(&self) -> usize {
        self.std.len()
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.mean.len() / 3
    }

    /// Standard deviation of each coefficient over people, metres.
    pub fn deviations(&self) -> &[f64] {
        &self.std
    }

    /// A point of the mean body, metres, pelvis at the origin. Panics for an index out of range.
    pub fn mean_point(&self, point: usize) -> Vec3 {
        Vec3::new(self.mean[3 * point], self.mean[3 * point + 1], self.mean[3 * point + 2])
    }

    /// The points, metres, of the body with these coefficients (metres, one per component; missing ones are zero), pelvis
    /// at the origin.
    pub fn body(&self, coefficients: &[f64]) -> Vec<Vec3> {
        let n = self.mean.len();
        let mut out = self.mean.clone();
        let split = (self.fine.len() / n).min(coefficients.len());
        let (of_fine, of_coarse) = coefficients.split_at(split);
        let fine: Vec<f32> = of_fine.iter().map(|c| *c as f32).collect();
        let coarse: Vec<f32> =
            of_coarse.iter().zip(&self.scales).map(|(c, scale)| (c * f64::from(*scale)) as f32).collect();
        for start in (0..n).step_by(BLOCK) {
            let range = start..(start + BLOCK).min(n);
            let sums = &mut out[range.clone()];
            add_fine(sums, &fine, &self.fine, n, start);
            add_coarse(sums, &coarse, &self.coarse, n, start);
        }
        out.chunks_exact(3).map(Vec3::from_slice).collect()
    }

    /// The entries of B for a component and a point: the derivative of its x, y and z with respect to the coefficient, metre
    /// per metre, as [`body`](Self::body) uses it. Panics for an index out of range.
    pub fn component(&self, component: usize, point: usize) -> [f64; 3] {
        let n = self.mean.len();
        let fine = self.fine.len() / n;
        let at = |axis: usize| {
            let i = 3 * point + axis;
            if component < fine {
                f64::from(self.fine[component * n + i])
            } else {
                let k = component - fine;
                f64::from(self.scales[k]) * f64::from(self.coarse[k * n + i])
            }
        };
        [at(0), at(1), at(2)]
    }

    /// Coefficients, metres, of the body nearest to `points` (metres; the first points of the space, such as the cage's):
    /// Bᵀ (x − mean), which is the least-squares solution where the components are orthonormal over those points.
    pub fn project(&self, points: &[Vec3]) -> Vec<f64> {
        let n = self.mean.len();
        let fine = self.fine.len() / n;
        let delta: Vec<f64> = points
            .iter()
            .flat_map(|p| p.to_array())
            .zip(&self.mean)
            .map(|(x, m)| f64::from(x) - f64::from(*m))
            .collect();
        (0..self.components())
            .map(|k| {
                if k < fine {
                    delta.iter().zip(&self.fine[k * n..]).map(|(d, &x)| d * f64::from(x)).sum::<f64>()
                } else {
                    let k = k - fine;
                    let sum: f64 =
                        delta.iter().zip(&self.coarse[k * n..]).map(|(d, &x)| d * f64::from(x)).sum();
                    sum * f64::from(self.scales[k])
                }
            })
            .collect()
    }
}

// Most of the time to decode a body is spent here. Wider registers give the same bits, as no sum is split over lanes.

#[multiversion(targets("x86_64+avx2"))]
fn add_fine(sums: &mut [f32], weights: &[f32], rows: &[f32], stride: usize, start: usize) {
    add_rows(sums, weights, |k| &rows[k * stride + start..], |x| x);
}

#[multiversion(targets("x86_64+avx2"))]
fn add_coarse(sums: &mut [f32], weights: &[f32], rows: &[i8], stride: usize, start: usize) {
    add_rows(sums, weights, |k| &rows[k * stride + start..], f32::from);
}

/// Adds weighted rows, four at a time, so that the sums are read and written a quarter as often.
#[inline(always)]
fn add_rows<'a, T: Copy + 'a>(
    sums: &mut [f32],
    weights: &[f32],
    row: impl Fn(usize) -> &'a [T],
    number: impl Fn(T) -> f32,
) {
    let (fours, rest) = weights.as_chunks::<4>();
    for (i, [a, b, c, d]) in fours.iter().enumerate() {
        let [ra, rb, rc, rd] = [0, 1, 2, 3].map(|j| row(4 * i + j));
        for ((((sum, &xa), &xb), &xc), &xd) in sums.iter_mut().zip(ra).zip(rb).zip(rc).zip(rd) {
            *sum += a * number(xa) + b * number(xb) + c * number(xc) + d * number(xd);
        }
    }
    for (j, weight) in rest.iter().enumerate() {
        for (sum, &x) in sums.iter_mut().zip(row(4 * fours.len() + j)) {
            *sum += weight * number(x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_are_the_mean_plus_scaled_components() {
        let n = 3 * 2_000;
        let wave = |k: usize, i: usize| libm::sin((k * 31 + i * 7) as f64) as f32;
        let fine: Vec<f32> = (0..2 * n).map(|i| wave(i / n, i % n)).collect();
        let coarse: Vec<i8> = (0..3 * n).map(|i| (wave(5 + i / n, i % n) * 127.0) as i8).collect();
        let space =
            ShapeSpace::new(vec![0.5; n], fine, coarse, vec![0.01, 0.02, 0.03], vec![1.0; 5]).unwrap();
        let c = [0.3, -0.2, 0.1, 0.5, -0.4];
        let body = space.body(&c);
        for p in [0, 1, 1_365, 1_366, 1_999] {
            for (axis, x) in body[p].to_array().into_iter().enumerate() {
                let exact: f64 = 0.5 + (0..5).map(|k| c[k] * space.component(k, p)[axis]).sum::<f64>();
                // Tolerance: five roundings of f32 near one.
                assert!((f64::from(x) - exact).abs() < 5e-7);
            }
        }
        // However wide the registers are, the bits are the same.
        let mut sums = vec![0.5_f32; n];
        add_rows(&mut sums, &[0.3, -0.2], |k| &space.fine[k * n..], |x| x);
        let scaled = [0.1, 0.5, -0.4].iter().zip(&space.scales).map(|(c, s)| (c * f64::from(*s)) as f32);
        add_rows(&mut sums, &scaled.collect::<Vec<_>>(), |k| &space.coarse[k * n..], f32::from);
        assert!(sums.chunks_exact(3).map(Vec3::from_slice).eq(body));
        assert!(ShapeSpace::new(vec![0.0; 4], vec![], vec![], vec![], vec![]).is_err());
        assert!(ShapeSpace::new(vec![f32::NAN; 3], vec![], vec![], vec![], vec![]).is_err());
    }
}
