//! Paths, files and child processes.

use anyhow::{Context as _, Error, Result, anyhow};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// What this machine lacks, in words for the reader: the reason for which a test is skipped.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{0}")]
pub(crate) struct Missing(pub(crate) String);

impl From<Error> for Missing {
    fn from(error: Error) -> Self {
        Self(format!("{error:#}"))
    }
}

/// Something that not every machine has, or why this one does not.
pub(crate) type Available<T> = std::result::Result<T, Missing>;

/// One error for all the failures of a chore that runs every step, or none.
pub(crate) fn all_succeeded(failures: &[Error]) -> Result<()> {
    let lines: Vec<_> = failures.iter().map(|failure| format!("{failure:#}")).collect();
    if lines.is_empty() { Ok(()) } else { Err(anyhow!(lines.join("\nxtask: "))) }
}

/// The repository's root.
pub(crate) fn root() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}

/// Cargo's target folder.
pub(crate) fn target() -> PathBuf {
    match std::env::var_os("CARGO_TARGET_DIR") {
        Some(folder) => root().join(folder),
        None => root().join("target"),
    }
}

/// What is tested with cargo, but for `xtask`: with the same features, so that it is built once.
pub(crate) const EVERYTHING: [&str; 4] = ["--workspace", "--exclude", "xtask", "--all-features"];

/// A cargo command for any supported toolchain that never changes `Cargo.lock`.
pub(crate) fn cargo(verb: &str) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root()).arg(verb).args(["--ignore-rust-version", "--locked"]);
    command
}

/// Runs a command, whose output goes to ours; prints the command before and the time it took after.
pub(crate) fn run(command: &mut Command) -> Result<()> {
    let text = shown(command);
    println!("$ {text}");
    let start = Instant::now();
    let status = command.status().with_context(|| format!("`{text}` did not start"))?;
    println!("  {:.1} s", start.elapsed().as_secs_f64());
    if status.success() { Ok(()) } else { Err(anyhow!("`{text}` failed: {status}")) }
}

/// Runs a command silently and returns its standard output; an error ends with the last lines of its standard error.
pub(crate) fn output(command: &mut Command) -> Result<String> {
    let text = shown(command);
    let output = command.output().with_context(|| format!("`{text}` did not start"))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let stderr = String::from_utf8_lossy(&output.stderr);
    let tail: Vec<_> = stderr.lines().rev().take(6).collect();
    let tail: Vec<_> = tail.into_iter().rev().collect();
    Err(anyhow!("`{text}` failed: {}: {}", output.status, tail.join(" / ")))
}

/// The command as typed in the repository's root, with paths relative to it.
pub(crate) fn shown(command: &Command) -> String {
    let root = format!("{}{}", root().display(), std::path::MAIN_SEPARATOR);
    let mut words = Vec::new();
    for (name, value) in command.get_envs() {
        if let Some(value) = value {
            words.push(format!("{}={:?}", name.to_string_lossy(), value.to_string_lossy()));
        }
    }
    let program = Path::new(command.get_program());
    words.push(match program.file_stem() {
        Some(stem) if stem == "cargo" => "cargo".to_owned(),
        _ => program.to_string_lossy().into_owned(),
    });
    words.extend(command.get_args().map(|a| a.to_string_lossy().into_owned()));
    words.join(" ").replace(&root, "")
}

/// Reads a text file; the error names it.
pub(crate) fn read(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).with_context(|| format!("{}: cannot read", path.display()))
}

/// Writes a file whole or not at all; creates its folder.
pub(crate) fn write(path: &Path, content: &str) -> Result<()> {
    if let Some(folder) = path.parent() {
        create_folder(folder)?;
    }
    let beside = path.with_extension("partial");
    std::fs::write(&beside, content)
        .and_then(|()| std::fs::rename(&beside, path))
        .with_context(|| format!("{}: cannot write", path.display()))
}

/// The Rust files below a folder, sorted.
pub(crate) fn rust_files(folder: &Path) -> Result<Vec<PathBuf>> {
    let cannot = || format!("{}: cannot read", folder.display());
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(cannot)? {
        let path = entry.with_context(cannot)?.path();
        if path.is_dir() {
            files.extend(rust_files(&path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// Creates a folder and those above it.
pub(crate) fn create_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("{}: cannot create", folder.display()))
}

/// Deletes a folder with all that is in it, if it exists.
pub(crate) fn remove_folder(folder: &Path) -> Result<()> {
    if folder.exists() {
        std::fs::remove_dir_all(folder).with_context(|| format!("{}: cannot remove", folder.display()))?;
    }
    Ok(())
}

/// Copies a file, or a folder with all that is in it; creates the folders above.
pub(crate) fn copy(from: &Path, to: &Path) -> Result<()> {
    copy_except(from, to, &[])
}

/// Likewise, without the files and folders that have one of these names.
pub(crate) fn copy_except(from: &Path, to: &Path, names: &[&str]) -> Result<()> {
    let cannot = || format!("{}: cannot copy to {}", from.display(), to.display());
    if !from.is_dir() {
        create_folder(to.parent().unwrap_or(to))?;
        return std::fs::copy(from, to).map(drop).with_context(cannot);
    }
    create_folder(to)?;
    for entry in std::fs::read_dir(from).with_context(cannot)? {
        let entry = entry.with_context(cannot)?;
        let name = entry.file_name();
        if !names.iter().any(|skipped| name == *skipped) {
            copy_except(&entry.path(), &to.join(&name), names)?;
        }
    }
    Ok(())
}

/// Builds the released command as a user would and returns its path.
pub(crate) fn command_line() -> Result<PathBuf> {
    // The same arguments as the alias `cargo anthronet`, so that both share one build.
    run(cargo("build").args(["--release", "--package", "anthronet-cli", "--bin", "anthronet"]))?;
    let path = command_path();
    if path.is_file() { Ok(path) } else { Err(anyhow!("{}: not there after a build", path.display())) }
}

/// Where the released command is once it is built.
pub(crate) fn command_path() -> PathBuf {
    target().join("release").join(format!("anthronet{}", std::env::consts::EXE_SUFFIX))
}
