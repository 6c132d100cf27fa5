//! The anthronet command.
mod failure;
mod render;
fn main() {}
