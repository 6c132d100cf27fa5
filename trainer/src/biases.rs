//! Fits the centres of the sliders (`sampling_bias.json`), so that per sex the mean of every measure that a survey has is the survey's.
//!
//! The mean of a measure over many bodies is nearly linear in the sliders' centres, so a few Gauss-Newton steps with one
//! Jacobian suffice. There are more sliders than measures: of all centres that fit as well, those are chosen that bend the
//! skin least, by the precision that sliders are drawn with ([`crate::smoothness`]). What the networks read is weighed by
//! people's correlations: a waist a quarter of a deviation too narrow is nothing, beside exact hips and chest it is a belt.

use anthronet::measure::{Definition, MEASURE_COUNT, MeasureId, Measurements, Sex};
use faer::Mat;
use rayon::prelude::*;

use crate::corpus::{Corpus, Gauge, Readings};
use crate::measures::Definer;
use crate::sampling::{Centres, Fixed, MUSCLE, WEIGHT};
use crate::smoothness::{bounded_step, inverse};
use crate::survey::{self, SexStatistics, Survey};
use crate::{Error, Result};

/// Number of bodies that a slider's effect is measured on.
const JACOBIAN_BODIES: u64 = 40;
/// Number of bodies whose means are fitted; standard errors are below 0.05 of the survey's standard deviations.
const FITTED_BODIES: u64 = 2_000;
const STEPS: usize = 4;
/// Step of a slider for the finite difference.
const NUDGE: f64 = 0.1;
/// Price of the sliders against a squared deviation of one measure.
const PRICE: f64 = 0.006;
/// Share of independent noise in the correlations of what the networks read.
const NOISE: f64 = 0.05;
/// Weight of a squared deviation of what they do not read.
const UNREAD: f64 = 0.5;
/// Largest centre of a local slider.
const FURTHEST: f64 = 0.6;
/// Ranges of the medians of muscle and weight, so that both builds stay frequent, and standard deviation of their price.
const MACROS: [[f64; 2]; 2] = [[0.4, 0.6], [0.4, 0.7]];
const MACRO_SPREAD: f64 = 0.1;

/// Fitted centres, and how near the means are with them.
pub struct Fitted {
    /// Centres, female first.
    pub centres: [Centres; 2],
    /// Means of the bodies beside the survey's.
    pub means: Vec<Mean>,
}

/// A measure of the sampled bodies beside the survey's, metres.
#[derive(Clone, Debug)]
pub struct Mean {
    /// The sex.
    pub sex: Sex,
    /// The survey's column.
    pub column: String,
    /// Mean and standard deviation of the bodies.
    pub ours: [f64; 2],
    /// Mean and standard deviation of the people.
    pub people: [f64; 2],
}

impl Mean {
    /// Difference of the means in the people's standard deviations.
    pub fn z(&self) -> f64 {
        (self.ours[0] - self.people[0]) / self.people[1]
    }
}

impl Fitted {
    /// The text of `sampling_bias.json`.
    pub fn to_json(&self) -> String {
        let of_sexes = Sex::ALL.iter().zip(&self.centres).map(|(sex, centres)| {
            let lines: Vec<String> =
                centres.iter().map(|(name, value)| format!("  {name:?}: {value}")).collect();
            format!(" \"{sex}\": {{\n{}\n }}", lines.join(",\n"))
        });
        format!("{{\n{}\n}}\n", of_sexes.collect::<Vec<_>>().join(",\n"))
    }
}

impl std::fmt::Display for Fitted {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (sex, centres) in Sex::ALL.into_iter().zip(&self.centres) {
            let of_sex: Vec<&Mean> = self.means.iter().filter(|mean| mean.sex == sex).collect();
            let rms = (of_sex.iter().map(|m| m.z() * m.z()).sum::<f64>() / of_sex.len() as f64).sqrt();
            let [muscle, weight] =
                [MUSCLE, WEIGHT].map(|name| centres.get(name).copied().unwrap_or(f64::NAN));
            writeln!(
                f,
                "{sex}: muscle {muscle:.2}, weight {weight:.2}; metres; z in deviations of ANSUR II, rms {rms:.2}"
            )?;
            writeln!(
                f,
                "{:28} {:>7} {:>7} | {:>7} {:>7} | {:>6}",
                "column", "mean", "sd", "people", "sd", "z"
            )?;
            for mean in of_sex {
                let [[a, b], [c, d]] = [mean.ours, mean.people];
                writeln!(f, "{:28} {a:7.4} {b:7.4} | {c:7.4} {d:7.4} | {:6.2}", mean.column, mean.z())?;
            }
        }
        Ok(())
    }
}

/// What is fitted: a column of the survey and what is read for it.
struct Aims {
    /// Columns that measures are, with the measures whose mean each is, then those of [`Definer::columns`].
    columns: Vec<(String, Vec<usize>)>,
    /// Number of columns that the networks read.
    read: usize,
    /// Weights of the others.
    weights: Vec<f64>,
}

impl Aims {
    fn new(columns: &[(Definition, f64)]) -> Self {
        let mapped = Survey::Ansur2.mappings().into_iter().map(|mapping| {
            let ids = anthronet::measure::expand_name(mapping.measure).unwrap_or_default();
            (mapping.column.to_owned(), ids.into_iter().map(MeasureId::index).collect())
        });
        let mut all: Vec<(String, Vec<usize>)> = mapped.collect();
        let read = all.len();
        let further = columns.iter().enumerate();
        all.extend(further.map(|(i, (c, _))| (c.name.clone(), vec![MEASURE_COUNT + i])));
        Self { columns: all, read, weights: columns.iter().map(|c| c.1).collect() }
    }

    /// Mean and standard deviation of each column over the bodies of these numbers; `read` gives measures and further columns.
    fn means(&self, read: impl Fn(u64) -> (Measurements, Vec<f64>) + Sync, bodies: u64) -> Vec<[f64; 2]> {
        let row = |n: u64| -> Vec<f64> {
            let (own, further) = read(n);
            let value = |i: &usize| own.get(*i).copied().unwrap_or_else(|| further[i - MEASURE_COUNT]);
            let columns = self.columns.iter();
            columns.map(|(_, of)| of.iter().map(value).sum::<f64>() / of.len() as f64).collect()
        };
        let rows: Vec<Vec<f64>> = (0..bodies).into_par_iter().map(row).collect();
        let n = bodies as f64;
        (0..self.columns.len())
            .map(|i| {
                let mean = rows.iter().map(|r| r[i]).sum::<f64>() / n;
                let variance = rows.iter().map(|r| (r[i] - mean) * (r[i] - mean)).sum::<f64>() / n;
                [mean, variance.sqrt()]
            })
            .collect()
    }

    /// Weights of differences in standard deviations of the survey.
    fn weights(&self, statistics: &SexStatistics) -> Result<Mat<f64>> {
        let of: Vec<usize> = self.columns.iter().map(|c| statistics.column(&c.0)).collect::<Result<_>>()?;
        let deviation = |i: usize| statistics.columns[of[i]].deviation;
        let correlations = Mat::from_fn(self.read, self.read, |i, j| {
            let noise = if i == j { NOISE } else { 0.0 };
            statistics.covariance(of[i], of[j]) / (deviation(i) * deviation(j)) + noise
        });
        let inverted = inverse(&correlations)?;
        let n = self.columns.len();
        Ok(Mat::from_fn(n, n, |i, j| match (i < self.read && j < self.read, i == j) {
            (true, _) => inverted[(i, j)],
            (false, true) => UNREAD * self.weights[i - self.read],
            (false, false) => 0.0,
        }))
    }
}

/// The sliders that are fitted: the local ones, then muscle and weight.
struct Sliders {
    names: Vec<String>,
    /// Where each starts.
    middle: Vec<f64>,
    /// How far it may go from there.
    bounds: Vec<[f64; 2]>,
    /// Price of going there.
    precision: Mat<f64>,
}

impl Sliders {
    fn new(corpus: &Corpus) -> Self {
        let (locals, precision_of_locals) = corpus.sampler.precision();
        let mut names: Vec<String> = locals.into_iter().map(str::to_owned).collect();
        let of_locals = names.len();
        names.extend([MUSCLE, WEIGHT].map(str::to_owned));
        let precision = Mat::from_fn(names.len(), names.len(), |i, j| {
            PRICE
                * match (i < of_locals && j < of_locals, i == j) {
                    (true, _) => precision_of_locals[(i, j)],
                    (false, true) => 1.0 / (MACRO_SPREAD * MACRO_SPREAD),
                    (false, false) => 0.0,
                }
        });
        let middle = (0..names.len()).map(|i| if i < of_locals { 0.0 } else { 0.5 }).collect();
        let bounds = (0..names.len()).map(|i| match i.checked_sub(of_locals) {
            None => [-FURTHEST, FURTHEST],
            Some(i) => MACROS[i].map(|m| m - 0.5),
        });
        Self { middle, bounds: bounds.collect(), precision, names }
    }

    /// The centres at these distances from the middle, as the file keeps them.
    fn centres(&self, offsets: &[f64]) -> Centres {
        let values = offsets.iter().zip(&self.middle).map(|(o, m)| ((m + o) * 1e4).round() / 1e4);
        self.names.iter().cloned().zip(values).collect()
    }
}

/// Fits all centres from the middle of all sliders.
///
/// # Errors
/// When a slider is unknown or the equations cannot be solved.
pub fn fit(corpus: &mut Corpus, progress: &(dyn Fn(&str, u64, u64) + Sync)) -> Result<Fitted> {
    let mirror = |v: u32| corpus.assets.mesh.mirror.get(&v).copied();
    let landmarks = crate::landmarks::landmarks(&mirror)?;
    let definitions = corpus.definitions()?;
    let columns = Definer::new(corpus, &landmarks)?.columns()?;
    let extra = corpus.with_standing(definitions.turns(), |standing| {
        Readings::new(columns.iter().map(|c| &c.0), standing)
    })?;
    let aims = Aims::new(&columns);
    let subdivision = corpus.subdivision.clone();
    let gauge = Gauge::new(&definitions, &subdivision);
    let extra = Gauge::of(extra, &subdivision);

    let sliders = Sliders::new(corpus);
    let statistics = survey::committed()?;
    let statistics = statistics
        .get(Survey::Ansur2.name())
        .ok_or_else(|| Error::Invalid("no statistics of ANSUR II".into()))?;
    let total = 2 * (JACOBIAN_BODIES * (sliders.names.len() as u64 + 1) + FITTED_BODIES * (STEPS as u64 + 1));
    let mut done = 0;
    let mut centres = [Centres::new(), Centres::new()];
    let mut means = Vec::new();
    for sex in Sex::ALL {
        let people = statistics.of(sex);
        let of_people = aims.columns.iter().map(|c| {
            let column = &people.columns[people.column(&c.0)?];
            Ok([column.mean, column.deviation])
        });
        let of_people: Vec<[f64; 2]> = of_people.collect::<Result<_>>()?;
        let stature = &people.columns[people.column("stature")?];
        let stature = [stature.mean, stature.deviation];
        let weights = aims.weights(people)?;
        let mut measure = |corpus: &mut Corpus, offsets: &[f64], bodies: u64| -> Result<Vec<[f64; 2]>> {
            corpus.sampler.set_centres(sex, &sliders.centres(offsets))?;
            let fixed = Fixed { sex: Some(sex), stature: Some(stature), middle: false };
            let means = aims.means(
                |n| {
                    let points = corpus.fixed_specimen(n, fixed).points;
                    (gauge.read(&points), extra.read_all(&points))
                },
                bodies,
            );
            done += bodies;
            progress("mean measures", done, total);
            Ok(means)
        };
        let mut offsets = vec![0.0; sliders.names.len()];
        let before = measure(corpus, &offsets, JACOBIAN_BODIES)?;
        let mut jacobian = Mat::zeros(aims.columns.len(), sliders.names.len());
        for j in 0..sliders.names.len() {
            offsets[j] = NUDGE;
            let after = measure(corpus, &offsets, JACOBIAN_BODIES)?;
            offsets[j] = 0.0;
            for (i, (a, b)) in after.iter().zip(&before).enumerate() {
                jacobian[(i, j)] = (a[0] - b[0]) / NUDGE / of_people[i][1];
            }
        }
        let mut ours = measure(corpus, &offsets, FITTED_BODIES)?;
        for _ in 0..STEPS {
            let residual: Vec<f64> = ours.iter().zip(&of_people).map(|(o, p)| (o[0] - p[0]) / p[1]).collect();
            let step =
                bounded_step(&jacobian, &weights, &residual, &sliders.precision, &offsets, &sliders.bounds);
            for (offset, step) in offsets.iter_mut().zip(step) {
                *offset += step;
            }
            ours = measure(corpus, &offsets, FITTED_BODIES)?;
        }
        centres[sex.index()] = sliders.centres(&offsets);
        means.extend(aims.columns.iter().zip(ours.iter().zip(&of_people)).map(
            |((column, _), (ours, people))| Mean {
                sex,
                column: column.clone(),
                ours: *ours,
                people: *people,
            },
        ));
    }
    Ok(Fitted { centres, means })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::sampling::committed_centres;

    #[test]
    fn the_file_holds_what_was_fitted() {
        let centres = committed_centres().unwrap();
        let fitted = Fitted { centres: centres.clone(), means: Vec::new() };
        let read: BTreeMap<String, Centres> = serde_json::from_str(&fitted.to_json()).unwrap();
        assert_eq!(Sex::ALL.map(|sex| read[sex.name()].clone()), centres);
    }

    #[test]
    fn what_the_networks_read_is_weighed_by_peoples_correlations() {
        let statistics = survey::committed().unwrap();
        let aims = Aims::new(&[]);
        let weights = aims.weights(&statistics["ansur2"].female).unwrap();
        let of = |name: &str| aims.columns.iter().position(|c| c.0 == name).unwrap();
        let n = aims.columns.len();
        let waist = of("waistcircumference");
        // Everything larger by a deviation is commoner than the waist alone.
        let all: f64 = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|ij| weights[ij]).sum();
        assert!(all < weights[(waist, waist)], "{all} {}", weights[(waist, waist)]);
    }
}
