//! Random Fourier encoding of scalars (paper section 5.2; Tancik et al., "Fourier features let networks
//! learn high frequency functions in low dimensional domains", 2020).
//!
//! Every scalar `y` has its own `f` frequencies `b ~ N(0, σ²)` and becomes `[cos 2πby …, sin 2πby …]`. The
//! frequencies follow from the seed alone, the same on every machine, so a model file stores only
//! `(f, σ, seed)`.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::random::Random;
use crate::{Error, Result};

/// Largest number of components per scalar in a configuration.
pub const MAX_COMPONENTS: usize = 256;

/// The stream of [`Random`] that the frequencies are drawn from.
const FREQUENCY_STREAM: u64 = 3;

/// Configuration of an encoding.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FourierConfig {
    /// Frequencies per scalar, the paper's f; 0 passes the scalars through unchanged.
    pub components: usize,
    /// Standard deviation σ of the frequencies, in cycles per unit of the (standardised) scalar.
    pub sigma: f64,
    /// Seed of the frequencies.
    pub seed: u64,
}

impl Default for FourierConfig {
    fn default() -> Self {
        // None: beside the linear skip they gain nothing (numbers in MODEL_CARD.md).
        Self { components: 0, sigma: 0.03, seed: 1 }
    }
}

impl FourierConfig {
    /// Checks that there are at most [`MAX_COMPONENTS`] and that σ is in 0..=1000.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field.
    pub fn validate(&self) -> Result<()> {
        if self.components > MAX_COMPONENTS {
            return Err(Error::invalid(
                "fourier.components",
                format!("expected at most {MAX_COMPONENTS}, got {}", self.components),
            ));
        }
        if !(0.0..=1000.0).contains(&self.sigma) {
            return Err(Error::invalid(
                "fourier.sigma",
                format!("expected a number from 0 to 1000, got {}", self.sigma),
            ));
        }
        Ok(())
    }

    /// Length of the encoding of one scalar: 2f, or 1 without frequencies.
    pub fn width(&self) -> usize {
        if self.components == 0 { 1 } else { 2 * self.components }
    }
}

/// An encoding with its frequencies, for a fixed number of scalars.
#[derive(Clone, Debug, PartialEq)]
pub struct Fourier {
    inputs: usize,
    components: usize,
    /// 2π b, `inputs × components`.
    angular: Vec<f64>,
}

impl Fourier {
    /// Draws the frequencies for `inputs` scalars.
    ///
    /// # Errors
    /// As [`FourierConfig::validate`].
    pub fn new(config: &FourierConfig, inputs: usize) -> Result<Self> {
        config.validate()?;
        let mut random = Random::new(config.seed, FREQUENCY_STREAM);
        let angular = (0..inputs * config.components).map(|_| TAU * config.sigma * random.normal()).collect();
        Ok(Self { inputs, components: config.components, angular })
    }

    /// Number of scalars.
    pub fn input_len(&self) -> usize {
        self.inputs
    }

    /// Length of the encoding: `inputs · 2f`, or `inputs` without frequencies.
    pub fn output_len(&self) -> usize {
        if self.components == 0 { self.inputs } else { self.inputs * 2 * self.components }
    }

    /// Appends the encoding of `input` to `out`: per scalar, the f cosines and then the f sines. Scalars beyond
    /// [`Fourier::input_len`] are ignored; missing ones append nothing.
    pub fn encode(&self, input: &[f64], out: &mut Vec<f64>) {
        if self.components == 0 {
            out.extend(input.iter().take(self.inputs));
            return;
        }
        for (&y, row) in input.iter().zip(self.angular.chunks_exact(self.components)) {
            out.extend(row.iter().map(|w| libm::cos(w * y)));
            out.extend(row.iter().map(|w| libm::sin(w * y)));
        }
    }

    /// Appends the derivative of each number of the encoding with respect to its scalar, in the order of
    /// [`Fourier::encode`]. All other entries of the Jacobian are zero: it is block diagonal, with blocks of
    /// [`FourierConfig::width`] rows and one column.
    pub fn derivative(&self, input: &[f64], out: &mut Vec<f64>) {
        if self.components == 0 {
            out.extend(input.iter().take(self.inputs).map(|_| 1.0));
            return;
        }
        for (&y, row) in input.iter().zip(self.angular.chunks_exact(self.components)) {
            out.extend(row.iter().map(|w| -w * libm::sin(w * y)));
            out.extend(row.iter().map(|w| w * libm::cos(w * y)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn config(components: usize, sigma: f64) -> FourierConfig {
        FourierConfig { components, sigma, seed: 7 }
    }

    #[test]
    fn without_components_the_scalars_pass() {
        let fourier = Fourier::new(&config(0, 0.1), 3).unwrap();
        let (mut out, mut slope) = (Vec::new(), Vec::new());
        fourier.encode(&[1.0, -2.0, 3.0], &mut out);
        fourier.derivative(&[1.0, -2.0, 3.0], &mut slope);
        assert_eq!((out, slope), (vec![1.0, -2.0, 3.0], vec![1.0; 3]));
        assert_eq!(fourier.output_len(), 3);
    }

    #[test]
    fn cosine_and_sine_of_one_angle() {
        let fourier = Fourier::new(&config(4, 0.5), 2).unwrap();
        let mut out = Vec::new();
        fourier.encode(&[0.7, 0.0], &mut out);
        assert_eq!(out.len(), fourier.output_len());
        for i in 0..4 {
            // Rounding of two libm calls.
            assert!((out[i] * out[i] + out[i + 4] * out[i + 4] - 1.0).abs() < 1e-14);
        }
        assert_eq!(&out[8..], &[1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn derivative_matches_differences() {
        let fourier = Fourier::new(&config(3, 0.4), 2).unwrap();
        let (mut low, mut high, mut slope) = (Vec::new(), Vec::new(), Vec::new());
        let h = 1e-6;
        fourier.encode(&[0.3 - h, -1.1 - h], &mut low);
        fourier.encode(&[0.3 + h, -1.1 + h], &mut high);
        fourier.derivative(&[0.3, -1.1], &mut slope);
        for ((l, u), s) in low.iter().zip(&high).zip(&slope) {
            // Central differences of size 1e-6 in f64.
            assert!(((u - l) / (2.0 * h) - s).abs() < 1e-8);
        }
    }

    #[test]
    fn the_seed_fixes_the_frequencies() {
        let a = Fourier::new(&config(8, 0.03), 37).unwrap();
        assert_eq!(a, Fourier::new(&config(8, 0.03), 37).unwrap());
        assert_ne!(a, Fourier::new(&FourierConfig { seed: 8, ..config(8, 0.03) }, 37).unwrap());
        let rms = (a.angular.iter().map(|w| w * w).sum::<f64>() / a.angular.len() as f64).sqrt() / TAU;
        // 296 draws: the standard error of the deviation is 4 %.
        assert!((rms / 0.03 - 1.0).abs() < 0.15, "{rms}");
    }

    #[test]
    fn absurd_configurations_are_refused() {
        assert!(Fourier::new(&config(100_000, 0.1), 37).is_err());
        assert!(Fourier::new(&config(8, f64::NAN), 37).is_err());
        assert!(Fourier::new(&config(8, -1.0), 37).is_err());
    }
}
