//! Motion: clips, readers of motion files, retargeting to a body. Stands on [`pose`](crate::pose).

#[allow(clippy::module_inception)]
mod clip;

pub use clip::{Clip, MAX_FRAMES, TranslationTrack};
