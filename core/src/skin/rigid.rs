//! Converts the joints of a pose to double precision.

use glam::DQuat;

use crate::math::{RigidTransform, RigidTransformF64};
use crate::{Error, Result};

/// Checks and normalises the joints, and replaces the content of `out` with them.
pub(super) fn in_double(
    what: &'static str,
    joints: &[RigidTransform],
    out: &mut Vec<RigidTransformF64>,
) -> Result<()> {
    out.clear();
    for (j, joint) in joints.iter().enumerate() {
        let (rotation, translation) = (DQuat::from(joint.rotation), joint.translation.as_dvec3());
        // Also false for NaN.
        let unit = (rotation.length() - 1.0).abs() <= 1e-3;
        if !(unit && translation.is_finite()) {
            let message = format!(
                "joint {j}: expected a unit quaternion and finite metres, got {rotation} {translation}"
            );
            return Err(Error::invalid(what, message));
        }
        out.push(RigidTransformF64 { rotation: rotation.normalize(), translation });
    }
    Ok(())
}
