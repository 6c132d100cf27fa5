//! Motion: clips, readers of motion files, retargeting to a body. Stands on [`pose`](crate::pose).

mod bvh;
#[allow(clippy::module_inception)]
mod clip;
mod fbx;
mod gltf;
mod joint_map;
mod npz;
mod proportions;
mod raw;
mod read;
mod retarget;
mod settle;
pub(crate) mod usd;

pub use clip::{Clip, MAX_FRAMES, TranslationTrack};
pub use joint_map::{JointMap, JointMapReport, JointMatch, MatchedBy, Overrides, read_overrides};
pub use read::{Found, Motion, ReadOptions, ReadReport, from_bytes, read};
pub use retarget::{
    BoneError, DirectionError, FingerMode, Floor, FootMode, RetargetOptions, Retargeter, RootMotion,
    direction_error,
};
