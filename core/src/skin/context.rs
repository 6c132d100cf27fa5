//! Scratch memory of skinning.

use super::palette::Palette;
use crate::math::RigidTransformF64;

/// Scratch memory that skinning calls reuse: the skinning transforms of each character's joints.
///
/// It has no influence on results, which are the same with a new one; it only saves allocations. Keep one per character or
/// per skinning thread. It grows to the most joints and characters of any call and is freed when dropped.
#[derive(Clone, Debug, Default)]
pub struct SkinContext {
    /// Posed `model_from_joint` of the character being prepared.
    pub(super) posed: Vec<RigidTransformF64>,
    /// One per character of a call.
    pub(super) palettes: Vec<Palette>,
}
