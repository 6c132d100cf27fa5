//! Files appear on the disk whole or not at all.
//!
//! Bytes go to a temporary file in the folder of the target, which is then renamed over it. If anything fails before
//! that, what was there stays as it was and nothing is left behind.

use std::{
    fs, io,
    io::Write,
    path::{Path, PathBuf},
};

use tempfile::{Builder, NamedTempFile};

use crate::{Error, Result};

/// Writes a document and the buffer that it refers to, both or none.
///
/// # Errors
/// [`Error::Io`] as of [`write_atomic`], of either file.
pub(crate) fn write_pair(document: (&Path, &[u8]), buffer: (&Path, &[u8])) -> Result<()> {
    let [bin, json] =
        [buffer, document].map(|(path, bytes)| Pending::new(path, |file| file.write_all(bytes)));
    commit_pair(bin?, json?)
}

/// Gives a document and its buffer their names, when both are on the disk. The document comes last, as it is what is
/// opened; if it cannot have its name, the buffer that was there before is put back.
///
/// No file system renames two files at once: a program that is killed between the two renames leaves the new buffer
/// beside the old document.
fn commit_pair(bin: Pending, json: Pending) -> Result<()> {
    let bin_target = bin.target.clone();
    let before = bin_target.exists().then(|| keep(&bin)).transpose()?;
    bin.commit()?;
    json.commit().inspect_err(|_| {
        // The failure itself is what the caller must hear of.
        let _ = match before {
            Some(before) => before.persist(&bin_target).map_err(|e| e.error),
            None => fs::remove_file(&bin_target),
        };
    })
}

/// A second name for the file that is about to be replaced, removed when dropped; a copy where the file system has no
/// second names.
fn keep(pending: &Pending) -> Result<NamedTempFile<()>> {
    let target = &pending.target;
    let kept = temporary().make_in(folder_of(target), |place| {
        fs::hard_link(target, place).or_else(|_| fs::copy(target, place).map(drop))
    });
    kept.map_err(|source| fault(&pending.path, "create", source))
}

/// Writes a file whole or not at all; an existing regular file is replaced, through a symbolic link too.
///
/// # Errors
/// [`Error::Io`] names the path: the folder is missing or read-only, the target is a folder or a device, the disk is full.
pub fn write_atomic(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    Pending::new(path.as_ref(), |file| file.write_all(bytes))?.commit()
}

/// A file that is written completely but has not got its name yet. Dropping it removes it.
struct Pending {
    file: NamedTempFile,
    target: PathBuf,
    /// The path as the caller wrote it, for messages.
    path: PathBuf,
}

impl Pending {
    fn new(path: &Path, write: impl FnOnce(&mut fs::File) -> io::Result<()>) -> Result<Self> {
        let create = || {
            let target = target_of(path)?;
            let mut builder = temporary();
            // The default is private to the user; the finished file shall be like any other that the user makes.
            #[cfg(unix)]
            builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
            // Only the kind: the message would name the temporary file.
            let file = builder.tempfile_in(folder_of(&target)).map_err(|e| io::Error::from(e.kind()))?;
            Ok((file, target))
        };
        let (mut file, target) = create().map_err(|source| fault(path, "create", source))?;
        // A full disk may only be reported when the data is really written.
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

/// The regular file that a path names or will name. Renaming over a folder fails late and over a device destroys it.
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
