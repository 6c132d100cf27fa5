//! The generator's networks, the paper's 05_02 and 05_03: how large they are, what they are built of, and how they are
//! evaluated: plain loops over stored weights, batch norm already folded in (paper sections 5.3 and 9.1).
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
