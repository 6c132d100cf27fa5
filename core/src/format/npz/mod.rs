//! AMASS and SMPL-X motion: numpy archives of axis-angle rotations, as in Mahmood et al., "AMASS: Archive of Motion Capture
//! as Surface Shapes" (2019), and as written by the tools of the SMPL, SMPL-H and SMPL-X body models.
//!
//! The files contain no skeleton, which is part of the body model. The rest pose used here has the public joint names and
//! **assumed bone lengths**, round numbers for a person of 1.70 m: see `smpl`. World axes are AMASS' +Z up, unless the body
//! is upright along another axis, as in the axes of a camera; rest poses of the body models are +Y up, facing +Z.
//!
//! Of the results of tools that estimate poses from pictures (WHAM, TRAM, GVHMR, HMR2, ROMP, SLAHMR), saved as arrays, those in the
//! world's axes are read where there are any: [`names`].
//!
//! The pelvis is placed at `trans`. The body models place it at `trans` + J₀, where J₀ is the pelvis position in the
//! model's own rest pose: some 0.2 to 0.4 m below the model's origin, the same vector in every frame of a file. J₀ belongs
//! to the body model, whose data may not be used here, and varies with the shape. The missing term is one constant shift
//! of the whole clip, horizontal in a world of +Z up and downwards in one of +Y up; it leaves poses, speeds and paths
//! unchanged, and the height is found from the feet ([`plant`](crate::retarget::feet::plant)).

mod array;
mod motion;
mod names;
mod pose;
mod poses;
mod smpl;
#[cfg(test)]
mod tests;

use super::kind::{Description, Holds};
use crate::error::NpzError;

pub(super) use pose::read as read_pose;

type Result<T> = std::result::Result<T, NpzError>;

pub(super) const NPZ: Description = Description {
    extension: "npz",
    title: "AMASS and SMPL motion",
    holds: Holds { meshes: false, skeleton: false, clips: true },
    read_motion: Some(motion::read),
    read_scene: None,
    read_meshes: None,
    write: None,
};
