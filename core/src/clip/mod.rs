//! Motion: clips, readers of motion files, retargeting to a body. Stands on [`pose`](crate::pose).

#[allow(clippy::module_inception)]
mod clip;
mod joint_map;
mod retarget;
#[cfg(test)]
mod test_person;

pub use clip::{Clip, MAX_FRAMES, TranslationTrack};
pub use joint_map::{JointMap, JointMapReport, JointMatch, MatchedBy, Overrides, read_overrides};
pub use retarget::{
    BoneError, DirectionError, FingerMode, Floor, FootMode, RetargetOptions, Retargeter, RootMotion, direction_error,
};
