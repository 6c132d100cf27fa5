//! The prior of a survey's people over all measures, those that it has and those that it has not.
//!
//! Measures that are a column of the survey have its mean, covariance and quantiles, both sides alike but for the differences
//! that the sampled bodies have. The rest is predicted by the regression of the sampled bodies on them, with a doubt of a
//! centimetre in each: definitions differ by so much here and there, and a regression that took such a difference at its word
//! would ask for a body that nobody has.

use anthronet::condition::QUANTILE_COUNT;
use anthronet::measure::{MEASURE_COUNT, MeasureId, Sex, expand_name};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};

use crate::survey::{SexStatistics, Survey, SurveyStatistics};
use crate::{Error, Result};

/// Variance by which people's measures and the sampled bodies' may differ for reasons of definition, m².
const DISAGREEMENT: f64 = 1e-4;

/// Mean, covariance and quantiles per sex, female first, as [`anthronet::model::ModelParts::priors`] has them.
///
/// # Errors
/// When the survey lacks a column that a measure is, or the bodies' covariance is singular.
pub fn prior(survey: Survey, statistics: &SurveyStatistics, bodies: &[Vec<f64>; 3]) -> Result<[Vec<f64>; 3]> {
    let mut out = [Vec::new(), Vec::new(), Vec::new()];
    for sex in Sex::ALL {
        let n = MEASURE_COUNT;
        let place = sex.index();
        let mean = &bodies[0][place * n..(place + 1) * n];
        let covariance = &bodies[1][place * n * n..(place + 1) * n * n];
        let [mean, covariance, quantiles] = of_sex(survey, statistics.of(sex), mean, covariance)?;
        out[0].extend(mean);
        out[1].extend(covariance);
        out[2].extend(quantiles);
    }
    Ok(out)
}

/// A measure that the survey has.
struct Mapped {
    /// One measure, or both sides.
    ids: Vec<MeasureId>,
    column: usize,
}

fn of_sex(survey: Survey, people: &SexStatistics, mean: &[f64], covariance: &[f64]) -> Result<[Vec<f64>; 3]> {
    let n = MEASURE_COUNT;
    let mapped = survey.mappings().into_iter().map(|mapping| {
        let ids = expand_name(mapping.measure).unwrap_or_default();
        Ok(Mapped { ids, column: people.column(mapping.column)? })
    });
    let mapped: Vec<Mapped> = mapped.collect::<Result<_>>()?;
    let m = mapped.len();
    // Means over both sides of the mapped measures: the bodies' covariance with everything.
    let with = Mat::from_fn(n, m, |i, k| {
        let ids = &mapped[k].ids;
        ids.iter().map(|id| covariance[i * n + id.index()]).sum::<f64>() / ids.len() as f64
    });
    let over_sides = |value: &dyn Fn(usize) -> f64, k: usize| {
        let ids = &mapped[k].ids;
        ids.iter().map(|id| value(id.index())).sum::<f64>() / ids.len() as f64
    };
    let among = Mat::from_fn(m, m, |k, l| {
        let doubt = if k == l { DISAGREEMENT } else { 0.0 };
        over_sides(&|i| with[(i, l)], k) + doubt
    });
    let factor = among.llt(Side::Lower);
    let factor = factor.map_err(|e| Error::Invalid(format!("covariance of the bodies: {e:?}")))?;
    // Regression of every measure on the mapped ones; a mapped one is itself, whatever its side.
    let mut slopes = factor.solve(with.transpose()).transpose().to_owned();
    for i in 0..n {
        if let Some(own) = mapped.iter().position(|of| of.ids.iter().any(|id| id.index() == i)) {
            for k in 0..m {
                slopes[(i, k)] = f64::from(u8::from(k == own));
            }
        }
    }
    let is_mapped = |i: usize| mapped.iter().any(|of| of.ids.iter().any(|id| id.index() == i));
    let difference =
        Mat::from_fn(m, 1, |k, _| people.columns[mapped[k].column].mean - over_sides(&|i| mean[i], k));
    let shift = &slopes * &difference;
    let new_mean: Vec<f64> = (0..n)
        .map(|i| match mapped.iter().find(|of| of.ids.iter().any(|id| id.index() == i)) {
            Some(of) => people.columns[of.column].mean,
            None => mean[i] + shift[(i, 0)],
        })
        .collect();
    let surveyed = Mat::from_fn(m, m, |k, l| people.covariance(mapped[k].column, mapped[l].column));
    let explained = &slopes * &surveyed * slopes.transpose();
    let predicted = &slopes * with.transpose();
    let mut new_covariance = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let rest = match (is_mapped(i), is_mapped(j)) {
                (true, true) => difference_of_sides(covariance, i, j),
                (false, false) => {
                    // What the bodies' regression leaves open; symmetric but for rounding.
                    covariance[i * n + j] - 0.5 * (predicted[(i, j)] + predicted[(j, i)])
                }
                _ => 0.0,
            };
            new_covariance[i * n + j] = explained[(i, j)] + rest;
            new_covariance[j * n + i] = new_covariance[i * n + j];
        }
    }
    let mut quantiles = Vec::with_capacity(n * QUANTILE_COUNT);
    for i in 0..n {
        match mapped.iter().find(|of| of.ids.iter().any(|id| id.index() == i)) {
            Some(of) => quantiles.extend(&people.columns[of.column].quantiles),
            None => {
                let deviation = new_covariance[i * (n + 1)].sqrt();
                quantiles.extend((0..QUANTILE_COUNT).map(|q| new_mean[i] + normal_quantile(q) * deviation));
            }
        }
    }
    Ok([new_mean, new_covariance, quantiles])
}

/// The covariance of two sides' differences from their mean, zero between different measures: what the bodies have.
fn difference_of_sides(covariance: &[f64], i: usize, j: usize) -> f64 {
    let n = MEASURE_COUNT;
    let mirror = |i: usize| MeasureId::from_index(i).map_or(i, |id| id.mirrored().index());
    if mirror(i) == i || (j != i && j != mirror(i)) {
        return 0.0;
    }
    let k = mirror(i);
    let spread = 0.25 * (covariance[i * n + i] + covariance[k * n + k] - 2.0 * covariance[i * n + k]);
    if i == j { spread } else { -spread }
}

/// The standard normal quantile of a percentage; its ends are those of 2,000 people.
fn normal_quantile(percent: usize) -> f64 {
    let share = (percent as f64 / 100.0).clamp(1.0 / 2_000.0, 1.0 - 1.0 / 2_000.0);
    // By bisection of the distribution function.
    let (mut low, mut high) = (-4.0, 4.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if 0.5 * libm::erfc(-middle / std::f64::consts::SQRT_2) < share {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use anthronet::condition::Prior;
    use anthronet::model::Model;

    use super::*;

    #[test]
    fn quantiles_are_the_textbooks() {
        for (percent, quantile) in [(50, 0.0), (95, 1.644_854), (5, -1.644_854), (100, 3.290_527)] {
            assert!((normal_quantile(percent) - quantile).abs() < 1e-5, "{percent}");
        }
    }

    #[test]
    fn people_have_the_surveys_measures_and_probable_others() {
        let statistics = &crate::survey::committed().unwrap()["ansur2"];
        let model = Model::embedded().unwrap();
        let synthetic = model.prior(anthronet::condition::Population::Synthetic);
        let flat = |of: &dyn Fn(&anthronet::condition::SexPrior) -> Vec<f64>| {
            Sex::ALL.iter().flat_map(|sex| of(synthetic.of(*sex))).collect::<Vec<f64>>()
        };
        let bodies = [flat(&|p| p.mean().to_vec()), flat(&|p| p.covariance().to_vec()), Vec::new()];
        let [mean, covariance, quantiles] = prior(Survey::Ansur2, statistics, &bodies).unwrap();
        let people = Prior::from_slices(&mean, &covariance, &quantiles).unwrap();
        for sex in Sex::ALL {
            let (of, columns) = (people.of(sex), statistics.of(sex));
            for mapping in Survey::Ansur2.mappings() {
                let column = columns.column(mapping.column).unwrap();
                for id in expand_name(mapping.measure).unwrap() {
                    let i = id.index();
                    assert_eq!(of.mean()[i], columns.columns[column].mean, "{id}");
                    let variance = of.covariance()[i * (MEASURE_COUNT + 1)];
                    let ratio = variance.sqrt() / columns.columns[column].deviation;
                    // Sides differ a little.
                    assert!((1.0..1.06).contains(&ratio), "{sex} {id} {ratio}");
                }
            }
            // What no survey has is where the sampled bodies have it, within their spread.
            for id in MeasureId::all() {
                let i = id.index();
                let deviation = synthetic.of(sex).covariance()[i * (MEASURE_COUNT + 1)].sqrt();
                let off = (of.mean()[i] - synthetic.of(sex).mean()[i]).abs() / deviation;
                assert!(off < 2.0, "{sex} {id} {off}");
            }
        }
    }
}
