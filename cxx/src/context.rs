//! The memory that sampling and skinning work in.

use anthronet::math::RigidTransform;
use anthronet::skeleton::Pose;
use anthronet::skin::SkinContext;

#[derive(Default)]
pub(crate) struct Context {
    /// The pose that is sampled.
    pub(crate) pose: Pose,
    /// Its joints relative to the model.
    pub(crate) model: Vec<RigidTransform>,
    /// What is computed of the joints of characters that are skinned.
    pub(crate) skin: SkinContext,
}

impl Context {
    pub(crate) fn create() -> Box<Self> {
        Box::default()
    }
}
