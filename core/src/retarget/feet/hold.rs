//! Corrections of a foot that hold in place what touches the floor.

use glam::Vec3;

use super::contacts::{Contact, FootPoint, runs};
use crate::math::{Rotation, smoothstep};
use crate::pose::Sole;

/// A rigid motion of a foot: a rotation about its ball joint, then a translation by `shift`, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Correction {
    /// Axis of the rotation times its angle, radians.
    pub(super) scaled_axis: Vec3,
    pub(super) shift: Vec3,
    /// Whether only the heel is held.
    pub(super) on_heel: bool,
}

impl Correction {
    /// The rotation.
    pub(super) fn rotation(&self) -> Rotation {
        Rotation::from_scaled_axis(self.scaled_axis)
    }

    /// Moves a point of the foot, whose ball joint is at `joint`; model space.
    pub(super) fn apply(&self, point: Vec3, joint: Vec3) -> Vec3 {
        joint + self.shift + self.rotation() * (point - joint)
    }
}

/// One correction per frame; `at_rest` is the vector from heel to ball at rest, `blend` is in frames.
///
/// While heel and ball touch, the foot is laid flat and its direction and position are fixed; while one of them touches, its
/// position is fixed. Between contacts, corrections are blended, so that a foot begins to move before it lands and is still
/// corrected after it leaves the floor.
pub(super) fn corrections(
    track: &[Sole],
    contacts: &[Contact],
    at_rest: Vec3,
    blend: usize,
) -> Vec<Correction> {
    let anchors = anchors(track, contacts, at_rest.length());
    let mut held: [Vec<Option<Vec3>>; 2] = [vec![None; track.len()], vec![None; track.len()]];
    for (contact, anchor) in contacts.iter().zip(&anchors) {
        held[contact.point as usize][contact.start..contact.end].fill(Some(*anchor));
    }
    let [heel, ball] = held;

    let rotations = track.iter().zip(heel.iter().zip(&ball)).map(|(sole, held)| match held {
        (Some(heel), Some(ball)) => flattening(sole.rotation, at_rest, *ball - *heel),
        _ => None,
    });
    let rotations = bridged(&rotations.collect::<Vec<_>>(), blend);
    let shifts =
        track.iter().zip(&rotations).zip(heel.iter().zip(&ball)).map(|((sole, scaled_axis), held)| {
            let of_heel = |anchor: Vec3| {
                anchor + Rotation::from_scaled_axis(*scaled_axis) * (sole.joint - sole.heel) - sole.joint
            };
            match held {
                // In a flat foot the skin of the ball is straight below its joint.
                (Some(heel), Some(ball)) => {
                    Some(0.5 * (of_heel(*heel) + (*ball - sole.joint.with_y(sole.ball.y))))
                }
                (Some(heel), None) => Some(of_heel(*heel)),
                (None, Some(ball)) => Some(*ball - sole.ball),
                (None, None) => None,
            }
        });
    let shifts = bridged(&shifts.collect::<Vec<_>>(), blend);
    let on_heel = heel.iter().zip(&ball).map(|(heel, ball)| heel.is_some() && ball.is_none());
    let moves = rotations.into_iter().zip(shifts).zip(on_heel);
    moves.map(|((scaled_axis, shift), on_heel)| Correction { scaled_axis, shift, on_heel }).collect()
}

/// The point of the floor at which each contact is held: its mean position, the longest contact first; but a contact that
/// overlaps a held one of the other point is held a foot's length from that, in the foot's direction half-way through the overlap.
fn anchors(track: &[Sole], contacts: &[Contact], sole_length: f32) -> Vec<Vec3> {
    let mut anchors: Vec<Option<Vec3>> = vec![None; contacts.len()];
    loop {
        let open = (0..contacts.len()).filter(|c| anchors[*c].is_none());
        // The open contact that overlaps a held one the longest, else the longest one.
        let best = open
            .map(|c| {
                let beside = (0..contacts.len())
                    .filter(|h| anchors[*h].is_some() && contacts[*h].point != contacts[c].point)
                    .map(|h| (overlap(&contacts[c], &contacts[h]), h))
                    .filter(|((start, end), _)| start < end)
                    .max_by_key(|((start, end), h)| (end - start, std::cmp::Reverse(*h)));
                let length = contacts[c].end - contacts[c].start;
                (beside.map_or(0, |((start, end), _)| end - start), length, std::cmp::Reverse(c), beside)
            })
            .max_by_key(|(overlap, length, c, _)| (*overlap, *length, *c));
        let Some((_, _, std::cmp::Reverse(c), beside)) = best else { break };
        let contact = &contacts[c];
        let held = beside.and_then(|((start, end), h)| Some((&track[(start + end) / 2], anchors[h]?)));
        let anchor = match held {
            Some((sole, other)) => {
                let along = (sole.ball - sole.heel).with_y(0.0).normalize_or_zero() * sole_length;
                if contact.point == FootPoint::Ball { other + along } else { other - along }
            }
            None => {
                let frames = &track[contact.start..contact.end];
                frames.iter().map(|sole| contact.point.of(sole)).sum::<Vec3>() / frames.len().max(1) as f32
            }
        };
        anchors[c] = Some(anchor.with_y(0.0));
    }
    anchors.into_iter().map(Option::unwrap_or_default).collect()
}

fn overlap(a: &Contact, b: &Contact) -> (usize, usize) {
    (a.start.max(b.start), a.end.min(b.end))
}

/// The rotation, as axis times angle, from `rotation` to a foot flat on the floor that points along `sole`; `None` when a
/// direction has no length.
fn flattening(rotation: Rotation, at_rest: Vec3, sole: Vec3) -> Option<Vec3> {
    let heading = Rotation::from_rotation_arc(at_rest.try_normalize()?, sole.try_normalize()?);
    let delta = heading * rotation.conjugate();
    Some((if delta.w < 0.0 { -delta } else { delta }).to_scaled_axis())
}

/// Fills frames without a value: the values at both ends of a gap fade out smoothly over `blend` frames, or over the whole gap
/// when it is shorter.
pub(super) fn bridged(values: &[Option<Vec3>], blend: usize) -> Vec<Vec3> {
    let mut out: Vec<Vec3> = values.iter().map(|v| v.unwrap_or_default()).collect();
    for (start, end) in runs(&values.iter().map(Option::is_none).collect::<Vec<_>>()) {
        let before = start.checked_sub(1).and_then(|f| values[f]);
        let after = values.get(end).copied().flatten();
        let length = (end - start + 1) as f32;
        let fade = (blend.max(1) as f32).min(length);
        for (frame, value) in out.iter_mut().enumerate().take(end).skip(start) {
            let since = (frame + 1 - start) as f32;
            let share = |distance: f32| 1.0 - smoothstep(distance / fade);
            *value =
                before.unwrap_or_default() * share(since) + after.unwrap_or_default() * share(length - since);
        }
    }
    out
}

/// Raises values as little as possible so that they change by at most `most` from one frame to the next.
pub(super) fn ramped(values: &mut [f32], most: f32) {
    for frame in 1..values.len() {
        values[frame] = values[frame].max(values[frame - 1] - most);
    }
    for frame in (1..values.len()).rev() {
        values[frame - 1] = values[frame - 1].max(values[frame] - most);
    }
}
