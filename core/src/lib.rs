//! Conditional human bodies from tape measures.

mod error;
pub mod export;
pub mod import;
pub mod measure;
pub mod rig;

pub use error::{Error, Result};
