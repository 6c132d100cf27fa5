//! Mathematics that knows nothing of bodies: rotations, rigid transforms, factorisations, least squares, eased steps.

pub(crate) mod cholesky;
mod least_squares;
#[allow(clippy::disallowed_types, reason = "conversions from and to glam's, and the comparison with it")]
mod rotation;
mod smoothstep;
mod transform;

pub(crate) use least_squares::least_squares;
pub use rotation::Rotation;
pub(crate) use smoothstep::smoothstep;
pub use transform::RigidTransform;
pub(crate) use transform::unit;
