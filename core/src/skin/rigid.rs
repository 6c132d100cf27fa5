//! Rigid motions of joints in double precision.

use glam::{DQuat, DVec3};

use crate::math::RigidTransform;
use crate::{Error, Result};

/// A rigid motion in double precision, so that the two poses of a joint cancel where it rests.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) rotation: DQuat,
    pub(super) translation: DVec3,
}

impl Motion {
    pub(super) fn after(&self, inner: &Self) -> Self {
        Self {
            rotation: self.rotation * inner.rotation,
            translation: self.translation + self.rotation * inner.translation,
        }
    }

    pub(super) fn inverse(&self) -> Self {
        let rotation = self.rotation.conjugate();
        Self { rotation, translation: rotation * -self.translation }
    }
}

/// Checked and normalised, into a list that is emptied first.
pub(super) fn motions(what: &'static str, joints: &[RigidTransform], out: &mut Vec<Motion>) -> Result<()> {
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
        out.push(Motion { rotation: rotation.normalize(), translation });
    }
    Ok(())
}
