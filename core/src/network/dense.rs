//! The layers of the networks: the fully connected layer, and the paper's core block around one.

use super::tensor::{Shapes, Tensors, take};
use crate::Result;

pub(super) fn dense_shapes(shapes: &mut Shapes, name: &str, inputs: usize, outputs: usize) {
    shapes.insert(format!("{name}.weight"), vec![inputs, outputs]);
    shapes.insert(format!("{name}.bias"), vec![outputs]);
}

pub(super) fn block_shapes(shapes: &mut Shapes, name: &str, inputs: usize, outputs: usize) {
    dense_shapes(shapes, name, inputs, outputs);
    shapes.insert(format!("{name}.slope"), vec![outputs]);
}

/// A fully connected layer.
#[derive(Clone, Debug)]
pub(super) struct Dense {
    pub(super) outputs: usize,
    /// Shape `(inputs, outputs)`.
    pub(super) weight: Vec<f32>,
    bias: Vec<f32>,
}

impl Dense {
    pub(super) fn take(tensors: &Tensors, shapes: &Shapes, name: &str) -> Result<Self> {
        let weight = take(tensors, shapes, &format!("{name}.weight"))?;
        let bias = take(tensors, shapes, &format!("{name}.bias"))?;
        Ok(Self { outputs: bias.len(), weight, bias })
    }

    pub(super) fn forward(&self, input: &[f64]) -> Vec<f64> {
        let mut out: Vec<f64> = self.bias.iter().map(|&b| f64::from(b)).collect();
        add_product(input, &self.weight, &mut out);
        out
    }

    /// Maps tangents of the input, `rows × inputs`, to those of the output, `rows × outputs` (forward mode).
    pub(super) fn tangents(&self, input: &[f64], rows: usize) -> Vec<f64> {
        let inputs = self.weight.len() / self.outputs;
        let mut out = vec![0.0; rows * self.outputs];
        for (x, y) in input.chunks_exact(inputs).zip(out.chunks_exact_mut(self.outputs)) {
            add_product(x, &self.weight, y);
        }
        out
    }
}

/// `out += x W`, with W of shape `(x.len(), out.len())`. Takes four rows of W at a time, so that `out` is read and
/// written a quarter as often; each output still adds its terms in the order of x.
pub(super) fn add_product(x: &[f64], weight: &[f32], out: &mut [f64]) {
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

/// The paper's core block (section 5.3): fully connected layer with batch norm folded in, and parametric ReLU with a slope
/// per output.
#[derive(Clone, Debug)]
pub(super) struct Block {
    pub(super) dense: Dense,
    slope: Vec<f32>,
}

impl Block {
    pub(super) fn take(tensors: &Tensors, shapes: &Shapes, name: &str) -> Result<Self> {
        let slope = take(tensors, shapes, &format!("{name}.slope"))?;
        Ok(Self { dense: Dense::take(tensors, shapes, name)?, slope })
    }

    pub(super) fn forward(&self, input: &[f64]) -> Vec<f64> {
        let mut out = self.dense.forward(input);
        for (y, &s) in out.iter_mut().zip(&self.slope) {
            if *y < 0.0 {
                *y *= f64::from(s);
            }
        }
        out
    }

    /// The block's output, and tangents of the input (`rows × inputs`) mapped through its Jacobian to `rows × outputs`.
    pub(super) fn forward_with_tangents(
        &self,
        input: &[f64],
        tangents: &[f64],
        rows: usize,
    ) -> (Vec<f64>, Vec<f64>) {
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
