//! FBX, binary and text, through the `ufbx` library, which handles pre- and post-rotations, pivots and layers.
//!
//! Nodes are evaluated in the file's own unit and composed to world space here, including scale; joints are the bone nodes
//! (the animated nodes where there are none), with nodes between and above them folded in. The rest pose is the file's
//! bind pose where it has one. Files whose up axis is neither +Y nor +Z are rotated here, as FBX allows any axes.

#[cfg(test)]
pub(super) mod binary;
mod document;
mod motion;
#[cfg(test)]
pub(super) mod tests;

use super::kind::{Description, Holds};
use crate::error::FbxError;

type Result<T> = std::result::Result<T, FbxError>;

pub(super) const FBX: Description = Description {
    extension: "fbx",
    title: "FBX",
    holds: Holds { meshes: true, skeleton: true, clips: true },
    read_motion: Some(motion::read),
    read_scene: None,
    read_meshes: None,
    write: None,
};
