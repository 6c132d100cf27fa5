//! From a trained network to the arrays of `anthronet::network`: batch norm and units folded in.

use anthronet::network::config::{CONDITION_COUNT, GeneratorConfig};
use anthronet::network::{Decoder, Encoder, Tensor, Tensors};

use super::data::Frame;
use super::network::{Block, Network};
use super::ops::{EPSILON, values};
use crate::Result;

/// The arrays, checked to load. Inputs and outputs of the exported network are metres.
pub(crate) fn export(network: &Network, frame: &Frame, config: &GeneratorConfig) -> Result<Tensors> {
    let mut out = Tensors::new();
    let mut put = |name: String, shape: &[usize], data: Vec<f64>| {
        let data = data.into_iter().map(|v| v as f32).collect();
        out.insert(name, Tensor { shape: shape.to_vec(), data });
    };
    let (k, latent) = (config.coefficients, config.latent);
    for block in network.blocks() {
        let (mut weight, mut bias) = folded(block)?;
        let (inputs, outputs) = block.weight.dims2()?;
        if block.name == "mesh" {
            // The network saw (c − offset) / scale; with a skip the exported one is given c − offset.
            for (row, s) in weight.chunks_exact_mut(outputs).zip(&frame.scale) {
                row.iter_mut().for_each(|w| *w /= s);
            }
            if !config.skip {
                for (row, mean) in weight.chunks_exact(outputs).zip(&frame.skip_bias) {
                    bias.iter_mut().zip(row).for_each(|(b, w)| *b -= mean * w);
                }
            }
        }
        put(format!("{}.weight", block.name), &[inputs, outputs], weight);
        put(format!("{}.bias", block.name), &[outputs], bias);
        put(format!("{}.slope", block.name), &[outputs], widen(&values(&block.slope)?));
    }
    let mut mean_bias = widen(&values(&network.latent_mean.bias)?);
    if let Some((mesh, from_latent)) = &network.latent_skip {
        let mut to = widen(&values(mesh)?);
        for (row, s) in to.chunks_exact_mut(latent).zip(&frame.scale) {
            row.iter_mut().for_each(|w| *w /= s);
        }
        if !config.skip {
            for (row, mean) in to.chunks_exact(latent).zip(&frame.skip_bias) {
                mean_bias.iter_mut().zip(row).for_each(|(b, w)| *b -= mean * w);
            }
        }
        put("latent_mean.mesh".into(), &[k, latent], to);
        put("output.latent".into(), &[latent, k], scaled(&values(from_latent)?, &frame.scale));
    }
    let [mean, log_variance, output] = network.layers();
    put("latent_mean.weight".into(), mean.weight.dims(), widen(&values(&mean.weight)?));
    put("latent_mean.bias".into(), &[latent], mean_bias);
    put("latent_log_variance.weight".into(), mean.weight.dims(), widen(&values(&log_variance.weight)?));
    put("latent_log_variance.bias".into(), &[latent], widen(&values(&log_variance.bias)?));
    let mut bias = scaled(&values(&output.bias)?, &frame.scale);
    if config.skip {
        put("skip.weight".into(), &[CONDITION_COUNT, k], frame.skip_weight.clone());
        put("skip.bias".into(), &[k], frame.skip_bias.clone());
    } else {
        bias.iter_mut().zip(&frame.skip_bias).for_each(|(b, mean)| *b += mean);
    }
    put("output.weight".into(), output.weight.dims(), scaled(&values(&output.weight)?, &frame.scale));
    put("output.bias".into(), &[k], bias);
    Decoder::from_tensors(config, &out)?;
    Encoder::from_tensors(config, &out)?;
    Ok(out)
}

fn widen(values: &[f32]) -> Vec<f64> {
    values.iter().map(|&v| f64::from(v)).collect()
}

/// Columns times their scales.
fn scaled(values: &[f32], scale: &[f64]) -> Vec<f64> {
    values
        .chunks_exact(scale.len())
        .flat_map(|row| row.iter().zip(scale).map(|(&v, s)| f64::from(v) * s))
        .collect()
}

/// Weight and bias of a block with its batch norm folded in.
fn folded(block: &Block) -> Result<(Vec<f64>, Vec<f64>)> {
    let scale = values(&block.norm_scale)?;
    let shift = values(&block.norm_shift)?;
    let factor: Vec<f64> = scale
        .iter()
        .zip(&block.running_variance)
        .map(|(&s, &v)| f64::from(s) / f64::from(v + EPSILON).sqrt())
        .collect();
    let bias = shift
        .iter()
        .zip(&block.running_mean)
        .zip(&factor)
        .map(|((&b, &m), f)| f64::from(b) - f64::from(m) * f);
    let bias = bias.collect();
    Ok((scaled(&values(&block.weight)?, &factor), bias))
}
