//! Files on disk: read completely up to a size limit, written completely or not at all.

mod read;
mod write;

pub(super) use read::read;
pub use write::write_atomic;
pub(super) use write::write_pair;
