//! Whether the root moves as far as the legs say. Programs that convert a skeleton's unit sometimes leave the root's way in the old
//! one: a foot on the floor then slides.

use glam::Vec3;

use super::figure::Figure;
use super::raw::{RawMotion, Take};
use crate::math::RigidTransform;
use crate::skeleton::model_from_joints;
use crate::space::{Axis, Unit};

/// Ratios of the root's way to that of the legs which are put down to other causes than units: assumed lengths, jumps, feet that
/// slide.
const ALIKE: std::ops::Range<f64> = 0.4..2.5;
/// Least square of the correlation between the ways of root and foot.
const CORRELATED: f64 = 0.6;
/// Seconds between compared frames.
const STEP: f64 = 1.0 / 15.0;
/// Most frames that are compared, of each take.
const MOST: usize = 4096;

/// Sums over pairs of frames with the same foot on the floor.
#[derive(Default)]
struct Ways {
    /// Of the foot relative to the hips, squared.
    foot: f64,
    /// Of the root, squared.
    root: f64,
    /// Their product.
    both: f64,
    /// Heights of the root, and of the hips above the lower foot.
    heights: [f64; 2],
}

/// Scales the translations of the root where they are in another unit than the bones, and says so; says, too, where they fit no
/// unit.
pub(super) fn fit_root(raw: &mut RawMotion, figure: &Figure, up: Axis) {
    let parents = raw.skeleton.parents();
    let above: Vec<usize> =
        std::iter::successors(Some(figure.pelvis), |&joint| parents[joint].map(|p| p as usize)).collect();
    let mut ways = Ways::default();
    for take in &raw.takes {
        ways.add(raw, take, figure, &above, up.direction());
    }
    let leg = ways.heights[1];
    let ratio = ways.both / ways.foot;
    let level = (0.7..1.4).contains(&(ways.heights[0] / leg));
    let correlated = ways.both * ways.both > CORRELATED * ways.foot * ways.root;
    if !correlated || level || !(ratio.is_finite() && ratio > 0.0) || ALIKE.contains(&ratio) {
        return;
    }
    let Some((root, bones)) = units(ratio) else {
        raw.warnings.push(format!(
            "the root moves {ratio:.3} times as far as the feet on the floor say: its translation may be in another unit \
             than the lengths of bones"
        ));
        return;
    };
    let scale = (root.metres() / bones.metres()) as f32;
    for track in raw.takes.iter_mut().flat_map(|take| &mut take.tracks) {
        if above.contains(&(track.joint as usize)) {
            track.values.iter_mut().for_each(|v| *v *= scale);
        }
    }
    raw.warnings.push(format!(
        "the root's translation is in another unit than the lengths of bones, {root} where they are in {bones} or so: it was \
         scaled by {scale}, by which feet on the floor stay where they are"
    ));
}

/// Units of root and bones whose ratio this is: powers of ten are far apart, others need to fit.
fn units(ratio: f64) -> Option<(Unit, Unit)> {
    let common = [Unit::Metre, Unit::Centimetre, Unit::Millimetre, Unit::Decimetre, Unit::Inch, Unit::Foot];
    let metric = |unit: Unit| !matches!(unit, Unit::Inch | Unit::Foot);
    let pairs = common.into_iter().flat_map(|root| common.map(|bones| (root, bones)));
    let off = |(root, bones): &(Unit, Unit)| libm::log(ratio * root.metres() / bones.metres()).abs();
    let fits = |pair: &(Unit, Unit)| off(pair) < if metric(pair.0) && metric(pair.1) { 0.3 } else { 0.1 };
    // Of pairs with the same ratio the first, which is the most common.
    pairs.filter(fits).min_by_key(|pair| (off(pair) * 1e6).round() as u32)
}

impl Ways {
    fn add(&mut self, raw: &RawMotion, take: &Take, figure: &Figure, above: &[usize], up: Vec3) {
        let joints = raw.skeleton.len();
        let step = ((take.frames_per_second * STEP).round() as usize).max(1);
        let frames = (take.rotations.len() / joints / step).min(MOST);
        if !take.tracks.iter().any(|track| above.contains(&(track.joint as usize))) {
            return;
        }
        let mut before: Option<(Vec3, [Vec3; 2])> = None;
        let (mut world, mut sums, mut leg) = (Vec::new(), Self::default(), 0.0f32);
        for frame in (0..frames).map(|i| i * step) {
            let (full, still) = poses(raw, take, frame, above);
            model_from_joints(raw.skeleton.parents(), &still, &mut world);
            let held = world[figure.pelvis].translation;
            model_from_joints(raw.skeleton.parents(), &full, &mut world);
            let pelvis = world[figure.pelvis].translation;
            let (root, feet) = (pelvis - held, figure.feet().map(|foot| world[foot].translation - pelvis));
            let lower = usize::from(feet[1].dot(up) < feet[0].dot(up));
            sums.heights[0] += f64::from(root.dot(up)) / frames as f64;
            sums.heights[1] -= f64::from(feet[lower].dot(up)) / frames as f64;
            leg = leg.max(feet[lower].length());
            if let Some((root_before, feet_before)) = before
                && (feet_before[lower].dot(up) <= feet_before[1 - lower].dot(up))
            {
                let [foot, root] = [feet_before[lower] - feet[lower], root - root_before].map(Vec3::as_dvec3);
                sums.foot += foot.length_squared();
                sums.root += root.length_squared();
                sums.both += foot.dot(root);
            }
            before = Some((root, feet));
        }
        // Legs that hardly move tell nothing.
        if sums.foot.sqrt() > 0.05 * f64::from(leg) && sums.both.is_finite() {
            self.foot += sums.foot;
            self.root += sums.root;
            self.both += sums.both;
            self.heights = sums.heights;
        }
    }
}

/// The pose of a frame, and the same without translations of these joints.
fn poses(
    raw: &RawMotion,
    take: &Take,
    frame: usize,
    above: &[usize],
) -> (Vec<RigidTransform>, Vec<RigidTransform>) {
    let mut full = raw.skeleton.rest_pose().locals.clone();
    for (local, rotation) in full.iter_mut().zip(&take.rotations[frame * raw.skeleton.len()..]) {
        local.rotation = *rotation;
    }
    let mut still = full.clone();
    for track in &take.tracks {
        let joint = track.joint as usize;
        full[joint].translation = track.values[frame];
        still[joint].translation = if above.contains(&joint) { Vec3::ZERO } else { track.values[frame] };
    }
    (full, still)
}
