//! The generator's networks (paper sections 5.3 and 9.1): configuration, layers and inference, with batch norm folded
//! into the stored weights.
//!
//! Weights are f32. Sums are f64 in a fixed order, vectorised over outputs and never over the summed index, so a result
//! has the same bits on every machine. A weight matrix W has shape `(inputs, outputs)`, row-major, and acts on row vectors:
//! `y = x W + b`. In the diagram A are the standardised measures, c the shape coefficients:
//!
//! ```text
//! A, sex ─ Fourier ─ condition ─┬──────────────── h_a ─────────────┐
//! c ─ mesh ── h_v ─ [h_v, h_a] ─ fusion.0 ─ fusion.1 ─ μ, log σ²   │
//! z ───────────────────────────── [z, h_a] ─ decoder.0 … decoder.2 ─ output ─ (+) ─ c
//! A, sex ─────────────────────────────── skip ─────────────────────────────────┘
//! ```

mod condition;
pub mod config;
mod decoder;
mod dense;
mod encoder;
pub mod fourier;
mod tensor;
#[cfg(test)]
mod tests;

pub use condition::condition_vector;
pub use decoder::{Decoder, decoder_shapes};
pub use encoder::{Encoder, encoder_shapes};
pub use tensor::{Shapes, Tensor, Tensors};
