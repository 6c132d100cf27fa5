//! The way of a person whose file has none.

use glam::Vec3;

use super::figure::Figure;
use super::raw::RawMotion;
use crate::clip::TranslationTrack;
use crate::math::RigidTransform;
use crate::skeleton::model_from_joints;
use crate::space::Axis;

/// Gives the root a height, by which the lowest joint is on the floor in every frame. Up is as asked, or as the person stands, or
/// as the file says.
pub(crate) fn stand_on_floor(raw: &mut RawMotion, asked: Option<Axis>) {
    let stance = Figure::of(&raw.skeleton).and_then(|figure| figure.stance(raw));
    let seen = stance.and_then(|stance| stance.axis());
    let up = asked.or(seen).or(raw.up).unwrap_or(Axis::Y);
    raw.up = Some(up);
    let (parents, ends) = (raw.skeleton.parents(), raw.skeleton.ends());
    let mut pose = raw.skeleton.rest_pose().locals.clone();
    pose[0].translation = Vec3::ZERO;
    let mut world = Vec::new();
    for take in &mut raw.takes {
        let mut values = Vec::with_capacity(take.rotations.len() / pose.len());
        for rotations in take.rotations.chunks_exact(pose.len()) {
            for (local, rotation) in pose.iter_mut().zip(rotations) {
                local.rotation = *rotation;
            }
            model_from_joints(parents, &pose, &mut world);
            let height = |(joint, end): (&RigidTransform, &Option<Vec3>)| {
                let end = joint.translation + joint.rotation * end.unwrap_or_default();
                end.dot(up.direction()).min(joint.translation.dot(up.direction()))
            };
            let lowest = world.iter().zip(ends).map(height).fold(f32::INFINITY, f32::min);
            values.push(up.direction() * -lowest);
        }
        take.tracks.retain(|track| track.joint != 0);
        take.tracks.push(TranslationTrack { joint: 0, values });
    }
}
