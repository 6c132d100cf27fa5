//! Retargeting of motions to bodies of the rig: joint matching, the pose to compare with, pose transfer, joint limits, foot contact.

mod confidence;
pub mod feet;
mod joint_map;
mod pipeline;
mod reference_pose;
mod solve;

pub use confidence::{Confidence, LEAST_CONFIDENCE};
pub use joint_map::{JointMap, JointMapReport, JointMatch, MatchedBy, Overrides, read_overrides};
pub use pipeline::{
    ClipReport, RetargetOptions, RetargetReport, retarget, retarget_clip, worst_limit_excess,
};
pub use reference_pose::ReferenceFrame;
pub use solve::{
    BoneError, DirectionError, FingerMode, Floor, FootMode, Jump, Retargeter, RootMotion, TransferOptions,
    direction_error, worst_jump,
};
