//! The common result of all motion readers: a motion in the units and axes of its file.

use glam::Vec3;

use super::Found;
use crate::clip::{MAX_FRAMES, TranslationTrack};
use crate::error::Fault;
use crate::math::{RigidTransform, RigidTransformF64, Rotation};
use crate::skeleton::Skeleton;
use crate::space::{Axis, Unit};

/// A skeleton and its motions as stored in a file.
#[derive(Debug)]
pub(crate) struct RawMotion {
    /// The format's name.
    pub(crate) format: &'static str,
    /// In the file's unit and axes.
    pub(crate) skeleton: Skeleton,
    pub(crate) takes: Vec<Take>,
    /// The unit stated by the file, if any.
    pub(crate) unit: Option<Unit>,
    /// The up axis stated by the file, if any.
    pub(crate) up: Option<Axis>,
    /// The rest pose is +Y up regardless of the motion's up axis.
    pub(crate) rest_is_upright: bool,
    pub(crate) rate_found: Found,
    pub(crate) warnings: Vec<String>,
}

/// One motion.
#[derive(Debug)]
pub(crate) struct Take {
    pub(crate) name: String,
    pub(crate) frames_per_second: f64,
    /// Frames × joints.
    pub(crate) rotations: Vec<Rotation>,
    pub(crate) tracks: Vec<TranslationTrack>,
    /// Morph target weights, for characters with morph targets.
    pub(crate) weights: Vec<WeightTrack>,
}

/// The weight of the morph targets identified by a token.
#[derive(Debug)]
pub(crate) struct WeightTrack {
    pub(crate) token: String,
    /// One per frame.
    pub(crate) weights: Vec<f32>,
}

/// Renames every joint that repeats an earlier name, with a warning.
pub(crate) fn make_unique(names: &mut [String], warnings: &mut Vec<String>) {
    let all: std::collections::BTreeSet<String> = names.iter().cloned().collect();
    let mut counts = std::collections::BTreeMap::<String, usize>::new();
    let mut taken = std::collections::BTreeSet::new();
    for name in names {
        if taken.insert(name.clone()) {
            continue;
        }
        let count = counts.entry(name.clone()).or_default();
        let fresh = loop {
            *count += 1;
            let candidate = format!("{name}.{count}");
            if !all.contains(&candidate) && !taken.contains(&candidate) {
                break candidate;
            }
        };
        warnings.push(format!("a second joint `{name}` was renamed to `{fresh}`"));
        taken.insert(fresh.clone());
        *name = fresh;
    }
}

/// Rounds a rate within 0.02 % of a whole number to it: 1 / 0.0333333 becomes 30.
pub(crate) fn snapped_rate(rate: f64) -> f64 {
    let whole = rate.round();
    if whole >= 1.0 && (rate / whole - 1.0).abs() < 2e-4 { whole } else { rate }
}

/// Translation tracks of the joints that leave their rest position; `columns` holds every joint's translations.
pub(crate) fn moving(rest: &[RigidTransform], columns: Vec<Vec<Vec3>>) -> Vec<TranslationTrack> {
    let longest = rest.iter().map(|l| l.translation.length()).fold(0.0, f32::max);
    // Accumulated rounding, relative to the size of the skeleton.
    let tolerance = 4e-6 * longest;
    let moves = |joint: usize, values: &[Vec3]| {
        let rest = rest[joint].translation;
        // NaN counts as movement, so that the clip's own check finds it.
        !values.iter().all(|v| v.distance(rest) <= tolerance)
    };
    let tracks = columns.into_iter().enumerate().filter(|(joint, values)| moves(*joint, values));
    tracks.map(|(joint, values)| TranslationTrack { joint: joint as u32, values }).collect()
}

/// Each joint's `parent_from_joint`, for joints that come after their parents.
pub(crate) fn parent_from_joints(
    world: &[RigidTransformF64],
    parents: &[Option<u32>],
) -> Vec<RigidTransform> {
    let local = |(joint, parent): (&RigidTransformF64, &Option<u32>)| {
        let parent = parent.and_then(|p| world.get(p as usize));
        parent.map_or(*joint, |parent| joint.relative_to(*parent)).rounded()
    };
    world.iter().zip(parents).map(local).collect()
}

/// Collects frames of local transforms into a take.
pub(crate) struct Recorder {
    rotations: Vec<Rotation>,
    columns: Vec<Vec<Vec3>>,
}

impl Recorder {
    pub(crate) fn new(joints: usize) -> Self {
        Self { rotations: Vec::new(), columns: vec![Vec::new(); joints] }
    }

    pub(crate) fn push(&mut self, locals: &[RigidTransform]) {
        for (local, column) in locals.iter().zip(&mut self.columns) {
            self.rotations.push(local.rotation);
            column.push(local.translation);
        }
    }

    pub(crate) fn take(self, name: String, frames_per_second: f64, rest: &[RigidTransform]) -> Take {
        Take {
            name,
            frames_per_second,
            rotations: self.rotations,
            tracks: moving(rest, self.columns),
            weights: Vec::new(),
        }
    }
}

/// Number of frames of a motion, if a clip with this many joints may have them.
pub(crate) fn frame_count(seconds: f64, rate: f64, joints: usize) -> Result<usize, Fault> {
    // Each joint is evaluated from curves in each frame: a few bytes of a file must not demand unbounded work.
    const MOST: u32 = 1 << 24;
    let frames = (seconds * rate).round() + 1.0;
    if (0.0..=MAX_FRAMES as f64).contains(&frames) && frames * joints as f64 <= f64::from(MOST) {
        return Ok(frames as usize);
    }
    Err(Fault::too_many(
        format_args!("{MAX_FRAMES} frames and {MOST} rotations"),
        format_args!("{seconds} s at {rate} frames a second of {joints} joints"),
    ))
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DQuat, DVec3};

    use super::*;

    #[test]
    fn names_become_unique() {
        let mut names = ["a", "b", "a", "a.1", "a"].map(String::from);
        let mut warnings = Vec::new();
        make_unique(&mut names, &mut warnings);
        assert_eq!(names, ["a", "b", "a.2", "a.1", "a.3"]);
        assert_eq!(warnings.len(), 2);
    }

    #[test]
    fn rates_snap_to_what_was_meant() {
        let rates = [1.0 / 0.0333333, 1.0 / 0.008333, 1.0 / 0.03333, 30_000.0 / 1001.0];
        assert_eq!(rates.map(snapped_rate), [30.0, 120.0, 30.0, 30_000.0 / 1001.0]);
    }

    #[test]
    fn scale_is_folded_into_translations() {
        let turn = DQuat::from_rotation_z(0.4);
        let parent = DAffine3::from_scale_rotation_translation(DVec3::splat(2.0), turn, DVec3::X);
        let child = parent * DAffine3::from_translation(DVec3::Y);
        let locals = parent_from_joints(
            &[RigidTransformF64::without_scale(&parent), RigidTransformF64::without_scale(&child)],
            &[None, Some(0)],
        );
        assert!(locals[1].translation.distance(Vec3::Y * 2.0) < 1e-6);
        assert!(locals[1].rotation.angle_between(Rotation::IDENTITY) < 1e-3);
        assert!(locals[0].rotation.dot(turn.into()) > 0.999_999);
    }

    #[test]
    fn a_long_motion_is_refused() {
        assert_eq!(frame_count(2.0, 30.0, 50), Ok(61));
        for seconds in [1e9, f64::NAN, f64::INFINITY, -1.0] {
            assert!(matches!(frame_count(seconds, 30.0, 50), Err(Fault::TooMany { .. })));
        }
        assert!(frame_count(10_000.0, 30.0, 4000).is_err());
    }
}
