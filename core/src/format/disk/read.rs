//! Reads whole files up to a size limit.

use std::{fs, path::Path};

use crate::error::Fault;
use crate::{Error, Result};

/// Largest file that is read: far above any character or motion, far below the memory of a small machine.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// Reads a regular file of at most `MAX_FILE_BYTES`.
///
/// # Errors
/// [`Error::File`] when it is larger or not a regular file, [`Error::Io`] when reading fails.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>> {
    let fault = |source| Error::Io { path: path.into(), action: "read", source };
    let metadata = fs::metadata(path).map_err(fault)?;
    if !metadata.is_file() {
        return Err(Error::file(path, Fault::unexpected("a regular file", "a folder or a device")));
    }
    if metadata.len() > MAX_FILE_BYTES {
        let fault = Fault::too_many(format_args!("{MAX_FILE_BYTES} bytes"), metadata.len());
        return Err(Error::file(path, fault));
    }
    fs::read(path).map_err(fault)
}
