//! `cargo xtask package python`: the wheel, built by pip as users do.

use crate::tools::{self, cargo};
use anyhow::{Context as _, Result, anyhow};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Builds the shared library as released and returns its path.
pub(crate) fn library() -> Result<PathBuf> {
    tools::run(cargo("build").args(["--release", "--package", "anthronet-ffi"]))?;
    let name = format!("{}anthronet{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let path = tools::target().join("release").join(name);
    if path.is_file() { Ok(path) } else { Err(anyhow!("{}: not there after a build", path.display())) }
}

/// The wheel of the Python package, built by pip as users do; its build backend finds the library already built.
pub(crate) fn package_python(python: &Path) -> Result<PathBuf> {
    library()?;
    let dist = tools::target().join("dist");
    // Wheels of older versions could be mistaken for this one.
    for old in wheels(&dist) {
        std::fs::remove_file(&old).with_context(|| format!("{}: cannot remove", old.display()))?;
    }
    let pip = ["-m", "pip", "wheel", "--quiet", "--disable-pip-version-check", "--no-deps", "--wheel-dir"];
    let mut command = Command::new(python);
    command.env_remove("ANTHRONET_LIBRARY").args(pip).arg(&dist).arg(tools::root().join("python"));
    tools::run(&mut command)?;
    wheel()
}

/// The wheel that has been made.
pub(crate) fn wheel() -> Result<PathBuf> {
    let dist = tools::target().join("dist");
    match wheels(&dist).as_slice() {
        [wheel] => Ok(wheel.clone()),
        found => Err(anyhow!("{}: expected one wheel after pip, found {}", dist.display(), found.len())),
    }
}

/// Our wheels in a folder.
fn wheels(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let ours = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with("anthronet-") && name.ends_with(".whl")
    };
    entries.filter(ours).collect()
}
