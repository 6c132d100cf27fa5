//! The gradient of the loss, written out.
//!
//! candle's own backward pass gives the same numbers (a test holds them together) but also the gradients of the
//! inputs, zero-filled sums for every tensor, and elementwise work on a pool of spinning threads: written out,
//! a step takes half of the time, and its matrix products and block kernels run on the caller's threads.

use candle_core::{CustomOp1, CustomOp2, Device, Result, Tensor};

use super::data::Batch;
use super::network::{Block, Dense, Network, Norm};
use super::ops::{Normalise, ScaleShiftPrelu, combine, values};
use crate::losses::{Losses, Parts};

/// What a block's backward pass needs of its forward pass.
pub(crate) struct Trace {
    input: Tensor,
    /// The linear layer's output, normalised by the batch when `batch` is set.
    unit: Tensor,
    /// Scale, shift, slope, `(3, outputs)`.
    parameters: Tensor,
    /// The batch statistics' operation, or nothing when running statistics were used.
    pub(crate) batch: Option<Normalise>,
}

impl Trace {
    pub(crate) fn new(input: &Tensor, unit: Tensor, parameters: Tensor, batch: Option<Normalise>) -> Self {
        Self { input: input.clone(), unit, parameters, batch }
    }
}

impl Block {
    /// Gradients of weight, norm scale, norm shift and slope, and of the input when wanted.
    fn backward(
        &self,
        trace: &Trace,
        gradient: &Tensor,
        input: bool,
    ) -> Result<(Option<Tensor>, [Tensor; 4])> {
        let (unit, parameters) =
            ScaleShiftPrelu.bwd(&trace.unit, &trace.parameters, &trace.unit, gradient)?;
        let missing = || candle_core::Error::Msg("a gradient is missing".into()).bt();
        let (unit, parameters) = (unit.ok_or_else(missing)?, values(&parameters.ok_or_else(missing)?)?);
        let n = parameters.len() / 3;
        let (scale, rest) = parameters.split_at(n);
        let (shift, slope) = rest.split_at(n);
        let mut scale = scale.to_vec();
        let linear = match &trace.batch {
            Some(op) => op.bwd(&trace.unit, &trace.unit, &unit)?.ok_or_else(missing)?,
            None => {
                // scale' = scale / σ, shift' = shift − μ scale / σ.
                let (inverse, mean) = self.running();
                for c in 0..n {
                    scale[c] = inverse[c] * (scale[c] - mean[c] * shift[c]);
                }
                unit
            }
        };
        let weight = trace.input.t()?.matmul(&linear)?;
        let input = if input { Some(linear.matmul(&self.weight.t()?)?) } else { None };
        let tensor = |v: &[f32]| Tensor::from_slice(v, n, &Device::Cpu);
        Ok((input, [weight, tensor(&scale)?, tensor(shift)?, tensor(slope)?]))
    }
}

impl Dense {
    /// Gradients of the input, and of weight and bias.
    fn backward(&self, input: &Tensor, gradient: &Tensor) -> Result<(Tensor, [Tensor; 2])> {
        let weight = input.t()?.matmul(gradient)?;
        Ok((gradient.matmul(&self.weight.t()?)?, [weight, gradient.sum(0)?]))
    }
}

fn sum(a: &Tensor, b: &Tensor) -> Result<Tensor> {
    combine(a, b, |a, b| a + b)
}

impl Network {
    /// The losses of a batch and their gradients, in the order of [`Network::variables`].
    pub(crate) fn gradients(
        &mut self,
        batch: &Batch,
        noise: &Tensor,
        norm: Norm,
        losses: &Losses,
    ) -> Result<(Parts, Vec<Tensor>)> {
        // Forward, as in `Network::forward`.
        let (features, condition_trace) = self.condition.forward(&batch.conditions, norm)?;
        let width = features.dim(1)?;
        let (h, mesh_trace) = self.mesh.forward(&batch.residuals, norm)?;
        let (h, fusion_0) = self.fusion[0].forward(&Tensor::cat(&[&h, &features], 1)?, norm)?;
        let (fused, fusion_1) = self.fusion[1].forward(&h, norm)?;
        let mut mean = self.latent_mean.forward(&fused)?;
        if let Some((mesh, _)) = &self.latent_skip {
            mean = sum(&mean, &batch.residuals.matmul(mesh)?)?;
        }
        let log_variance = self.latent_log_variance.forward(&fused)?;
        let spread = combine(&log_variance, noise, |v, e| libm::expf(0.5 * v) * e)?;
        let z = sum(&mean, &spread)?;
        let mut x = Tensor::cat(&[&z, &features], 1)?;
        let mut decoder = Vec::new();
        for block in &mut self.decoder {
            let (y, trace) = block.forward(&x, norm)?;
            decoder.push(trace);
            x = y;
        }
        let mut output = self.output.forward(&x)?;
        if let Some((_, latent)) = &self.latent_skip {
            output = sum(&output, &z.matmul(latent)?)?;
        }
        let (parts, d_output) = losses.output_gradient(&output, batch)?;
        let (divergence, d_mean, d_log_variance) = losses.latent_gradient(&mean, &log_variance)?;

        // Backward.
        let (mut d_x, [output_weight, output_bias]) = self.output.backward(&x, &d_output)?;
        let mut decoder_gradients = Vec::new();
        for (block, trace) in self.decoder.iter().zip(&decoder).rev() {
            let (input, gradients) = block.backward(trace, &d_x, true)?;
            decoder_gradients.push(gradients);
            d_x = input.unwrap_or(d_x);
        }
        decoder_gradients.reverse();
        let latent = z.dim(1)?;
        let mut d_z = d_x.narrow(1, 0, latent)?.contiguous()?;
        let d_features = d_x.narrow(1, latent, width)?.contiguous()?;
        let mut paths = None;
        if let Some((_, from_latent)) = &self.latent_skip {
            d_z = sum(&d_z, &d_output.matmul(&from_latent.t()?)?)?;
            paths = Some(z.t()?.matmul(&d_output)?);
        }
        let d_mean = sum(&d_mean, &d_z)?;
        let d_spread = combine(&d_z, &spread, |d, s| 0.5 * d * s)?;
        let d_log_variance = sum(&d_log_variance, &d_spread)?;
        let paths = match paths {
            Some(path) => Some((batch.residuals.t()?.matmul(&d_mean)?, path)),
            None => None,
        };
        let (d_fused, mean_gradients) = self.latent_mean.backward(&fused, &d_mean)?;
        let (d_fused_2, variance_gradients) = self.latent_log_variance.backward(&fused, &d_log_variance)?;
        let (d_h, fusion_1) = self.fusion[1].backward(&fusion_1, &sum(&d_fused, &d_fused_2)?, true)?;
        let d_h = d_h.unwrap_or(d_fused);
        let (d_h, fusion_0) = self.fusion[0].backward(&fusion_0, &d_h, true)?;
        let d_h = d_h.unwrap_or(d_fused_2);
        let (_, mesh) = self.mesh.backward(&mesh_trace, &d_h.narrow(1, 0, width)?.contiguous()?, false)?;
        let d_features = sum(&d_features, &d_h.narrow(1, width, width)?.contiguous()?)?;
        let (_, condition) = self.condition.backward(&condition_trace, &d_features, false)?;

        let mut out = Vec::new();
        for block in [condition, mesh, fusion_0, fusion_1].into_iter().chain(decoder_gradients) {
            out.extend(block);
        }
        for layer in [mean_gradients, variance_gradients, [output_weight, output_bias]] {
            out.extend(layer);
        }
        if let Some((mesh, latent)) = paths {
            out.extend([mesh, latent]);
        }
        Ok((Parts { divergence, ..parts }, out))
    }
}

#[cfg(test)]
mod tests {
    use anthronet::network::config::GeneratorConfig;
    use anthronet::network::fourier::FourierConfig;

    use super::*;
    use crate::generator::data::Frame;
    use crate::generator::{QuadraticForm, synthetic_set};
    use crate::training::{epoch_random, random_normals};

    #[test]
    fn agrees_with_candle() {
        const K: usize = 12;
        let set = synthetic_set(100, K, 1);
        let mut matrix = vec![0.0; K * K];
        (0..K).for_each(|i| matrix[i * K + i] = 0.1 + i as f64);
        let form = QuadraticForm { matrix, vector: vec![0.3; K], constant: 0.2 };
        for (skip, norm) in [(true, Norm::Batch(0.1)), (false, Norm::Batch(0.1)), (true, Norm::Running)] {
            let config = GeneratorConfig {
                fourier: FourierConfig { components: 2, ..FourierConfig::default() },
                coefficients: K,
                width: 1,
                skip,
                latent_skip: skip,
                alpha: 1e-3,
                beta: 0.1,
                gamma: 1e-6,
                ..GeneratorConfig::default()
            };
            let frame = Frame::fit(&set, &config).unwrap();
            let losses = Losses::new(&config, &frame.scale, 30, Some(&form)).unwrap();
            let batch = frame.prepare(&set, true).batch(&(0..90).collect::<Vec<_>>()).unwrap();
            let mut network = Network::new(&config, &frame, 5).unwrap();
            let noise = random_normals(&mut epoch_random(1, 1), 90 * config.latent);
            let noise = Tensor::from_vec(noise, (90, config.latent), &Device::Cpu).unwrap();
            if norm == Norm::Running {
                // Statistics that are not those of the start.
                network.gradients(&batch, &noise, Norm::Batch(0.7), &losses).unwrap();
            }
            let forward = network.forward(&batch, Some(&noise), norm).unwrap();
            let loss = losses.total(&forward.output, &forward.mean, &forward.log_variance, &batch).unwrap();
            let expected = loss.backward().unwrap();
            let (parts, gradients) = network.gradients(&batch, &noise, norm, &losses).unwrap();
            let loss = f64::from(loss.to_scalar::<f32>().unwrap());
            assert!((losses.weighted(&parts) / loss - 1.0).abs() < 1e-5, "{parts:?} {loss}");
            let variables = network.variables();
            assert_eq!(variables.len(), gradients.len());
            for ((name, variable), gradient) in variables.iter().zip(&gradients) {
                let expected = values(expected.get(variable.as_tensor()).unwrap()).unwrap();
                let got = values(gradient).unwrap();
                assert_eq!(got.len(), expected.len(), "{name}");
                let largest = expected.iter().fold(1e-6_f32, |m, v| m.max(v.abs()));
                for (a, b) in got.iter().zip(&expected) {
                    // f32 rounding of sums over 90 rows and 10 layers; of a bias before batch norm they almost cancel.
                    assert!((a - b).abs() < 1e-3 * largest, "{name}: {a} {b}, largest {largest}");
                }
            }
        }
    }
}
