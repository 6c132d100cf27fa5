//! `cargo xtask train`: the committed model, from scratch.

use crate::tools::{self, cargo};
use anyhow::Result;

pub(crate) fn run(rest: &[String]) -> Result<()> {
    let command = ["--release", "--package", "anthronet-cli", "--bin", "anthronet", "--features", "train"];
    tools::run(cargo("run").args(command).args(["--", "train", "generator"]).args(rest))
}
