//! Tape measures: what they are called, where they lie on the body and how they are read.

mod names;

pub use names::{MEASURE_COUNT, MeasureId, Measurements, Sex, expand_name};
