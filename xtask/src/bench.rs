//! `cargo xtask bench`: the library's benchmarks.

use crate::tools::{self, Outcome, cargo};

pub(crate) fn run(rest: &[String]) -> Outcome {
    tools::run(cargo("bench").args(["--package", "anthronet"]).args(rest))
}
