//! Wavefront OBJ: meshes in the bind pose. Skeleton, motion, morph targets and materials are not stored.

mod read;
mod write;

use super::kind::{Description, Holds, Write};

pub use write::to_obj;

pub(super) const OBJ: Description = Description {
    extension: "obj",
    title: "Wavefront OBJ",
    holds: Holds { meshes: true, skeleton: false, clips: false },
    read_motion: None,
    read_scene: None,
    read_meshes: Some(read::read),
    write: Some(Write::Alone(|scene, _| to_obj(scene))),
};
