//! BVH, Biovision's hierarchy and motion in one text file.
//!
//! There is no standard beyond "Biovision BVH" (Meredith and Maddock, "Motion Capture File Formats Explained", 2001) and
//! existing files. What they leave open is read as the common exporters write it: angles are degrees, rotations are
//! applied in channel order, each about the axes rotated by those before it (`R = R₁ R₂ R₃`); a position channel replaces
//! that component of the joint's OFFSET; a joint's rest pose is its OFFSET without rotation. Neither unit nor up axis is
//! stated.

mod frames;
mod hierarchy;
mod lexer;
mod motion;
#[cfg(test)]
mod tests;

use super::kind::{Description, Holds};
use crate::error::BvhError;

type Result<T> = std::result::Result<T, BvhError>;

pub(super) const BVH: Description = Description {
    extension: "bvh",
    title: "BVH",
    holds: Holds { meshes: false, skeleton: true, clips: true },
    read_motion: Some(motion::read),
    read_scene: None,
    read_meshes: None,
    write: None,
};
