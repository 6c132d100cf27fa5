//! Files are written completely or not at all.
//!
//! Bytes go to a temporary file in the target's folder, which is then renamed over the target. If anything fails before
//! that, an existing file is unchanged and no temporary file remains.

use std::{
    fs, io,
    io::Write,
    path::{Path, PathBuf},
};

use tempfile::{Builder, NamedTempFile};

use crate::{Error, Result};

/// Writes a document and the buffer it refers to, both or neither.
///
/// # Errors
/// [`Error::Io`] as [`write_atomic`], for either file.
pub(crate) fn write_pair(document: (&Path, &[u8]), buffer: (&Path, &[u8])) -> Result<()> {
    let [bin, json] =
        [buffer, document].map(|(path, bytes)| Pending::new(path, |file| file.write_all(bytes)));
    commit_pair(bin?, json?)
}

/// Renames a document and its buffer to their final names, once both are on disk. The document comes last, because it is
/// the file that programs open; if its rename fails, the previous buffer is restored.
///
/// No file system renames two files atomically: a program killed between the two renames leaves the new buffer beside the
/// old document.
fn commit_pair(bin: Pending, json: Pending) -> Result<()> {
    let bin_target = bin.target.clone();
    let before = bin_target.exists().then(|| keep(&bin)).transpose()?;
    bin.commit()?;
    json.commit().inspect_err(|_| {
        // The caller needs the original error, not one of the restore.
        let _ = match before {
            Some(before) => before.persist(&bin_target).map_err(|e| e.error),
            None => fs::remove_file(&bin_target),
        };
    })
}

/// A hard link to the file that is about to be replaced, removed when dropped; a copy where the file system has no hard
/// links.
fn keep(pending: &Pending) -> Result<NamedTempFile<()>> {
    let target = &pending.target;
    let kept = temporary().make_in(folder_of(target), |place| {
        fs::hard_link(target, place).or_else(|_| fs::copy(target, place).map(drop))
    });
    kept.map_err(|source| fault(&pending.path, "create", source))
}

/// Writes a file completely or not at all; an existing regular file is replaced, also through a symbolic link.
///
/// # Errors
/// [`Error::Io`] names the path: the folder is missing or read-only, the target is a folder or a device, the disk is full.
pub fn write_atomic(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    Pending::new(path.as_ref(), |file| file.write_all(bytes))?.commit()
}

/// A completely written file that still has its temporary name. Dropping it removes it.
struct Pending {
    file: NamedTempFile,
    target: PathBuf,
    /// The path as the caller gave it, for messages.
    path: PathBuf,
}

impl Pending {
    fn new(path: &Path, write: impl FnOnce(&mut fs::File) -> io::Result<()>) -> Result<Self> {
        let create = || {
            let target = target_of(path)?;
            let mut builder = temporary();
            // The default is private to the user; the finished file should have the user's ordinary permissions.
            #[cfg(unix)]
            builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
            // Only the kind: the full message would name the temporary file.
            let file = builder.tempfile_in(folder_of(&target)).map_err(|e| io::Error::from(e.kind()))?;
            Ok((file, target))
        };
        let (mut file, target) = create().map_err(|source| fault(path, "create", source))?;
        // A full disk may be reported only when the data is flushed.
        let written = write(file.as_file_mut()).and_then(|()| file.as_file().sync_all());
        written.map_err(|source| fault(path, "write", source))?;
        Ok(Self { file, target, path: path.into() })
    }

    fn commit(self) -> Result<()> {
        let path = self.path;
        self.file.persist(&self.target).map(drop).map_err(|e| fault(&path, "write", e.error))
    }
}

fn temporary() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(".anthronet-").suffix(".part");
    builder
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| *parent != Path::new("")).unwrap_or(Path::new("."))
}

/// The regular file that a path names or will name. Renaming over a folder fails late; over a device it destroys the device.
fn target_of(path: &Path) -> io::Result<PathBuf> {
    if path.file_name().is_none() {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "is a folder, expected a file name"));
    }
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => {
            Err(io::Error::new(io::ErrorKind::IsADirectory, "is a folder, expected a file name"))
        }
        Ok(found) if !found.is_file() => {
            Err(io::Error::new(io::ErrorKind::InvalidInput, "is not a regular file"))
        }
        Ok(_) => fs::canonicalize(path),
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(path.into()),
        Err(e) => Err(e),
    }
}

fn fault(path: &Path, action: &'static str, source: io::Error) -> Error {
    Error::Io { path: path.into(), action, source }
}

#[cfg(test)]
mod tests;
