//! Poses of one skeleton, mixed and added.

use super::JointMask;
use crate::clip::sample::mix;
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::Pose;

/// Mixes poses of the same skeleton in place: `a` becomes `a` at weight 0 and `b` at 1.
pub fn blend_pose(a: &mut Pose, b: &Pose, weight: f32, mask: &JointMask) {
    for (joint, (a, b)) in a.locals.iter_mut().zip(&b.locals).enumerate() {
        *a = mix(*a, *b, weight * mask.weight(joint));
    }
}

/// One of the poses that [`blend_poses`] mixes, or of the clips that [`blend_layers`](super::blend_layers) does.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a, T> {
    /// What is mixed.
    pub of: &'a T,
    /// Its share beside the other layers', not negative; shares need not add up to 1.
    pub weight: f32,
    /// How much of that each joint takes; `None` is all of it.
    pub mask: Option<&'a JointMask>,
}

impl<T> Layer<'_, T> {
    fn weight_of(&self, joint: usize) -> f32 {
        self.weight * self.mask.map_or(1.0, |mask| mask.weight(joint))
    }
}

/// The sum of weights below which a joint goes back to rest, so that a layer that fades away alone fades to rest.
const FULL_WEIGHT: f32 = 0.1;

/// Mixes any number of poses of one skeleton into `out`. Each joint is the mean of the layers by their weights there, the same
/// in whatever order the layers come but for rounding: rotations by normalised sums of quaternions, translations by sums.
/// Where weights add up to less than 0.1 `rest` has the remainder, so that nothing jumps as they vanish.
///
/// Layers whose poses have fewer joints than `rest` leave the others out.
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
        // A quaternion and its negative are the same rotation: all on the side of the first.
        let same_side = |q: Rotation| if q.dot(first.rotation) < 0.0 { -q } else { q };
        for (local, weight) in weighted {
            total += weight;
            rotation = rotation.sum(1.0, same_side(local.rotation), weight);
            translation += local.translation * weight;
        }
        let to_rest = FULL_WEIGHT - total;
        if to_rest > 0.0 {
            total = FULL_WEIGHT;
            rotation = rotation.sum(1.0, same_side(rest.rotation), to_rest);
            translation += rest.translation * to_rest;
        }
        RigidTransform { rotation: rotation.normalize(), translation: translation / total }
    }));
}

/// Adds to a pose, in place, what `layer` differs from `reference` by: rotations in joint space, translations in the
/// parent's.
pub fn add_pose(base: &mut Pose, layer: &Pose, reference: &Pose, weight: f32, mask: &JointMask) {
    for (joint, (base, (layer, reference))) in
        base.locals.iter_mut().zip(layer.locals.iter().zip(&reference.locals)).enumerate()
    {
        let weight = weight * mask.weight(joint);
        let by = reference.rotation.conjugate() * layer.rotation;
        let by = if by.w < 0.0 { -by } else { by };
        *base = RigidTransform {
            rotation: (base.rotation * Rotation::IDENTITY.slerp(by, weight)).normalize(),
            translation: base.translation + (layer.translation - reference.translation) * weight,
        };
    }
}
