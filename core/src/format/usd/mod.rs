//! USD with UsdSkel: text, crate and package.

pub(crate) mod document;
pub(crate) mod motion;
pub(crate) mod read;
pub(crate) mod skeleton;
mod track;
pub(crate) mod values;
pub(crate) mod write;
pub(crate) mod xform;

pub use read::{from_bytes, scene_from_bytes};
pub use write::{to_usda, to_usdc, to_usdz};
