//! Relaxed hands, for sources without fingers.

use glam::Vec3;

use super::Joints;
use crate::math::Rotation;
use crate::skeleton::Finger;

/// Curl of each finger's joints beyond the rest pose, degrees, in the order of [`Finger::index`] and from the palm outwards: a
/// hanging hand curls more towards the little finger.
const CURLS: [[f32; 3]; 5] =
    [[4.0, 6.0, 10.0], [10.0, 14.0, 8.0], [14.0, 16.0, 10.0], [17.0, 18.0, 12.0], [20.0, 20.0, 14.0]];

/// Rotation of `parent_from_joint` of a relaxed finger's joint, which is its `number`th from the palm outwards, 1 to 3.
pub(super) fn relaxed(joints: &Joints, joint: usize, finger: Finger, number: usize) -> Option<Rotation> {
    let degrees = CURLS[finger.index()][number - 1];
    let rest = &joints.target_rest[joint];
    // In the T-pose palms face down. A finger curls about the axis at right angles to its bone and to the palm's direction. So
    // does a thumb, whose tip already points towards the middle of the palm.
    let bone = rest.rotation * Vec3::Y;
    let axis = rest.rotation.conjugate() * bone.cross(Vec3::NEG_Y).try_normalize()?;
    Some(
        joints.target.rest_pose().locals[joint].rotation
            * Rotation::from_axis_angle(axis, degrees.to_radians()),
    )
}
