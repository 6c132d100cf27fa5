//! Conditional human bodies from tape measures.

mod error;
pub mod measure;

pub use error::{Error, Result};
