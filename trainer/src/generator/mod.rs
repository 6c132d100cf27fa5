//! The mesh generator: a conditional variational autoencoder from measures and sex to shape coefficients
//! (paper sections 5.2, 5.3 and 9.1).
//!
//! [`train`] fits the linear skip in closed form, trains the network on what it leaves over, and returns the
//! arrays that `anthronet::network` runs.

mod backward;
pub(crate) mod data;
mod export;
pub(crate) mod network;
pub(crate) mod ops;
mod run;
mod synthetic;
#[cfg(test)]
mod tests;

use std::path::PathBuf;
use std::sync::Arc;

use anthronet::measure::MEASURE_COUNT;
use anthronet::network::Tensors;
use anthronet::network::config::GeneratorConfig;
use serde::{Deserialize, Serialize};

pub use run::train;
pub use synthetic::synthetic_set;

use crate::{Error, Result};

/// Bodies to train the generator on.
#[derive(Clone, Debug)]
pub struct TrainingSet {
    /// Number N of bodies.
    pub count: usize,
    /// Number K of coefficients per body.
    pub k: usize,
    /// `N × K`, metres, in an orthonormal basis of the 3V coordinates.
    pub coefficients: Vec<f32>,
    /// `N × MEASURE_COUNT`, metres.
    pub measures: Vec<f32>,
    /// `N`: 0 female, 1 male.
    pub sex: Vec<u8>,
}

impl TrainingSet {
    /// Checks that the sizes agree and the numbers are finite.
    fn validate(&self, name: &str) -> Result<()> {
        let sizes = [
            ("coefficients", self.coefficients.len(), self.count * self.k),
            ("measures", self.measures.len(), self.count * MEASURE_COUNT),
            ("sex", self.sex.len(), self.count),
        ];
        for (what, got, expected) in sizes {
            if got != expected {
                return Err(Error::Invalid(format!("{name} set: expected {expected} {what}, got {got}")));
            }
        }
        if self.count < 2 {
            return Err(Error::Invalid(format!(
                "{name} set: expected at least 2 bodies, got {}",
                self.count
            )));
        }
        for (what, values, width) in
            [("coefficient", &self.coefficients, self.k), ("measure", &self.measures, MEASURE_COUNT)]
        {
            if let Some(i) = values.iter().position(|v| !v.is_finite()) {
                let (body, column) = (i / width, i % width);
                let value = values[i];
                return Err(Error::Invalid(format!("{name} set: {what} {column} of body {body} is {value}")));
            }
        }
        Ok(())
    }
}

/// `cᵀ M c + v·c + constant`.
#[derive(Clone, Debug)]
pub struct QuadraticForm {
    /// M, `K × K`, symmetric.
    pub matrix: Vec<f64>,
    /// v, `K`.
    pub vector: Vec<f64>,
    /// The value at c = 0.
    pub constant: f64,
}

/// Statistics of the shape space that the coefficients belong to.
#[derive(Clone, Debug)]
pub struct ShapeStatistics {
    /// Number V of vertices of the mesh behind the coefficients.
    pub vertex_count: usize,
    /// Deviation of every coefficient over the training set, metres.
    pub coefficient_std: Vec<f64>,
    /// The cotangent Laplacian loss of a body as a function of its coefficients, m².
    pub laplacian: Option<QuadraticForm>,
}

/// Mean distance between the vertices of two sets of bodies, metres, from their coefficients: predicted, true,
/// both `n × K`.
pub type PointDistance = Arc<dyn Fn(&[f32], &[f32]) -> f64 + Send + Sync>;

/// Options of the training.
#[derive(Clone)]
pub struct TrainingOptions {
    /// Folder of the checkpoint.
    pub out_dir: PathBuf,
    /// Fixes initial weights, order and noise.
    pub seed: u64,
    /// Number of epochs.
    pub epochs: usize,
    /// Threads; 0 for as many as there are cores.
    pub threads: usize,
    /// Continues from the checkpoint in `out_dir` where there is one.
    pub resume: bool,
    /// No progress bar.
    pub quiet: bool,
    /// Bodies per step.
    pub batch: usize,
    /// Peak learning rate of the one-cycle schedule.
    pub learning_rate: f64,
    /// Fraction of the training until that peak.
    pub warmup: f64,
    /// Fraction of the training after which batch norm uses its running statistics, as it will in use.
    pub freeze_norm: f64,
    /// Epochs from one validation to the next.
    pub validate_every: usize,
    /// Seconds from one checkpoint to the next; checkpoints fall between epochs.
    pub checkpoint_seconds: u64,
    /// Stops after this epoch, as if interrupted, with a checkpoint.
    pub stop_after: Option<usize>,
    /// Exact mean vertex distance for the metrics.
    pub point_distance: Option<PointDistance>,
}

impl Default for TrainingOptions {
    fn default() -> Self {
        Self {
            out_dir: PathBuf::from("."),
            seed: 1,
            epochs: 70,
            threads: 0,
            resume: false,
            quiet: false,
            batch: 256,
            learning_rate: 0.005,
            warmup: 0.15,
            freeze_norm: 0.5,
            validate_every: 5,
            checkpoint_seconds: 30,
            stop_after: None,
            point_distance: None,
        }
    }
}

/// Metrics of the network on the validation set, z = encoder mean unless stated.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Epochs done.
    pub epoch: usize,
    /// Mean training loss of the last epoch: reconstruction (mm²), divergence (nats), Laplacian (mm²).
    pub training: [f64; 3],
    /// Root mean square vertex distance, mm, exact for the coefficients.
    pub rms_mm: f64,
    /// The same at z = 0: the variation that the measures do not determine.
    pub rms_z0_mm: f64,
    /// The same for z drawn from the encoder's distribution.
    pub rms_sampled_mm: f64,
    /// Mean vertex distance by [`TrainingOptions::point_distance`], mm.
    pub p2p_mm: Option<f64>,
    /// Largest ‖Δc‖ of a body, metres: a bound on the error of any coordinate. Below 1 the Huber distance is
    /// exactly quadratic.
    pub largest_error_m: f64,
    /// Divergence from the prior, nats.
    pub divergence: f64,
    /// Mean of μ per latent number.
    pub latent_mean: Vec<f64>,
    /// Deviation of z per latent number over the set, its spread around μ included: 1 fits the prior.
    pub latent_std: Vec<f64>,
}

/// What [`train`] returns.
#[derive(Clone, Debug)]
pub struct TrainedGenerator {
    /// Decoder and encoder for `anthronet::network`.
    pub tensors: Tensors,
    /// As trained.
    pub config: GeneratorConfig,
    /// Mean of the measures, metres: the network's inputs are (m − mean) / deviation.
    pub measure_mean: [f64; MEASURE_COUNT],
    /// Deviation of the measures, metres.
    pub measure_std: [f64; MEASURE_COUNT],
    /// On the validation set, after the last epoch.
    pub metrics: Metrics,
    /// Metrics of every validation during the training.
    pub history: Vec<Metrics>,
    /// Deviation of z per latent number over the validation set; 1 fits the prior.
    pub latent_std: Vec<f64>,
}
