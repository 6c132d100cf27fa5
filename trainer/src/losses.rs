//! The losses of the generator (paper section 5.3) on shape coefficients.
//!
//! Lengths enter in millimetres, squared: in metres the gradients would sink below Adam's epsilon. With
//! orthonormal columns of B, `Σ (x − x̃)²` over all coordinates is `Σ (c − c̃)²`, and as no coordinate is ever
//! 1 m wrong, the paper's Huber distance is exactly half of the square.
//!
//! - Reconstruction: `½ · mean over samples and 3V coordinates of Δ²`, mm².
//! - Divergence: `KL(N(μ, σ²) ‖ N(0, 1))`, nats, summed over z and averaged over samples.
//! - Laplacian: `cᵀ G c + g·c + constant` of the generated body, averaged over samples, mm² where G is in m² per m².

use anthronet::network::config::GeneratorConfig;
use candle_core::{Device, Result, Tensor};

use crate::generator::QuadraticForm;
use crate::generator::data::Batch;
use crate::generator::ops::{combine, values};

/// mm² per m².
const SQUARE_MILLIMETRES: f64 = 1e6;

/// The losses of one batch, unweighted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Parts {
    pub(crate) reconstruction: f64,
    pub(crate) divergence: f64,
    pub(crate) laplacian: f64,
}

/// The weighted sum α · reconstruction + β · divergence + γ · Laplacian.
#[derive(Debug)]
pub(crate) struct Losses {
    alpha: f64,
    beta: f64,
    gamma: f64,
    /// Square of the network's output in its own unit → its part of the reconstruction, per coefficient.
    weight: Vec<f64>,
    /// Metres per unit of output.
    scale: Vec<f64>,
    laplacian: Option<Laplacian>,
}

/// The quadratic form as tensors, mm².
#[derive(Debug)]
struct Laplacian {
    /// `(K, K)`.
    matrix: Tensor,
    vector: Vec<f64>,
    constant: f64,
}

impl Losses {
    /// For outputs that represent `scale · output` metres, of a mesh with this many vertices.
    pub(crate) fn new(
        config: &GeneratorConfig,
        scale: &[f64],
        vertex_count: usize,
        laplacian: Option<&QuadraticForm>,
    ) -> Result<Self> {
        let factor = 0.5 * SQUARE_MILLIMETRES / (3.0 * vertex_count as f64);
        let k = scale.len();
        let laplacian = match laplacian.filter(|_| config.gamma > 0.0) {
            Some(form) => {
                let matrix = form.matrix.iter().map(|v| (v * SQUARE_MILLIMETRES) as f32).collect();
                Some(Laplacian {
                    matrix: Tensor::from_vec(matrix, (k, k), &Device::Cpu)?,
                    vector: form.vector.iter().map(|v| v * SQUARE_MILLIMETRES).collect(),
                    constant: form.constant * SQUARE_MILLIMETRES,
                })
            }
            None => None,
        };
        Ok(Self {
            alpha: config.alpha,
            beta: config.beta,
            gamma: config.gamma,
            weight: scale.iter().map(|s| s * s * factor).collect(),
            scale: scale.to_vec(),
            laplacian,
        })
    }

    /// Whether batches need their offsets.
    pub(crate) fn needs_offsets(&self) -> bool {
        self.laplacian.is_some()
    }

    /// The sum that is minimised.
    pub(crate) fn weighted(&self, parts: &Parts) -> f64 {
        self.alpha * parts.reconstruction + self.beta * parts.divergence + self.gamma * parts.laplacian
    }

    /// Reconstruction and Laplacian, and the gradient of their weighted sum with respect to the output `(N, K)`.
    pub(crate) fn output_gradient(&self, output: &Tensor, batch: &Batch) -> Result<(Parts, Tensor)> {
        let (n, k) = output.dims2()?;
        let samples = n as f64;
        let mut gradient =
            combine(output, &batch.residuals, |a, b| a - b)?.flatten_all()?.to_vec1::<f32>()?;
        let mut parts = Parts::default();
        let step: Vec<f32> = self.weight.iter().map(|w| (2.0 * self.alpha * w / samples) as f32).collect();
        for row in gradient.chunks_exact_mut(k) {
            for ((d, w), step) in row.iter_mut().zip(&self.weight).zip(&step) {
                parts.reconstruction += f64::from(*d).powi(2) * w;
                *d *= step;
            }
        }
        parts.reconstruction /= samples;
        if let (Some(laplacian), Some(offsets)) = (&self.laplacian, &batch.offsets) {
            let mut c = values(output)?;
            for (row, offsets) in c.chunks_exact_mut(k).zip(values(offsets)?.chunks_exact(k)) {
                for ((c, s), o) in row.iter_mut().zip(&self.scale).zip(offsets) {
                    *c = *c * *s as f32 + o;
                }
            }
            let product = Tensor::from_slice(&c, (n, k), &Device::Cpu)?.matmul(&laplacian.matrix)?;
            let product = values(&product)?;
            let factor = self.gamma / samples;
            for ((c, p), g) in
                c.chunks_exact(k).zip(product.chunks_exact(k)).zip(gradient.chunks_exact_mut(k))
            {
                for i in 0..k {
                    let (c, p, v) = (f64::from(c[i]), f64::from(p[i]), laplacian.vector[i]);
                    parts.laplacian += c * (p + v) / samples;
                    g[i] += (factor * self.scale[i] * (2.0 * p + v)) as f32;
                }
            }
            parts.laplacian += laplacian.constant;
        }
        Ok((parts, Tensor::from_vec(gradient, (n, k), &Device::Cpu)?))
    }

    /// The divergence, and the gradients of its weighted value with respect to μ and log σ², `(N, latent)`.
    pub(crate) fn latent_gradient(
        &self,
        mean: &Tensor,
        log_variance: &Tensor,
    ) -> Result<(f64, Tensor, Tensor)> {
        let samples = mean.dim(0)? as f64;
        let factor = (self.beta / samples) as f32;
        let d_mean = combine(mean, mean, |m, _| factor * m)?;
        let d_log_variance =
            combine(log_variance, log_variance, |v, _| 0.5 * factor * (libm::expf(v) - 1.0))?;
        let terms = values(&combine(mean, log_variance, |m, v| 0.5 * (m * m + libm::expf(v) - v - 1.0))?)?;
        let divergence = terms.iter().map(|&t| f64::from(t)).sum::<f64>() / samples;
        Ok((divergence, d_mean, d_log_variance))
    }

    /// The same sum as candle operations, for candle's own backward pass.
    #[cfg(test)]
    pub(crate) fn total(
        &self,
        output: &Tensor,
        mean: &Tensor,
        log_variance: &Tensor,
        batch: &Batch,
    ) -> Result<Tensor> {
        let k = self.scale.len();
        let row = |v: Vec<f64>| Tensor::from_vec(v.iter().map(|&x| x as f32).collect(), (1, k), &Device::Cpu);
        let samples = output.dim(0)? as f64;
        let roots = row(self.weight.iter().map(|w| w.sqrt()).collect())?;
        let difference = (output - &batch.residuals)?.broadcast_mul(&roots)?;
        let mut total = (difference.sqr()?.sum_all()? * (self.alpha / samples))?;
        let terms = ((mean.sqr()? + log_variance.exp()?)? - log_variance)?;
        let divergence = (terms.sum_all()? / samples)?.affine(0.5, -0.5 * mean.dim(1)? as f64)?;
        total = (total + (divergence * self.beta)?)?;
        if let (Some(laplacian), Some(offsets)) = (&self.laplacian, &batch.offsets) {
            let c = (output.broadcast_mul(&row(self.scale.clone())?)? + offsets)?;
            let square = (c.matmul(&laplacian.matrix)? * &c)?.sum_all()?;
            let linear = c.broadcast_mul(&row(laplacian.vector.clone())?)?.sum_all()?;
            total = (total
                + ((square + linear)? / samples)?.affine(self.gamma, self.gamma * laplacian.constant)?)?;
        }
        Ok(total)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tensor(values: &[f32], rows: usize) -> Tensor {
        Tensor::from_slice(values, (rows, values.len() / rows), &Device::Cpu).unwrap()
    }

    fn batch(residuals: &[f32], offsets: &[f32], rows: usize) -> Batch {
        let offsets = Some(tensor(offsets, rows));
        Batch { residuals: tensor(residuals, rows), conditions: tensor(&[0.0; 2], rows), offsets }
    }

    #[test]
    fn reconstruction_is_the_huber_distance_of_vertices() {
        // Two vertices, six coordinates; columns of B are unit vectors, so coefficients are coordinates.
        let losses = Losses::new(&GeneratorConfig::default(), &[0.1, 0.2], 2, None).unwrap();
        let output = tensor(&[0.03, 0.0, 0.0, 0.01], 2);
        let (parts, _) = losses.output_gradient(&output, &batch(&[0.0; 4], &[0.0; 4], 2)).unwrap();
        let by_hand = 0.5 * (3.0_f64.powi(2) + 2.0_f64.powi(2)) / (2.0 * 6.0);
        assert!((parts.reconstruction - by_hand).abs() < 1e-5, "{parts:?} {by_hand}");
    }

    #[test]
    fn divergence_vanishes_at_the_prior() {
        let losses = Losses::new(&GeneratorConfig::default(), &[1.0], 1, None).unwrap();
        let zero = tensor(&[0.0; 6], 2);
        assert_eq!(losses.latent_gradient(&zero, &zero).unwrap().0, 0.0);
        let mean = tensor(&[1.0, 0.0, 0.0, -1.0, 0.0, 0.0], 2);
        assert!((losses.latent_gradient(&mean, &zero).unwrap().0 - 0.5).abs() < 1e-6);
    }

    #[test]
    fn laplacian_is_the_quadratic_form() {
        let form =
            QuadraticForm { matrix: vec![2.0, 1.0, 1.0, 3.0], vector: vec![0.5, -1.0], constant: 0.25 };
        let config = GeneratorConfig { gamma: 1.0, ..GeneratorConfig::default() };
        let losses = Losses::new(&config, &[0.1, 0.2], 1, Some(&form)).unwrap();
        let output = tensor(&[1.0, 2.0], 1);
        let (parts, _) = losses.output_gradient(&output, &batch(&[0.0; 2], &[0.3, -0.1], 1)).unwrap();
        let (a, b) = (0.4, 0.3);
        let by_hand = 1e6 * (2.0 * a * a + 2.0 * a * b + 3.0 * b * b + 0.5 * a - b + 0.25);
        assert!((parts.laplacian / by_hand - 1.0).abs() < 1e-5, "{parts:?} {by_hand}");
    }
}
