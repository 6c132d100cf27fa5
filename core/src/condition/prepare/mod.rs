//! A request prepared for the network: checked, its sex decided, its conflicts found, its open measures filled.

use super::error::PROJECTION_NOISE;
use super::feasibility::{Feasibility, Limits};
use super::prior::{Conditional, GivenMeasures, Population, Prior, Priors, SexPrior};
use super::request::{Fill, MeasureRange, Request};
use crate::error::Conflict;
use crate::measure::{MEASURE_COUNT, MeasureId, Measurements, Sex};
use crate::random::Random;
use crate::{Error, Result};

/// The stream of [`Random`] that open measures are drawn from.
const FILL_STREAM: u64 = 2;

/// Draws of the open measures after which the mean is taken, for given measures beside which no draw is plausible.
const MOST_DRAWS: usize = 60;

/// The inputs of the network and of the solve, with what the report says about their origin. Metres.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The given sex, or the likelier one.
    pub sex: Sex,
    /// The measures to be met exactly: the given ones; where they are infeasible and the request allows it, the nearest
    /// feasible ones.
    pub given: GivenMeasures,
    /// All measures: the given ones and the filled ones.
    pub filled: Measurements,
    /// `filled` after [`SexPrior::project`] by the prior of the trained bodies: the measures that the network is conditioned on.
    pub projected: Measurements,
    /// Lower end of each open measure's 90 % interval, conditioned on the given ones; the value of a given one.
    pub low90: Measurements,
    /// Upper end of that interval; the value of a given one.
    pub high90: Measurements,
    /// The latent vector z.
    pub z: Vec<f64>,
    /// Sentences about what was assumed and what is unusual.
    pub warnings: Vec<String>,
    /// The conflicts that were resolved by replacing the request with the nearest feasible one.
    pub conflicts: Vec<Conflict>,
}

impl Prepared {
    /// Prepares a request for a network of `latent_size` latent dimensions.
    ///
    /// # Errors
    /// As [`Request::check`]; [`Error::Infeasible`] for measures that no person has together, unless the request allows
    /// the nearest feasible ones.
    pub fn new(
        request: &Request,
        priors: &Priors,
        ranges: &[MeasureRange; MEASURE_COUNT],
        limits: &Limits,
        latent_size: usize,
    ) -> Result<Self> {
        request.check(ranges, latent_size)?;
        let mut warnings = Vec::new();
        let sex = match request.sex {
            Some(sex) => sex,
            None => guess_sex(request, priors.of(request.population), limits, &mut warnings)?,
        };
        let prior = priors.of(request.population).of(sex);
        let bodies = priors.of(Population::Synthetic).of(sex);
        let judges = [prior, bodies];
        let feasibility = Feasibility::assess(judges, request.population, sex, &request.measures, limits)?;
        if !feasibility.is_feasible() {
            if !request.nearest {
                return Err(Error::Infeasible(feasibility.infeasible()));
            }
            warnings
                .push("the request is infeasible and was replaced by the nearest feasible one".to_owned());
        }
        warnings.extend(feasibility.warning());

        let conditional = prior.condition(&feasibility.nearest)?;
        let filled = match request.fill {
            Fill::Mean => *conditional.mean(),
            Fill::Sample => plausible_sample(prior, &conditional, request.seed),
        };
        let (low90, high90) = conditional.interval90();
        Ok(Self {
            sex,
            given: feasibility.nearest,
            filled,
            projected: bodies.project(&filled, PROJECTION_NOISE)?,
            low90,
            high90,
            z: request.latent(latent_size),
            warnings,
            conflicts: feasibility.conflicts,
        })
    }
}

/// Draws the open measures until each is within the quantiles of its sex, as the Gaussian's tails reach beyond real
/// people. Draws are scaled towards the mean more with each failure.
fn plausible_sample(prior: &SexPrior, conditional: &Conditional, seed: u64) -> Measurements {
    let mut random = Random::new(seed, FILL_STREAM);
    let mean = conditional.mean();
    let mut scale = 1.0;
    for _ in 0..MOST_DRAWS {
        let draw = conditional.sample(&mut random);
        let scaled: Measurements = std::array::from_fn(|i| mean[i] + scale * (draw[i] - mean[i]));
        let plausible = MeasureId::all().zip(conditional.given()).all(|(id, given)| {
            let percentile = prior.percentile(id, scaled[id.index()]);
            *given || (percentile > 0.0 && percentile < 100.0)
        });
        if plausible {
            return scaled;
        }
        scale *= 0.9;
    }
    *mean
}

fn guess_sex(request: &Request, prior: &Prior, limits: &Limits, warnings: &mut Vec<String>) -> Result<Sex> {
    if request.given().next().is_none() {
        warnings.push("sex not given, nor any measure: female assumed".to_owned());
        return Ok(Sex::Female);
    }
    let posterior = prior.sex_posterior(&request.measures, limits.noise)?;
    let sex = if posterior[0] >= posterior[1] { Sex::Female } else { Sex::Male };
    // Never 100 %: the model's people are only a sample.
    let percent = (100.0 * posterior[sex.index()]).floor().min(99.0);
    warnings.push(format!("sex not given: {sex} is likelier ({percent:.0} %)"));
    Ok(sex)
}

#[cfg(test)]
mod tests;
