//! Fits the biases of the local sliders (`sampling_bias.json`), so that the mean of every measure is the paper's.
//!
//! The mean of a measure over many bodies is nearly linear in the sliders' centres, so a few Gauss-Newton steps with one
//! Jacobian suffice. There are more sliders than measures: of all biases that fit, the ones nearest to the present ones are
//! chosen, which keeps proportions that were judged natural by eye.

use std::collections::BTreeMap;

use anthronet::measure::Definitions;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use rayon::prelude::*;

use crate::corpus::{Corpus, Gauge, plausible};
use crate::dataset::Bodies;
use crate::evaluation::{NOT_MATCHED, Statistics};
use crate::sampling::committed_biases;
use crate::{Error, Result};

/// Target mean of [`NOT_MATCHED`] instead of the paper's, metres.
const NATURAL_HEAD_HEIGHT: f64 = 0.231;
/// Number of bodies that a slider's effect is measured on.
const JACOBIAN_BODIES: u64 = 400;
/// Number of bodies whose means are fitted; the standard errors are below 0.03 of the paper's standard deviations.
const FITTED_BODIES: u64 = 16_000;
const STEPS: usize = 3;
/// Step of a slider for the finite difference.
const NUDGE: f64 = 0.1;
/// Weight of a squared change of a slider against a squared z.
const RELUCTANCE: f64 = 0.02;

/// Fitted biases, and the statistics with them.
pub struct Fitted {
    /// Centre of each slider, by MakeHuman's name.
    pub biases: BTreeMap<String, f64>,
    /// Statistics of the bodies that they were fitted on.
    pub statistics: Statistics,
}

impl Fitted {
    /// The text of `sampling_bias.json`.
    pub fn to_json(&self) -> String {
        let lines: Vec<String> =
            self.biases.iter().map(|(name, bias)| format!(" {name:?}: {bias}")).collect();
        format!("{{\n{}\n}}\n", lines.join(",\n"))
    }
}

/// Fits all biases, starting from the committed ones.
///
/// # Errors
/// When a slider is unknown or the equations cannot be solved.
pub fn fit(
    corpus: &mut Corpus,
    definitions: &Definitions,
    progress: &(dyn Fn(&str, u64, u64) + Sync),
) -> Result<Fitted> {
    let gauge = Gauge::new(definitions, &corpus.subdivision);
    let start = committed_biases()?;
    let total = JACOBIAN_BODIES * (start.len() as u64 + 1) + FITTED_BODIES * (STEPS as u64 + 1);
    let mut done = 0;
    let mut measure = |corpus: &mut Corpus, biases: &BTreeMap<String, f64>, bodies, people| {
        corpus.sampler.set_biases(biases)?;
        let statistics = statistics(corpus, &gauge, bodies, people);
        done += bodies;
        progress("mean measures", done, total);
        Ok::<Statistics, Error>(statistics)
    };

    let before = misses(&measure(corpus, &start, JACOBIAN_BODIES, false)?);
    let mut jacobian = Mat::zeros(before.nrows(), start.len());
    for (j, name) in start.keys().enumerate() {
        let nudged = start.iter().map(|(n, b)| (n.clone(), if n == name { b + NUDGE } else { *b })).collect();
        let after = misses(&measure(corpus, &nudged, JACOBIAN_BODIES, false)?);
        for i in 0..before.nrows() {
            jacobian[(i, j)] = (after[(i, 0)] - before[(i, 0)]) / NUDGE;
        }
    }

    let mut biases = start.clone();
    let mut statistics = measure(corpus, &biases, FITTED_BODIES, true)?;
    let mut change = Mat::zeros(start.len(), 1);
    for _ in 0..STEPS {
        change = better(&jacobian, &misses(&statistics), &change)?;
        for ((bias, from), j) in biases.values_mut().zip(start.values()).zip(0..) {
            *bias = ((from + change[(j, 0)]) * 1e4).round() / 1e4;
        }
        statistics = measure(corpus, &biases, FITTED_BODIES, true)?;
    }
    Ok(Fitted { biases, statistics })
}

/// The change x of all sliders with the least |m + J (x - x₀)|² + reluctance |x|², for misses m at the change x₀.
fn better(jacobian: &Mat<f64>, misses: &Mat<f64>, so_far: &Mat<f64>) -> Result<Mat<f64>> {
    let mut gram = jacobian * jacobian.transpose();
    for i in 0..gram.nrows() {
        gram[(i, i)] += RELUCTANCE;
    }
    let factor = gram.llt(Side::Lower).map_err(|e| Error::Invalid(format!("biases: {e:?}")))?;
    Ok(jacobian.transpose() * factor.solve(jacobian * so_far - misses))
}

/// Difference of each mean from its target, in the paper's standard deviations.
fn misses(statistics: &Statistics) -> Mat<f64> {
    Mat::from_fn(statistics.measures.len(), 1, |i, _| {
        let row = &statistics.measures[i];
        let [mean, deviation, ..] = row.paper;
        if row.name == NOT_MATCHED { row.z - (NATURAL_HEAD_HEIGHT - mean) / deviation } else { row.z }
    })
}

/// Statistics of the first bodies of the corpus, optionally of the plausible ones only. A slider's effect is measured on
/// all bodies, so that the set does not change with the slider.
fn statistics(corpus: &Corpus, gauge: &Gauge<'_>, count: u64, people: bool) -> Statistics {
    let drawn: Vec<_> =
        (0..count).into_par_iter().map(|n| (n, gauge.read(&corpus.specimen(n).points))).collect();
    let mut bodies = Bodies::default();
    for (n, measures) in drawn.iter().filter(|(_, measures)| !people || plausible(measures)) {
        bodies.numbers.push(*n);
        bodies.measures.extend(measures.map(|m| m as f32));
    }
    Statistics::of(&[&bodies], drawn.len() - bodies.len())
}

#[cfg(test)]
mod tests {
    use anthronet::measure::MeasureId;

    use super::*;
    use crate::evaluation::paper_row;

    #[test]
    fn steps_end_where_means_fit_with_the_least_change() {
        // Two means of three sliders; the third does the same as the first, half as well, and the effect bends.
        let effect = |x: &Mat<f64>| {
            let a = x[(0, 0)] + 0.5 * x[(2, 0)];
            Mat::from_fn(2, 1, |i, _| if i == 0 { 8.0 * a + a * a - 4.0 } else { 5.0 * x[(1, 0)] + 1.0 })
        };
        let jacobian = Mat::from_fn(2, 3, |i, j| [[8.0, 0.0, 4.0], [0.0, 5.0, 0.0]][i][j]);
        let mut x = Mat::zeros(3, 1);
        for _ in 0..STEPS {
            x = better(&jacobian, &effect(&x), &x).unwrap();
        }
        let left = effect(&x);
        assert!((0..2).all(|i| left[(i, 0)].abs() < 0.01), "{left:?}");
        assert!((x[(2, 0)] - 0.5 * x[(0, 0)]).abs() < 1e-9, "{x:?}");
    }

    #[test]
    fn the_file_holds_what_was_fitted() {
        let biases = committed_biases().unwrap();
        let fitted = Fitted { biases: biases.clone(), statistics: Statistics::of(&[], 0) };
        let read: BTreeMap<String, f64> = serde_json::from_str(&fitted.to_json()).unwrap();
        assert_eq!(read, biases);
        let id = MeasureId::from_name(NOT_MATCHED).unwrap();
        assert!((NATURAL_HEAD_HEIGHT - paper_row(id).unwrap()[0]).abs() < 0.02);
    }
}
