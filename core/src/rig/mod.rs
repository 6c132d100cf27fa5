//! The skeleton, its skin weights, and what other programs call its joints.

pub mod humanoid;
mod skeleton;
mod skin_weights;
pub(crate) mod written;

pub use skeleton::{Joint, Skeleton, SkeletonShape};
pub use skin_weights::{Influences, SkinWeights};
