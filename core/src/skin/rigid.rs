//! Joints of a pose in double precision.

use glam::DQuat;

use crate::math::{RigidTransform, RigidTransformF64};
use crate::{Error, Result};

/// Checked and normalised, into a list that is emptied first.
pub(super) fn in_double(
    what: &'static str,
    joints: &[RigidTransform],
    out: &mut Vec<RigidTransformF64>,
) -> Result<()> {
    out.clear();
    for (j, joint) in joints.iter().enumerate() {
        let (rotation, translation) = (DQuat::from(joint.rotation), joint.translation.as_dvec3());
        // False for what is not a number, too.
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
