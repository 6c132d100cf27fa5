//! The memory that sampling and skinning work in.

use anthronet::math::RigidTransform;
use anthronet::skeleton::Pose;
use anthronet::skin::SkinContext;

use crate::pointer::{Out, change, free};
use crate::status::{Outcome, anthronet_error, anthronet_status, guard};

/// Memory that sampling and skinning work in, used again by the next call: it saves allocations and changes no result. Keep
/// one per character or per thread that calls; one call at a time may use it. It grows as calls need and is freed as a
/// whole. Where a function takes one, NULL stands for memory that is made for the call.
#[derive(Default)]
pub struct anthronet_context {
    /// The pose that is sampled.
    pub(crate) pose: Pose,
    /// Its joints relative to the model.
    pub(crate) model: Vec<RigidTransform>,
    /// The joints of all jobs that are skinned, one job after the other.
    pub(crate) joints: Vec<RigidTransform>,
    /// What the library computes of them.
    pub(crate) skin: SkinContext,
}

impl anthronet_context {
    /// The caller's, or `own` where the caller passes none.
    pub(crate) fn of(pointer: *mut Self, own: &mut Self) -> Outcome<&mut Self> {
        if pointer.is_null() { Ok(own) } else { change(pointer, "context") }
    }
}

/// Makes a context, which holds nothing yet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_context_new(
    out_context: *mut *mut anthronet_context,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        Out::new(out_context, "out_context")?.give(anthronet_context::default());
        Ok(())
    })
}

/// Frees a context; NULL is nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_context_free(context: *mut anthronet_context) {
    free(context);
}
