//! Motion: clips, readers of motion files, retargeting to a body. Stands on [`pose`](crate::pose).

mod bvh;
#[allow(clippy::module_inception)]
mod clip;
mod fbx;
mod gltf;
mod npz;
mod proportions;
mod raw;
mod read;
mod settle;

pub use clip::{Clip, MAX_FRAMES, TranslationTrack};
pub use read::{Found, Motion, ReadOptions, ReadReport, from_bytes, read};
