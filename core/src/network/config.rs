//! Configuration of a generator network: its sizes and the weights of its losses (paper sections 5.3 and 9.1).

use serde::{Deserialize, Serialize};

use crate::measure::MEASURE_COUNT;
use crate::network::fourier::FourierConfig;
use crate::{Error, Result};

/// Length of the condition vector: the standardised measures and the sex.
pub const CONDITION_COUNT: usize = MEASURE_COUNT + 1;

/// Largest number of shape coefficients in a configuration.
pub const MAX_COEFFICIENTS: usize = 4096;
/// Largest length of the latent vector.
pub const MAX_LATENT: usize = 256;
/// Largest multiple of the paper's layer widths.
pub const MAX_WIDTH: usize = 16;

/// Sizes and losses of the conditional variational autoencoder.
///
/// The mesh is `mean + B c` with orthonormal columns of B, so the paper's first and last layers act on the
/// coefficients `c` (metres) instead of vertices, with the same loss and gradient.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct GeneratorConfig {
    /// Encoding of the condition.
    pub fourier: FourierConfig,
    /// Length of the latent vector z.
    pub latent: usize,
    /// Multiple of the paper's layer widths (128, 256, 64).
    pub width: usize,
    /// Adds the linear least-squares prediction from the condition to the output, so that the network learns its
    /// residual. The paper has none.
    pub skip: bool,
    /// Adds linear paths from the mesh to the latent mean and from z to the output. The paper has none.
    pub latent_skip: bool,
    /// Number K of shape coefficients.
    pub coefficients: usize,
    /// Weight α of the reconstruction loss: Huber, mean over the 3V coordinates, in mm².
    pub alpha: f64,
    /// Weight β of the Kullback–Leibler divergence, summed over z, in nats.
    pub beta: f64,
    /// Weight γ of the Laplacian loss, in mm².
    pub gamma: f64,
    /// Exponent p in 0..=1: the last layer's outputs are multiplied by σᵖ, σ being the standard deviation of the
    /// coefficient, so that the optimiser reaches the small coefficients. 0 is the paper's plain output, 1 whitens.
    pub scale_power: f64,
}

impl Default for GeneratorConfig {
    fn default() -> Self {
        Self {
            fourier: FourierConfig::default(),
            latent: 10,
            width: 2,
            skip: true,
            latent_skip: true,
            coefficients: 300,
            alpha: 1.0,
            beta: 5e-4,
            gamma: 0.0,
            scale_power: 0.5,
        }
    }
}

/// Widths of the layers that follow from a configuration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Widths {
    /// Encoded condition, the input of the condition encoder: 37 · 2f.
    pub condition: usize,
    /// Features of the mesh encoder and of the condition encoder: 128.
    pub features: usize,
    /// Outputs of the two fusion blocks: 128, 64.
    pub fusion: [usize; 2],
    /// Outputs of the three decoder blocks: 64, 128, 256.
    pub decoder: [usize; 3],
}

impl GeneratorConfig {
    /// The network of the paper, with no linear paths: f = 8 Fourier components.
    ///
    /// `scale_power` keeps its default: it changes the unit of the last layer, not the functions that the network can
    /// represent, and without it Adam never reaches the small coefficients.
    pub fn paper() -> Self {
        Self {
            fourier: FourierConfig { components: 8, ..FourierConfig::default() },
            width: 1,
            skip: false,
            latent_skip: false,
            ..Self::default()
        }
    }

    /// Checks sizes against their limits, before anything is allocated from them.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the field, what was expected and what was found.
    pub fn validate(&self) -> Result<()> {
        self.fourier.validate()?;
        let sizes = [
            ("latent", self.latent, MAX_LATENT),
            ("width", self.width, MAX_WIDTH),
            ("coefficients", self.coefficients, MAX_COEFFICIENTS),
        ];
        for (what, value, most) in sizes {
            if !(1..=most).contains(&value) {
                return Err(Error::invalid(what, format!("expected 1 to {most}, got {value}")));
            }
        }
        let weights = [("alpha", self.alpha, 1e12), ("beta", self.beta, 1e12), ("gamma", self.gamma, 1e12)];
        for (what, value, most) in weights.into_iter().chain([("scale_power", self.scale_power, 1.0)]) {
            if !(0.0..=most).contains(&value) {
                return Err(Error::invalid(what, format!("expected a number from 0 to {most}, got {value}")));
            }
        }
        Ok(())
    }

    /// The layer widths. Call [`GeneratorConfig::validate`] first when the configuration is untrusted.
    pub fn widths(&self) -> Widths {
        let w = self.width;
        Widths {
            condition: CONDITION_COUNT * self.fourier.width(),
            features: 128 * w,
            fusion: [128 * w, 64 * w],
            decoder: [64 * w, 128 * w, 256 * w],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_of_the_paper() {
        let widths = GeneratorConfig::paper().widths();
        assert_eq!(widths.condition, 37 * 16);
        assert_eq!((widths.features, widths.fusion, widths.decoder), (128, [128, 64], [64, 128, 256]));
    }

    #[test]
    fn json_round_trip_and_defaults() {
        let config = GeneratorConfig { beta: 3e-4, ..GeneratorConfig::paper() };
        let json = serde_json::to_string(&config).unwrap();
        assert_eq!(serde_json::from_str::<GeneratorConfig>(&json).unwrap(), config);
        assert_eq!(serde_json::from_str::<GeneratorConfig>("{}").unwrap(), GeneratorConfig::default());
        assert!(serde_json::from_str::<GeneratorConfig>("{\"widht\": 2}").is_err());
    }

    #[test]
    fn absurd_sizes_are_refused() {
        let bad: [fn(&mut GeneratorConfig); 8] = [
            |c| c.latent = 0,
            |c| c.latent = 1 << 40,
            |c| c.width = 0,
            |c| c.width = usize::MAX,
            |c| c.coefficients = usize::MAX,
            |c| c.fourier.components = usize::MAX,
            |c| c.beta = f64::NAN,
            |c| c.scale_power = 2.0,
        ];
        assert!(GeneratorConfig::default().validate().is_ok());
        for change in bad {
            let mut config = GeneratorConfig::default();
            change(&mut config);
            assert!(config.validate().is_err(), "{config:?}");
        }
    }
}
