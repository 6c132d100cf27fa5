//! The training of the generator.

use std::time::{Duration, Instant};

use anthronet::network::config::GeneratorConfig;
use candle_core::{Device, Tensor};

use super::data::{Frame, NetworkData};
use super::export::export;
use super::network::{Network, Norm};
use super::{Metrics, ShapeStatistics, TrainedGenerator, TrainingOptions, TrainingSet};
use crate::checkpoint::{Checkpoint, Identity};
use crate::losses::{Losses, Parts};
use crate::progress::Progress;
use crate::training::{Adam, OneCycle, epoch_random, random_normals, random_order};
use crate::{Error, Result};

/// Weight of a batch in the running statistics of batch norm.
const MOMENTUM: f32 = 0.02;
/// Bodies per step of a validation.
const VALIDATION_BATCH: usize = 1024;
/// File name of the checkpoint.
const CHECKPOINT: &str = "generator.checkpoint.safetensors";

/// Trains a generator. The same sets, configuration, seed and options give the same bits, also when the run is
/// interrupted and resumed.
///
/// # Errors
/// When the sets, statistics or options do not fit together, the checkpoint is of another run or damaged, the
/// output folder cannot be written, or the loss stops being finite.
pub fn train(
    training: &TrainingSet,
    validation: &TrainingSet,
    statistics: &ShapeStatistics,
    config: &GeneratorConfig,
    options: &TrainingOptions,
) -> Result<TrainedGenerator> {
    check(training, validation, statistics, config, options)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads)
        .build()
        .map_err(|e| Error::Invalid(format!("threads: {e}")))?;
    pool.install(|| Run::start(training, validation, statistics, config, options)?.finish())
}

fn check(
    training: &TrainingSet,
    validation: &TrainingSet,
    statistics: &ShapeStatistics,
    config: &GeneratorConfig,
    options: &TrainingOptions,
) -> Result<()> {
    config.validate()?;
    training.validate("training")?;
    validation.validate("validation")?;
    let k = config.coefficients;
    let mut sizes = vec![
        ("coefficients of the training set", training.k),
        ("coefficients of the validation set", validation.k),
        ("coefficient deviations", statistics.coefficient_std.len()),
    ];
    if let Some(form) = &statistics.laplacian {
        sizes.push(("numbers in the Laplacian's vector", form.vector.len()));
        if form.matrix.len() != k * k {
            let got = form.matrix.len();
            return Err(Error::Invalid(format!(
                "expected {} numbers in the Laplacian's matrix, got {got}",
                k * k
            )));
        }
    }
    for (what, got) in sizes {
        if got != k {
            return Err(Error::Invalid(format!("expected {k} {what}, got {got}")));
        }
    }
    if statistics.vertex_count == 0 {
        return Err(Error::Invalid("expected a mesh with vertices".into()));
    }
    if options.batch < 2 || options.epochs == 0 {
        let (batch, epochs) = (options.batch, options.epochs);
        return Err(Error::Invalid(format!("expected batch ≥ 2 and epochs ≥ 1, got {batch} and {epochs}")));
    }
    let fractions = 0.0..=1.0;
    if !(options.learning_rate > 0.0 && fractions.contains(&options.warmup) && options.freeze_norm >= 0.0) {
        return Err(Error::Invalid(
            "expected a positive learning rate, warmup from 0 to 1, freeze ≥ 0".into(),
        ));
    }
    Ok(())
}

/// The state of a training.
struct Run<'a> {
    config: &'a GeneratorConfig,
    options: &'a TrainingOptions,
    vertex_count: usize,
    frame: Frame,
    training: NetworkData,
    validation: NetworkData,
    losses: Losses,
    network: Network,
    adam: Adam,
    schedule: OneCycle,
    identity: Identity,
    epoch: usize,
    history: Vec<Metrics>,
}

impl<'a> Run<'a> {
    fn start(
        training: &TrainingSet,
        validation: &TrainingSet,
        statistics: &ShapeStatistics,
        config: &'a GeneratorConfig,
        options: &'a TrainingOptions,
    ) -> Result<Self> {
        let frame = Frame::fit(training, config)?;
        let losses =
            Losses::new(config, &frame.scale, statistics.vertex_count, statistics.laplacian.as_ref())?;
        let network = Network::new(config, &frame, options.seed)?;
        let steps = options.epochs * training.count.div_ceil(options.batch);
        let sizes: Vec<usize> = network.variables().iter().map(|(_, v)| v.elem_count()).collect();
        let mut run = Self {
            config,
            options,
            vertex_count: statistics.vertex_count,
            training: frame.prepare(training, losses.needs_offsets()),
            validation: frame.prepare(validation, true),
            losses,
            network,
            adam: Adam::new(sizes),
            schedule: OneCycle { peak: options.learning_rate, warmup: options.warmup, steps },
            identity: Identity::of(training, statistics, config, options)?,
            frame,
            epoch: 0,
            history: Vec::new(),
        };
        let path = options.out_dir.join(CHECKPOINT);
        if options.resume && path.exists() {
            let saved = Checkpoint::read(&path, &run.identity)?;
            (run.epoch, run.history) = (saved.epoch, saved.history.clone());
            run.adam = saved.restore(&mut run.network)?;
        }
        Ok(run)
    }

    fn finish(mut self) -> Result<TrainedGenerator> {
        let progress = Progress::new("generator", self.options.epochs, self.epoch, self.options.quiet);
        let mut saved = Instant::now();
        let stop = self.options.stop_after.unwrap_or(usize::MAX).min(self.options.epochs);
        while self.epoch < stop {
            let losses = self.run_epoch()?;
            self.epoch += 1;
            let last = self.epoch == stop;
            if last || self.epoch.is_multiple_of(self.options.validate_every.max(1)) {
                let metrics = self.validate(losses)?;
                progress.message(&metrics);
                self.history.push(metrics);
            }
            if last || saved.elapsed() >= Duration::from_secs(self.options.checkpoint_seconds) {
                self.save()?;
                saved = Instant::now();
            }
            progress.advance();
        }
        progress.finish();
        let metrics = match self.history.last() {
            Some(metrics) if metrics.epoch == self.epoch => metrics.clone(),
            _ => self.validate([0.0; 3])?,
        };
        Ok(TrainedGenerator {
            tensors: export(&self.network, &self.frame, self.config)?,
            config: self.config.clone(),
            measure_mean: self.frame.measure_mean,
            measure_std: self.frame.measure_std,
            latent_std: metrics.latent_std.clone(),
            metrics,
            history: self.history,
        })
    }

    /// One pass over the training set; the mean losses.
    fn run_epoch(&mut self) -> Result<[f64; 3]> {
        let mut random = epoch_random(self.options.seed, self.epoch);
        let order = random_order(&mut random, self.training.count);
        let frozen = self.epoch as f64 >= self.options.freeze_norm * self.options.epochs as f64;
        let norm = if frozen { Norm::Running } else { Norm::Batch(MOMENTUM) };
        let mut sums = [0.0; 3];
        let mut batches = 0.0;
        for rows in order.chunks(self.options.batch) {
            // Batch norm of one body is undefined; later epochs see the body.
            if rows.len() < 2 {
                continue;
            }
            let noise = random_normals(&mut random, rows.len() * self.config.latent);
            let parts = self.step(rows, noise, norm)?;
            for (s, l) in sums.iter_mut().zip([parts.reconstruction, parts.divergence, parts.laplacian]) {
                *s += l;
            }
            batches += 1.0;
        }
        Ok(sums.map(|s| s / batches))
    }

    fn step(&mut self, rows: &[usize], noise: Vec<f32>, norm: Norm) -> Result<Parts> {
        let batch = self.training.batch(rows)?;
        let noise = Tensor::from_vec(noise, (rows.len(), self.config.latent), &Device::Cpu)?;
        let (parts, gradients) = self.network.gradients(&batch, &noise, norm, &self.losses)?;
        if !self.losses.weighted(&parts).is_finite() {
            let (epoch, rate) = (self.epoch, self.options.learning_rate);
            let message = format!("the loss is not finite in epoch {epoch}: try a rate below {rate}");
            return Err(Error::Invalid(message));
        }
        let rate = self.schedule.rate(self.adam.steps() as usize);
        let variables = self.network.variables();
        self.adam.step(variables.iter().map(|(_, v)| *v).zip(&gradients), rate)?;
        Ok(parts)
    }

    /// Measures the network on the validation set.
    fn validate(&mut self, training: [f64; 3]) -> Result<Metrics> {
        let (k, latent, count) = (self.config.coefficients, self.config.latent, self.validation.count);
        let mut random = epoch_random(self.options.seed, usize::MAX - 1);
        let rows: Vec<usize> = (0..count).collect();
        let mut squares = [0.0; 3];
        let (mut largest, mut divergence_sum) = (0.0_f64, 0.0);
        let (mut sum, mut square) = (vec![0.0; latent], vec![0.0; latent]);
        let (mut predicted, mut truth) = (Vec::new(), Vec::new());
        for rows in rows.chunks(VALIDATION_BATCH) {
            let batch = self.validation.batch(rows)?;
            let shape = (rows.len(), latent);
            let noise =
                Tensor::from_vec(random_normals(&mut random, rows.len() * latent), shape, &Device::Cpu)?;
            let features = self.network.features(&batch.conditions, Norm::Running)?;
            let (mean, log_variance) = self.network.encode(&batch.residuals, &features, Norm::Running)?;
            divergence_sum += self.losses.latent_gradient(&mean, &log_variance)?.0 * rows.len() as f64;
            let z = (&mean + ((&log_variance * 0.5)?.exp()? * noise)?)?;
            let mut outputs = Vec::new();
            for z in [&mean, &mean.zeros_like()?, &z] {
                outputs.push(self.network.decode(z, &features, Norm::Running)?.to_vec2::<f32>()?);
            }
            for (i, &row) in rows.iter().enumerate() {
                let target = self.validation.residual(row);
                for (which, output) in outputs.iter().enumerate() {
                    let error: f64 = (0..k)
                        .map(|c| (f64::from(output[i][c] - target[c]) * self.frame.scale[c]).powi(2))
                        .sum();
                    squares[which] += error;
                    if which == 0 {
                        largest = largest.max(error.sqrt());
                    }
                }
            }
            for (m, v) in mean.to_vec2::<f32>()?.iter().zip(log_variance.to_vec2::<f32>()?) {
                for l in 0..latent {
                    let m = f64::from(m[l]);
                    sum[l] += m;
                    square[l] += m * m + libm::exp(f64::from(v[l]));
                }
            }
            if self.options.point_distance.is_some() {
                let offsets = batch.offsets.ok_or_else(|| Error::Invalid("no offsets prepared".into()))?;
                for ((i, &row), offset) in rows.iter().enumerate().zip(offsets.to_vec2::<f32>()?) {
                    let target = self.validation.residual(row);
                    for c in 0..k {
                        let scale = self.frame.scale[c] as f32;
                        predicted.push(offset[c] + scale * outputs[0][i][c]);
                        truth.push(offset[c] + scale * target[c]);
                    }
                }
            }
        }
        let n = count as f64;
        let rms = |s: f64| 1e3 * (s / (n * self.vertex_count as f64)).sqrt();
        let latent_mean: Vec<f64> = sum.iter().map(|s| s / n).collect();
        let latent_std =
            square.iter().zip(&latent_mean).map(|(s, m)| (s / n - m * m).max(0.0).sqrt()).collect();
        Ok(Metrics {
            epoch: self.epoch,
            training,
            rms_mm: rms(squares[0]),
            rms_z0_mm: rms(squares[1]),
            rms_sampled_mm: rms(squares[2]),
            p2p_mm: self.options.point_distance.as_ref().map(|f| 1e3 * f(&predicted, &truth)),
            largest_error_m: largest,
            divergence: divergence_sum / n,
            latent_mean,
            latent_std,
        })
    }

    fn save(&self) -> Result<()> {
        std::fs::create_dir_all(&self.options.out_dir).map_err(Error::io(&self.options.out_dir))?;
        let path = self.options.out_dir.join(CHECKPOINT);
        Checkpoint::of(&self.network, &self.adam, self.epoch, &self.history)?.write(&path, &self.identity)
    }
}
