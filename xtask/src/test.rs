//! `cargo xtask test`: everything that shows that the project works.

use crate::tools::{self, Outcome, cargo};
use crate::{check, hosts};

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
}

/// Runs the parts one after the other, all of them even when one fails, and closes with the counts of the last.
pub(crate) fn run(only: Option<Part>) -> Outcome {
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
        failures.extend(tools::run(cargo("test").args(everything)).err());
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
    if failures.is_empty() { Ok(()) } else { Err(failures.join("\nxtask: ")) }
}
