//! The report on a generated body: requested and obtained measures, how open ones were filled, and warnings.

use std::fmt;

use serde::Serialize;
use serde_json::json;

use super::prepare::Prepared;
use super::prior::{Population, Priors};
use super::request::{Fill, Request, group_by};
use super::solve::SolveOutcome;
use crate::error::{Conflict, Infeasible};
use crate::measure::{MeasureId, Sex};

/// Measures that the printed table shows even when they were not given.
const ALWAYS_SHOWN: [&str; 4] = ["height", "chest_circumference", "waist_circumference", "hip_circumference"];

/// Where the value of a measure came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Filled {
    /// From the request.
    #[serde(rename = "given")]
    Given,
    /// The likeliest value, conditioned on the given measures.
    #[serde(rename = "prior mean")]
    PriorMean,
    /// Drawn from the distribution conditioned on the given measures.
    #[serde(rename = "prior sample")]
    PriorSample,
    /// Interpolated between the bodies of two requests.
    #[serde(rename = "interpolated")]
    Interpolated,
}

/// One measure of a body; metres unless stated.
#[derive(Clone, Debug, Serialize)]
pub struct MeasureReport {
    /// Identifier, with its side.
    pub name: &'static str,
    /// The value in the request; `None` for an open measure.
    pub asked: Option<f64>,
    /// The value of the body.
    pub obtained: f64,
    /// Obtained − asked; `None` for an open measure.
    pub residual: Option<f64>,
    /// Whether the request gives it.
    pub given: bool,
    /// Where the value came from.
    pub filled: Filled,
    /// Lower end of the interval that holds 90 % of people with the given measures; for a measure that is given or
    /// interpolated, its value.
    pub low90: f64,
    /// Upper end of that interval.
    pub high90: f64,
    /// Percentage of the population's people of this sex, 0 to 100, whose value is at most the obtained one.
    pub percentile: f64,
}

/// The report on one body. Serialises to the JSON of `--report`; displays as a table.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// All measures, in order.
    pub measures: Vec<MeasureReport>,
    /// Sentences about what was assumed and what is unusual.
    pub warnings: Vec<String>,
    /// Which given measures contradicted each other; empty unless the request was replaced by the nearest feasible one.
    pub conflicts: Vec<Conflict>,
    /// The request's seed.
    pub seed: u64,
    /// The sex of the body.
    pub sex: Sex,
    /// How open measures were filled.
    pub fill: Fill,
    /// Whose prior filled them.
    pub population: Population,
    /// The latent vector of the body.
    pub z: Vec<f64>,
    /// Mass, kg.
    pub mass_kg: f64,
    /// Volume, m³.
    pub volume_m3: f64,
    /// Body mass index, kg/m².
    pub bmi: f64,
    /// Gauss–Newton steps of the exact solve.
    pub iterations: usize,
    /// Largest |obtained − target| of the exact solve, metres. Targets are the given measures, the nearest feasible ones where
    /// those replaced them, or all interpolated measures between two requests.
    pub solve_residual: f64,
    /// Whether the solve reached its tolerance.
    pub converged: bool,
}

impl Report {
    /// The report on the body of `prepared` and `outcome`, of this mass (kg) and volume (m³).
    pub fn new(
        request: &Request,
        prepared: &Prepared,
        priors: &Priors,
        outcome: &SolveOutcome,
        mass: f64,
        volume: f64,
    ) -> Self {
        let filled = match request.fill {
            Fill::Mean => Filled::PriorMean,
            Fill::Sample => Filled::PriorSample,
        };
        let prior = priors.of(request.population).of(prepared.sex);
        let measures: Vec<_> = MeasureId::all()
            .map(|id| {
                let i = id.index();
                let (asked, obtained) = (request.measures[i], outcome.obtained[i]);
                MeasureReport {
                    name: id.name(),
                    asked,
                    obtained,
                    residual: asked.map(|a| obtained - a),
                    given: asked.is_some(),
                    filled: if asked.is_some() { Filled::Given } else { filled },
                    low90: prepared.low90[i],
                    high90: prepared.high90[i],
                    percentile: prior.percentile(id, obtained),
                }
            })
            .collect();
        let height = outcome.obtained[MeasureId::HEIGHT.index()];
        let mut warnings = prepared.warnings.clone();
        if !outcome.converged {
            warnings.push(format!(
                "the given measures could not be met exactly: the worst is {:.2} mm off",
                1000.0 * outcome.residual_max
            ));
        }
        Self {
            measures,
            warnings,
            conflicts: prepared.conflicts.clone(),
            seed: request.seed,
            sex: prepared.sex,
            fill: request.fill,
            population: request.population,
            z: prepared.z.clone(),
            mass_kg: mass,
            volume_m3: volume,
            bmi: mass / (height * height),
            iterations: outcome.iterations,
            solve_residual: outcome.residual_max,
            converged: outcome.converged,
        }
    }

    /// This report for a body between two requests: no measure is given, all are interpolated, and it has the warnings and
    /// conflicts of both ends.
    pub(crate) fn interpolated(mut self, ends: [&Prepared; 2]) -> Self {
        for measure in &mut self.measures {
            (measure.asked, measure.residual, measure.given) = (None, None, false);
            measure.filled = Filled::Interpolated;
            (measure.low90, measure.high90) = (measure.obtained, measure.obtained);
        }
        for end in ends {
            add_new(&mut self.warnings, &end.warnings);
            add_new(&mut self.conflicts, &end.conflicts);
        }
        self
    }

    /// The JSON of `--report`, indented.
    pub fn to_json(&self) -> String {
        // Cannot fail: keys are strings and values plain numbers and text.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}

fn add_new<T: Clone + PartialEq>(to: &mut Vec<T>, from: &[T]) {
    for item in from {
        if !to.contains(item) {
            to.push(item.clone());
        }
    }
}

/// The JSON of `--report` for a refused request: the requested measures, the conflicts, and `null` for what only a body
/// has.
pub fn refusal_json(request: &Request, why: &Infeasible) -> String {
    let measures = MeasureId::all().zip(&request.measures).map(|(id, asked)| {
        json!({
            "name": id.name(),
            "asked": asked,
            "obtained": null,
            "residual": null,
            "given": asked.is_some(),
            "filled": asked.map(|_| Filled::Given),
            "low90": null,
            "high90": null,
            "percentile": null,
        })
    });
    let report = json!({
        "measures": measures.collect::<Vec<_>>(),
        "warnings": [],
        "conflicts": why.conflicts,
        "seed": request.seed,
        "sex": request.sex,
        "error": why.to_string(),
    });
    format!("{report:#}")
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}, {:.1} kg, BMI {:.1}, seed {}", self.sex, self.mass_kg, self.bmi, self.seed)?;
        writeln!(
            f,
            "{:<28} {:>9} {:>9} {:>9} {:>10}  90 % interval",
            "", "asked", "obtained", "off by", "percentile"
        )?;
        // Both sides share a row where they were given alike and differ by less than half a millimetre.
        let values = std::array::from_fn(|i| self.measures.get(i).map(|m| m.obtained));
        let shown = |name: &str| ALWAYS_SHOWN.contains(&name);
        for group in group_by(&values, |left, right| (left - right).abs() < 5e-4) {
            let rows: Vec<_> = group.ids.iter().filter_map(|id| self.measures.get(id.index())).collect();
            let alike = rows.windows(2).all(|w| w[0].asked == w[1].asked);
            for row in rows.iter().take(if alike { 1 } else { rows.len() }) {
                if row.given || shown(row.name) {
                    write_row(f, if alike { &group.name } else { row.name }, row)?;
                }
            }
        }
        for warning in &self.warnings {
            writeln!(f, "warning: {warning}")?;
        }
        for conflict in &self.conflicts {
            writeln!(f, "conflict: {}", conflict.message)?;
        }
        Ok(())
    }
}

fn write_row(f: &mut fmt::Formatter<'_>, name: &str, row: &MeasureReport) -> fmt::Result {
    let (asked, off) = match (row.asked, row.residual) {
        (Some(asked), Some(residual)) => {
            (format!("{asked:.3} m"), format!("{:.2} mm", 1000.0 * residual.abs()))
        }
        _ => ("-".to_owned(), "-".to_owned()),
    };
    let obtained = format!("{:.3} m", row.obtained);
    write!(f, "{name:<28} {asked:>9} {obtained:>9} {off:>9} {:>10.0}", row.percentile)?;
    if row.low90 == row.high90 {
        writeln!(f)
    } else {
        writeln!(f, "  {:.3} to {:.3} m", row.low90, row.high90)
    }
}

#[cfg(test)]
mod tests;
