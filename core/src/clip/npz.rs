use super::ReadOptions; use super::raw::{Outcome, Raw};
pub(super) fn read(_: &[u8], _: &str, _: &ReadOptions) -> Outcome<Raw> { Err("not yet".into()) }
