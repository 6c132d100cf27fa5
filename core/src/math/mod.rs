//! Mathematics that knows nothing of bodies: rigid transforms, factorisations.

pub(crate) mod cholesky;
mod transform;

pub use transform::RigidTransform;
pub(crate) use transform::unit;
