//! Makes the model.

mod checkpoint;
pub mod generator;
mod losses;
mod progress;
pub mod training;

mod error;
pub use error::{Error, Result};
