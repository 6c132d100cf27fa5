//! Conditional human bodies from tape measures.

pub mod condition;
mod error;
pub mod measure;
pub mod mesh;
pub mod random;
pub mod model;

pub use error::{Error, Result};
