//! The encoder: from shape coefficients, measures and sex to z.

use super::condition::{Condition, condition_vector, skip_shapes};
use super::config::GeneratorConfig;
use super::dense::{Block, Dense, add_product, block_shapes, dense_shapes};
use super::tensor::{Shapes, Tensors, take};
use crate::measure::{Measurements, Sex};
use crate::{Error, Result};

/// Names and shapes of the arrays that [`Encoder::from_tensors`] reads.
pub fn encoder_shapes(config: &GeneratorConfig) -> Shapes {
    let widths = config.widths();
    let mut shapes = Shapes::new();
    block_shapes(&mut shapes, "condition", widths.condition, widths.features);
    block_shapes(&mut shapes, "mesh", config.coefficients, widths.features);
    block_shapes(&mut shapes, "fusion.0", 2 * widths.features, widths.fusion[0]);
    block_shapes(&mut shapes, "fusion.1", widths.fusion[0], widths.fusion[1]);
    dense_shapes(&mut shapes, "latent_mean", widths.fusion[1], config.latent);
    dense_shapes(&mut shapes, "latent_log_variance", widths.fusion[1], config.latent);
    if config.latent_skip {
        shapes.insert("latent_mean.mesh".into(), vec![config.coefficients, config.latent]);
    }
    skip_shapes(&mut shapes, config);
    shapes
}

/// Body and condition → distribution of z: for evaluation and for finding the z of a known body.
#[derive(Clone, Debug)]
pub struct Encoder {
    condition: Condition,
    mesh: Block,
    fusion: [Block; 2],
    mean: Dense,
    log_variance: Dense,
    /// Shape `(K, latent)`.
    mean_skip: Option<Vec<f32>>,
}

impl Encoder {
    /// Whether the set has any array that belongs to the encoder alone; a model may come without, as generation needs none.
    pub fn is_in(tensors: &Tensors) -> bool {
        tensors.keys().any(|name| ["mesh.", "fusion.", "latent_"].iter().any(|own| name.starts_with(own)))
    }

    /// Builds the network from its arrays.
    ///
    /// # Errors
    /// As [`Decoder::from_tensors`](super::Decoder::from_tensors).
    pub fn from_tensors(config: &GeneratorConfig, tensors: &Tensors) -> Result<Self> {
        config.validate()?;
        let shapes = encoder_shapes(config);
        Ok(Self {
            condition: Condition::take(config, tensors, &shapes)?,
            mesh: Block::take(tensors, &shapes, "mesh")?,
            fusion: [Block::take(tensors, &shapes, "fusion.0")?, Block::take(tensors, &shapes, "fusion.1")?],
            mean: Dense::take(tensors, &shapes, "latent_mean")?,
            log_variance: Dense::take(tensors, &shapes, "latent_log_variance")?,
            mean_skip: config.latent_skip.then(|| take(tensors, &shapes, "latent_mean.mesh")).transpose()?,
        })
    }

    /// Mean μ and log σ² of z for a body with the given coefficients (K, metres).
    ///
    /// # Errors
    /// [`Error::Invalid`] when the number of coefficients is not K.
    pub fn encode(
        &self,
        measures_standardised: &Measurements,
        sex: Sex,
        coefficients: &[f64],
    ) -> Result<(Vec<f64>, Vec<f64>)> {
        let k = self.mesh.dense.weight.len() / self.mesh.dense.outputs;
        if coefficients.len() != k {
            let message = format!("expected {k}, got {}", coefficients.len());
            return Err(Error::invalid("shape coefficients", message));
        }
        let condition = condition_vector(measures_standardised, sex);
        // The networks model only what the linear skip leaves unexplained.
        let mut residual = coefficients.to_vec();
        if let Some(skip) = &self.condition.skip {
            for (r, s) in residual.iter_mut().zip(skip.forward(&condition)) {
                *r -= s;
            }
        }
        let mut x = self.mesh.forward(&residual);
        x.extend(self.condition.features(&condition));
        for block in &self.fusion {
            x = block.forward(&x);
        }
        let mut mean = self.mean.forward(&x);
        if let Some(weight) = &self.mean_skip {
            add_product(&residual, weight, &mut mean);
        }
        Ok((mean, self.log_variance.forward(&x)))
    }
}
