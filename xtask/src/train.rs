//! `cargo xtask train`: the committed model, from nothing.

use crate::tools::{self, Outcome, cargo};

pub(crate) fn run(rest: &[String]) -> Outcome {
    let command = ["--release", "--package", "anthronet-cli", "--bin", "anthronet", "--features", "train"];
    tools::run(cargo("run").args(command).args(["--", "train", "generator"]).args(rest))
}
