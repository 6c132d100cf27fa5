//! Files on the disk: read whole if they are of a sensible size, written whole or not at all.

mod read;
mod write;

pub(super) use read::read;
pub use write::write_atomic;
pub(super) use write::write_pair;
