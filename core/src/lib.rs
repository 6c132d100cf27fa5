//! Conditional human bodies from tape measures.

mod error;
pub mod measure;
pub mod mesh;

pub use error::{Error, Result};
