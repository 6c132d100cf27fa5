//! Dense Cholesky factorisation in `f64`, for matrices over a few dozen measures or the few hundred unknowns of a fitted
//! body.
//!
//! Plain loops in a fixed order, so that the result has the same bits on every machine.

/// The lower triangle L of A = L Lᵀ, row-major, n × n.
#[derive(Clone, Debug)]
pub(crate) struct Cholesky {
    n: usize,
    l: Vec<f64>,
}

impl Cholesky {
    /// Factors the symmetric matrix `a` (row-major, n × n; only the lower triangle is read).
    ///
    /// `None` when the matrix is not n × n, not finite, or not positive definite to working precision: every pivot must
    /// stay above 1e-15 of its own diagonal entry, below which it is rounding noise.
    pub(crate) fn new(a: &[f64], n: usize) -> Option<Self> {
        if a.len() != n * n {
            return None;
        }
        let mut l = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let dot: f64 = (0..j).map(|k| l[i * n + k] * l[j * n + k]).sum();
                let rest = a[i * n + j] - dot;
                if i == j {
                    // Written so that NaN fails too.
                    if !(rest > 1e-15 * a[i * n + i] && rest.is_finite()) {
                        return None;
                    }
                    l[i * n + i] = rest.sqrt();
                } else {
                    l[i * n + j] = rest / l[j * n + j];
                }
            }
        }
        Some(Self { n, l })
    }

    /// Factors A + δI with the smallest δ that works of 0 and 10⁻¹⁵, 10⁻¹⁴, … below 10⁻³ times the largest diagonal entry:
    /// for positive *semi*-definite matrices, whose smallest pivots are rounding noise. `None` when no δ works.
    pub(crate) fn with_jitter(a: &[f64], n: usize) -> Option<Self> {
        if let Some(factor) = Self::new(a, n) {
            return Some(factor);
        }
        let scale = (0..n).map(|i| a.get(i * n + i).copied().unwrap_or(f64::NAN)).fold(0.0, f64::max);
        let mut shifted = a.to_vec();
        let mut jitter = 1e-15;
        while jitter < 1e-3 && shifted.len() == n * n {
            for i in 0..n {
                shifted[i * n + i] = a[i * n + i] + jitter * scale.max(f64::MIN_POSITIVE / jitter);
            }
            if let Some(factor) = Self::new(&shifted, n) {
                return Some(factor);
            }
            jitter *= 10.0;
        }
        None
    }

    /// Solves L x = b in place; entries of `b` beyond n are not changed.
    pub(crate) fn forward(&self, b: &mut [f64]) {
        for i in 0..self.n.min(b.len()) {
            let dot: f64 = (0..i).map(|k| self.l[i * self.n + k] * b[k]).sum();
            b[i] = (b[i] - dot) / self.l[i * self.n + i];
        }
    }

    /// Solves A x = b in place; `b` has n entries.
    pub(crate) fn solve(&self, b: &mut [f64]) {
        self.forward(b);
        let n = self.n.min(b.len());
        for i in (0..n).rev() {
            let dot: f64 = (i + 1..n).map(|k| self.l[k * self.n + i] * b[k]).sum();
            b[i] = (b[i] - dot) / self.l[i * self.n + i];
        }
    }

    /// bᵀ A⁻¹ b.
    pub(crate) fn quadratic_form(&self, b: &[f64]) -> f64 {
        let mut x = b.to_vec();
        self.forward(&mut x);
        x.iter().map(|v| v * v).sum()
    }

    /// L x: gives independent standard normal numbers the covariance A.
    pub(crate) fn multiply(&self, x: &[f64]) -> Vec<f64> {
        (0..self.n)
            .map(|i| x.iter().take(i + 1).enumerate().map(|(k, v)| self.l[i * self.n + k] * v).sum())
            .collect()
    }

    /// ln det A.
    pub(crate) fn log_determinant(&self) -> f64 {
        (0..self.n).map(|i| 2.0 * libm::log(self.l[i * self.n + i])).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn gram(rows: &[f64], n: usize, ridge: f64) -> Vec<f64> {
        let m = rows.len() / n;
        let mut a = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..n {
                a[i * n + j] = (0..m).map(|k| rows[k * n + i] * rows[k * n + j]).sum();
            }
            a[i * n + i] += ridge;
        }
        a
    }

    proptest! {
        #[test]
        fn solves_what_it_factors(rows in prop::collection::vec(-1.0..1.0f64, 8 * 6), b in prop::collection::vec(-1.0..1.0f64, 6)) {
            let a = gram(&rows, 6, 1e-3);
            let factor = Cholesky::new(&a, 6).unwrap();
            let mut x = b.clone();
            factor.solve(&mut x);
            for i in 0..6 {
                let back: f64 = (0..6).map(|j| a[i * 6 + j] * x[j]).sum();
                // Condition number at most about 5e4 by construction.
                prop_assert!((back - b[i]).abs() < 1e-9);
            }
            let form: f64 = b.iter().zip(&x).map(|(p, q)| p * q).sum();
            prop_assert!((factor.quadratic_form(&b) - form).abs() <= 1e-9 * form.max(1.0));
        }

        #[test]
        fn jitter_factors_every_semidefinite_matrix(rows in prop::collection::vec(-1.0..1.0f64, 2 * 7), scale in -12..3i32) {
            let a: Vec<_> = gram(&rows, 7, 0.0).iter().map(|v| v * 10f64.powi(scale)).collect();
            prop_assert!(Cholesky::with_jitter(&a, 7).is_some());
        }
    }

    #[test]
    fn determinant_of_a_known_matrix() {
        let factor = Cholesky::new(&[4.0, 2.0, 2.0, 3.0], 2).unwrap();
        assert!((factor.log_determinant() - 8f64.ln()).abs() < 1e-15);
        assert_eq!(factor.multiply(&[1.0, 1.0]), vec![2.0, 1.0 + 2f64.sqrt()]);
    }

    #[test]
    fn refuses_what_is_not_positive_definite() {
        assert!(Cholesky::new(&[1.0, 2.0, 2.0, 1.0], 2).is_none());
        assert!(Cholesky::new(&[f64::NAN], 1).is_none());
        assert!(Cholesky::new(&[f64::INFINITY], 1).is_none());
        assert!(Cholesky::new(&[1.0], 2).is_none());
        assert!(Cholesky::with_jitter(&[1.0, 2.0, 2.0, 1.0], 2).is_none());
        assert!(Cholesky::with_jitter(&[1.0], 2).is_none());
        assert!(Cholesky::with_jitter(&[0.0; 4], 2).is_some());
        assert!(Cholesky::new(&[], 0).is_some());
    }
}
