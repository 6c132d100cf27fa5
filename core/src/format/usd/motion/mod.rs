//! Reads SkelAnimations of `.usda`, `.usdc` and `.usdz` (openusd.org, "UsdSkel: Schemas In-Depth").
//!
//! Transforms of the prims above the skeleton, animated or
//! not, are applied to its root joints; joint scales are folded into the translations below them.

mod track;

use glam::{DAffine3, DQuat};
use openusd::sdf::Path;

use self::track::{Track, merged};
use super::Result;
use super::document::Document;
use super::document::layer::Layer;
use super::document::skeleton::{Joints, Skeleton};
use super::document::xform::Xforms;
use crate::error::{Fault, UsdError, Within};
use crate::format::motion::bind::rest_from_bind;
use crate::format::motion::raw::{
    RawMotion, Recorder, Take, WeightTrack, frame_count, make_unique, parent_from_joints, snapped_rate,
};
use crate::format::motion::{Found, ReadOptions};
use crate::math::{RigidTransform, RigidTransformF64};
use crate::space::{Axis, Unit};

/// Maximum number of joints of an animation; those that the skeleton does not have are ignored.
const MAX_JOINTS: usize = crate::skeleton::MAX_JOINTS;
/// Keys at a lower rate, per second, are poses to interpolate, not frames.
const LEAST_FRAME_RATE: f64 = 10.0;

/// Reads every animation of the skeleton chosen by [`Document::skeleton`]. `name` is for unnamed clips.
pub(super) fn read(document: &Document, name: &str, options: &ReadOptions) -> Result<RawMotion> {
    if document.animations.is_empty() {
        let prims = document.prims.len();
        let missing = document.missing.iter().cloned().chain(value_clips(document));
        let missing: String = missing.map(|missing| format!("; {missing}")).collect();
        return Err(Fault::missing(format_args!("SkelAnimation among {prims} prims{missing}")).into());
    }
    let skeleton = document.skeleton()?.ok_or_else(|| Fault::missing("Skeleton beside the SkelAnimation"))?;
    of_skeleton(document, &skeleton, name, options)
}

/// Reads every animation that moves this skeleton, the bound one first.
pub(super) fn of_skeleton(
    document: &Document,
    skeleton: &Skeleton,
    name: &str,
    options: &ReadOptions,
) -> Result<RawMotion> {
    let (layer, Skeleton { prim, joints, above, animation: bound }) = (&document.layer, skeleton);
    let mut warnings: Vec<String> = document.missing.iter().map(|m| format!("left out: {m}")).collect();
    warnings.extend(value_clips(document));
    let skeletons = document.skeleton_count();
    if skeletons > 1 {
        warnings.push(format!("{skeletons} skeletons: {prim} is read"));
    }
    let rate = TimeCodes::read(layer)?;
    let mut takes = Vec::new();
    let mut ordered: Vec<&Path> = document.animations.iter().collect();
    ordered.sort_by_key(|path| Some(*path) != bound.as_ref());
    let rest = rest(layer, skeleton)?;
    for path in ordered {
        let animation = Animation::read(layer, path, joints)?;
        if animation.joints.iter().all(Option::is_none) {
            warnings.push(format!("{path}: moves no joint of {prim}, left out"));
            continue;
        }
        let title = layer.text(path, "displayName")?.or_else(|| path.name().map(String::from));
        let title = title.unwrap_or_else(|| name.to_owned());
        takes.push(animation.take(title, (joints, &rest), above, &rate, options)?);
    }
    if takes.is_empty() {
        return Err(Fault::missing(format_args!("SkelAnimation that moves a joint of {prim}")).into());
    }
    let mut names = joints.names.clone();
    make_unique(&mut names, &mut warnings);
    let ends = vec![None; names.len()];
    let rest_skeleton =
        crate::skeleton::Skeleton::new(names, joints.parents.clone(), rest, ends).map_err(Box::new)?;
    Ok(RawMotion {
        format: "USD",
        skeleton: rest_skeleton,
        takes,
        unit: layer.number("metersPerUnit")?.and_then(Unit::from_metres),
        up: match layer.text(&Path::abs_root(), "upAxis")?.as_deref() {
            Some("Y") => Some(Axis::Y),
            Some("Z") => Some(Axis::Z),
            _ => None,
        },
        rest_is_upright: false,
        rate_found: if options.frames_per_second.is_some() { Found::Asked } else { rate.found },
        warnings,
    })
}

/// What to say of value clips: animation in other files, a file for a span of time each.
fn value_clips(document: &Document) -> Option<String> {
    let prims: Vec<String> = document.value_clips.iter().map(Path::to_string).collect();
    (!prims.is_empty()).then(|| format!("value clips are not read: {} has them", prims.join(", ")))
}

/// `parent_from_joint` of every joint in the pose of `bindTransforms`, where that is another than that of `restTransforms`,
/// which may be a frame of a motion.
fn rest(layer: &Layer, Skeleton { prim, joints, above, .. }: &Skeleton) -> Result<Vec<RigidTransform>> {
    let above = above.at_start()?;
    let nodes = joints.locals(&above);
    let bind = joints.bind_pose(layer, prim, &DAffine3::IDENTITY)?;
    let bind: Vec<_> = bind.iter().map(|joint| Some(RigidTransformF64::without_scale(joint))).collect();
    let turns = [RigidTransformF64::without_scale(&above).rotation, DQuat::IDENTITY];
    Ok(rest_from_bind(&nodes, &joints.parents, &bind, &turns).unwrap_or(nodes))
}

/// Time codes per second, and the source of that value.
struct TimeCodes {
    per_second: f64,
    found: Found,
}

impl TimeCodes {
    fn read(layer: &Layer) -> Result<Self> {
        let stated = match layer.number("timeCodesPerSecond")? {
            Some(rate) => Some(rate),
            None => layer.number("framesPerSecond")?,
        };
        // USD's default.
        let per_second = stated.unwrap_or(24.0);
        if !(1e-3..=1e6).contains(&per_second) {
            return Err(Fault::unexpected("a positive number", per_second).into())
                .within("timeCodesPerSecond");
        }
        Ok(Self { per_second, found: if stated.is_some() { Found::File } else { Found::Assumed } })
    }
}

/// A SkelAnimation's joints and their tracks.
struct Animation {
    /// For each joint of the skeleton, its index in the animation.
    joints: Vec<Option<usize>>,
    rotations: Track<4>,
    translations: Track<3>,
    scales: Track<3>,
    /// The token of each row of `weights`, which identifies its morph targets.
    tokens: Vec<String>,
    weights: Track<1>,
}

impl Animation {
    fn read(layer: &Layer, path: &Path, skeleton: &Joints) -> Result<Self> {
        let own = layer.tokens(path, "joints")?.unwrap_or_default();
        if own.is_empty() || own.len() > MAX_JOINTS {
            return Err(Fault::unexpected(format_args!("1 to {MAX_JOINTS} joints"), own.len()).into())
                .within(format_args!("{path}.joints"));
        }
        let place: std::collections::BTreeMap<&str, usize> =
            own.iter().enumerate().map(|(i, joint)| (joint.as_str(), i)).collect();
        let tokens = layer.tokens(path, "blendShapes")?.unwrap_or_default();
        Ok(Self {
            weights: match tokens.len() {
                0 => Track::none(),
                count => Track::read(layer, path, "blendShapeWeights", count)?,
            },
            tokens,
            joints: skeleton.paths.iter().map(|joint| place.get(joint.as_str()).copied()).collect(),
            rotations: Track::read(layer, path, "rotations", own.len())?,
            translations: Track::read(layer, path, "translations", own.len())?,
            scales: Track::read(layer, path, "scales", own.len())?,
        })
    }

    fn take(
        &self,
        name: String,
        (joints, rest): (&Joints, &[RigidTransform]),
        above: &Xforms,
        rate: &TimeCodes,
        options: &ReadOptions,
    ) -> Result<Take> {
        let times = merged(
            [self.rotations.times(), self.translations.times(), self.scales.times()]
                .into_iter()
                .chain(above.times()),
        );
        // Key times of the joints if any is animated; else those of the weights.
        let times = if times.is_empty() { self.weights.times() } else { times };
        let (start, end) = (times.first().copied().unwrap_or(0.0), times.last().copied().unwrap_or(0.0));
        let seconds = (end - start) / rate.per_second;
        let frames_per_second =
            options.frames_per_second.unwrap_or_else(|| frame_rate(&times, rate.per_second));
        let frames = frame_count(seconds, frames_per_second, joints.parents.len())
            .map_err(UsdError::from)
            .within(format_args!("`{name}`"))?;

        let mut recorder = Recorder::new(joints.parents.len());
        let mut world: Vec<DAffine3> = Vec::with_capacity(joints.parents.len());
        let time = |frame: usize| start + frame as f64 / frames_per_second * rate.per_second;
        for time in (0..frames).map(time) {
            let rotations = self.rotations.at(time);
            let (translations, scales) = (self.translations.at(time), self.scales.at(time));
            let root = above.at(time)?;
            world.clear();
            for (joint, parent) in joints.parents.iter().enumerate() {
                let mut local = joints.rest[joint];
                if let Some(own) = self.joints[joint] {
                    if let Some(rotation) = rotations.get(own) {
                        local.rotate(*rotation);
                    }
                    if let Some(translation) = translations.get(own) {
                        local.translation = glam::DVec3::from_array(*translation);
                    }
                    if let Some(scale) = scales.get(own) {
                        local.scale = glam::DVec3::from_array(*scale);
                    }
                }
                let parent = parent.and_then(|p| world.get(p as usize)).unwrap_or(&root);
                world.push(*parent * local.to_affine());
            }
            let rigid: Vec<RigidTransformF64> = world.iter().map(RigidTransformF64::without_scale).collect();
            recorder.push(&parent_from_joints(&rigid, &joints.parents));
        }
        let mut take = recorder.take(name, frames_per_second, rest);
        let weights: Vec<Vec<[f64; 1]>> = (0..frames).map(|frame| self.weights.at(time(frame))).collect();
        let of_token = |(i, token): (usize, &String)| WeightTrack {
            token: token.clone(),
            weights: weights.iter().filter_map(|row| row.get(i)).map(|[weight]| *weight as f32).collect(),
        };
        if self.weights.has_values() {
            take.weights = self.tokens.iter().enumerate().map(of_token).collect();
        }
        Ok(take)
    }
}

/// Frame rate of keys at these time codes: their own if they are evenly spaced, else that of the time codes.
fn frame_rate(times: &[f64], time_codes_per_second: f64) -> f64 {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return time_codes_per_second };
    let gap = (last - first) / (times.len() - 1).max(1) as f64;
    let even = times.iter().enumerate().all(|(i, t)| (t - (first + i as f64 * gap)).abs() <= gap * 1e-3);
    let rate = snapped_rate(time_codes_per_second / gap);
    if even && rate.is_finite() && rate >= LEAST_FRAME_RATE { rate } else { time_codes_per_second }
}

#[cfg(test)]
pub(in crate::format) mod tests;
