//! `cargo xtask package`: what others build upon, put together under `target/dist`.

use crate::package_cpp::package_cpp;
use crate::tools::Outcome;

/// For whom.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Kind {
    /// C++17: static library, headers, CMake files
    Cpp,
}

pub(crate) fn run(kind: Kind) -> Outcome {
    match kind {
        Kind::Cpp => package_cpp().map(drop),
    }
}
