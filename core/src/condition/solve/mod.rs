//! The exact solve: the smallest change of a decoded body that gives it exactly the asked measures.
//!
//! Gauss–Newton on min (c − c₀)ᵀ Σ⁻¹ (c − c₀) subject to m(c) = A over the given measures, with c the coefficients of
//! the shape basis, c₀ what the decoder said and Σ how uncertain each coefficient is. The paper has no such step: its
//! tables leave errors of centimetres, a tailor does not.

use super::prior::GivenMeasures;
use crate::math::cholesky::Cholesky;
use crate::measure::{MEASURE_COUNT, MeasureId, Measurements};
use crate::{Error, Result};

/// Added to the Gram matrix, whose diagonal is scaled to 1 first: small enough to cost no accuracy, it only keeps
/// rounding from making the matrix indefinite.
const RIDGE: f64 = 1e-14;

/// How often a matrix that a ridge did not make definite is tried again with ten times the ridge: until the ridge is this
/// share of the diagonal. Beyond, the step is the ridge's and no longer the measures'.
const RIDGE_MOST: f64 = 1e-3;

/// What the ridge grows by after a step that failed: measures that contradict each other ask for endless steps along
/// what they share, and a ridge turns those into a compromise.
const RIDGE_GROWTH: f64 = 1e4;

/// Steps in a row that may fail to improve on the point they came from. Tapes have kinks where the hull changes corners; a few
/// such steps get over one, more of them mean that there is nothing beyond.
const FAILURES: usize = 4;

/// Below this largest residual, metres, the next step is expected to be the last, and its derivatives are not computed
/// before it has failed to be.
const NEARLY_DONE: f64 = 3e-4;

/// A body as the solver sees it: coefficients in, measures and their derivatives out.
pub trait MeasuredShape {
    /// Number of coefficients K.
    fn dim(&self) -> usize;

    /// The measures, metres, of the body with the coefficients `c` (K of them). Where `jacobian` is given it has
    /// [`MEASURE_COUNT`] × K entries, row-major, of any content, and is filled with the derivatives.
    fn measure(&self, c: &[f64], jacobian: Option<&mut [f64]>) -> Measurements;
}

/// When the solve is content, and when it gives up.
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

/// What a solve arrived at.
#[derive(Clone, Debug)]
pub struct SolveOutcome {
    /// The coefficients of the best body found.
    pub coefficients: Vec<f64>,
    /// Its measures, metres.
    pub obtained: Measurements,
    /// Largest |asked − obtained| over the given measures, metres; 0 when nothing is given.
    pub residual_max: f64,
    /// Gauss–Newton steps taken.
    pub iterations: usize,
    /// Whether `residual_max` is within the tolerance.
    pub converged: bool,
    /// Length of the change in standard deviations: √((c − c₀)ᵀ Σ⁻¹ (c − c₀)).
    pub move_distance: f64,
}

/// Finds the coefficients nearest to `start` whose given measures are as asked.
///
/// `variances` holds the variance of each coefficient; one of zero keeps its coefficient where it is. Measures that are
/// not given float. A request that no body meets exactly ends with the best body found and `converged` false.
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
    while at.largest > options.tolerance && iterations < options.max_iterations && failures < FAILURES {
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

/// A body on the way.
#[derive(Clone)]
struct Point {
    coefficients: Vec<f64>,
    measures: Measurements,
    /// Largest absolute residual and sum of squared residuals of the given measures; infinite for a broken body.
    largest: f64,
    squares: f64,
    /// Whether the problem's Jacobian is the one of this point.
    has_jacobian: bool,
}

struct Problem<'a, S: ?Sized> {
    shape: &'a S,
    start: &'a [f64],
    variances: &'a [f64],
    /// Index and asked value of each given measure.
    rows: Vec<(usize, f64)>,
    /// [`MEASURE_COUNT`] × K, of the last point that was evaluated with it.
    jacobian: Vec<f64>,
}

impl<S: MeasuredShape + ?Sized> Problem<'_, S> {
    fn evaluate(&mut self, coefficients: Vec<f64>, has_jacobian: bool) -> Point {
        let jacobian = has_jacobian.then_some(self.jacobian.as_mut_slice());
        let measures = self.shape.measure(&coefficients, jacobian);
        let residuals = self.rows.iter().map(|(i, asked)| (asked - measures[*i]).abs());
        let largest = residuals.clone().fold(0.0, f64::max);
        let squares: f64 = residuals.map(|r| r * r).sum();
        let (largest, squares) =
            if squares.is_finite() { (largest, squares) } else { (f64::INFINITY, f64::INFINITY) };
        Point { coefficients, measures, largest, squares, has_jacobian }
    }

    /// Where the measures would be as asked if they were linear; see [`Targets`]. `None` when the derivatives are not
    /// finite.
    fn targets(&self, at: &Point, mut ridge: f64) -> Option<Targets> {
        let k = self.start.len();
        let n = self.rows.len();
        // Rows of J Σ^½, scaled to length 1: the Gram matrix then has a unit diagonal.
        let mut scaled = Vec::with_capacity(n * k);
        let mut residual = Vec::with_capacity(n);
        let mut moved = Vec::with_capacity(n);
        for &(i, asked) in &self.rows {
            let row = &self.jacobian[i * k..(i + 1) * k];
            let first = scaled.len();
            scaled.extend(row.iter().zip(self.variances).map(|(j, v)| j * v.sqrt()));
            let length = scaled[first..].iter().map(|x| x * x).sum::<f64>().sqrt();
            if !length.is_finite() {
                return None;
            }
            // A measure that no coefficient moves takes no part.
            let factor = if length > 0.0 { 1.0 / length } else { 0.0 };
            for x in &mut scaled[first..] {
                *x *= factor;
            }
            let change: f64 =
                row.iter().zip(&at.coefficients).zip(self.start).map(|((j, c), c0)| j * (c - c0)).sum();
            residual.push((asked - at.measures[i]) * factor);
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
                None if ridge < RIDGE_MOST => ridge *= 10.0,
                None => return None,
            }
        };
        let from = |base: &[f64], mut right: Vec<f64>| {
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
        Some(Targets { nearest: from(self.start, whole)?, correction: from(&at.coefficients, residual)? })
    }

    /// The next point, and whether it is better than the last.
    ///
    /// The nearest target is taken if it at least halves the residual. Else its sideways move has crossed kinks, and
    /// the correction alone is followed, in ever shorter steps until the residual falls; if it never does, the best of
    /// them is the next point.
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

/// Where the next step could lead.
struct Targets {
    /// c₀ + ΣJᵀ (JΣJᵀ + ε)⁻¹ (A − m + J(c − c₀)): of all points that meet the measures, the one nearest to the start.
    nearest: Vec<f64>,
    /// c + ΣJᵀ (JΣJᵀ + ε)⁻¹ (A − m): the one nearest to the current point.
    correction: Vec<f64>,
}

#[cfg(test)]
mod tests;
