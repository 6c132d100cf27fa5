//! Hands at ease, for sources that say nothing of fingers.

use glam::Vec3;

use super::Joints;
use crate::math::Rotation;
use crate::skeleton::Finger;

/// Degrees by which a joint of each finger curls beyond the rest pose, in the order of
/// [`Finger::index`] and from the palm outwards: a hand that hangs curls more towards the little finger.
const CURLS: [[f32; 3]; 5] =
    [[4.0, 6.0, 10.0], [10.0, 14.0, 8.0], [14.0, 16.0, 10.0], [17.0, 18.0, 12.0], [20.0, 20.0, 14.0]];

/// `parent_from_joint` of a finger's joint at ease, which is its `number`th from the palm outwards, 1 to 3.
pub(super) fn relaxed(joints: &Joints, joint: usize, finger: Finger, number: usize) -> Option<Rotation> {
    let degrees = CURLS[finger.index()][number - 1];
    let rest = &joints.target_rest[joint];
    // In the T-pose palms look down; a finger curls about the axis across it and the way the palm looks. A thumb curls
    // towards the palm's middle, which is the way its tip already leans: about the same axis.
    let bone = rest.rotation * Vec3::Y;
    let axis = rest.rotation.conjugate() * bone.cross(Vec3::NEG_Y).try_normalize()?;
    Some(
        joints.target.rest_pose().locals[joint].rotation
            * Rotation::from_axis_angle(axis, degrees.to_radians()),
    )
}
