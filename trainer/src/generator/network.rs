//! The conditional variational autoencoder of the paper (sections 5.3 and 9.1) for training.
//!
//! Tensors are named as in `anthronet::network`, which runs what [`super::export`] makes of them; weights
//! have shape `(inputs, outputs)`. Here a block is a linear layer without bias, batch norm (`norm_scale`,
//! `norm_shift`, running statistics) and a parametric ReLU (`slope`).

use std::sync::PoisonError;

use anthronet::network::config::GeneratorConfig;
use anthronet::random::Random;
use candle_core::{Device, Result, Tensor, Var};

use super::backward::Trace;
use super::data::Frame;
use super::ops::{EPSILON, Normalise, ScaleShiftPrelu};

/// The stream of a seed that the network starts from; the epochs take those after it.
const START_STREAM: u64 = 0;

/// How batch norm behaves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Norm {
    /// Statistics of the batch, which are also blended into the running ones with this weight.
    Batch(f32),
    /// Running statistics, as constants.
    Running,
}

/// Fully connected layer, batch norm, parametric ReLU.
#[derive(Debug)]
pub(crate) struct Block {
    pub(crate) name: String,
    pub(crate) weight: Var,
    pub(crate) norm_scale: Var,
    pub(crate) norm_shift: Var,
    pub(crate) slope: Var,
    pub(crate) running_mean: Vec<f32>,
    pub(crate) running_variance: Vec<f32>,
}

/// Fully connected layer.
#[derive(Debug)]
pub(crate) struct Dense {
    pub(crate) name: String,
    pub(crate) weight: Var,
    pub(crate) bias: Var,
}

fn variable(values: Vec<f32>, shape: &[usize]) -> Result<Var> {
    Var::from_tensor(&Tensor::from_vec(values, shape, &Device::Cpu)?)
}

/// Uniform in ± 1/√inputs, the usual start of a linear layer.
fn uniform(rng: &mut Random, inputs: usize, count: usize) -> Vec<f32> {
    let bound = 1.0 / (inputs as f64).sqrt();
    (0..count).map(|_| ((2.0 * rng.uniform() - 1.0) * bound) as f32).collect()
}

impl Block {
    fn new(name: &str, inputs: usize, outputs: usize, rng: &mut Random) -> Result<Self> {
        Ok(Self {
            name: name.into(),
            weight: variable(uniform(rng, inputs, inputs * outputs), &[inputs, outputs])?,
            norm_scale: variable(vec![1.0; outputs], &[outputs])?,
            norm_shift: variable(vec![0.0; outputs], &[outputs])?,
            slope: variable(vec![0.25; outputs], &[outputs])?,
            running_mean: vec![0.0; outputs],
            running_variance: vec![1.0; outputs],
        })
    }

    /// The block's output, and what its backward pass needs.
    pub(crate) fn forward(&mut self, x: &Tensor, norm: Norm) -> Result<(Tensor, Trace)> {
        let linear = x.matmul(&self.weight)?;
        let (unit, scale, shift, batch) = match norm {
            Norm::Batch(momentum) => {
                let op = Normalise::default();
                let copy = Normalise { statistics: op.statistics.clone() };
                let unit = linear.apply_op1(op)?;
                self.follow(&copy, x.dim(0)?, momentum);
                (unit, self.norm_scale.as_tensor().clone(), self.norm_shift.as_tensor().clone(), Some(copy))
            }
            Norm::Running => {
                let (inverse, mean) = self.running();
                let size = mean.len();
                let scale = (self.norm_scale.as_tensor() * Tensor::from_vec(inverse, size, &Device::Cpu)?)?;
                let mean = Tensor::from_slice(mean, size, &Device::Cpu)?;
                let shift = (self.norm_shift.as_tensor() - (&scale * mean)?)?;
                (linear, scale, shift, None)
            }
        };
        let parameters = Tensor::stack(&[&scale, &shift, self.slope.as_tensor()], 0)?;
        let out = unit.apply_op2(&parameters, ScaleShiftPrelu)?;
        Ok((out, Trace::new(x, unit, parameters, batch)))
    }

    /// Blends the statistics of a batch into the running ones.
    fn follow(&mut self, op: &Normalise, rows: usize, momentum: f32) {
        let batch = op.statistics.lock().unwrap_or_else(PoisonError::into_inner);
        let unbiased = rows as f32 / (rows as f32 - 1.0).max(1.0);
        for (r, b) in self.running_mean.iter_mut().zip(&batch.mean) {
            *r += momentum * (b - *r);
        }
        for (r, b) in self.running_variance.iter_mut().zip(&batch.variance) {
            *r += momentum * (b * unbiased - *r);
        }
    }

    /// 1/σ and μ of the running statistics.
    pub(crate) fn running(&self) -> (Vec<f32>, &[f32]) {
        (self.running_variance.iter().map(|v| 1.0 / (v + EPSILON).sqrt()).collect(), &self.running_mean)
    }
}

impl Dense {
    fn new(name: &str, inputs: usize, outputs: usize, gain: f32, rng: &mut Random) -> Result<Self> {
        let weight = uniform(rng, inputs, inputs * outputs).into_iter().map(|w| w * gain).collect();
        Ok(Self {
            name: name.into(),
            weight: variable(weight, &[inputs, outputs])?,
            bias: variable(vec![0.0; outputs], &[outputs])?,
        })
    }

    pub(crate) fn forward(&self, x: &Tensor) -> Result<Tensor> {
        x.matmul(&self.weight)?.broadcast_add(&self.bias)
    }
}

/// The whole network: see the drawing in `anthronet::network`.
#[derive(Debug)]
pub(crate) struct Network {
    pub(crate) condition: Block,
    pub(crate) mesh: Block,
    pub(crate) fusion: [Block; 2],
    pub(crate) latent_mean: Dense,
    pub(crate) latent_log_variance: Dense,
    pub(crate) decoder: [Block; 3],
    pub(crate) output: Dense,
    /// `(K, latent)` and `(latent, K)`: the linear paths from the mesh to z and from z to the output.
    pub(crate) latent_skip: Option<(Var, Var)>,
}

/// What a forward pass gives, `(N, …)`.
#[cfg(test)]
pub(crate) struct Forward {
    pub(crate) mean: Tensor,
    pub(crate) log_variance: Tensor,
    /// In the network's units: metres are `offset + scale · output`.
    pub(crate) output: Tensor,
}

impl Network {
    /// A network at the start of its training.
    pub(crate) fn new(config: &GeneratorConfig, frame: &Frame, seed: u64) -> Result<Self> {
        let rng = &mut Random::new(seed, START_STREAM);
        let w = config.widths();
        let (k, latent) = (config.coefficients, config.latent);
        let [d0, d1, d2] = w.decoder;
        // With linear paths the network starts as their closed-form solution plus nothing.
        let gain = if config.latent_skip { 0.1 } else { 1.0 };
        let network = Self {
            condition: Block::new("condition", w.condition, w.features, rng)?,
            mesh: Block::new("mesh", k, w.features, rng)?,
            fusion: [
                Block::new("fusion.0", 2 * w.features, w.fusion[0], rng)?,
                Block::new("fusion.1", w.fusion[0], w.fusion[1], rng)?,
            ],
            latent_mean: Dense::new("latent_mean", w.fusion[1], latent, gain, rng)?,
            latent_log_variance: Dense::new("latent_log_variance", w.fusion[1], latent, gain, rng)?,
            decoder: [
                Block::new("decoder.0", latent + w.features, d0, rng)?,
                Block::new("decoder.1", d0, d1, rng)?,
                Block::new("decoder.2", d1, d2, rng)?,
            ],
            output: Dense::new("output", d2, k, gain, rng)?,
            latent_skip: if config.latent_skip { Some(linear_paths(frame, k, latent, rng)?) } else { None },
        };
        if config.latent_skip {
            // Samples of z start close to their mean: the linear paths already know where that is.
            network.latent_log_variance.bias.set(&Tensor::full(-3.0_f32, latent, &Device::Cpu)?)?;
        }
        Ok(network)
    }

    /// Every block, in a fixed order.
    pub(crate) fn blocks(&self) -> [&Block; 7] {
        let ([f0, f1], [d0, d1, d2]) = (&self.fusion, &self.decoder);
        [&self.condition, &self.mesh, f0, f1, d0, d1, d2]
    }

    pub(crate) fn blocks_mut(&mut self) -> [&mut Block; 7] {
        let ([f0, f1], [d0, d1, d2]) = (&mut self.fusion, &mut self.decoder);
        [&mut self.condition, &mut self.mesh, f0, f1, d0, d1, d2]
    }

    /// Every layer that is no block, in a fixed order.
    pub(crate) fn layers(&self) -> [&Dense; 3] {
        [&self.latent_mean, &self.latent_log_variance, &self.output]
    }

    /// Everything that is trained, by name, in a fixed order.
    pub(crate) fn variables(&self) -> Vec<(String, &Var)> {
        let mut out = Vec::new();
        for b in self.blocks() {
            out.push((format!("{}.weight", b.name), &b.weight));
            out.push((format!("{}.norm_scale", b.name), &b.norm_scale));
            out.push((format!("{}.norm_shift", b.name), &b.norm_shift));
            out.push((format!("{}.slope", b.name), &b.slope));
        }
        for layer in self.layers() {
            out.push((format!("{}.weight", layer.name), &layer.weight));
            out.push((format!("{}.bias", layer.name), &layer.bias));
        }
        if let Some((mesh, latent)) = &self.latent_skip {
            out.push(("latent_mean.mesh".into(), mesh));
            out.push(("output.latent".into(), latent));
        }
        out
    }

    /// The features h_a of conditions.
    pub(crate) fn features(&mut self, conditions: &Tensor, norm: Norm) -> Result<Tensor> {
        Ok(self.condition.forward(conditions, norm)?.0) // (N, 128 w)
    }

    /// Mean and log variance of z.
    pub(crate) fn encode(
        &mut self,
        residuals: &Tensor,
        features: &Tensor,
        norm: Norm,
    ) -> Result<(Tensor, Tensor)> {
        let h = self.mesh.forward(residuals, norm)?.0; // (N, 128 w)
        let h = Tensor::cat(&[&h, features], 1)?; // (N, 256 w)
        let h = self.fusion[0].forward(&h, norm)?.0; // (N, 128 w)
        let h = self.fusion[1].forward(&h, norm)?.0; // (N, 64 w)
        let mut mean = self.latent_mean.forward(&h)?; // (N, latent)
        if let Some((mesh, _)) = &self.latent_skip {
            mean = (mean + residuals.matmul(mesh)?)?;
        }
        Ok((mean, self.latent_log_variance.forward(&h)?))
    }

    /// The output for z `(N, latent)` and features.
    pub(crate) fn decode(&mut self, z: &Tensor, features: &Tensor, norm: Norm) -> Result<Tensor> {
        let mut x = Tensor::cat(&[z, features], 1)?; // (N, latent + 128 w)
        for block in &mut self.decoder {
            x = block.forward(&x, norm)?.0; // (N, 64 w), (N, 128 w), (N, 256 w)
        }
        let output = self.output.forward(&x)?; // (N, K)
        match &self.latent_skip {
            Some((_, latent)) => output + z.matmul(latent)?,
            None => Ok(output),
        }
    }

    /// One pass that candle can differentiate, with z = μ + σ ε, where ε is `(N, latent)`, or z = μ.
    #[cfg(test)]
    pub(crate) fn forward(
        &mut self,
        batch: &super::data::Batch,
        noise: Option<&Tensor>,
        norm: Norm,
    ) -> Result<Forward> {
        let features = self.features(&batch.conditions, norm)?;
        let (mean, log_variance) = self.encode(&batch.residuals, &features, norm)?;
        let z = match noise {
            Some(noise) => (&mean + ((&log_variance * 0.5)?.exp()? * noise)?)?,
            None => mean.clone(),
        };
        let output = self.decode(&z, &features, norm)?;
        Ok(Forward { mean, log_variance, output })
    }
}

/// The best linear z: principal components of the residual, scores at deviation 1.
fn linear_paths(frame: &Frame, k: usize, latent: usize, rng: &mut Random) -> Result<(Var, Var)> {
    let (mut to, mut from) = (vec![0.0; k * latent], vec![0.0; latent * k]);
    for l in 0..latent {
        let deviation = frame.component_std[l];
        for i in 0..k {
            let u = frame.components[i * latent + l];
            if deviation > 0.0 {
                to[i * latent + l] = (u * frame.scale[i] / deviation) as f32;
                from[l * k + i] = (u * deviation / frame.scale[i]) as f32;
            } else {
                to[i * latent + l] = (0.01 * rng.normal()) as f32;
            }
        }
    }
    Ok((variable(to, &[k, latent])?, variable(from, &[latent, k])?))
}
