//! Paths and child processes.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// What a chore returns; the message names the step that failed and how.
pub(crate) type Outcome<T = ()> = Result<T, String>;

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

/// A cargo command that works on every documented toolchain and never changes `Cargo.lock`.
pub(crate) fn cargo(verb: &str) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(root()).arg(verb).args(["--ignore-rust-version", "--locked"]);
    command
}

/// Runs a command with its output on ours; prints the command first and its time after.
pub(crate) fn run(command: &mut Command) -> Outcome {
    let text = shown(command);
    println!("$ {text}");
    let start = Instant::now();
    let status = command.status().map_err(|e| format!("`{text}` did not start: {e}"))?;
    println!("  {:.1} s", start.elapsed().as_secs_f64());
    if status.success() { Ok(()) } else { Err(format!("`{text}` failed: {status}")) }
}

/// Runs a command silently; its standard output, or an error that ends with what it wrote on standard error.
pub(crate) fn output(command: &mut Command) -> Outcome<String> {
    let text = shown(command);
    let output = command.output().map_err(|e| format!("`{text}` did not start: {e}"))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let complaint = String::from_utf8_lossy(&output.stderr);
    let tail: Vec<_> = complaint.lines().rev().take(6).collect();
    let tail: Vec<_> = tail.into_iter().rev().collect();
    Err(format!("`{text}` failed: {}: {}", output.status, tail.join(" / ")))
}

/// The command as a person would type it, paths shortened to the repository's root.
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
pub(crate) fn read(path: &Path) -> Outcome<String> {
    std::fs::read_to_string(path).map_err(|e| format!("{}: cannot read: {e}", path.display()))
}

/// Writes a file whole or not at all, with its folder.
pub(crate) fn write(path: &Path, content: &str) -> Outcome {
    let complain = |e| format!("{}: cannot write: {e}", path.display());
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).map_err(complain)?;
    }
    let beside = path.with_extension("partial");
    std::fs::write(&beside, content).map_err(complain)?;
    std::fs::rename(&beside, path).map_err(complain)
}

/// Builds the released command as a user would and returns its path.
pub(crate) fn command_line() -> Outcome<PathBuf> {
    // The same arguments as the alias `cargo anthronet`, so that neither builds what the other has built.
    run(cargo("build").args(["--release", "--package", "anthronet-cli", "--bin", "anthronet"]))?;
    let path = target().join("release").join(format!("anthronet{}", std::env::consts::EXE_SUFFIX));
    if path.is_file() { Ok(path) } else { Err(format!("{}: not there after a build", path.display())) }
}
