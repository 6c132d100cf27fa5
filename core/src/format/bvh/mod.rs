//! BVH, Biovision's hierarchy and motion in one text file.
//!
//! There is no standard but "Biovision BVH" (Meredith and Maddock, "Motion Capture File Formats Explained", 2001) and
//! the files. What they leave open is read as the programs do that write most of them: angles are degrees, turned one
//! after the other in the order of the channels, each about the axes that the one before has left (`R = R₁ R₂ R₃`); a
//! position channel replaces its number of the joint's OFFSET; a joint rests unturned at its OFFSET. Neither unit nor
//! up axis is said.

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
    ending: "bvh",
    title: "BVH",
    holds: Holds { meshes: false, skeleton: true, clips: true },
    read_motion: Some(motion::read),
    read_scene: None,
    read_meshes: None,
    write: None,
};
