//! Converts a file's unit and axes to metres, +Y up: as requested, as stated by the file, or as inferred from its body.
//!
//! Files are often wrong about both: programs export centimetres as metres, or bodies upright along another axis than the
//! file states. People are 1.3 to 2.3 m tall and upright most of the time, which reveals most such mistakes.

use std::sync::Arc;

use super::bounds::{check_motion, jumps};
use super::figure::{Figure, Stance};
use super::proportions::Proportions;
use super::raw::{RawMotion, Take};
use super::stride::fit_root;
use super::{Found, Motion, ReadOptions, ReadReport};
use crate::clip::Clip;
use crate::skeleton::Skeleton;
use crate::space::{Axis, Unit};
use crate::{Error, Result};

/// Assumed stature of a body of unknown unit, metres.
const TYPICAL: f64 = 1.7;
/// Statures for which the file's own unit is trusted, metres: from babies to giants in games.
const PLAUSIBLE: std::ops::RangeInclusive<f64> = 0.4..=3.2;
/// Statures for which a detected unit is accepted without a warning, metres.
const ORDINARY: std::ops::RangeInclusive<f64> = 1.2..=2.3;

/// Converts a file's motion to clips in metres, +Y up.
///
/// # Errors
/// [`Invalid`](crate::Error::Invalid) when joints or motions are inconsistent, or beyond what a person can do.
pub(crate) fn resolve(mut raw: RawMotion, options: &ReadOptions) -> Result<Motion> {
    let huge = |fault: crate::error::Fault| Error::invalid("motion", fault.to_string());
    check_motion(&raw, None).map_err(huge)?;
    let body = Proportions::of(&raw);
    let height = body.stature(&raw);
    let (unit, unit_found) = unit(&mut raw, &body, height, options);
    let (mut up, mut up_found) = up(&mut raw, &body, options);
    let mut rest_up = if raw.rest_is_upright { Axis::Y } else { up };
    if let Some(figure) = &Figure::of(&convert_skeleton(&raw, unit, rest_up)?) {
        (up, up_found) = stand(&mut raw, figure, up, up_found);
        rest_up = rest_axis(&raw, figure, up);
        fit_root(&mut raw, figure, up);
    }
    check_motion(&raw, Some(unit.metres())).map_err(huge)?;
    raw.warnings.append(&mut jumps(&raw, unit.metres()));
    raw.warnings.append(&mut still_takes(&raw));
    let mut warnings = std::mem::take(&mut raw.warnings);
    let stature = height * unit.metres();
    if unit_found != Found::File && height > 0.0 && !ORDINARY.contains(&stature) {
        warnings.push(format!("with lengths in {unit} the body is about {stature:.2} m tall"));
    }

    convert_takes(&mut raw, unit, up);
    let rest = Arc::new(convert_skeleton(&raw, unit, rest_up)?);
    let rate = raw.takes.first().map_or(0.0, |take| take.frames_per_second);
    let clip = |take: Take| {
        Clip::new(take.name, Arc::clone(&rest), take.frames_per_second, take.rotations, take.tracks)
    };
    let clips = raw.takes.into_iter().map(clip).collect::<Result<Vec<_>>>()?;
    let report = ReadReport {
        format: raw.format,
        unit,
        unit_found,
        up,
        up_found,
        frames_per_second: rate,
        rate_found: raw.rate_found,
        stature,
        warnings,
    };
    Ok(Motion { clips, report })
}

fn unit(raw: &mut RawMotion, body: &Proportions, height: f64, options: &ReadOptions) -> (Unit, Found) {
    if let Some(unit) = options.unit {
        return (unit, Found::Asked);
    }
    if !(height.is_finite() && height > 0.0) {
        let unit = raw.unit.unwrap_or(Unit::Metre);
        return (unit, if raw.unit.is_some() { Found::File } else { Found::Assumed });
    }
    let off = |unit: &Unit| libm::log(height * unit.metres() / TYPICAL).abs();
    // Besides named units, errors in the file's own unit by a power of ten, usually a factor of 100 applied once too often.
    let powers =
        raw.unit.into_iter().flat_map(|said| [1e-4, 1e-3, 1e-2, 1e2, 1e3, 1e4].map(|p| said.metres() * p));
    let candidates = Unit::NAMED.into_iter().chain(powers.filter_map(Unit::from_metres));
    let mut likely = candidates.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(Unit::Metre);
    if let Some(said) = raw.unit {
        let was = height * said.metres();
        if !body.is_figure() || PLAUSIBLE.contains(&was) {
            return (said, Found::File);
        }
        raw.warnings.push(format!("the file says {said}, by which the body is {was:.3} m tall"));
    }
    if body.is_figure() && !ORDINARY.contains(&(height * likely.metres())) {
        likely = Unit::Metres(TYPICAL / height);
        raw.warnings.push(format!("no usual unit makes the body a person: it was scaled to {TYPICAL:.2} m"));
    } else if raw.unit.is_some() {
        raw.warnings.push(format!(
            "lengths were taken to be in {likely}, which makes it {:.2} m",
            height * likely.metres()
        ));
    }
    (likely, Found::Detected)
}

fn up(raw: &mut RawMotion, body: &Proportions, options: &ReadOptions) -> (Axis, Found) {
    if let Some(up) = options.up {
        return (up, Found::Asked);
    }
    match (raw.up, body.upright(raw)) {
        (Some(said), Some(seen)) if said != seen && body.is_figure() => {
            raw.warnings.push(format!(
                "the file says that {said} points up, but the body stands along {seen}: taken as {seen} up"
            ));
            (seen, Found::Detected)
        }
        (Some(said), _) => (said, Found::File),
        (None, Some(seen)) => (seen, Found::Detected),
        (None, None) => (Axis::Y, Found::Assumed),
    }
}

/// What to say of takes in which nothing moves, beside others: programs leave empty ones behind.
fn still_takes(raw: &RawMotion) -> Vec<String> {
    let moves = |take: &Take| {
        let mut frames = take.rotations.chunks_exact(raw.skeleton.len());
        let first = frames.next();
        let weights = take.weights.iter().flat_map(|track| track.weights.windows(2));
        frames.any(|frame| Some(frame) != first)
            || take.tracks.iter().any(|track| track.values.windows(2).any(|pair| pair[0] != pair[1]))
            || weights.into_iter().any(|pair| pair[0] != pair[1])
    };
    let (moving, still): (Vec<&Take>, Vec<&Take>) = raw.takes.iter().partition(|take| moves(take));
    if moving.is_empty() {
        return Vec::new();
    }
    still.iter().map(|take| format!("`{}` is empty: nothing moves in it", take.name)).collect()
}

/// The axis up, corrected where a person who is seen to stand would come out lying or upside down; told where that cannot be
/// decided: people do lie and stand on their heads.
fn stand(raw: &mut RawMotion, figure: &Figure, up: Axis, found: Found) -> (Axis, Found) {
    let Some(stance) = figure.stance(raw) else { return (up, found) };
    let upright = stance.up.dot(up.direction());
    let Some(seen) = stance.axis().filter(|seen| *seen != up) else { return (up, found) };
    if found != Found::Asked && is_mistaken(raw, figure, &stance, up, seen) {
        raw.warnings.push(format!(
            "with {up} up the person would {}: taken as {seen} up, the axis along which it stands",
            if upright < -0.5 { "be upside down" } else { "lie" }
        ));
        return (seen, Found::Detected);
    }
    if upright < -0.5 {
        raw.warnings
            .push(format!("with {up} up the person is upside down: head below feet, along the axis {seen}"));
    } else if upright < 0.5 && stance.stands {
        raw.warnings
            .push(format!("with {up} up the person lies along the axis {seen} wherever it could stand"));
    }
    (up, found)
}

/// Whether the axis of a standing person is up, and not the one that the file, its format or its rest pose says.
fn is_mistaken(raw: &RawMotion, figure: &Figure, stance: &Stance, said: Axis, seen: Axis) -> bool {
    let reversed = said.direction() == -seen.direction();
    let rests_so = || !raw.rest_is_upright && raw.up.is_none() && figure.rest_axis(raw) == Some(seen);
    let elsewhere = || reversed || raw.rest_is_upright || stance.stands_on_floor(seen);
    (stance.stands && rests_so()) || (!stance.lies_on_floor(said) && elsewhere())
}

/// The axis along which the rest pose stands. A rest pose that lies by a quarter turn is left to retargeting.
fn rest_axis(raw: &RawMotion, figure: &Figure, up: Axis) -> Axis {
    let usual = |axis: &Axis| matches!(axis, Axis::Y | Axis::Z);
    match figure.rest_axis(raw) {
        _ if raw.rest_is_upright => Axis::Y,
        Some(rest) if !(usual(&rest) && usual(&up)) => rest,
        _ => up,
    }
}

/// The skeleton with lengths scaled to metres and root joints rotated to +Y up.
fn convert_skeleton(raw: &RawMotion, unit: Unit, up: Axis) -> Result<Skeleton> {
    let metres = unit.metres() as f32;
    let mut locals = raw.skeleton.rest_pose().locals.clone();
    for (local, parent) in locals.iter_mut().zip(raw.skeleton.parents()) {
        local.translation *= metres;
        if parent.is_none() && up != Axis::Y {
            local.rotation = up.ours_from_file() * local.rotation;
            local.translation = up.vector_to_ours(local.translation);
        }
    }
    let ends = raw.skeleton.ends().iter().map(|end| end.map(|end| end * metres)).collect();
    let skeleton = Skeleton::from_rest_pose(raw.skeleton.tree().clone(), locals, ends)?;
    Ok(skeleton.with_humanoid(raw.skeleton.humanoid().to_vec()))
}

/// Scales all lengths to metres and rotates the root joints to +Y up.
fn convert_takes(raw: &mut RawMotion, unit: Unit, up: Axis) {
    let metres = unit.metres() as f32;
    let turn = up.ours_from_file();
    let parents = raw.skeleton.parents();
    for take in &mut raw.takes {
        for track in &mut take.tracks {
            let root = parents.get(track.joint as usize).is_some_and(Option::is_none);
            for v in &mut track.values {
                *v *= metres;
                if root {
                    *v = up.vector_to_ours(*v);
                }
            }
        }
        if up != Axis::Y {
            for frame in take.rotations.chunks_mut(parents.len()) {
                for (rotation, _) in frame.iter_mut().zip(parents).filter(|(_, p)| p.is_none()) {
                    *rotation = turn * *rotation;
                }
            }
        }
    }
}

#[cfg(test)]
pub(in crate::format) mod tests;
