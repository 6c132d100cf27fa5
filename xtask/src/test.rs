//! `cargo xtask test`: all tests.

use crate::tools::{self, cargo};
use crate::{check, hosts};
use anyhow::{Context as _, Result, anyhow};
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

/// Runs the parts one after the other, all of them even when one fails.
pub(crate) fn run(only: Option<Part>) -> Result<()> {
    let wanted = |part| only.is_none_or(|one| one == part);
    let mut failures = Vec::new();
    if wanted(Part::Check) {
        failures.extend(check::run().err());
    }
    if wanted(Part::Rust) {
        // Tests open the C library as a file, which `cargo test` does not build. It is built together with everything that
        // `cargo test` builds: another choice of targets has other features, and everything would be built twice.
        let everything = ["--workspace", "--all-features"];
        let targets = ["--lib", "--bins", "--tests", "--examples"];
        failures.extend(tools::run(cargo("build").args(everything).args(targets)).err());
        failures.extend(rust_tests(cargo("test").arg("--no-fail-fast").args(everything)).err());
    }
    if wanted(Part::Hosts) {
        failures.extend(hosts::run().err());
    }
    if only == Some(Part::C) {
        failures.extend(hosts::run_c().err());
    }
    if only == Some(Part::Cpp) {
        failures.extend(hosts::run_cpp().err());
    }
    if only == Some(Part::Python) {
        failures.extend(hosts::run_python().err());
    }
    if only == Some(Part::Unity) {
        failures.extend(hosts::run_unity().err());
    }
    if only == Some(Part::Blender) {
        failures.extend(hosts::run_blender().err());
    }
    if only == Some(Part::Motion) {
        failures.extend(hosts::run_motion().err());
    }
    tools::all_succeeded(&failures)
}
