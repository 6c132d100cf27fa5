//! From bodies to the network's inputs: standardised and encoded conditions, the linear skip, scaled residuals.

use anthronet::measure::MEASURE_COUNT;
use anthronet::network::config::{CONDITION_COUNT, GeneratorConfig};
use anthronet::network::fourier::Fourier;
use candle_core::{Device, Tensor};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use rayon::prelude::*;

use super::TrainingSet;
use crate::{Error, Result};

/// Everything that is fitted in closed form on the training set before the first step.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    pub(crate) measure_mean: [f64; MEASURE_COUNT],
    pub(crate) measure_std: [f64; MEASURE_COUNT],
    /// `(37, K)`; zero without a skip.
    pub(crate) skip_weight: Vec<f64>,
    /// `(K)`, metres: the mean coefficients.
    pub(crate) skip_bias: Vec<f64>,
    /// Metres per unit of the network's output, `(K)`.
    pub(crate) scale: Vec<f64>,
    /// The leading principal components of the scaled residual, `(K, latent)`, and the deviation along each.
    pub(crate) components: Vec<f64>,
    pub(crate) component_std: Vec<f64>,
    fourier: Fourier,
    k: usize,
    skip: bool,
}

/// A set of bodies as inputs and targets of the network.
#[derive(Debug)]
pub(crate) struct NetworkData {
    pub(crate) count: usize,
    /// Scaled residuals `(count, K)`: input of the mesh encoder and target of the decoder.
    residuals: Vec<f32>,
    /// Encoded conditions `(count, 37 · 2f)`.
    conditions: Vec<f32>,
    /// What the skip explains, `(count, K)`, metres; only where the Laplacian loss needs it.
    offsets: Option<Vec<f32>>,
    k: usize,
    width: usize,
}

/// Some rows of a [`NetworkData`] set as tensors.
pub(crate) struct Batch {
    pub(crate) residuals: Tensor,
    pub(crate) conditions: Tensor,
    pub(crate) offsets: Option<Tensor>,
}

impl Frame {
    /// Fits the frame to the training set.
    pub(crate) fn fit(set: &TrainingSet, config: &GeneratorConfig) -> Result<Self> {
        let k = config.coefficients;
        if k != set.k {
            return Err(Error::Invalid(format!(
                "the configuration has {k} coefficients, the set has {}",
                set.k
            )));
        }
        let (measure_mean, measure_std) = measure_statistics(set)?;
        let mut frame = Self {
            measure_mean,
            measure_std,
            skip_weight: vec![0.0; CONDITION_COUNT * k],
            skip_bias: column_means(&set.coefficients, k),
            scale: vec![1.0; k],
            components: Vec::new(),
            component_std: Vec::new(),
            fourier: Fourier::new(&config.fourier, CONDITION_COUNT)?,
            k,
            skip: config.skip,
        };
        if config.skip {
            frame.fit_skip(set)?;
        }
        // The residual's statistics are smooth: a fifth of a large set is plenty.
        let sample: Vec<usize> = (0..set.count).step_by((set.count / 20_000).max(1)).collect();
        let residuals: Vec<f64> = sample.iter().flat_map(|&i| frame.residual(set, i)).collect();
        let rows = sample.len() as f64;
        let mut deviation = vec![0.0; k];
        for row in residuals.chunks_exact(k) {
            for (d, r) in deviation.iter_mut().zip(row) {
                *d += r * r / rows;
            }
        }
        deviation.iter_mut().for_each(|d| *d = d.sqrt());
        let largest = deviation.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 {
            return Err(Error::Invalid("the condition explains every body exactly: nothing to learn".into()));
        }
        for (s, d) in frame.scale.iter_mut().zip(&deviation) {
            *s = largest * libm::pow((d / largest).max(1e-6), config.scale_power);
        }
        if config.latent_skip {
            frame.fit_components(&residuals, config.latent);
        }
        Ok(frame)
    }

    /// The 37 numbers of a sample's condition.
    pub(crate) fn condition(&self, set: &TrainingSet, i: usize) -> [f64; CONDITION_COUNT] {
        let measures = &set.measures[i * MEASURE_COUNT..(i + 1) * MEASURE_COUNT];
        std::array::from_fn(|j| {
            if j < MEASURE_COUNT {
                (f64::from(measures[j]) - self.measure_mean[j]) / self.measure_std[j]
            } else if set.sex[i] == 0 {
                -1.0
            } else {
                1.0
            }
        })
    }

    /// What the skip predicts, metres.
    fn offset(&self, set: &TrainingSet, i: usize) -> Vec<f64> {
        let mut out = self.skip_bias.clone();
        if self.skip {
            for (x, row) in self.condition(set, i).iter().zip(self.skip_weight.chunks_exact(self.k)) {
                for (o, w) in out.iter_mut().zip(row) {
                    *o += x * w;
                }
            }
        }
        out
    }

    /// The residual of the skip, metres.
    fn residual(&self, set: &TrainingSet, i: usize) -> Vec<f64> {
        let coefficients = &set.coefficients[i * self.k..(i + 1) * self.k];
        coefficients.iter().zip(self.offset(set, i)).map(|(&c, o)| f64::from(c) - o).collect()
    }

    /// A set of bodies as inputs and targets of the network.
    pub(crate) fn prepare(&self, set: &TrainingSet, offsets: bool) -> NetworkData {
        let (k, width) = (self.k, self.fourier.output_len());
        let mut residuals = vec![0.0; set.count * k];
        let mut conditions = vec![0.0; set.count * width];
        residuals.par_chunks_mut(k).zip(conditions.par_chunks_mut(width)).enumerate().for_each(
            |(i, (r, c))| {
                for ((r, v), s) in r.iter_mut().zip(self.residual(set, i)).zip(&self.scale) {
                    *r = (v / s) as f32;
                }
                let mut encoded = Vec::with_capacity(width);
                self.fourier.encode(&self.condition(set, i), &mut encoded);
                for (c, v) in c.iter_mut().zip(encoded) {
                    *c = v as f32;
                }
            },
        );
        let offsets = offsets.then(|| {
            let mut all = vec![0.0; set.count * k];
            all.par_chunks_mut(k).enumerate().for_each(|(i, row)| {
                for (o, v) in row.iter_mut().zip(self.offset(set, i)) {
                    *o = v as f32;
                }
            });
            all
        });
        NetworkData { count: set.count, residuals, conditions, offsets, k, width }
    }

    /// Least squares from the condition to the coefficients, by normal equations in f64.
    fn fit_skip(&mut self, set: &TrainingSet) -> Result<()> {
        const N: usize = CONDITION_COUNT;
        let k = self.k;
        let mut gram = Mat::<f64>::zeros(N, N);
        let mut right = vec![0.0; N * k];
        let mut mean = [0.0; N];
        for i in 0..set.count {
            for (m, x) in mean.iter_mut().zip(self.condition(set, i)) {
                *m += x / set.count as f64;
            }
        }
        for i in 0..set.count {
            let x = self.condition(set, i);
            let c = &set.coefficients[i * k..(i + 1) * k];
            for a in 0..N {
                let xa = x[a] - mean[a];
                for b in 0..N {
                    gram[(a, b)] += xa * (x[b] - mean[b]);
                }
                for (r, &c) in right[a * k..(a + 1) * k].iter_mut().zip(c) {
                    *r += xa * f64::from(c);
                }
            }
        }
        // Keeps a constant measure (or a single sex) from making the system singular; far below the noise.
        let ridge = 1e-10 * set.count as f64;
        for a in 0..N {
            gram[(a, a)] += ridge;
        }
        let weight = gram
            .llt(Side::Lower)
            .map_err(|e| Error::Invalid(format!("linear skip: normal equations: {e:?}")))?
            .solve(Mat::from_fn(N, k, |a, j| right[a * k + j]));
        self.skip_weight = (0..N).flat_map(|a| (0..k).map(move |j| (a, j))).map(|at| weight[at]).collect();
        for (row, m) in self.skip_weight.chunks_exact(k).zip(mean) {
            for (bias, w) in self.skip_bias.iter_mut().zip(row) {
                *bias -= m * w;
            }
        }
        Ok(())
    }

    /// Principal components of the residual by orthogonal iteration, in the scaled coordinates of the network.
    fn fit_components(&mut self, residuals: &[f64], latent: usize) {
        let k = self.k;
        let rows = residuals.len() / k;
        let mut covariance = vec![0.0; k * k];
        covariance.par_chunks_mut(k).enumerate().for_each(|(a, out)| {
            for row in residuals.chunks_exact(k) {
                let v = row[a] / rows as f64;
                for (o, r) in out.iter_mut().zip(row) {
                    *o += v * r;
                }
            }
        });
        // Rows are the components; start from the coefficients that vary most.
        let mut order: Vec<usize> = (0..k).collect();
        order.sort_by(|&a, &b| covariance[b * k + b].total_cmp(&covariance[a * k + a]));
        let count = latent.min(k);
        let mut basis = vec![0.0; count * k];
        for (row, &at) in basis.chunks_exact_mut(k).zip(&order) {
            row[at] = 1.0;
        }
        let mut values = vec![0.0_f64; count];
        for _ in 0..200 {
            let mut next = vec![0.0; count * k];
            for (to, from) in next.chunks_exact_mut(k).zip(basis.chunks_exact(k)) {
                for (f, row) in from.iter().zip(covariance.chunks_exact(k)) {
                    for (t, c) in to.iter_mut().zip(row) {
                        *t += f * c;
                    }
                }
            }
            for (i, value) in values.iter_mut().enumerate() {
                let (done, rest) = next.split_at_mut(i * k);
                let row = &mut rest[..k];
                for other in done.chunks_exact(k) {
                    let dot: f64 = row.iter().zip(other).map(|(a, b)| a * b).sum();
                    row.iter_mut().zip(other).for_each(|(a, b)| *a -= dot * b);
                }
                let norm = row.iter().map(|v| v * v).sum::<f64>().sqrt();
                *value = norm;
                row.iter_mut().for_each(|v| *v /= norm.max(1e-300));
            }
            basis = next;
        }
        // In scaled coordinates r/s, the component's score is Σ s u (r/s) and it moves r/s by u/s.
        self.components = vec![0.0; k * latent];
        self.component_std = vec![0.0; latent];
        for (l, row) in basis.chunks_exact(k).enumerate() {
            self.component_std[l] = values[l].sqrt();
            for (i, v) in row.iter().enumerate() {
                self.components[i * latent + l] = *v;
            }
        }
    }
}

impl NetworkData {
    /// The given rows, in that order.
    pub(crate) fn batch(&self, rows: &[usize]) -> candle_core::Result<Batch> {
        let gather = |from: &[f32], width: usize| {
            let mut out = Vec::with_capacity(rows.len() * width);
            for &i in rows {
                out.extend_from_slice(&from[i * width..(i + 1) * width]);
            }
            Tensor::from_vec(out, (rows.len(), width), &Device::Cpu)
        };
        Ok(Batch {
            residuals: gather(&self.residuals, self.k)?,
            conditions: gather(&self.conditions, self.width)?,
            offsets: self.offsets.as_ref().map(|o| gather(o, self.k)).transpose()?,
        })
    }

    /// One row of scaled residuals.
    pub(crate) fn residual(&self, i: usize) -> &[f32] {
        &self.residuals[i * self.k..(i + 1) * self.k]
    }
}

fn measure_statistics(set: &TrainingSet) -> Result<([f64; MEASURE_COUNT], [f64; MEASURE_COUNT])> {
    let mean: [f64; MEASURE_COUNT] = column_means(&set.measures, MEASURE_COUNT)
        .try_into()
        .map_err(|_| Error::Invalid(format!("measures: expected {MEASURE_COUNT} columns")))?;
    let mut std = [0.0; MEASURE_COUNT];
    for row in set.measures.chunks_exact(MEASURE_COUNT) {
        for j in 0..MEASURE_COUNT {
            std[j] += (f64::from(row[j]) - mean[j]).powi(2) / set.count as f64;
        }
    }
    // A constant measure carries no information; any deviation will do.
    std.iter_mut().for_each(|s| *s = if *s > 1e-12 { s.sqrt() } else { 1.0 });
    Ok((mean, std))
}

fn column_means(values: &[f32], columns: usize) -> Vec<f64> {
    let rows = (values.len() / columns).max(1) as f64;
    let mut mean = vec![0.0; columns];
    for row in values.chunks_exact(columns) {
        for (m, &v) in mean.iter_mut().zip(row) {
            *m += f64::from(v);
        }
    }
    mean.iter_mut().for_each(|m| *m /= rows);
    mean
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generator::synthetic::synthetic_set;

    #[test]
    fn the_skip_leaves_nothing_that_is_linear() {
        let set = synthetic_set(600, 12, 1);
        let config = GeneratorConfig { coefficients: 12, ..GeneratorConfig::default() };
        let frame = Frame::fit(&set, &config).unwrap();
        let largest = set.coefficients.iter().fold(0.0_f32, |a, b| a.max(b.abs()));
        for j in 0..CONDITION_COUNT {
            let mut dot = [0.0; 12];
            for i in 0..set.count {
                for (d, r) in dot.iter_mut().zip(frame.residual(&set, i)) {
                    *d += frame.condition(&set, i)[j] * r / set.count as f64;
                }
            }
            assert!(dot.iter().all(|d| d.abs() < 1e-6 * f64::from(largest)), "{j} {dot:?}");
        }
    }
}
