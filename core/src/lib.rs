//! Conditional human bodies from tape measures.

pub mod condition;
mod error;
pub mod measure;
pub mod mesh;
pub mod random;

pub use error::{Error, Result};
