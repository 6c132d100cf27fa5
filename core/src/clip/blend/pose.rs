//! Blending and adding poses of one skeleton.

use super::JointMask;
use crate::clip::sample::mix;
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::Pose;

/// Interpolates poses of one skeleton in place: `a` stays at weight 0 and becomes `b` at 1; each joint's weight is multiplied
/// by `mask`.
pub fn blend_pose(a: &mut Pose, b: &Pose, weight: f32, mask: &JointMask) {
    for (joint, (a, b)) in a.locals.iter_mut().zip(&b.locals).enumerate() {
        *a = mix(*a, *b, weight * mask.weight(joint));
    }
}

/// A pose for [`blend_poses`], or a clip for [`blend_layers`](super::blend_layers), with its weight.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a, T> {
    /// The pose or clip.
    pub of: &'a T,
    /// Its weight relative to the other layers, not negative; weights need not add up to 1.
    pub weight: f32,
    /// A factor of the weight per joint; `None` is 1 for all.
    pub mask: Option<&'a JointMask>,
}

impl<T> Layer<'_, T> {
    fn weight_of(&self, joint: usize) -> f32 {
        self.weight * self.mask.map_or(1.0, |mask| mask.weight(joint))
    }
}

/// The sum of weights below which a joint blends towards rest, so that a single layer that fades out ends at rest.
const FULL_WEIGHT: f32 = 0.1;

/// Blends any number of poses of one skeleton into `out`. Each joint is the weighted mean of the layers, in any order but for
/// rounding: rotations as normalised sums of quaternions, translations as sums. Where weights add up to less than 0.1, `rest`
/// has the remainder, so that nothing jumps when they vanish.
///
/// Layers whose poses have fewer joints than `rest` do not affect the others.
pub fn blend_poses(layers: &[Layer<'_, Pose>], rest: &Pose, out: &mut Pose) {
    out.locals.clear();
    out.locals.extend(rest.locals.iter().enumerate().map(|(joint, rest)| {
        let mut weighted = layers.iter().filter_map(|layer| {
            let (local, weight) = (layer.of.locals.get(joint)?, layer.weight_of(joint));
            (weight > 0.0).then_some((local, weight))
        });
        let Some((first, weight)) = weighted.next() else { return *rest };
        let mut total = weight;
        let mut rotation = first.rotation.sum(weight, first.rotation, 0.0);
        let mut translation = first.translation * weight;
        // A quaternion and its negative are the same rotation: give all of them the sign of the first.
        let same_sign = |q: Rotation| if q.dot(first.rotation) < 0.0 { -q } else { q };
        for (local, weight) in weighted {
            total += weight;
            rotation = rotation.sum(1.0, same_sign(local.rotation), weight);
            translation += local.translation * weight;
        }
        let to_rest = FULL_WEIGHT - total;
        if to_rest > 0.0 {
            total = FULL_WEIGHT;
            rotation = rotation.sum(1.0, same_sign(rest.rotation), to_rest);
            translation += rest.translation * to_rest;
        }
        RigidTransform { rotation: rotation.normalize(), translation: translation / total }
    }));
}

/// Adds the difference between `layer` and `reference` to `base` in place: rotations in joint space, translations in the
/// parent's space.
pub fn add_pose(base: &mut Pose, layer: &Pose, reference: &Pose, weight: f32, mask: &JointMask) {
    for (joint, (base, (layer, reference))) in
        base.locals.iter_mut().zip(layer.locals.iter().zip(&reference.locals)).enumerate()
    {
        let weight = weight * mask.weight(joint);
        let delta = reference.rotation.conjugate() * layer.rotation;
        let delta = if delta.w < 0.0 { -delta } else { delta };
        *base = RigidTransform {
            rotation: (base.rotation * Rotation::IDENTITY.slerp(delta, weight)).normalize(),
            translation: base.translation + (layer.translation - reference.translation) * weight,
        };
    }
}
