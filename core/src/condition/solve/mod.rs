//! The exact solve: the smallest change of a decoded body that gives it exactly the given measures.
//!
//! Gauss–Newton on min (c − c₀)ᵀ Σ⁻¹ (c − c₀) subject to m(c) = A over the given measures: c are the shape coefficients, c₀
//! those from the decoder, Σ the diagonal matrix of their variances, m the measures and A their given values. The paper has
//! no such step and errors of centimetres in its tables.

use super::prior::GivenMeasures;
use crate::math::cholesky::Cholesky;
use crate::measure::{MEASURE_COUNT, MeasureId, Measurements};
use crate::{Error, Result};

/// Ridge ε added to the diagonal of the Gram matrix, which is scaled to 1 first: too small to cost accuracy, it keeps
/// rounding from making the matrix indefinite.
const RIDGE: f64 = 1e-14;

/// Largest ridge: while the matrix is not positive definite, the ridge grows tenfold up to this. A larger one would
/// determine the step more than the measures do.
const MAX_RIDGE: f64 = 1e-3;

/// Factor on the ridge after a step that failed: nearly contradictory measures give huge steps along nearly dependent
/// directions, which a ridge turns into a compromise.
const RIDGE_GROWTH: f64 = 1e4;

/// Steps in a row without improvement after which the solve stops. Tapes have kinks where the hull changes corners; a few
/// such steps cross one, more mean that no better point is in reach.
const MAX_FAILURES: usize = 4;

/// Largest residual, metres, below which the next step is expected to be the last, so that its Jacobian is computed only
/// if it was not.
const NEARLY_DONE: f64 = 3e-4;

/// A body as the solver sees it: measures and their derivatives as a function of coefficients.
pub trait MeasuredShape {
    /// Number of coefficients K.
    fn dim(&self) -> usize;

    /// The measures, metres, of the body with the K coefficients `c`. `jacobian` has [`MEASURE_COUNT`] × K entries,
    /// row-major, and is overwritten with the derivatives of the measures (rows) with respect to the coefficients (columns).
    fn measure(&self, c: &[f64], jacobian: Option<&mut [f64]>) -> Measurements;
}

/// When the solve stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolveOptions {
    /// Largest residual of a given measure that counts as solved, metres.
    pub tolerance: f64,
    /// Largest number of Gauss–Newton steps.
    pub max_iterations: usize,
}

impl Default for SolveOptions {
    fn default() -> Self {
        Self { tolerance: 1e-7, max_iterations: 20 }
    }
}

/// The result of a solve.
#[derive(Clone, Debug)]
pub struct SolveOutcome {
    /// The coefficients of the best body found.
    pub coefficients: Vec<f64>,
    /// Its measures, metres.
    pub obtained: Measurements,
    /// Largest |given − obtained| over the given measures, metres; 0 when nothing is given.
    pub residual_max: f64,
    /// Gauss–Newton steps taken.
    pub iterations: usize,
    /// Whether `residual_max` is within the tolerance.
    pub converged: bool,
    /// Mahalanobis length of the change, in standard deviations: √((c − c₀)ᵀ Σ⁻¹ (c − c₀)).
    pub move_distance: f64,
}

/// Finds the coefficients nearest to `start` (K, metres) whose body has the given measures (metres).
///
/// `variances` holds the variance of each coefficient, m²; a variance of zero keeps the coefficient at its start. Measures
/// that are not given are free. Where no body has the given measures, the result is the best one found, with `converged`
/// false.
///
/// # Errors
/// [`Error::Invalid`] when `start` or `variances` do not have K finite entries, when a variance is negative, and when
/// the shape has no finite measures at the start; [`Error::Request`] for a given measure that is not finite.
pub fn solve<S: MeasuredShape + ?Sized>(
    shape: &S,
    start: &[f64],
    variances: &[f64],
    given: &GivenMeasures,
    options: &SolveOptions,
) -> Result<SolveOutcome> {
    let k = shape.dim();
    for (what, data) in [("decoded coefficients", start), ("coefficient variances", variances)] {
        if data.len() != k {
            return Err(Error::invalid(what, format!("expected {k} numbers, got {}", data.len())));
        }
        if let Some(bad) = data.iter().find(|v| !v.is_finite()) {
            return Err(Error::invalid(what, format!("expected finite numbers, got {bad}")));
        }
    }
    if let Some(bad) = variances.iter().find(|v| **v < 0.0) {
        return Err(Error::invalid("coefficient variances", format!("expected none below zero, got {bad}")));
    }
    let mut rows = Vec::new();
    for (id, value) in MeasureId::all().zip(given) {
        match value {
            Some(v) if !v.is_finite() => {
                return Err(Error::request(
                    id.name(),
                    format!("expected a finite number of metres, got {v}"),
                ));
            }
            Some(v) => rows.push((id.index(), *v)),
            None => {}
        }
    }

    let mut problem = Problem { shape, start, variances, rows, jacobian: vec![0.0; MEASURE_COUNT * k] };
    let mut at = problem.evaluate(start.to_vec(), true);
    if at.measures.iter().any(|v| !v.is_finite()) {
        return Err(Error::invalid("decoded body", "its measures are not finite"));
    }
    let mut best = at.clone();
    let mut iterations = 0;
    let mut failures = 0;
    let mut ridge = RIDGE;
    while at.largest > options.tolerance && iterations < options.max_iterations && failures < MAX_FAILURES {
        if !at.has_jacobian {
            at = problem.evaluate(at.coefficients, true);
        }
        let Some(targets) = problem.targets(&at, ridge) else { break };
        iterations += 1;
        let (next, improved) = problem.search(&at, &targets);
        (failures, ridge) = if improved { (0, RIDGE) } else { (failures + 1, ridge * RIDGE_GROWTH) };
        at = next;
        if at.largest < best.largest {
            best = at.clone();
        }
    }

    let move_distance = best
        .coefficients
        .iter()
        .zip(start)
        .zip(variances)
        .filter(|(_, variance)| **variance > 0.0)
        .map(|((c, c0), variance)| (c - c0) * (c - c0) / variance)
        .sum::<f64>()
        .sqrt();
    Ok(SolveOutcome {
        converged: best.largest <= options.tolerance,
        coefficients: best.coefficients,
        obtained: best.measures,
        residual_max: best.largest,
        iterations,
        move_distance,
    })
}

/// An iterate.
#[derive(Clone)]
struct Point {
    coefficients: Vec<f64>,
    measures: Measurements,
    /// Largest absolute residual and sum of squared residuals of the given measures; infinite where a measure is not finite.
    largest: f64,
    squares: f64,
    /// Whether [`Problem::jacobian`] is the one at this point.
    has_jacobian: bool,
}

struct Problem<'a, S: ?Sized> {
    shape: &'a S,
    start: &'a [f64],
    variances: &'a [f64],
    /// Index and given value, metres, of each given measure.
    rows: Vec<(usize, f64)>,
    /// [`MEASURE_COUNT`] × K, at the last point that was evaluated with its Jacobian.
    jacobian: Vec<f64>,
}

impl<S: MeasuredShape + ?Sized> Problem<'_, S> {
    fn evaluate(&mut self, coefficients: Vec<f64>, has_jacobian: bool) -> Point {
        let jacobian = has_jacobian.then_some(self.jacobian.as_mut_slice());
        let measures = self.shape.measure(&coefficients, jacobian);
        let residuals = self.rows.iter().map(|(i, given)| (given - measures[*i]).abs());
        let largest = residuals.clone().fold(0.0, f64::max);
        let squares: f64 = residuals.map(|r| r * r).sum();
        let (largest, squares) =
            if squares.is_finite() { (largest, squares) } else { (f64::INFINITY, f64::INFINITY) };
        Point { coefficients, measures, largest, squares, has_jacobian }
    }

    /// The points that have the given measures in the linearisation at `at`; `None` when the derivatives are not finite or
    /// the Gram matrix is not positive definite even with [`MAX_RIDGE`].
    fn targets(&self, at: &Point, mut ridge: f64) -> Option<Targets> {
        let k = self.start.len();
        let n = self.rows.len();
        // Rows of J Σ^½, scaled to length 1, which gives the Gram matrix a unit diagonal.
        let mut scaled = Vec::with_capacity(n * k);
        let mut residual = Vec::with_capacity(n);
        let mut moved = Vec::with_capacity(n);
        for &(i, given) in &self.rows {
            let row = &self.jacobian[i * k..(i + 1) * k];
            let first = scaled.len();
            scaled.extend(row.iter().zip(self.variances).map(|(j, v)| j * v.sqrt()));
            let length = scaled[first..].iter().map(|x| x * x).sum::<f64>().sqrt();
            if !length.is_finite() {
                return None;
            }
            // A measure that no coefficient changes is left out.
            let factor = if length > 0.0 { 1.0 / length } else { 0.0 };
            for x in &mut scaled[first..] {
                *x *= factor;
            }
            let change: f64 =
                row.iter().zip(&at.coefficients).zip(self.start).map(|((j, c), c0)| j * (c - c0)).sum();
            residual.push((given - at.measures[i]) * factor);
            moved.push(change * factor);
        }
        let mut gram = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let dot: f64 = scaled[i * k..(i + 1) * k]
                    .iter()
                    .zip(&scaled[j * k..(j + 1) * k])
                    .map(|(a, b)| a * b)
                    .sum();
                gram[i * n + j] = dot;
                gram[j * n + i] = dot;
            }
        }
        let factor = loop {
            let mut regular = gram.clone();
            for i in 0..n {
                regular[i * n + i] += ridge;
            }
            match Cholesky::new(&regular, n) {
                Some(factor) => break factor,
                None if ridge < MAX_RIDGE => ridge *= 10.0,
                None => return None,
            }
        };
        let target_from = |base: &[f64], mut right: Vec<f64>| {
            factor.solve(&mut right);
            let mut target = base.to_vec();
            for (row, multiplier) in scaled.chunks_exact(k.max(1)).zip(&right) {
                for ((c, x), variance) in target.iter_mut().zip(row).zip(self.variances) {
                    *c += variance.sqrt() * x * multiplier;
                }
            }
            target.iter().all(|c| c.is_finite()).then_some(target)
        };
        let whole = residual.iter().zip(&moved).map(|(r, m)| r + m).collect();
        Some(Targets {
            nearest: target_from(self.start, whole)?,
            correction: target_from(&at.coefficients, residual)?,
        })
    }

    /// The next point, and whether it is better than the last.
    ///
    /// The nearest target is taken if it at least halves the residual norm. Otherwise its tangential part has crossed kinks,
    /// and a backtracking line search goes towards the correction alone; if the residual never falls enough, the best
    /// point tried is the next one.
    fn search(&mut self, at: &Point, targets: &Targets) -> (Point, bool) {
        let want_jacobian = at.largest > NEARLY_DONE;
        let mut best = self.evaluate(targets.nearest.clone(), want_jacobian);
        if best.squares <= 0.25 * at.squares {
            return (best, true);
        }
        best.has_jacobian = false;
        let mut length = 1.0;
        for _ in 0..7 {
            let step =
                at.coefficients.iter().zip(&targets.correction).map(|(c, t)| c + length * (t - c)).collect();
            let point = self.evaluate(step, false);
            let falls = point.squares <= (1.0 - 0.01 * length) * at.squares;
            if point.squares < best.squares {
                best = point;
            }
            if falls {
                break;
            }
            length *= 0.5;
        }
        let improved = best.squares <= 0.999 * at.squares;
        (best, improved)
    }
}

/// Targets of the next step: points that have the given measures if these are linear. m and J are taken at c.
struct Targets {
    /// c₀ + ΣJᵀ (JΣJᵀ + ε)⁻¹ (A − m + J(c − c₀)): the one nearest to the start.
    nearest: Vec<f64>,
    /// c + ΣJᵀ (JΣJᵀ + ε)⁻¹ (A − m): the one nearest to the current point c.
    correction: Vec<f64>,
}

#[cfg(test)]
mod tests;
