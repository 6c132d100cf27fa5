//! The generator's networks for use: plain loops over stored weights, batch norm already folded in
//! (paper sections 5.3 and 9.1).
//!
//! Weights are f32, sums are f64 in a fixed order, vectorised over outputs and never over the summed index,
//! so a result has the same bits on every machine. A weight matrix has shape `(inputs, outputs)`: `y = x W + b`.
//!
//! ```text
//! A, sex ─ Fourier ─ condition ─┬──────────────── h_a ─────────────┐
//! c ─ mesh ── h_v ─ [h_v, h_a] ─ fusion.0 ─ fusion.1 ─ μ, log σ²   │
//! z ───────────────────────────── [z, h_a] ─ decoder.0 … decoder.2 ─ output ─ (+) ─ c
//! A, sex ─────────────────────────────── skip ─────────────────────────────────┘
//! ```

use std::collections::BTreeMap;

use super::config::{CONDITION_COUNT, GeneratorConfig};
use crate::measure::{MEASURE_COUNT, Measurements, Sex};
use crate::network::fourier::Fourier;
use crate::{Error, Result};

/// A named array as stored in a model file, row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensor {
    /// Sizes, outermost first.
    pub shape: Vec<usize>,
    /// As many values as the product of the sizes.
    pub data: Vec<f32>,
}

/// Arrays by name.
pub type Tensors = BTreeMap<String, Tensor>;

/// Names and shapes of the arrays, in the order of the names.
pub type Shapes = BTreeMap<String, Vec<usize>>;

/// What [`Decoder::from_tensors`] reads.
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

/// What [`Encoder::from_tensors`] reads.
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

fn dense_shapes(shapes: &mut Shapes, name: &str, inputs: usize, outputs: usize) {
    shapes.insert(format!("{name}.weight"), vec![inputs, outputs]);
    shapes.insert(format!("{name}.bias"), vec![outputs]);
}

fn block_shapes(shapes: &mut Shapes, name: &str, inputs: usize, outputs: usize) {
    dense_shapes(shapes, name, inputs, outputs);
    shapes.insert(format!("{name}.slope"), vec![outputs]);
}

fn skip_shapes(shapes: &mut Shapes, config: &GeneratorConfig) {
    if config.skip {
        dense_shapes(shapes, "skip", CONDITION_COUNT, config.coefficients);
    }
}

/// Takes one array out of the set, with its shape checked.
fn take(tensors: &Tensors, shapes: &Shapes, name: &str) -> Result<Vec<f32>> {
    let bad = |message: String| Error::Model { origin: format!("tensor `{name}`"), message };
    let expected = shapes.get(name).ok_or_else(|| bad("not part of this network".into()))?;
    let tensor =
        tensors.get(name).ok_or_else(|| bad(format!("expected shape {expected:?}, it is missing")))?;
    if &tensor.shape != expected {
        return Err(bad(format!("expected shape {expected:?}, got {:?}", tensor.shape)));
    }
    let count: usize = expected.iter().product();
    if tensor.data.len() != count {
        return Err(bad(format!("expected {count} values, got {}", tensor.data.len())));
    }
    if let Some(i) = tensor.data.iter().position(|v| !v.is_finite()) {
        return Err(bad(format!("expected finite values, got {} at {i}", tensor.data[i])));
    }
    Ok(tensor.data.clone())
}

/// A fully connected layer.
#[derive(Clone, Debug)]
struct Dense {
    outputs: usize,
    /// `(inputs, outputs)`.
    weight: Vec<f32>,
    bias: Vec<f32>,
}

impl Dense {
    fn take(tensors: &Tensors, shapes: &Shapes, name: &str) -> Result<Self> {
        let weight = take(tensors, shapes, &format!("{name}.weight"))?;
        let bias = take(tensors, shapes, &format!("{name}.bias"))?;
        Ok(Self { outputs: bias.len(), weight, bias })
    }

    fn forward(&self, input: &[f64]) -> Vec<f64> {
        let mut out: Vec<f64> = self.bias.iter().map(|&b| f64::from(b)).collect();
        add_product(input, &self.weight, &mut out);
        out
    }

    /// Maps tangents, `rows × inputs`, to `rows × outputs`.
    fn tangents(&self, input: &[f64], rows: usize) -> Vec<f64> {
        let inputs = self.weight.len() / self.outputs;
        let mut out = vec![0.0; rows * self.outputs];
        for (x, y) in input.chunks_exact(inputs).zip(out.chunks_exact_mut(self.outputs)) {
            add_product(x, &self.weight, y);
        }
        out
    }
}

/// `out += x W`, with W of shape `(x.len(), out.len())`. Four rows of W at a time, so that `out` is read and
/// written a quarter as often; each output still adds its terms in the order of x.
fn add_product(x: &[f64], weight: &[f32], out: &mut [f64]) {
    let n = out.len();
    let mut rows = weight.chunks_exact(4 * n);
    let mut quads = x.chunks_exact(4);
    for (w, q) in (&mut rows).zip(&mut quads) {
        let (w0, rest) = w.split_at(n);
        let (w1, rest) = rest.split_at(n);
        let (w2, w3) = rest.split_at(n);
        for ((((o, &a), &b), &c), &d) in out.iter_mut().zip(w0).zip(w1).zip(w2).zip(w3) {
            let mut sum = *o + q[0] * f64::from(a);
            sum += q[1] * f64::from(b);
            sum += q[2] * f64::from(c);
            *o = sum + q[3] * f64::from(d);
        }
    }
    for (w, &xi) in rows.remainder().chunks_exact(n).zip(quads.remainder()) {
        for (o, &a) in out.iter_mut().zip(w) {
            *o += xi * f64::from(a);
        }
    }
}

/// The paper's core block: fully connected layer, batch norm (folded), parametric ReLU with a slope per output.
#[derive(Clone, Debug)]
struct Block {
    dense: Dense,
    slope: Vec<f32>,
}

impl Block {
    fn take(tensors: &Tensors, shapes: &Shapes, name: &str) -> Result<Self> {
        let slope = take(tensors, shapes, &format!("{name}.slope"))?;
        Ok(Self { dense: Dense::take(tensors, shapes, name)?, slope })
    }

    fn forward(&self, input: &[f64]) -> Vec<f64> {
        let mut out = self.dense.forward(input);
        for (y, &s) in out.iter_mut().zip(&self.slope) {
            if *y < 0.0 {
                *y *= f64::from(s);
            }
        }
        out
    }

    /// The block's value, and tangents (`rows × inputs`) mapped through its derivative there.
    fn forward_with_tangents(&self, input: &[f64], tangents: &[f64], rows: usize) -> (Vec<f64>, Vec<f64>) {
        let mut out = self.dense.forward(input);
        let mut moved = self.dense.tangents(tangents, rows);
        for row in moved.chunks_exact_mut(out.len()) {
            for ((t, &y), &s) in row.iter_mut().zip(&out).zip(&self.slope) {
                if y < 0.0 {
                    *t *= f64::from(s);
                }
            }
        }
        for (y, &s) in out.iter_mut().zip(&self.slope) {
            if *y < 0.0 {
                *y *= f64::from(s);
            }
        }
        (out, moved)
    }
}

/// Measures and sex → features h_a, and the linear skip, which reads the same numbers.
#[derive(Clone, Debug)]
struct Condition {
    fourier: Fourier,
    block: Block,
    skip: Option<Dense>,
}

impl Condition {
    fn take(config: &GeneratorConfig, tensors: &Tensors, shapes: &Shapes) -> Result<Self> {
        Ok(Self {
            fourier: Fourier::new(&config.fourier, CONDITION_COUNT)?,
            block: Block::take(tensors, shapes, "condition")?,
            skip: config.skip.then(|| Dense::take(tensors, shapes, "skip")).transpose()?,
        })
    }

    fn encoded(&self, condition: &[f64]) -> Vec<f64> {
        let mut encoded = Vec::with_capacity(self.fourier.output_len());
        self.fourier.encode(condition, &mut encoded);
        encoded
    }

    fn features(&self, condition: &[f64]) -> Vec<f64> {
        self.block.forward(&self.encoded(condition))
    }
}

/// The 37 numbers of the condition: the standardised measures, then −1 for female or 1 for male.
pub fn condition_vector(measures_standardised: &Measurements, sex: Sex) -> [f64; CONDITION_COUNT] {
    let mut condition = [0.0; CONDITION_COUNT];
    condition[..MEASURE_COUNT].copy_from_slice(measures_standardised);
    condition[MEASURE_COUNT] = match sex {
        Sex::Female => -1.0,
        Sex::Male => 1.0,
    };
    condition
}

/// Condition and latent vector → shape coefficients: all that generation needs.
#[derive(Clone, Debug)]
pub struct Decoder {
    latent: usize,
    condition: Condition,
    blocks: [Block; 3],
    output: Dense,
    /// `(latent, K)`.
    latent_skip: Option<Vec<f32>>,
}

impl Decoder {
    /// Builds the network from its arrays.
    ///
    /// # Errors
    /// [`Error::Invalid`] for an absurd configuration, [`Error::Model`] naming the tensor that is missing, of
    /// another shape or not finite. Tensors of other networks in the set are ignored.
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

    /// The K shape coefficients, metres, for standardised measures ((m − mean) / deviation). Of a z of another
    /// length than [`Decoder::latent_len`], what is missing counts as zero and what is over is ignored.
    pub fn decode(&self, measures_standardised: &Measurements, sex: Sex, z: &[f32]) -> Vec<f64> {
        let z: Vec<f64> = z.iter().map(|&v| f64::from(v)).collect();
        self.decode_exact(measures_standardised, sex, &z)
    }

    /// [`Decoder::decode`] with z in double precision.
    pub fn decode_exact(&self, measures_standardised: &Measurements, sex: Sex, z: &[f64]) -> Vec<f64> {
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

/// Body and condition → distribution of z: for evaluation and for finding the z of a known body.
#[derive(Clone, Debug)]
pub struct Encoder {
    condition: Condition,
    mesh: Block,
    fusion: [Block; 2],
    mean: Dense,
    log_variance: Dense,
    /// `(K, latent)`.
    mean_skip: Option<Vec<f32>>,
}

impl Encoder {
    /// Whether the set has any array that only the encoder has: generation needs none of them.
    pub fn is_in(tensors: &Tensors) -> bool {
        tensors.keys().any(|name| ["mesh.", "fusion.", "latent_"].iter().any(|own| name.starts_with(own)))
    }

    /// Builds the network from its arrays.
    ///
    /// # Errors
    /// As [`Decoder::from_tensors`].
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
        // The skip leaves to the network what it does not explain; the encoder looks at just that.
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
