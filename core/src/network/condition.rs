//! The condition vector, and the layers on it that encoder and decoder share.

use super::config::{CONDITION_COUNT, GeneratorConfig};
use super::dense::{Block, Dense, dense_shapes};
use super::fourier::Fourier;
use super::tensor::{Shapes, Tensors};
use crate::Result;
use crate::measure::{MEASURE_COUNT, Measurements, Sex};

pub(super) fn skip_shapes(shapes: &mut Shapes, config: &GeneratorConfig) {
    if config.skip {
        dense_shapes(shapes, "skip", CONDITION_COUNT, config.coefficients);
    }
}

/// Condition vector → features h_a; and the linear skip from the same vector to the output.
#[derive(Clone, Debug)]
pub(super) struct Condition {
    pub(super) fourier: Fourier,
    pub(super) block: Block,
    pub(super) skip: Option<Dense>,
}

impl Condition {
    pub(super) fn take(config: &GeneratorConfig, tensors: &Tensors, shapes: &Shapes) -> Result<Self> {
        Ok(Self {
            fourier: Fourier::new(&config.fourier, CONDITION_COUNT)?,
            block: Block::take(tensors, shapes, "condition")?,
            skip: config.skip.then(|| Dense::take(tensors, shapes, "skip")).transpose()?,
        })
    }

    pub(super) fn encoded(&self, condition: &[f64]) -> Vec<f64> {
        let mut encoded = Vec::with_capacity(self.fourier.output_len());
        self.fourier.encode(condition, &mut encoded);
        encoded
    }

    pub(super) fn features(&self, condition: &[f64]) -> Vec<f64> {
        self.block.forward(&self.encoded(condition))
    }
}

/// The condition vector: the standardised measures, then −1 for female or 1 for male.
pub fn condition_vector(measures_standardised: &Measurements, sex: Sex) -> [f64; CONDITION_COUNT] {
    let mut condition = [0.0; CONDITION_COUNT];
    condition[..MEASURE_COUNT].copy_from_slice(measures_standardised);
    condition[MEASURE_COUNT] = match sex {
        Sex::Female => -1.0,
        Sex::Male => 1.0,
    };
    condition
}
