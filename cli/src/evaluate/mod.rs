//! Evaluation of retargeting.

pub(crate) mod motion;
mod soles;
