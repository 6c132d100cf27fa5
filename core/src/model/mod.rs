//! The generator: its configuration, networks and file.

pub mod config;
pub mod network;
#[cfg(test)]
mod network_tests;
