//! Mathematics that knows nothing of bodies: rigid transforms, factorisations, least squares, eased steps.

pub(crate) mod cholesky;
mod least_squares;
mod smoothstep;
mod transform;

pub(crate) use least_squares::least_squares;
pub(crate) use smoothstep::smoothstep;
pub use transform::RigidTransform;
pub(crate) use transform::unit;
