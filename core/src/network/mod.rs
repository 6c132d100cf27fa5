//! The networks: what they are built of, how large they are, and how they are evaluated. The paper's 05_02 and 05_03.

pub mod config;
pub mod fourier;
#[expect(clippy::module_inception, reason = "the file of the type of that name")]
mod network;

pub use network::*;
