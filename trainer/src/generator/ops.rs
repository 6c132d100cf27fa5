//! Fused operations for training on the CPU: batch normalisation over a batch, and per-channel scale, shift
//! and parametric ReLU. candle has both as chains of elementwise operations; fused they cost a fifth.
//!
//! Rows are handled in fixed chunks whose partial sums are added in order, so that the result does not depend
//! on the number of threads.

use std::sync::{Arc, Mutex, PoisonError};

use candle_core::{CpuStorage, CustomOp1, CustomOp2, Device, Layout, Result, Shape, Tensor, bail};
use rayon::prelude::*;

/// Rows per unit of work.
const CHUNK: usize = 32;

/// Added to the variance, as in every batch norm.
pub(crate) const EPSILON: f32 = 1e-5;

/// The elements of a contiguous f32 storage.
pub(crate) fn slice<'a>(storage: &'a CpuStorage, layout: &Layout) -> Result<&'a [f32]> {
    let Some((from, to)) = layout.contiguous_offsets() else { bail!("expected a contiguous tensor") };
    Ok(&storage.as_slice::<f32>()?[from..to])
}

/// The values of a tensor, copied.
pub(crate) fn values(tensor: &Tensor) -> Result<Vec<f32>> {
    tensor.flatten_all()?.to_vec1::<f32>()
}

/// Runs `f` on the values of a tensor without copying when it is contiguous.
fn with_values<R>(tensor: &Tensor, f: impl FnOnce(&[f32]) -> R) -> Result<R> {
    let tensor = tensor.contiguous()?;
    let (storage, layout) = tensor.storage_and_layout();
    match &*storage {
        candle_core::Storage::Cpu(cpu) => Ok(f(slice(cpu, layout)?)),
        _ => bail!("expected a tensor on the CPU"),
    }
}

/// `f` of every pair of numbers of two tensors of one shape, on the caller's thread.
pub(crate) fn combine(a: &Tensor, b: &Tensor, f: impl Fn(f32, f32) -> f32) -> Result<Tensor> {
    if a.shape() != b.shape() {
        bail!("expected two tensors of one shape, got {:?} and {:?}", a.shape(), b.shape());
    }
    let out = with_values(a, |a| {
        with_values(b, |b| a.iter().zip(b).map(|(&a, &b)| f(a, b)).collect::<Vec<f32>>())
    })??;
    Tensor::from_vec(out, a.shape(), &Device::Cpu)
}

fn rows_and_columns(layout: &Layout) -> Result<(usize, usize)> {
    layout.shape().dims2()
}

/// Sums `f(row values)` into a vector of `width` numbers, over all rows, in a fixed order.
fn sum_rows(rows: usize, width: usize, f: impl Fn(usize, &mut [f32]) + Sync) -> Vec<f32> {
    let partial: Vec<Vec<f32>> = (0..rows.div_ceil(CHUNK))
        .into_par_iter()
        .map(|chunk| {
            let mut sum = vec![0.0; width];
            for row in chunk * CHUNK..rows.min((chunk + 1) * CHUNK) {
                f(row, &mut sum);
            }
            sum
        })
        .collect();
    let mut total = vec![0.0; width];
    for part in partial {
        for (t, p) in total.iter_mut().zip(part) {
            *t += p;
        }
    }
    total
}

/// Mean and variance of every column of the last batch.
#[derive(Debug, Default)]
pub(crate) struct BatchStatistics {
    pub(crate) mean: Vec<f32>,
    /// Biased: divided by the number of rows.
    pub(crate) variance: Vec<f32>,
}

/// `(rows, columns)` → the same with every column at mean 0 and variance 1; gradients flow through the
/// statistics. Ioffe and Szegedy, "Batch normalization", 2015.
#[derive(Debug, Default)]
pub(crate) struct Normalise {
    /// Filled by the forward pass.
    pub(crate) statistics: Arc<Mutex<BatchStatistics>>,
}

impl CustomOp1 for Normalise {
    fn name(&self) -> &'static str {
        "normalise"
    }

    fn cpu_fwd(&self, storage: &CpuStorage, layout: &Layout) -> Result<(CpuStorage, Shape)> {
        let (rows, columns) = rows_and_columns(layout)?;
        let x = slice(storage, layout)?;
        let count = rows as f32;
        let row_of = |row: usize| &x[row * columns..(row + 1) * columns];
        let mut mean = sum_rows(rows, columns, |row, sum| {
            for (s, v) in sum.iter_mut().zip(row_of(row)) {
                *s += v;
            }
        });
        mean.iter_mut().for_each(|m| *m /= count);
        let mut variance = sum_rows(rows, columns, |row, sum| {
            for ((s, v), m) in sum.iter_mut().zip(row_of(row)).zip(&mean) {
                *s += (v - m) * (v - m);
            }
        });
        variance.iter_mut().for_each(|v| *v /= count);
        let inverse: Vec<f32> = variance.iter().map(|v| 1.0 / (v + EPSILON).sqrt()).collect();
        let mut out = vec![0.0; rows * columns];
        out.par_chunks_mut(CHUNK * columns).zip(x.par_chunks(CHUNK * columns)).for_each(|(to, from)| {
            for (to, from) in to.chunks_exact_mut(columns).zip(from.chunks_exact(columns)) {
                for (((o, v), m), i) in to.iter_mut().zip(from).zip(&mean).zip(&inverse) {
                    *o = (v - m) * i;
                }
            }
        });
        *self.statistics.lock().unwrap_or_else(PoisonError::into_inner) = BatchStatistics { mean, variance };
        Ok((CpuStorage::F32(out), layout.shape().clone()))
    }

    fn bwd(&self, arg: &Tensor, result: &Tensor, gradient: &Tensor) -> Result<Option<Tensor>> {
        let (rows, columns) = arg.dims2()?;
        let statistics = self.statistics.lock().unwrap_or_else(PoisonError::into_inner);
        let inverse: Vec<f32> = statistics.variance.iter().map(|v| 1.0 / (v + EPSILON).sqrt()).collect();
        let out = with_values(gradient, |g| {
            with_values(result, |y| {
                // Column means of g and of g·y, side by side.
                let mut sums = sum_rows(rows, 2 * columns, |row, sum| {
                    let (sum_g, sum_gy) = sum.split_at_mut(columns);
                    let at = row * columns..(row + 1) * columns;
                    for (((a, b), g), y) in sum_g.iter_mut().zip(sum_gy).zip(&g[at.clone()]).zip(&y[at]) {
                        *a += g;
                        *b += g * y;
                    }
                });
                sums.iter_mut().for_each(|s| *s /= rows as f32);
                let (mean_g, mean_gy) = sums.split_at(columns);
                let mut out = vec![0.0; rows * columns];
                let size = CHUNK * columns;
                let work = out.par_chunks_mut(size).zip(g.par_chunks(size)).zip(y.par_chunks(size));
                work.for_each(|((out, g), y)| {
                    let rows = out.chunks_exact_mut(columns).zip(g.chunks_exact(columns));
                    for ((out, g), y) in rows.zip(y.chunks_exact(columns)) {
                        let (out, g, y) = (&mut out[..columns], &g[..columns], &y[..columns]);
                        let (mean_g, mean_gy) = (&mean_g[..columns], &mean_gy[..columns]);
                        let inverse = &inverse[..columns];
                        for c in 0..columns {
                            out[c] = inverse[c] * (g[c] - mean_g[c] - y[c] * mean_gy[c]);
                        }
                    }
                });
                out
            })
        })??;
        Ok(Some(Tensor::from_vec(out, (rows, columns), &Device::Cpu)?))
    }
}

/// `x (rows, columns)`, `p (3, columns)` = scale, shift, slope → `u = x · scale + shift`, then `u` where positive
/// and `u · slope` elsewhere (He et al., "Delving deep into rectifiers", 2015).
#[derive(Debug)]
pub(crate) struct ScaleShiftPrelu;

impl CustomOp2 for ScaleShiftPrelu {
    fn name(&self) -> &'static str {
        "scale-shift-prelu"
    }

    fn cpu_fwd(
        &self,
        s1: &CpuStorage,
        l1: &Layout,
        s2: &CpuStorage,
        l2: &Layout,
    ) -> Result<(CpuStorage, Shape)> {
        let (rows, columns) = rows_and_columns(l1)?;
        let x = slice(s1, l1)?;
        let p = slice(s2, l2)?;
        if p.len() != 3 * columns {
            bail!("expected parameters (3, {columns}), got {:?}", l2.shape());
        }
        let (scale, shift, slope) = (&p[..columns], &p[columns..2 * columns], &p[2 * columns..]);
        let mut out = vec![0.0; rows * columns];
        out.par_chunks_mut(CHUNK * columns).zip(x.par_chunks(CHUNK * columns)).for_each(|(out, x)| {
            for (out, x) in out.chunks_exact_mut(columns).zip(x.chunks_exact(columns)) {
                // Slices of one visible length lose their bounds checks, and the loop becomes vector code.
                let (scale, shift, slope) = (&scale[..columns], &shift[..columns], &slope[..columns]);
                let (out, x) = (&mut out[..columns], &x[..columns]);
                for c in 0..columns {
                    let u = x[c] * scale[c] + shift[c];
                    out[c] = u.max(0.0) + u.min(0.0) * slope[c];
                }
            }
        });
        Ok((CpuStorage::F32(out), l1.shape().clone()))
    }

    fn bwd(
        &self,
        arg1: &Tensor,
        arg2: &Tensor,
        _result: &Tensor,
        gradient: &Tensor,
    ) -> Result<(Option<Tensor>, Option<Tensor>)> {
        let (rows, columns) = arg1.dims2()?;
        let p = values(arg2)?;
        let (scale, shift, slope) = (&p[..columns], &p[columns..2 * columns], &p[2 * columns..]);
        let (dx, dp) = with_values(gradient, |g| {
            with_values(arg1, |x| {
                let mut dx = vec![0.0; rows * columns];
                let size = CHUNK * columns;
                let work = dx.par_chunks_mut(size).zip(g.par_chunks(size)).zip(x.par_chunks(size));
                let partial: Vec<Vec<f32>> = work
                    .map(|((dx, g), x)| {
                        let mut sum = vec![0.0; 3 * columns];
                        let (d_scale, rest) = sum.split_at_mut(columns);
                        let (d_shift, d_slope) = rest.split_at_mut(columns);
                        let rows = dx.chunks_exact_mut(columns).zip(g.chunks_exact(columns));
                        for ((dx, g), x) in rows.zip(x.chunks_exact(columns)) {
                            prelu_backward([scale, shift, slope], x, g, dx, [d_scale, d_shift, d_slope]);
                        }
                        sum
                    })
                    .collect();
                let mut dp = vec![0.0; 3 * columns];
                for part in partial {
                    for (t, v) in dp.iter_mut().zip(part) {
                        *t += v;
                    }
                }
                (dx, dp)
            })
        })??;
        Ok((
            Some(Tensor::from_vec(dx, (rows, columns), &Device::Cpu)?),
            Some(Tensor::from_vec(dp, (3, columns), &Device::Cpu)?),
        ))
    }
}

/// One row of [`ScaleShiftPrelu`]'s backward pass. A function of its own, because only across a call does the
/// compiler know that the outputs do not overlap, without which it writes no vector code.
#[inline(never)]
fn prelu_backward(
    [scale, shift, slope]: [&[f32]; 3],
    x: &[f32],
    gradient: &[f32],
    dx: &mut [f32],
    [d_scale, d_shift, d_slope]: [&mut [f32]; 3],
) {
    let sums = d_scale.iter_mut().zip(d_shift).zip(d_slope);
    let parameters = scale.iter().zip(shift).zip(slope);
    for ((((dx, x), g), ((a, b), c)), ((p, q), r)) in
        dx.iter_mut().zip(x).zip(gradient).zip(sums).zip(parameters)
    {
        let u = x * p + q;
        let du = g * if u > 0.0 { 1.0 } else { *r };
        *a += du * x;
        *b += du;
        *c += g * u.min(0.0);
        *dx = du * p;
    }
}

#[cfg(test)]
mod tests {
    use candle_core::Var;

    use super::*;

    fn wave(rows: usize, columns: usize, seed: f64) -> Tensor {
        let data = (0..rows * columns).map(|i| ((i as f64 * 0.7 + seed).sin() * 1.3 + 0.1) as f32).collect();
        Tensor::from_vec(data, (rows, columns), &Device::Cpu).unwrap()
    }

    fn largest_difference(a: &Tensor, b: &Tensor) -> f32 {
        (a - b).unwrap().abs().unwrap().max_all().unwrap().to_scalar().unwrap()
    }

    #[test]
    fn block_agrees_with_candle() {
        let (rows, columns) = (70, 5);
        let x = Var::from_tensor(&wave(rows, columns, 0.3)).unwrap();
        let p = Var::from_tensor(&wave(3, columns, 2.0)).unwrap();
        let mix = wave(rows, columns, 5.0);
        let fused = x.apply_op1(Normalise::default()).unwrap().apply_op2(&p, ScaleShiftPrelu).unwrap();
        let mean = x.mean_keepdim(0).unwrap();
        let centred = x.broadcast_sub(&mean).unwrap();
        let variance = centred.sqr().unwrap().mean_keepdim(0).unwrap();
        let unit = centred.broadcast_div(&(variance + f64::from(EPSILON)).unwrap().sqrt().unwrap()).unwrap();
        let scaled = unit.broadcast_mul(&p.narrow(0, 0, 1).unwrap()).unwrap();
        let u = scaled.broadcast_add(&p.narrow(0, 1, 1).unwrap()).unwrap();
        let negative = (u.neg().unwrap().relu().unwrap()).neg().unwrap();
        let chain =
            (u.relu().unwrap() + negative.broadcast_mul(&p.narrow(0, 2, 1).unwrap()).unwrap()).unwrap();
        // f32 rounding of sums over 70 rows.
        assert!(largest_difference(&fused, &chain) < 1e-5);
        let a = (fused * &mix).unwrap().sum_all().unwrap().backward().unwrap();
        let b = (chain * &mix).unwrap().sum_all().unwrap().backward().unwrap();
        assert!(largest_difference(a.get(&x).unwrap(), b.get(&x).unwrap()) < 1e-4);
        assert!(largest_difference(a.get(&p).unwrap(), b.get(&p).unwrap()) < 1e-4);
    }
}
