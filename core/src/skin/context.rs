//! The memory that skinning works in.

use super::palette::Palette;
use crate::math::RigidTransformF64;

/// Memory that a skinning call works in and that the next call uses again: how each joint of each character moves what
/// follows it.
///
/// It says nothing about results, which are the same with a new one; it only saves allocations. Keep one per character or
/// per thread that skins. It grows to the most joints and characters of a call and shrinks when it is dropped.
#[derive(Clone, Debug, Default)]
pub struct SkinContext {
    /// Posed `model_from_joint` of the character at hand.
    pub(super) posed: Vec<RigidTransformF64>,
    /// One per character.
    pub(super) palettes: Vec<Palette>,
}
