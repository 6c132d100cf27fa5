//! General mathematics: rotations, rigid transforms, Cholesky factors, least squares, smoothstep.

pub(crate) mod cholesky;
mod least_squares;
#[allow(
    clippy::disallowed_types,
    reason = "conversions to and from glam's quaternions, and tests against them"
)]
mod rotation;
mod smoothstep;
mod transform;

pub(crate) use least_squares::least_squares;
pub use rotation::Rotation;
pub(crate) use smoothstep::smoothstep;
pub use transform::RigidTransform;
pub(crate) use transform::{RigidTransformF64, unit};
