//! The prior over measures: per sex, a Gaussian N(μ, S) and the quantiles of each measure.
//!
//! Three uses: open measures are filled from the Gaussian conditioned on the given ones; a full vector is shrunk towards
//! the mean ([`SexPrior::project`]) before the network sees it; and a sex that was not given is inferred from the
//! likelihoods of the given measures. In formulas G are the given measures, U the open ones, A their values and e the standard
//! deviation of the measurement noise.

mod population;

pub use population::{Population, Priors};

use super::chi_squared;
use super::error::FILL_NOISE;
use crate::math::cholesky::Cholesky;
use crate::measure::{MEASURE_COUNT, MeasureId, Measurements, Sex};
use crate::random::Random;
use crate::{Error, Result};

/// Number of quantiles kept per measure: 0 %, 1 %, … 100 %.
pub const QUANTILE_COUNT: usize = 101;

/// Standard normal quantile of 95 %: a 90 % interval is the mean ± this many standard deviations.
const HALF_INTERVAL_90: f64 = 1.644_853_626_951_472_7;

/// The measures that a request gives; `None` where it leaves the value open.
pub type GivenMeasures = [Option<f64>; MEASURE_COUNT];

/// The priors of both sexes.
#[derive(Clone, Debug)]
pub struct Prior {
    sexes: [SexPrior; 2],
}

impl Prior {
    /// From flat arrays, row-major, female first: `mean` 2 × M (m), `covariance` 2 × M × M (m²), `quantiles` 2 × M × 101 (m), where M is
    /// [`MEASURE_COUNT`].
    ///
    /// # Errors
    /// [`Error::Invalid`] for a wrong size and for whatever [`SexPrior::new`] refuses.
    pub fn from_slices(mean: &[f64], covariance: &[f64], quantiles: &[f64]) -> Result<Self> {
        let half = |what, data: &[f64], each: usize| {
            if data.len() == 2 * each {
                Ok([data[..each].to_vec(), data[each..].to_vec()])
            } else {
                Err(Error::invalid(what, format!("expected 2 x {each} numbers, got {}", data.len())))
            }
        };
        let [mean_f, mean_m] = half("prior mean", mean, MEASURE_COUNT)?;
        let [cov_f, cov_m] = half("prior covariance", covariance, MEASURE_COUNT * MEASURE_COUNT)?;
        let [quant_f, quant_m] = half("prior quantiles", quantiles, MEASURE_COUNT * QUANTILE_COUNT)?;
        Ok(Self {
            sexes: [SexPrior::new(&mean_f, &cov_f, &quant_f)?, SexPrior::new(&mean_m, &cov_m, &quant_m)?],
        })
    }

    /// From the two priors.
    pub fn new(female: SexPrior, male: SexPrior) -> Self {
        Self { sexes: [female, male] }
    }

    /// The prior of one sex.
    pub fn of(&self, sex: Sex) -> &SexPrior {
        match sex {
            Sex::Female => &self.sexes[0],
            Sex::Male => &self.sexes[1],
        }
    }

    /// Probability of each sex, in the order of [`Sex::index`], from the given measures, read with noise of standard
    /// deviation `noise` (metres). Both sexes are equally frequent: one half each when nothing is given.
    ///
    /// # Errors
    /// As [`SexPrior::project`].
    pub fn sex_posterior(&self, given: &GivenMeasures, noise: f64) -> Result<[f64; 2]> {
        let female = self.sexes[0].log_likelihood(given, noise)?;
        let male = self.sexes[1].log_likelihood(given, noise)?;
        // An overflow of exp to infinity still gives 0.
        let p = 1.0 / (1.0 + libm::exp(male - female));
        // NaN where both log-likelihoods overflow: no information.
        let p = if p.is_nan() { 0.5 } else { p };
        Ok([p, 1.0 - p])
    }
}

/// The Gaussian and the quantiles of one sex.
#[derive(Clone, Debug)]
pub struct SexPrior {
    mean: Measurements,
    /// M × M, symmetric.
    covariance: Vec<f64>,
    /// M × 101, non-decreasing along each row.
    quantiles: Vec<f64>,
}

impl SexPrior {
    /// From flat row-major arrays: `mean` M (m), `covariance` M × M (m²), `quantiles` M × 101 (m), where M is
    /// [`MEASURE_COUNT`].
    ///
    /// # Errors
    /// [`Error::Invalid`] for wrong sizes, numbers that are not finite, a covariance that is not symmetric or not
    /// positive definite with [`FILL_NOISE`] added, and quantiles that descend.
    pub fn new(mean: &[f64], covariance: &[f64], quantiles: &[f64]) -> Result<Self> {
        let n = MEASURE_COUNT;
        for (what, data, expected) in [
            ("prior mean", mean, n),
            ("prior covariance", covariance, n * n),
            ("prior quantiles", quantiles, n * QUANTILE_COUNT),
        ] {
            if data.len() != expected {
                return Err(Error::invalid(what, format!("expected {expected} numbers, got {}", data.len())));
            }
            if let Some(bad) = data.iter().find(|v| !v.is_finite()) {
                return Err(Error::invalid(what, format!("expected finite numbers, got {bad}")));
            }
        }
        let largest = covariance.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let mut symmetric = covariance.to_vec();
        for (i, a) in MeasureId::all().enumerate() {
            for (j, b) in MeasureId::all().enumerate().take(i) {
                let (lower, upper) = (covariance[i * n + j], covariance[j * n + i]);
                // Looser than the rounding of f32, far tighter than any effect on results.
                if (lower - upper).abs() > 1e-6 * largest {
                    let message = format!("not symmetric at {a}, {b}: {lower} and {upper}");
                    return Err(Error::invalid("prior covariance", message));
                }
                let middle = 0.5 * (lower + upper);
                symmetric[i * n + j] = middle;
                symmetric[j * n + i] = middle;
            }
        }
        let all: Vec<_> = (0..n).collect();
        if symmetric.iter().step_by(n + 1).any(|v| *v < 0.0)
            || noisy_factor(&symmetric, &all, FILL_NOISE).is_none()
        {
            return Err(Error::invalid("prior covariance", "expected a positive definite matrix"));
        }
        for (row, id) in quantiles.chunks_exact(QUANTILE_COUNT).zip(MeasureId::all()) {
            if row.windows(2).any(|w| w[0] > w[1]) {
                return Err(Error::invalid("prior quantiles", format!("those of {id} do not rise")));
            }
        }
        let mut fixed = [0.0; MEASURE_COUNT];
        fixed.copy_from_slice(mean);
        Ok(Self { mean: fixed, covariance: symmetric, quantiles: quantiles.to_vec() })
    }

    /// Mean of each measure, metres.
    pub fn mean(&self) -> &Measurements {
        &self.mean
    }

    /// Covariance, [`MEASURE_COUNT`] squared, row-major, m².
    pub fn covariance(&self) -> &[f64] {
        &self.covariance
    }

    /// Percentage of people, 0 to 100, whose measure is at most `value` metres: linear between the stored quantiles, 0
    /// below the smallest body of the data and 100 from the largest on.
    pub fn percentile(&self, id: MeasureId, value: f64) -> f64 {
        let row = &self.quantiles[id.index() * QUANTILE_COUNT..(id.index() + 1) * QUANTILE_COUNT];
        let above = row.partition_point(|q| *q <= value);
        match above {
            0 => 0.0,
            QUANTILE_COUNT => 100.0,
            // `above` is the first quantile beyond the value, so the interval is not empty.
            _ => (above - 1) as f64 + (value - row[above - 1]) / (row[above] - row[above - 1]),
        }
    }

    /// The distribution of all measures conditioned on the given ones (metres), which were read with noise e =
    /// [`FILL_NOISE`].
    ///
    /// # Errors
    /// [`Error::Request`] for a given measure that is not finite.
    pub fn condition(&self, given: &GivenMeasures) -> Result<Conditional> {
        let n = MEASURE_COUNT;
        let (rows, offset) = self.offsets(given)?;
        let factor = self.factor(&rows, FILL_NOISE)?;
        let mut weights = offset;
        factor.solve(&mut weights);

        let mut mean = self.mean;
        for (i, value) in mean.iter_mut().enumerate() {
            *value = given[i].unwrap_or_else(|| {
                *value + rows.iter().zip(&weights).map(|(g, w)| self.covariance[i * n + g] * w).sum::<f64>()
            });
        }

        // S_UU − S_UG (S_GG + e²I)⁻¹ S_GU, the second term as inner products of the columns of L⁻¹ S_GU.
        let half: Vec<Vec<f64>> = (0..n)
            .map(|u| {
                let mut column: Vec<_> = rows.iter().map(|g| self.covariance[g * n + u]).collect();
                factor.forward(&mut column);
                column
            })
            .collect();
        let mut covariance = vec![0.0; n * n];
        for i in (0..n).filter(|i| given[*i].is_none()) {
            for j in (0..n).filter(|j| given[*j].is_none()) {
                let explained: f64 = half[i].iter().zip(&half[j]).map(|(a, b)| a * b).sum();
                covariance[i * n + j] = self.covariance[i * n + j] - explained;
            }
        }
        Ok(Conditional { given: std::array::from_fn(|i| given[i].is_some()), mean, covariance })
    }

    /// The posterior mean of the true measures behind a full vector A (metres) that was read with Gaussian noise of standard
    /// deviation `noise` (metres): μ + S (S + e²I)⁻¹ (A − μ). It moves rounded or unlikely vectors towards the training data.
    ///
    /// # Errors
    /// [`Error::Request`] for a measure that is not finite, [`Error::Invalid`] for noise with which S + e²I is not positive
    /// definite.
    pub fn project(&self, measures: &Measurements, noise: f64) -> Result<Measurements> {
        let n = MEASURE_COUNT;
        let (rows, mut weights) = self.offsets(&measures.map(Some))?;
        self.factor(&rows, noise)?.solve(&mut weights);
        Ok(std::array::from_fn(|i| {
            let row = &self.covariance[i * n..(i + 1) * n];
            self.mean[i] + row.iter().zip(&weights).map(|(s, w)| s * w).sum::<f64>()
        }))
    }

    /// Squared Mahalanobis distance of the given measures from the mean, with covariance S_GG + e²I; 0 when nothing is given.
    ///
    /// # Errors
    /// As [`SexPrior::project`].
    pub fn distance_squared(&self, given: &GivenMeasures, noise: f64) -> Result<f64> {
        let (rows, offset) = self.offsets(given)?;
        Ok(self.factor(&rows, noise)?.quadratic_form(&offset))
    }

    /// Share of people, under the Gaussian, who are at least as far from the mean as the given measures; 1 when nothing is given.
    /// Two sides of one value count once: surveys take one side, and who gives both alike says nothing about their difference.
    ///
    /// # Errors
    /// As [`SexPrior::project`].
    pub fn share_beyond(&self, given: &GivenMeasures, noise: f64) -> Result<f64> {
        let once = MeasureId::all().map(|id| {
            let mirror = id.mirrored();
            given[id.index()].filter(|value| mirror >= id || given[mirror.index()] != Some(*value))
        });
        let mut given: GivenMeasures = [None; MEASURE_COUNT];
        for (slot, value) in given.iter_mut().zip(once) {
            *slot = value;
        }
        let count = given.iter().flatten().count();
        Ok(chi_squared::survival(self.distance_squared(&given, noise)?, count))
    }

    /// Log-likelihood of the given measures, with covariance S_GG + e²I, up to a constant that depends on their number only.
    ///
    /// # Errors
    /// As [`SexPrior::project`].
    pub fn log_likelihood(&self, given: &GivenMeasures, noise: f64) -> Result<f64> {
        let (rows, offset) = self.offsets(given)?;
        let factor = self.factor(&rows, noise)?;
        Ok(-0.5 * (factor.quadratic_form(&offset) + factor.log_determinant()))
    }

    /// Indices of the given measures and their differences from the mean.
    fn offsets(&self, given: &GivenMeasures) -> Result<(Vec<usize>, Vec<f64>)> {
        let mut rows = Vec::new();
        let mut offset = Vec::new();
        for (id, value) in MeasureId::all().zip(given) {
            if let Some(value) = value {
                if !value.is_finite() {
                    return Err(Error::request(
                        id.name(),
                        format!("expected a finite number of metres, got {value}"),
                    ));
                }
                rows.push(id.index());
                offset.push(value - self.mean[id.index()]);
            }
        }
        Ok((rows, offset))
    }

    fn factor(&self, rows: &[usize], noise: f64) -> Result<Cholesky> {
        noisy_factor(&self.covariance, rows, noise).ok_or_else(|| {
            Error::invalid("measurement error", format!("expected a positive number of metres, got {noise}"))
        })
    }
}

/// Cholesky factor L of the rows and columns `rows` of a covariance of all measures, with e² added to the diagonal.
fn noisy_factor(covariance: &[f64], rows: &[usize], noise: f64) -> Option<Cholesky> {
    let size = rows.len();
    let mut part = Vec::with_capacity(size * size);
    for &i in rows {
        for &j in rows {
            let variance = if i == j { noise * noise } else { 0.0 };
            part.push(covariance[i * MEASURE_COUNT + j] + variance);
        }
    }
    Cholesky::new(&part, size)
}

/// All measures conditioned on the given ones: a Gaussian over the open ones.
#[derive(Clone, Debug)]
pub struct Conditional {
    given: [bool; MEASURE_COUNT],
    mean: Measurements,
    /// M × M; the rows and columns of the given measures are zero.
    covariance: Vec<f64>,
}

impl Conditional {
    /// Which measures were given.
    pub fn given(&self) -> &[bool; MEASURE_COUNT] {
        &self.given
    }

    /// Conditional mean of each measure, metres; the given value of a given one.
    pub fn mean(&self) -> &Measurements {
        &self.mean
    }

    /// Standard deviation of each measure, metres; 0 for a given one.
    pub fn standard_deviation(&self) -> Measurements {
        // Rounding may leave a variance slightly below zero.
        std::array::from_fn(|i| self.covariance[i * (MEASURE_COUNT + 1)].max(0.0).sqrt())
    }

    /// Lower and upper ends of the central 90 % interval of each measure, metres; both are the value of a given one.
    pub fn interval90(&self) -> (Measurements, Measurements) {
        let deviation = self.standard_deviation();
        let end = |sign: f64| std::array::from_fn(|i| self.mean[i] + sign * HALF_INTERVAL_90 * deviation[i]);
        (end(-1.0), end(1.0))
    }

    /// One draw of all measures, metres; the given ones keep their values.
    pub fn sample(&self, random: &mut Random) -> Measurements {
        let open: Vec<_> = (0..MEASURE_COUNT).filter(|i| !self.given[*i]).collect();
        let part: Vec<_> = open
            .iter()
            .flat_map(|i| open.iter().map(move |j| self.covariance[i * MEASURE_COUNT + j]))
            .collect();
        let normals = random.normals(open.len());
        let deviation = self.standard_deviation();
        let step = match Cholesky::with_jitter(&part, open.len()) {
            Some(factor) => factor.multiply(&normals),
            // Not for a checked prior; independent draws are a fallback that is still plausible.
            None => open.iter().zip(&normals).map(|(i, x)| deviation[*i] * x).collect(),
        };
        let mut sample = self.mean;
        for (i, step) in open.iter().zip(step) {
            sample[*i] += step;
        }
        sample
    }
}

#[cfg(test)]
mod tests;
