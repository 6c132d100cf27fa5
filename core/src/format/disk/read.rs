//! Whole files of a sensible size.

use std::{fs, path::Path};

use crate::{Error, Result};

/// Largest file that is read: far above any character or motion, far below the memory of a small machine.
const MAX_FILE_BYTES: u64 = 1 << 30;

/// The whole of a regular file of a sensible size.
///
/// # Errors
/// [`Error::File`] when it is larger or no regular file, [`Error::Io`] when reading fails.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>> {
    let fault = |source| Error::Io { path: path.into(), action: "read", source };
    let metadata = fs::metadata(path).map_err(fault)?;
    if !metadata.is_file() {
        return Err(Error::file(path, "is not a regular file"));
    }
    if metadata.len() > MAX_FILE_BYTES {
        let bytes = metadata.len();
        return Err(Error::file(
            path,
            format!("expected a file of at most {MAX_FILE_BYTES} bytes, got {bytes}"),
        ));
    }
    fs::read(path).map_err(fault)
}
