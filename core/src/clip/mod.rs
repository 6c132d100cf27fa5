//! Animation clips: sampling, blending, editing, and the built-in clips.

mod blend;
mod builtin;
#[expect(clippy::module_inception, reason = "the file of the type of that name")]
mod clip;
pub(crate) mod edit;
mod sample;

pub use blend::{
    JointMask, Layer, add_pose, additive, blend, blend_layers, blend_pose, blend_poses, crossfade,
};
pub use builtin::{BUILTIN, builtin};
pub use clip::{Clip, MAX_FRAMES, MAX_ROTATIONS, TranslationTrack};
pub use edit::{in_place, looped, resample};
pub use sample::{Sampler, Wrap};
