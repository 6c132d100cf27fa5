//! The anthronet command.
fn main() {}
