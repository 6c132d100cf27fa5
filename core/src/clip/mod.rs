//! Motion: clips, readers of motion files, retargeting to a body. Stands on [`pose`](crate::pose).

mod blend;
mod builtin;
mod bvh;
#[allow(clippy::module_inception)]
mod clip;
mod edit;
mod fbx;
pub mod feet;
pub(crate) mod gltf;
mod joint_map;
mod npz;
mod onto;
mod proportions;
mod raw;
mod read;
mod retarget;
mod sample;
mod settle;
#[cfg(test)]
mod test_bodies;
#[cfg(test)]
mod test_clips;
#[cfg(test)]
mod test_person;
pub(crate) mod usd;

pub use blend::{JointMask, add_pose, additive, blend, blend_pose, crossfade};
pub use builtin::{BUILTIN, builtin};
pub use clip::{Clip, MAX_FRAMES, MAX_ROTATIONS, TranslationTrack};
pub use edit::{in_place, looped, resample};
pub use joint_map::{JointMap, JointMapReport, JointMatch, MatchedBy, Overrides, read_overrides};
pub use onto::{ClipQuality, OntoOptions, OntoReport, OntoSwitches, onto, onto_one, worst_excess};
pub use read::{Found, Motion, ReadOptions, ReadReport, from_bytes, read};
pub use retarget::{
    BoneError, DirectionError, FingerMode, Floor, FootMode, Jump, RetargetOptions, Retargeter, RootMotion,
    direction_error, worst_jump,
};
pub use sample::{Sampler, Wrap};
