//! Detection of foot contacts.

use glam::Vec3;

use super::FeetOptions;
use super::soles;
use crate::Result;
use crate::clip::Clip;
use crate::pose::{Leg, Sole};

/// A point of the sole on which a foot can stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FootPoint {
    /// The back end of the heel.
    Heel,
    /// The skin below the ball joint.
    Ball,
}

impl FootPoint {
    pub(super) fn of(self, sole: &Sole) -> Vec3 {
        match self {
            Self::Heel => sole.heel,
            Self::Ball => sole.ball,
        }
    }
}

/// A point that is this many times faster between two frames than a standing one may be is a capture error.
const JUMP: f32 = 6.0;

/// A contact: a point stands on the floor in the frames `start..end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contact {
    /// The point of the sole.
    pub point: FootPoint,
    /// First frame.
    pub start: usize,
    /// One past the last frame.
    pub end: usize,
}

/// The contacts of a clip.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contacts {
    /// Left, right; of each the contacts of the heel in order of time, then those of the ball.
    pub feet: [Vec<Contact>; 2],
    /// Height of the floor above which they were found, metres.
    pub floor: f32,
}

/// Finds when heels and balls are low and slow, with hysteresis. Positions are averaged over 0.05 s to each side before
/// speeds are taken, so that capture noise does not end a contact. A clip that walks in place has no contacts, as its feet
/// slide.
///
/// # Errors
/// [`Error`](crate::Error) naming a missing joint of the legs or an option out of range.
pub fn contacts(clip: &Clip, options: &FeetOptions) -> Result<Contacts> {
    options.check()?;
    let legs = Leg::both(clip.skeleton())?;
    let mut tracks = soles::tracks(clip, &legs, 0.0);
    let floor = if options.find_floor { floor_of(&tracks) } else { 0.0 };
    for sole in tracks.iter_mut().flatten() {
        sole.heel.y -= floor;
        sole.ball.y -= floor;
    }
    let rate = clip.frames_per_second() as f32;
    let feet = tracks.map(|track| {
        [FootPoint::Heel, FootPoint::Ball]
            .into_iter()
            .flat_map(|p| of_point(&track, p, rate, options))
            .collect()
    });
    Ok(Contacts { feet, floor })
}

/// Height of the floor: a body that walks, turns or stands nearly always has a foot on it, so it is the 20th percentile of the
/// lower foot's height over the frames.
fn floor_of(tracks: &[Vec<Sole>; 2]) -> f32 {
    let mut heights: Vec<f32> = tracks[0]
        .iter()
        .zip(&tracks[1])
        .map(|(l, r)| l.heel.y.min(l.ball.y).min(r.heel.y).min(r.ball.y))
        .collect();
    heights.sort_by(f32::total_cmp);
    heights.get(heights.len() / 5).copied().unwrap_or(0.0)
}

fn of_point(track: &[Sole], point: FootPoint, rate: f32, options: &FeetOptions) -> Vec<Contact> {
    let positions = smoothed(track, point, libm::roundf(0.05 * rate) as usize);
    let mut touching = Vec::with_capacity(positions.len());
    let mut on = false;
    for frame in 0..positions.len() {
        let (before, after) = (frame.saturating_sub(1), (frame + 1).min(positions.len() - 1));
        let seconds = (after - before).max(1) as f32 / rate;
        let speed = positions[before].distance(positions[after]) / seconds;
        let slack = if on { 1.25 } else { 1.0 };
        on = positions[frame].y < options.height * slack && speed < options.speed * slack;
        touching.push(on);
    }
    let shortest = (libm::roundf(options.shortest * rate) as usize).clamp(1, track.len().max(1));
    fill_gaps(&mut touching, shortest);
    // Averages hide capture errors that throw the point away and back.
    for (frame, pair) in track.windows(2).enumerate() {
        if point.of(&pair[0]).distance(point.of(&pair[1])) * rate > JUMP * options.speed {
            touching[frame..frame + 2].fill(false);
        }
    }
    let mut found = Vec::new();
    for (start, end) in runs(&touching) {
        split(&positions, start, end, options.stray, shortest, |start, end| {
            if end - start >= shortest {
                found.push(Contact { point, start, end });
            }
        });
    }
    found
}

/// Moving averages over `radius` frames to each side, fewer at the ends.
fn smoothed(track: &[Sole], point: FootPoint, radius: usize) -> Vec<Vec3> {
    (0..track.len())
        .map(|frame| {
            let radius = radius.min(frame).min(track.len() - 1 - frame);
            let window = &track[frame - radius..=frame + radius];
            window.iter().map(|sole| point.of(sole)).sum::<Vec3>() / window.len() as f32
        })
        .collect()
}

/// Runs of true values, as `start..end`.
pub(super) fn runs(frames: &[bool]) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for (frame, _) in frames.iter().enumerate().filter(|(_, on)| **on) {
        match found.last_mut() {
            Some((_, end)) if *end == frame => *end += 1,
            _ => found.push((frame, frame + 1)),
        }
    }
    found
}

/// Fills gaps between true runs that are shorter than `shortest` frames.
fn fill_gaps(frames: &mut [bool], shortest: usize) {
    for pair in runs(frames).windows(2) {
        if pair[1].0 - pair[0].1 < shortest {
            frames[pair[0].1..pair[1].0].fill(true);
        }
    }
}

/// Splits a run where the point is farther than `stray` from where the contact began, with `gap` frames between the parts in
/// which the foot may move on.
fn split(
    positions: &[Vec3],
    start: usize,
    end: usize,
    stray: f32,
    gap: usize,
    mut part: impl FnMut(usize, usize),
) {
    let mut first = start;
    while first < end {
        let start_position = positions[first].with_y(0.0);
        match (first..end).find(|f| positions[*f].with_y(0.0).distance(start_position) > stray) {
            Some(cut) => {
                part(first, cut);
                first = cut + gap;
            }
            None => {
                part(first, end);
                break;
            }
        }
    }
}
