//! Wavefront OBJ.

pub(crate) mod read;
pub(crate) mod write;

pub use read::from_bytes;
pub use write::to_obj;
