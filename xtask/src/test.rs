//! `cargo xtask test`: all tests.

use crate::tools::{self, cargo};
use crate::{check, hosts};
use anyhow::{Context as _, Result, anyhow};
use clap::ValueEnum as _;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::time::Instant;

/// A part of the tests.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Part {
    /// Formatting, lints, documentation, layering
    Check,
    /// Unit, property and integration tests of the workspace
    Rust,
    /// Cross-boundary tests: the files in third-party programs
    Hosts,
    /// What those use: built as it is released, packed, installed
    Release,
    /// Of those, only files of the command: validators, viewers, other tools
    Files,
    /// Of those, only the programs that use the C ABI
    C,
    /// Of those, only the package for C++
    Cpp,
    /// Of those, only the Python package
    Python,
    /// Of those, only the Unity package
    Unity,
    /// Of those, only the Blender extension
    Blender,
    /// Of those, only retargeting of motion files to bodies
    Motion,
}

impl Part {
    /// The name by which `--only` takes it.
    pub(crate) fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// Runs `cargo test` and counts the tests that print `skipped NAME: why`, which cargo counts as passed.
fn rust_tests(command: &mut Command) -> Result<()> {
    println!("$ {}", tools::shown(command));
    let start = Instant::now();
    let did_not_run = "`cargo test` did not run";
    let mut child = command.stdout(Stdio::piped()).spawn().context(did_not_run)?;
    let mut skipped = Vec::new();
    if let Some(output) = child.stdout.take() {
        for line in BufReader::new(output).split(b'\n') {
            let line = String::from_utf8_lossy(&line.context(did_not_run)?).into_owned();
            println!("{line}");
            skipped.extend(line.starts_with("skipped ").then_some(line));
        }
    }
    let status = child.wait().context(did_not_run)?;
    println!(
        "  {:.1} s; {} skipped of those that cargo counts as passed",
        start.elapsed().as_secs_f64(),
        skipped.len()
    );
    for line in skipped {
        println!("{line}");
    }
    if status.success() { Ok(()) } else { Err(anyhow!("`cargo test` failed: {status}")) }
}

/// All parts, or one. `prepared`: what the part uses is there already.
pub(crate) fn run(only: Option<Part>, prepared: bool) -> Result<()> {
    match only {
        None => all(),
        Some(Part::Check) => check::run(),
        Some(Part::Rust) if prepared => rust(),
        Some(Part::Rust) => all_succeeded([build(), rust()]),
        Some(Part::Hosts) => hosts::run(false),
        Some(Part::Release) => hosts::release(),
        Some(part) => hosts::run_part(part, prepared),
    }
}

/// The parts one after the other, all of them even when one fails.
fn all() -> Result<()> {
    let (mut results, mut seconds) = (Vec::new(), Vec::new());
    let mut keep = |what: &str, run: &dyn Fn() -> Result<()>| {
        let start = Instant::now();
        results.push(run());
        seconds.push(format!("{what} {:.1} s", start.elapsed().as_secs_f64()));
    };
    // Cargo builds what is released in a folder of its own. Beside that it leaves a core idle whenever it compiles one large
    // crate.
    hosts::beside(Part::Release, || {
        keep("check", &check::run);
        keep("build", &build);
    });
    // Rust's tests, too, use one core for most of the time. If the release failed, this makes it again and says why.
    keep("tests", &|| hosts::run(true));
    println!("{}", seconds.join(", "));
    all_succeeded(results)
}

fn all_succeeded(results: impl IntoIterator<Item = Result<()>>) -> Result<()> {
    tools::all_succeeded(&results.into_iter().filter_map(Result::err).collect::<Vec<_>>())
}

/// Builds everything that the Rust tests use.
///
/// Tests open the C library as a file, which `cargo test` does not build. It is built together with everything that `cargo
/// test` builds: another choice of targets has other features, and everything would be built twice.
fn build() -> Result<()> {
    let targets = ["--lib", "--bins", "--tests", "--examples"];
    tools::run(cargo("build").args(tools::EVERYTHING).args(targets))
}

/// Unit, property and integration tests of the workspace.
fn rust() -> Result<()> {
    all_succeeded([
        rust_tests(cargo("test").arg("--no-fail-fast").args(tools::EVERYTHING)),
        // Built over what `cargo xtask` itself was built over; with the features of all others that would be built twice.
        rust_tests(cargo("test").arg("--no-fail-fast").args(["--package", "xtask"])),
    ])
}
