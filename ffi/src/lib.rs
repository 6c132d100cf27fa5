//! `libanthronet`: the library behind a C ABI.
//!
//! One file per family of handles, named as in the core. `include/anthronet.h` is made from these files by `cargo
//! xtask gen`; the text before its first declaration says what holds for every call: see `cbindgen.toml`.
//!
//! All unsafe code of the project that reads a caller's memory is in [`pointer`]; the entries pass what it returns to
//! the core inside [`status::guard`], which turns errors and panics into codes.

// The contract of every entry is the header's preamble; `unsafe` is what this crate is for.
#![allow(clippy::missing_safety_doc, non_camel_case_types, unsafe_code)]

pub mod blend_shape;
pub mod body;
pub mod bytes;
pub mod clip;
pub mod context;
pub mod export;
pub mod job;
pub mod log;
pub mod measure;
pub mod mesh;
pub mod model;
pub mod motion;
pub mod options;
mod panic;
pub mod pointer;
pub mod request;
pub mod skeleton;
pub mod skin;
pub mod status;
#[cfg(feature = "test-hooks")]
pub mod test_hooks;
pub mod version;
