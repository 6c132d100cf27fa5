//! Skinning: a posed skeleton deforms the vertices and normals of a surface; builds on [`pose`](crate::pose).
//!
//! A [`Skinner`] holds a surface in its bind pose; it is immutable and may be shared between threads. [`Skinner::skin`]
//! poses one character, [`skin_many`] any number of them, on all threads of the pool, into the caller's buffers:
//! [`SurfaceMut`]. Both use the caller's scratch memory, a [`SkinContext`]. Every vertex is computed independently with the
//! same operations in the same order, so the bits depend neither on the number of threads nor on the processor.
//!
//! Metres; right-handed; column vectors. With `D_j = posed model_from_joint · bind joint_from_model`, vertex x, its
//! unit normal n, offset Δ in bind space and weights w_j:
//!
//! | [`SkinMethod`] | position | normal |
//! |---|---|---|
//! | `Linear` | Σ w_j D_j (x + Δ) | (Σ w_j R_j) n, normalised |
//! | `DualQuaternion` | D (x + Δ), D the normalised Σ ± w_j d_j | R n |
//! | `JointTranslation` | x + Δ + Σ w_j (t_j − t_j at bind) | n |

mod block;
mod buffers;
mod context;
mod dual_quaternion;
mod joint_translation;
mod linear;
mod palette;
mod rigid;
mod skinner;
#[cfg(feature = "test-hooks")]
#[doc(hidden)]
pub mod test_hooks;
#[cfg(test)]
mod tests;

pub use buffers::{BytesMut, StridedMut, SurfaceMut};
pub use context::SkinContext;
pub use skinner::{SkinJob, SkinMethod, Skinner, skin_many};
