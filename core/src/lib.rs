//! Conditional human bodies from tape measures.

mod body;
pub mod clip;
pub mod condition;
mod error;
pub mod export;
pub mod import;
mod input;
pub mod measure;
pub mod mesh;
pub mod model;
pub mod pose;
pub mod random;
pub mod rig;
pub mod skin;
pub mod space;

pub use body::Body;
pub use error::{Error, Result};
