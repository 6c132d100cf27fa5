//! How near bodies are to the people of a survey: each person's measures are given in part, and what was not given is
//! compared with the person's own.

use std::collections::BTreeMap;

use anthronet::condition::{FEASIBILITY_NOISE, Population, Request};
use anthronet::measure::{BodyPart, MeasureId, Sex, expand_name};
use anthronet::model::Model;
use rayon::prelude::*;
use serde::Serialize;

use crate::survey::{Mapping, Regression, Rows, SexStatistics, Survey};
use crate::{Error, Result};

/// Measures that are given together; those that a survey has not are left out, and sets that then hold the same.
const GIVEN: [&[&str]; 4] = [
    &["height"],
    &["height", "waist_circumference", "chest_circumference", "hip_circumference"],
    &[
        "height",
        "waist_circumference",
        "chest_circumference",
        "hip_circumference",
        "neck_circumference",
        "head_circumference",
        "hand_size",
        "arm_circumference",
        "forearm_circumference",
        "thigh_circumference",
        "calf_circumference",
        "foot_width",
        "heel_to_ball_length",
        "heel_to_toe_length",
    ],
    ALL,
];
/// Stands for every measure that the survey has.
const ALL: &[&str] = &[];

/// The table of one survey.
#[derive(Clone, Debug, Serialize)]
pub struct PeopleTable {
    /// The survey's short name.
    pub survey: &'static str,
    /// A row per sex and set of given measures.
    pub rows: Vec<PeopleRow>,
}

/// Bodies made from some of people's measures, beside these people.
#[derive(Clone, Debug, Serialize)]
pub struct PeopleRow {
    /// Their sex.
    pub sex: Sex,
    /// The given measures, without sides.
    pub given: Vec<&'static str>,
    /// Number of people who have all the given measures.
    pub people: usize,
    /// Number of those with a measure that the model takes for nobody's; they are not met, and in no other number.
    pub refused: usize,
    /// The measures that were not given.
    pub measures: BTreeMap<&'static str, MeasureScore>,
    /// Mean of the bodies' mass less the people's, kg.
    pub mass_bias_kg: f64,
    /// Standard deviation of that difference, kg.
    pub mass_sd_kg: f64,
    /// The same of a linear regression on the given measures, by the committed statistics.
    pub mass_sd_regression_kg: f64,
    /// Share of people whose given measures the body meets, all of them, within [`limit`].
    pub joint_met: f64,
    /// Distance (Kolmogorov–Smirnov) of people's shares-beyond, which tell how rare their given measures are, from the uniform distribution that
    /// they have if the prior is these people's.
    pub p_uniform_ks: f64,
}

/// A measure that was not given: the body's less the person's.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MeasureScore {
    /// Mean difference, mm.
    pub bias_mm: f64,
    /// Standard deviation of the difference, mm.
    pub sd_mm: f64,
    /// The same of a linear regression on the given measures, by the committed statistics.
    pub sd_regression_mm: f64,
    /// Share of people whose own value is inside the body's 90 % interval.
    pub cover90: f64,
}

/// The largest difference between two ways of taking a measure that ISO 20685-1 (2018, table 1) allows a scanner, metres; hands and feet
/// by how well they can be taken by hand.
pub fn limit(id: MeasureId) -> f64 {
    let large = ["waist_circumference", "chest_circumference", "hip_circumference", "thigh_circumference"];
    match id.part() {
        BodyPart::Hand => 0.001,
        BodyPart::Foot => 0.002,
        _ if id == MeasureId::HEIGHT || id.base_name().ends_with("_height") => 0.004,
        _ if large.contains(&id.base_name()) => 0.009,
        _ if id.base_name().ends_with("_circumference") => 0.004,
        _ => 0.005,
    }
}

/// Scores a model on the people of a survey.
///
/// # Errors
/// [`Error::Invalid`] when the statistics lack a column; errors of bodies other than that measures contradict each other,
/// in whose place the nearest are taken.
pub fn table(
    model: &Model,
    people: &[Rows; 2],
    statistics: [&SexStatistics; 2],
    progress: &(dyn Fn() + Sync),
) -> Result<PeopleTable> {
    let survey = people[0].survey;
    let mut rows = Vec::new();
    for (of_sex, statistics) in people.iter().zip(statistics) {
        for given in sets(&survey.mappings()) {
            rows.push(Scoring::new(model, of_sex, statistics, &given)?.row(progress)?);
        }
    }
    Ok(PeopleTable { survey: survey.name(), rows })
}

/// Number of bodies that [`table`] makes.
pub fn bodies(people: &[Rows; 2]) -> usize {
    people.iter().map(|rows| rows.people.len() * sets(&rows.survey.mappings()).len()).sum()
}

/// The sets of [`GIVEN`] that can be formed of these measures.
fn sets(mappings: &[Mapping]) -> Vec<Vec<Mapping>> {
    let mut sets: Vec<Vec<Mapping>> = Vec::new();
    for given in GIVEN {
        let of_survey = |m: &&Mapping| given.is_empty() || given.contains(&m.measure);
        let set: Vec<Mapping> = mappings.iter().filter(of_survey).copied().collect();
        if !set.is_empty() && !sets.contains(&set) {
            sets.push(set);
        }
    }
    sets
}

/// A measure of the survey, found in all that is compared.
struct Compared {
    name: &'static str,
    /// One measure, or both sides.
    ids: Vec<MeasureId>,
    /// Position in the rows.
    column: usize,
    /// Position in the statistics.
    of_statistics: usize,
}

struct Scoring<'a> {
    model: &'a Model,
    people: &'a Rows,
    given: Vec<Compared>,
    open: Vec<(Compared, Regression)>,
    mass_column: usize,
    mass: Regression,
}

/// What came of a person.
enum Tried {
    /// One of the given measures was not taken.
    Incomplete,
    /// One of the given measures is beyond the model's range.
    Refused,
    Made(Outcome),
}

/// One person beside the body: differences in metres and kg.
struct Outcome {
    /// Per open measure: difference, the regression's difference, inside the interval; `None` where the person has no value.
    open: Vec<Option<(f64, f64, bool)>>,
    mass: Option<(f64, f64)>,
    met: bool,
    share_beyond: f64,
}

impl<'a> Scoring<'a> {
    fn new(
        model: &'a Model,
        people: &'a Rows,
        statistics: &SexStatistics,
        given: &[Mapping],
    ) -> Result<Self> {
        let compared = |mapping: &Mapping| {
            Ok::<_, Error>(Compared {
                name: mapping.measure,
                ids: expand_name(mapping.measure).unwrap_or_default(),
                column: people.column(mapping.column)?,
                of_statistics: statistics.column(mapping.column)?,
            })
        };
        let open = people.survey.mappings().into_iter().filter(|m| !given.contains(m));
        let given = given.iter().map(compared).collect::<Result<Vec<_>>>()?;
        let from: Vec<usize> = given.iter().map(|g| g.of_statistics).collect();
        let open = open.map(|mapping| {
            let open = compared(&mapping)?;
            let regression = statistics.regression(&from, open.of_statistics)?;
            Ok((open, regression))
        });
        let weight = people.survey.weight();
        Ok(Self {
            model,
            people,
            open: open.collect::<Result<_>>()?,
            mass_column: people.column(weight)?,
            mass: statistics.regression(&from, statistics.column(weight)?)?,
            given,
        })
    }

    fn row(&self, progress: &(dyn Fn() + Sync)) -> Result<PeopleRow> {
        let outcomes: Vec<Tried> = self
            .people
            .people
            .par_iter()
            .map(|person| {
                let outcome = self.person(person);
                progress();
                outcome
            })
            .collect::<Result<_>>()?;
        let refused = outcomes.iter().filter(|tried| matches!(tried, Tried::Refused)).count();
        let outcomes: Vec<Outcome> = outcomes
            .into_iter()
            .filter_map(|tried| match tried {
                Tried::Made(outcome) => Some(outcome),
                Tried::Incomplete | Tried::Refused => None,
            })
            .collect();
        let people = outcomes.len() + refused;
        let measures = self.open.iter().enumerate().map(|(k, (open, _))| {
            let of: Vec<(f64, f64, bool)> = outcomes.iter().filter_map(|o| o.open[k]).collect();
            let (bias, deviation) = spread(of.iter().map(|o| o.0));
            let score = MeasureScore {
                bias_mm: 1000.0 * bias,
                sd_mm: 1000.0 * deviation,
                sd_regression_mm: 1000.0 * spread(of.iter().map(|o| o.1)).1,
                cover90: share(of.iter().map(|o| o.2)),
            };
            (open.name, score)
        });
        let masses = || outcomes.iter().filter_map(|o| o.mass);
        let (mass_bias_kg, mass_sd_kg) = spread(masses().map(|m| m.0));
        Ok(PeopleRow {
            sex: self.people.sex,
            given: self.given.iter().map(|g| g.name).collect(),
            people,
            refused,
            measures: measures.collect(),
            mass_bias_kg,
            mass_sd_kg,
            mass_sd_regression_kg: spread(masses().map(|m| m.1)).1,
            joint_met: outcomes.iter().filter(|o| o.met).count() as f64 / people.max(1) as f64,
            p_uniform_ks: distance_from_uniform(outcomes.iter().map(|o| o.share_beyond).collect()),
        })
    }

    fn person(&self, person: &[Option<f64>]) -> Result<Tried> {
        let mut request = Request { sex: Some(self.people.sex), nearest: true, ..Request::default() };
        let mut values = Vec::with_capacity(self.given.len());
        for given in &self.given {
            let Some(value) = person[given.column] else { return Ok(Tried::Incomplete) };
            values.push(value);
            for id in &given.ids {
                request.measures[id.index()] = Some(value);
            }
        }
        let body = match self.model.generate(&request) {
            Ok(body) => body,
            Err(anthronet::Error::Request { .. }) => return Ok(Tried::Refused),
            Err(error) => return Err(error.into()),
        };
        let report = body.report();
        let mean = |ids: &[MeasureId], of: &dyn Fn(usize) -> f64| {
            ids.iter().map(|id| of(id.index())).sum::<f64>() / ids.len() as f64
        };
        let open = self.open.iter().map(|(open, regression)| {
            let own = person[open.column]?;
            let [obtained, low, high] = [
                mean(&open.ids, &|i| report.measures[i].obtained),
                mean(&open.ids, &|i| report.measures[i].low90),
                mean(&open.ids, &|i| report.measures[i].high90),
            ];
            Some((obtained - own, regression.predict(&values) - own, (low..=high).contains(&own)))
        });
        let met = self.given.iter().zip(&values).all(|(given, asked)| {
            given.ids.iter().all(|id| (report.measures[id.index()].obtained - asked).abs() <= limit(*id))
        });
        let mass =
            person[self.mass_column].map(|own| (report.mass_kg - own, self.mass.predict(&values) - own));
        let prior = self.model.prior(Population::Ansur2).of(self.people.sex);
        Ok(Tried::Made(Outcome {
            open: open.collect(),
            mass,
            met,
            share_beyond: prior.share_beyond(&request.measures, FEASIBILITY_NOISE)?,
        }))
    }
}

/// Mean and standard deviation; zeros for nothing.
fn spread(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count().max(1) as f64;
    let mean = values.clone().sum::<f64>() / count;
    (mean, (values.map(|v| (v - mean) * (v - mean)).sum::<f64>() / count).sqrt())
}

/// Share of true values; zero for nothing.
fn share(values: impl Iterator<Item = bool> + Clone) -> f64 {
    let count = values.clone().count().max(1) as f64;
    values.filter(|v| *v).count() as f64 / count
}

/// The Kolmogorov–Smirnov distance of numbers from the uniform distribution on 0 to 1.
fn distance_from_uniform(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len() as f64;
    let gaps = values.iter().enumerate().map(|(i, p)| (p - i as f64 / n).max((i + 1) as f64 / n - p));
    gaps.fold(0.0, f64::max)
}

impl std::fmt::Display for PeopleTable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let title = Survey::ALL.into_iter().find(|s| s.name() == self.survey).map_or("", Survey::title);
        writeln!(f, "people of {title}: the body's measures less the person's")?;
        for row in &self.rows {
            writeln!(
                f,
                "\n{} people ({} refused), {}, given {}",
                row.people,
                row.refused,
                row.sex,
                row.given.join(", ")
            )?;
            writeln!(
                f,
                "  given measures met {:.1} %; mass {:+.1} kg (sd {:.1}, a regression's {:.1}); likelihoods {:.2} from uniform",
                100.0 * row.joint_met,
                row.mass_bias_kg,
                row.mass_sd_kg,
                row.mass_sd_regression_kg,
                row.p_uniform_ks
            )?;
            if !row.measures.is_empty() {
                writeln!(
                    f,
                    "  {:26} {:>8} {:>8} {:>12} {:>9}",
                    "mm", "bias", "sd", "regression's", "in 90 %"
                )?;
            }
            for (name, score) in &row.measures {
                writeln!(
                    f,
                    "  {name:26} {:8.1} {:8.1} {:12.1} {:7.0} %",
                    score.bias_mm,
                    score.sd_mm,
                    score.sd_regression_mm,
                    100.0 * score.cover90
                )?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_hold_what_the_survey_has() {
        let mapping = |measure| Mapping { measure, column: measure };
        let few = [mapping("height"), mapping("waist_circumference"), mapping("foot_width")];
        let names: Vec<Vec<&str>> =
            sets(&few).iter().map(|set| set.iter().map(|m| m.measure).collect()).collect();
        // The first two hold the same of a survey with less.
        let [a, b, c] = ["height", "waist_circumference", "foot_width"];
        assert_eq!(names, [vec![a], vec![a, b], vec![a, b, c]]);
        assert_eq!(sets(&Survey::Ansur2.mappings()).len(), 4);
    }

    #[test]
    fn distances_from_uniform_are_those_of_kolmogorov_and_smirnov() {
        assert!((distance_from_uniform(vec![0.25, 0.75]) - 0.25).abs() < 1e-12);
        assert!((distance_from_uniform(vec![0.0; 4]) - 1.0).abs() < 1e-12);
        let even = (0..100).map(|i| (f64::from(i) + 0.5) / 100.0).collect();
        assert!((distance_from_uniform(even) - 0.005).abs() < 1e-12);
    }

    #[test]
    fn every_measure_has_the_limit_of_its_kind() {
        for (name, millimetres) in [
            ("height", 4.0),
            ("waist_circumference", 9.0),
            ("thigh_circumference_left", 9.0),
            ("neck_circumference", 4.0),
            ("shoulder_width", 5.0),
            ("hand_size_right", 1.0),
            ("heel_to_toe_length_left", 2.0),
        ] {
            assert_eq!(1000.0 * limit(MeasureId::from_name(name).unwrap()), millimetres, "{name}");
        }
    }
}
