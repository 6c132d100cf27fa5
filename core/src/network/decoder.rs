//! The decoder: from measures, sex and z to shape coefficients.

use super::condition::{Condition, condition_vector, skip_shapes};
use super::config::{CONDITION_COUNT, GeneratorConfig};
use super::dense::{Block, Dense, add_product, block_shapes, dense_shapes};
use super::tensor::{Shapes, Tensors, take};
use crate::Result;
use crate::measure::{MEASURE_COUNT, Measurements, Sex};

/// Names and shapes of the arrays that [`Decoder::from_tensors`] reads.
pub fn decoder_shapes(config: &GeneratorConfig) -> Shapes {
    let widths = config.widths();
    let mut shapes = Shapes::new();
    block_shapes(&mut shapes, "condition", widths.condition, widths.features);
    let mut inputs = config.latent + widths.features;
    for (i, outputs) in widths.decoder.into_iter().enumerate() {
        block_shapes(&mut shapes, &format!("decoder.{i}"), inputs, outputs);
        inputs = outputs;
    }
    dense_shapes(&mut shapes, "output", inputs, config.coefficients);
    if config.latent_skip {
        shapes.insert("output.latent".into(), vec![config.latent, config.coefficients]);
    }
    skip_shapes(&mut shapes, config);
    shapes
}

/// Condition and latent vector → shape coefficients; the only network that generation needs.
#[derive(Clone, Debug)]
pub struct Decoder {
    latent: usize,
    condition: Condition,
    blocks: [Block; 3],
    output: Dense,
    /// Shape `(latent, K)`.
    latent_skip: Option<Vec<f32>>,
}

impl Decoder {
    /// Builds the network from its arrays.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for a configuration out of its limits,
    /// [`Error::Model`](crate::Error::Model) naming the tensor that is missing, of another shape or not finite. Tensors of
    /// other networks in the set are ignored.
    pub fn from_tensors(config: &GeneratorConfig, tensors: &Tensors) -> Result<Self> {
        config.validate()?;
        let shapes = decoder_shapes(config);
        let block = |i: usize| Block::take(tensors, &shapes, &format!("decoder.{i}"));
        Ok(Self {
            latent: config.latent,
            condition: Condition::take(config, tensors, &shapes)?,
            blocks: [block(0)?, block(1)?, block(2)?],
            output: Dense::take(tensors, &shapes, "output")?,
            latent_skip: config.latent_skip.then(|| take(tensors, &shapes, "output.latent")).transpose()?,
        })
    }

    /// Length of z.
    pub fn latent_len(&self) -> usize {
        self.latent
    }

    /// Number K of shape coefficients.
    pub fn coefficient_count(&self) -> usize {
        self.output.outputs
    }

    /// The K shape coefficients, metres, for standardised measures ((m − mean) / deviation). A z shorter than
    /// [`Decoder::latent_len`] is padded with zeros, a longer one is truncated.
    pub fn decode(&self, measures_standardised: &Measurements, sex: Sex, z: &[f32]) -> Vec<f64> {
        let z: Vec<f64> = z.iter().map(|&v| f64::from(v)).collect();
        self.decode_f64(measures_standardised, sex, &z)
    }

    /// [`Decoder::decode`] with z in double precision.
    pub fn decode_f64(&self, measures_standardised: &Measurements, sex: Sex, z: &[f64]) -> Vec<f64> {
        let condition = condition_vector(measures_standardised, sex);
        let mut x = self.padded(z);
        x.extend(self.condition.features(&condition));
        for block in &self.blocks {
            x = block.forward(&x);
        }
        let mut out = self.output.forward(&x);
        self.add_skips(&condition, z, &mut out);
        out
    }

    /// The coefficients and their derivative with respect to each standardised measure: row i of the
    /// [`MEASURE_COUNT`] `× K` matrix is d c / d measure i, metres per standard deviation.
    pub fn decode_with_jacobian(
        &self,
        measures_standardised: &Measurements,
        sex: Sex,
        z: &[f64],
    ) -> (Vec<f64>, Vec<f64>) {
        let condition = condition_vector(measures_standardised, sex);
        let encoded = self.condition.encoded(&condition);
        let width = encoded.len();
        let mut slopes = Vec::with_capacity(width);
        self.condition.fourier.derivative(&condition, &mut slopes);
        let per_scalar = width / CONDITION_COUNT;
        let mut tangents = vec![0.0; MEASURE_COUNT * width];
        for (i, row) in tangents.chunks_exact_mut(width).enumerate() {
            let at = i * per_scalar..(i + 1) * per_scalar;
            row[at.clone()].copy_from_slice(&slopes[at]);
        }
        let (features, moved) =
            self.condition.block.forward_with_tangents(&encoded, &tangents, MEASURE_COUNT);
        let mut x = self.padded(z);
        x.extend(&features);
        let mut t = vec![0.0; MEASURE_COUNT * x.len()];
        for (row, from) in t.chunks_exact_mut(x.len()).zip(moved.chunks_exact(features.len())) {
            row[self.latent..].copy_from_slice(from);
        }
        for block in &self.blocks {
            (x, t) = block.forward_with_tangents(&x, &t, MEASURE_COUNT);
        }
        let mut out = self.output.forward(&x);
        let mut jacobian = self.output.tangents(&t, MEASURE_COUNT);
        self.add_skips(&condition, z, &mut out);
        if let Some(skip) = &self.condition.skip {
            for (j, &w) in jacobian.iter_mut().zip(&skip.weight) {
                *j += f64::from(w);
            }
        }
        (out, jacobian)
    }

    fn padded(&self, z: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; self.latent];
        for (a, b) in x.iter_mut().zip(z) {
            *a = *b;
        }
        x
    }

    fn add_skips(&self, condition: &[f64; CONDITION_COUNT], z: &[f64], out: &mut [f64]) {
        if let Some(skip) = &self.condition.skip {
            for (o, s) in out.iter_mut().zip(skip.forward(condition)) {
                *o += s;
            }
        }
        if let Some(weight) = &self.latent_skip {
            add_product(&self.padded(z), weight, out);
        }
    }
}
