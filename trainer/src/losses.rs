//! The losses of the generator (paper section 5.3) on shape coefficients.
//!
//! Lengths enter in millimetres, squared: in metres the gradients would sink below Adam's epsilon. With
//! orthonormal columns of B, `Σ (x − x̃)²` over all coordinates is `Σ (c − c̃)²`, and as no coordinate is ever
//! 1 m wrong, the paper's Huber distance is exactly half of the square.

use candle_core::{Device, Result, Tensor};

/// mm² per m².
const SQUARE_MILLIMETRES: f64 = 1e6;

/// `½ · mean over samples and 3V coordinates of Δ²`, mm², from network outputs that stand for `scale · y` metres.
#[derive(Debug)]
pub(crate) struct Reconstruction {
    /// √ of the weight of each coefficient, `(1, K)`.
    weight: Tensor,
}

impl Reconstruction {
    pub(crate) fn new(scale: &[f64], vertex_count: usize) -> Result<Self> {
        let factor = (0.5 * SQUARE_MILLIMETRES / (3.0 * vertex_count as f64)).sqrt();
        let weight: Vec<f32> = scale.iter().map(|s| (s * factor) as f32).collect();
        Ok(Self { weight: Tensor::from_vec(weight, (1, scale.len()), &Device::Cpu)? })
    }

    /// For outputs and targets `(N, K)`.
    pub(crate) fn loss(&self, outputs: &Tensor, targets: &Tensor) -> Result<Tensor> {
        let samples = outputs.dim(0)? as f64;
        (outputs - targets)?.broadcast_mul(&self.weight)?.sqr()?.sum_all()? / samples
    }
}

/// `KL(N(μ, σ²) ‖ N(0, 1))`, nats, summed over the latent vector and averaged over samples.
pub(crate) fn divergence(mean: &Tensor, log_variance: &Tensor) -> Result<Tensor> {
    let samples = mean.dim(0)? as f64;
    let terms = ((mean.sqr()? + log_variance.exp()?)? - log_variance)?;
    (terms.sum_all()? / samples)?.affine(0.5, -0.5 * mean.dim(1)? as f64)
}

/// The cotangent Laplacian loss, `cᵀ G c + g·c + constant` with c = offset + scale · y, averaged over samples;
/// in mm² when G is in m² per m².
#[derive(Debug)]
pub(crate) struct Laplacian {
    matrix: Tensor,
    vector: Tensor,
    scale: Tensor,
    constant: f64,
}

impl Laplacian {
    pub(crate) fn new(matrix: &[f64], vector: &[f64], constant: f64, scale: &[f64]) -> Result<Self> {
        let k = scale.len();
        let tensor = |v: &[f64], shape: (usize, usize)| {
            Tensor::from_vec(v.iter().map(|&x| x as f32).collect(), shape, &Device::Cpu)
        };
        Ok(Self {
            matrix: tensor(matrix, (k, k))?,
            vector: tensor(vector, (k, 1))?,
            scale: tensor(scale, (1, k))?,
            constant,
        })
    }

    /// For outputs `(N, K)` and the offsets `(N, K)`, metres, that are added to them.
    pub(crate) fn loss(&self, outputs: &Tensor, offsets: &Tensor) -> Result<Tensor> {
        let samples = outputs.dim(0)? as f64;
        let c = (outputs.broadcast_mul(&self.scale)? + offsets)?;
        let square = (c.matmul(&self.matrix)? * &c)?.sum_all()?;
        let linear = c.matmul(&self.vector)?.sum_all()?;
        ((square + linear)? / samples)?.affine(SQUARE_MILLIMETRES, self.constant * SQUARE_MILLIMETRES)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tensor(values: &[f32], rows: usize) -> Tensor {
        Tensor::from_slice(values, (rows, values.len() / rows), &Device::Cpu).unwrap()
    }

    #[test]
    fn reconstruction_is_the_huber_distance_of_vertices() {
        // Two vertices, six coordinates; columns of B are unit vectors, so coefficients are coordinates.
        let scale = [0.1, 0.2];
        let loss = Reconstruction::new(&scale, 2).unwrap();
        let value: f32 = loss
            .loss(&tensor(&[0.03, 0.0, 0.0, 0.01], 2), &tensor(&[0.0, 0.0, 0.0, 0.0], 2))
            .unwrap()
            .to_scalar()
            .unwrap();
        let by_hand = 0.5 * ((3.0_f32).powi(2) + 2.0_f32.powi(2)) / (2.0 * 6.0);
        assert!((value - by_hand).abs() < 1e-5, "{value} {by_hand}");
    }

    #[test]
    fn divergence_vanishes_at_the_prior() {
        let zero = tensor(&[0.0; 6], 2);
        let value: f32 = divergence(&zero, &zero).unwrap().to_scalar().unwrap();
        assert_eq!(value, 0.0);
        let mean = tensor(&[1.0, 0.0, 0.0, -1.0, 0.0, 0.0], 2);
        let value: f32 = divergence(&mean, &zero).unwrap().to_scalar().unwrap();
        assert!((value - 0.5).abs() < 1e-6);
    }

    #[test]
    fn laplacian_is_the_quadratic_form() {
        let form = Laplacian::new(&[2.0, 1.0, 1.0, 3.0], &[0.5, -1.0], 0.25, &[0.1, 0.2]).unwrap();
        let value: f32 =
            form.loss(&tensor(&[1.0, 2.0], 1), &tensor(&[0.3, -0.1], 1)).unwrap().to_scalar().unwrap();
        let (a, b) = (0.4_f32, 0.3_f32);
        let by_hand = 1e6 * (2.0 * a * a + 2.0 * a * b + 3.0 * b * b + 0.5 * a - b + 0.25);
        assert!((value / by_hand - 1.0).abs() < 1e-5, "{value} {by_hand}");
    }
}
