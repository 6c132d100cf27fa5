//! Statistics of a survey: what of it is committed.

use std::collections::BTreeMap;

use anthronet::measure::Sex;
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use serde::{Deserialize, Serialize};

use super::rows::Rows;
use crate::{Error, Result};

/// Number of quantiles of a column: 0 %, 1 %, … 100 %.
pub const QUANTILES: usize = 101;

/// People whose logarithms are farther from the mean than √n + 5 standard deviations, for n columns, are slips of the pen: of a
/// Gaussian's people fewer than one in a hundred million, whatever n is.
const SLIP: f64 = 5.0;

/// Steps of the expectation maximisation; with the 2 % of values that NHANES lacks it has converged to 1e-9 after ten.
const STEPS: usize = 25;

const COMMITTED: &str = include_str!("statistics.json");

/// The committed statistics of both surveys.
///
/// # Errors
/// [`Error::Invalid`] when the file is not what it should be.
pub fn committed() -> Result<BTreeMap<String, SurveyStatistics>> {
    serde_json::from_str(COMMITTED).map_err(|e| Error::Invalid(format!("survey/statistics.json: {e}")))
}

/// Statistics of one survey, per sex.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SurveyStatistics {
    /// Of women.
    pub female: SexStatistics,
    /// Of men.
    pub male: SexStatistics,
}

impl SurveyStatistics {
    /// Those of one sex.
    pub fn of(&self, sex: Sex) -> &SexStatistics {
        match sex {
            Sex::Female => &self.female,
            Sex::Male => &self.male,
        }
    }
}

/// One column of a survey; metres or kilograms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Column {
    /// The survey's name of it.
    pub name: String,
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub deviation: f64,
    /// [`QUANTILES`] numbers that do not fall.
    pub quantiles: Vec<f64>,
    /// Correlations with the columns before it.
    pub correlations: Vec<f64>,
}

/// Statistics of the people of one sex.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SexStatistics {
    /// Number of people that they were computed from.
    pub people: usize,
    /// All measures of the survey.
    pub columns: Vec<Column>,
}

impl SexStatistics {
    /// Computes them, with the people's sample weights. Values that were not taken are replaced by what the others say of
    /// them (expectation maximisation for a Gaussian): leaving such people out would lose the heavy ones.
    ///
    /// # Errors
    /// [`Error::Invalid`] for columns that depend on each other, or without a single value.
    pub fn new(rows: &Rows) -> Result<Self> {
        let mut weights = rows.weights.clone();
        let logarithms = rows.people.iter().map(|p| p.iter().map(|v| v.map(libm::log)).collect());
        let logarithms: Vec<Vec<Option<f64>>> = logarithms.collect();
        let rough = gaussian(&logarithms, &weights)?;
        for (person, weight) in logarithms.iter().zip(&mut weights) {
            if rough.distance(person)? > SLIP + (person.len() as f64).sqrt() {
                *weight = 0.0;
            }
        }
        let Gaussian { mean, covariance } = gaussian(&rows.people, &weights)?;
        let deviation = |i: usize| covariance[(i, i)].sqrt();
        let columns = rows.columns.iter().enumerate().map(|(i, name)| Column {
            name: name.clone(),
            mean: rounded(mean[i]),
            deviation: rounded(deviation(i)),
            quantiles: quantiles(rows.people.iter().map(|p| p[i]).zip(weights.iter().copied())),
            correlations: (0..i)
                .map(|j| rounded(covariance[(i, j)] / (deviation(i) * deviation(j))))
                .collect(),
        });
        Ok(Self { people: weights.iter().filter(|w| **w > 0.0).count(), columns: columns.collect() })
    }

    /// Position of a column.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a column that it does not have.
    pub fn column(&self, name: &str) -> Result<usize> {
        let missing = || Error::Invalid(format!("no statistics of the column {name}"));
        self.columns.iter().position(|column| column.name == name).ok_or_else(missing)
    }

    /// Covariance of two columns.
    pub fn covariance(&self, i: usize, j: usize) -> f64 {
        let [a, b] = [&self.columns[i], &self.columns[j]];
        let correlation = match i.cmp(&j) {
            std::cmp::Ordering::Less => b.correlations[i],
            std::cmp::Ordering::Equal => 1.0,
            std::cmp::Ordering::Greater => a.correlations[j],
        };
        correlation * a.deviation * b.deviation
    }

    /// The linear regression of a column on others.
    ///
    /// # Errors
    /// [`Error::Invalid`] for columns that depend on each other.
    pub fn regression(&self, given: &[usize], target: usize) -> Result<Regression> {
        let among = Mat::from_fn(given.len(), given.len(), |i, j| self.covariance(given[i], given[j]));
        let with = Mat::from_fn(given.len(), 1, |i, _| self.covariance(given[i], target));
        let slopes = solved(&among, &with)?;
        let slopes: Vec<f64> = (0..given.len()).map(|i| slopes[(i, 0)]).collect();
        let at_mean: f64 = given.iter().zip(&slopes).map(|(g, slope)| self.columns[*g].mean * slope).sum();
        Ok(Regression { intercept: self.columns[target].mean - at_mean, slopes })
    }
}

/// A linear regression.
#[derive(Clone, Debug, PartialEq)]
pub struct Regression {
    /// Value where all given are zero.
    pub intercept: f64,
    /// Change per unit of each given column.
    pub slopes: Vec<f64>,
}

impl Regression {
    /// The predicted value; `given` in the order of the regression's columns.
    pub fn predict(&self, given: &[f64]) -> f64 {
        self.intercept + self.slopes.iter().zip(given).map(|(slope, value)| slope * value).sum::<f64>()
    }
}

struct Gaussian {
    mean: Vec<f64>,
    covariance: Mat<f64>,
}

impl Gaussian {
    /// Mahalanobis distance of the values that a person has.
    fn distance(&self, person: &[Option<f64>]) -> Result<f64> {
        let known: Vec<usize> = (0..person.len()).filter(|i| person[*i].is_some()).collect();
        let off = Mat::from_fn(known.len(), 1, |i, _| person[known[i]].unwrap_or(0.0) - self.mean[known[i]]);
        let solution = solved(&self.part(&known, &known), &off)?;
        Ok((0..known.len()).map(|i| off[(i, 0)] * solution[(i, 0)]).sum::<f64>().sqrt())
    }

    fn part(&self, rows: &[usize], columns: &[usize]) -> Mat<f64> {
        Mat::from_fn(rows.len(), columns.len(), |i, j| self.covariance[(rows[i], columns[j])])
    }
}

/// Mean and covariance of weighted rows with gaps.
fn gaussian(people: &[Vec<Option<f64>>], weights: &[f64]) -> Result<Gaussian> {
    let columns = people.first().map_or(0, Vec::len);
    let total: f64 = weights.iter().sum();
    let mut so_far = without_gaps(people, weights, columns)?;
    let mut patterns: BTreeMap<Vec<usize>, Vec<usize>> = BTreeMap::new();
    for (number, person) in people.iter().enumerate() {
        let missing = (0..columns).filter(|i| person[*i].is_none()).collect();
        patterns.entry(missing).or_default().push(number);
    }
    let steps = if patterns.keys().all(Vec::is_empty) { 1 } else { STEPS };
    for _ in 0..steps {
        let mut mean = vec![0.0; columns];
        let mut completed: Vec<(f64, Vec<f64>)> = Vec::with_capacity(people.len());
        let mut left_open = Mat::<f64>::zeros(columns, columns);
        for (missing, members) in &patterns {
            let known: Vec<usize> = (0..columns).filter(|i| !missing.contains(i)).collect();
            let slopes = solved(&so_far.part(&known, &known), &so_far.part(&known, missing))?;
            let unexplained = so_far.part(missing, missing) - so_far.part(missing, &known) * &slopes;
            for &number in members {
                let weight = weights[number] / total;
                let mut values: Vec<f64> =
                    (0..columns).map(|i| people[number][i].unwrap_or(so_far.mean[i])).collect();
                for (m, &i) in missing.iter().enumerate() {
                    let explained = known
                        .iter()
                        .enumerate()
                        .map(|(k, &j)| slopes[(k, m)] * (people[number][j].unwrap_or(0.0) - so_far.mean[j]));
                    values[i] += explained.sum::<f64>();
                    for (n, &j) in missing.iter().enumerate() {
                        left_open[(i, j)] += weight * unexplained[(m, n)];
                    }
                }
                for (sum, value) in mean.iter_mut().zip(&values) {
                    *sum += weight * value;
                }
                completed.push((weight, values));
            }
        }
        let mut covariance = left_open;
        for (weight, values) in &completed {
            for i in 0..columns {
                for j in 0..=i {
                    covariance[(i, j)] += weight * (values[i] - mean[i]) * (values[j] - mean[j]);
                }
            }
        }
        for i in 0..columns {
            for j in 0..i {
                covariance[(j, i)] = covariance[(i, j)];
            }
        }
        so_far = Gaussian { mean, covariance };
    }
    Ok(so_far)
}

/// Mean and variance of each column alone, as the start.
fn without_gaps(people: &[Vec<Option<f64>>], weights: &[f64], columns: usize) -> Result<Gaussian> {
    let mut start = Gaussian { mean: vec![0.0; columns], covariance: Mat::zeros(columns, columns) };
    for i in 0..columns {
        let taken = || people.iter().zip(weights).filter_map(|(p, w)| p[i].map(|v| (v, *w)));
        let total: f64 = taken().map(|(_, w)| w).sum();
        if total <= 0.0 {
            return Err(Error::Invalid(format!("column {i} of the survey has no values")));
        }
        let mean = taken().map(|(v, w)| v * w).sum::<f64>() / total;
        start.mean[i] = mean;
        start.covariance[(i, i)] = taken().map(|(v, w)| w * (v - mean) * (v - mean)).sum::<f64>() / total;
    }
    Ok(start)
}

/// The x of A x = b for a positive definite A.
fn solved(a: &Mat<f64>, b: &Mat<f64>) -> Result<Mat<f64>> {
    let factor = a.llt(Side::Lower);
    let factor = factor.map_err(|_| Error::Invalid("columns of the survey depend on each other".into()))?;
    Ok(factor.solve(b))
}

/// Weighted quantiles, each person in the middle of their weight.
fn quantiles(values: impl Iterator<Item = (Option<f64>, f64)>) -> Vec<f64> {
    let mut sorted: Vec<(f64, f64)> =
        values.filter_map(|(v, w)| Some((v?, w))).filter(|v| v.1 > 0.0).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = sorted.iter().map(|v| v.1).sum();
    let mut below = 0.0;
    let middles: Vec<(f64, f64)> = sorted
        .iter()
        .map(|&(value, weight)| {
            below += weight;
            ((below - 0.5 * weight) / total, value)
        })
        .collect();
    let at = |share: f64| {
        let next = middles.partition_point(|m| m.0 < share);
        match (next.checked_sub(1).and_then(|i| middles.get(i)), middles.get(next)) {
            (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (share - a.0) / (b.0 - a.0),
            (Some(only), None) | (None, Some(only)) => only.1,
            (None, None) => f64::NAN,
        }
    };
    (0..QUANTILES).map(|i| rounded(at(i as f64 / (QUANTILES - 1) as f64))).collect()
}

/// Six significant digits: what the file keeps.
fn rounded(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return value;
    }
    let scale = libm::pow(10.0, 5.0 - libm::floor(libm::log10(value.abs())));
    (value * scale).round() / scale
}
