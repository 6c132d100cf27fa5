//! `cargo xtask package`: the packages for users, in `target/dist`.

mod blender;
mod cpp;
mod python;
mod unity;

pub(crate) use blender::package_blender;
pub(crate) use cpp::{build_cpp, package_cpp};
pub(crate) use python::{library, package_python, wheel};
pub(crate) use unity::{package_unity, packed_library};

use crate::environment;
use crate::tools;
use anyhow::Result;

/// The packages.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Kind {
    /// The wheel of the Python package, with the library inside
    Python,
    /// C++17: static library, headers, CMake files
    Cpp,
    /// The Blender extension, with the wheel inside
    Blender,
    /// The Unity package, with the library of this system inside
    Unity,
}

pub(crate) fn run(kind: Kind) -> Result<()> {
    let made = match kind {
        Kind::Python => package_python(&environment::python()?)?,
        Kind::Cpp => package_cpp()?,
        Kind::Blender => package_blender(&environment::prepare()?, &tools::command_line()?, package_python)??,
        Kind::Unity => package_unity()?,
    };
    println!("{}", made.display());
    Ok(())
}
