//! FBX, binary and text, through the `ufbx` library, which handles its pre- and post-rotations, pivots and layers.
//!
//! Nodes are evaluated in the file's own unit and composed here to the world, scale and all; joints are those nodes
//! that are bones; nodes between and above them are folded in. They rest in the file's bind pose where it
//! has one. Axes other than +Y or +Z up are turned here, as the format lets any axis point anywhere.

#[cfg(test)]
mod binary;
mod document;
mod motion;
#[cfg(test)]
mod tests;

use super::kind::{Description, Holds};
use crate::error::FbxError;

type Result<T> = std::result::Result<T, FbxError>;

pub(super) const FBX: Description = Description {
    ending: "fbx",
    title: "FBX",
    holds: Holds { meshes: true, skeleton: true, clips: true },
    read_motion: Some(motion::read),
    read_scene: None,
    read_meshes: None,
    write: None,
};
