//! AnthroNet for C++17.
//!
//! `bridge` is the whole interface, from which `cxx` makes the C++ header; the other files do what it declares, one
//! file per class. It stands on the library itself and not on the C ABI, in a crate of its own: a shared library that
//! contained it would export the bridge's symbols too.
//!
//! `cargo xtask package cpp` makes a folder of it that CMake finds.

mod body;
mod bridge;
mod clip;
mod context;
mod enums;
mod mesh;
mod model;
mod panic;
mod request;
mod scene;
mod skin;

use anthronet::Result;
