//! `cargo xtask test`: everything that shows that the project works.

use crate::tools::{self, cargo};
use crate::{check, hosts};
use anyhow::{Context as _, Result, anyhow};
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::time::Instant;

/// A part of the tests that can be asked for alone.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Part {
    /// Formatting, lints, documentation, layering
    Check,
    /// Unit, property and integration tests of the workspace
    Rust,
    /// Cross-boundary tests: the files in programs that are not ours
    Hosts,
    /// Of those, the consumers of the C ABI alone
    C,
    /// Of those, the package for C++ alone
    Cpp,
    /// Of those, the Python package alone
    Python,
    /// Of those, the Unity package alone
    Unity,
    /// Of those, the Blender extension alone
    Blender,
    /// Of those, how motion files come onto bodies alone
    Motion,
}

/// Runs `cargo test` and counts the tests that say `skipped NAME: why`, which cargo counts as passed.
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

/// Runs the parts one after the other, all of them even when one fails, and closes with the counts of the last.
pub(crate) fn run(only: Option<Part>) -> Result<()> {
    let wanted = |part| only.is_none_or(|one| one == part);
    let mut failures = Vec::new();
    if wanted(Part::Check) {
        failures.extend(check::run().err());
    }
    if wanted(Part::Rust) {
        // Tests open the C library as a file, which cargo does not build for them. All that it does build for them is
        // asked for along with it: another choice of targets is another choice of features, and all is built twice.
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
