//! Linear least squares over many short rows.

use super::cholesky::Cholesky;

/// Minimises `|A x − b|² + ridge |x|²` over `n` unknowns x. `rows` are the rows of A, `right` is b.
///
/// Solves the normal equations by a Cholesky factor, with two steps of iterative refinement. `None` when a number is not
/// finite or the normal matrix is not positive definite.
pub(crate) fn least_squares(rows: &[Vec<f64>], right: &[f64], n: usize, ridge: f64) -> Option<Vec<f64>> {
    let mut normal = vec![0.0; n * n];
    for row in rows {
        for i in (0..n).filter(|i| row[*i] != 0.0) {
            for (sum, x) in normal[i * n..=i * n + i].iter_mut().zip(row) {
                *sum += row[i] * x;
            }
        }
    }
    for i in 0..n {
        normal[i * n + i] += ridge;
    }
    let factor = Cholesky::new(&normal, n)?;
    let mut x = vec![0.0; n];
    for _ in 0..3 {
        let mut step: Vec<f64> = x.iter().map(|x| -ridge * x).collect();
        for (row, b) in rows.iter().zip(right) {
            let gap = b - row.iter().zip(&x).map(|(a, x)| a * x).sum::<f64>();
            for (s, a) in step.iter_mut().zip(row) {
                *s += a * gap;
            }
        }
        factor.solve(&mut step);
        x.iter_mut().zip(&step).for_each(|(x, s)| *x += s);
    }
    x.iter().all(|v| v.is_finite()).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_squares_finds_an_exact_solution() {
        let truth = [0.5, -2.0, 3.0];
        let rows: Vec<Vec<f64>> = (0..9_u32)
            .map(|i| (0..3_u32).map(|k| f64::from((i * 7 + k * 5 + i * k * 3) % 11) - 4.0).collect())
            .collect();
        let right: Vec<f64> = rows.iter().map(|r| r.iter().zip(&truth).map(|(a, x)| a * x).sum()).collect();
        let x = least_squares(&rows, &right, 3, 1e-10).unwrap();
        assert!(x.iter().zip(&truth).all(|(a, b)| (a - b).abs() < 1e-9), "{x:?}");
        assert!(least_squares(&[vec![f64::NAN; 3]], &[1.0], 3, 1e-10).is_none());
    }
}
