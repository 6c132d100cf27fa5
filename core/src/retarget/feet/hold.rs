//! Where a foot has to go so that what touches the floor stays where it is.

use glam::Vec3;

use super::contacts::{Contact, FootPoint, runs};
use crate::math::{Rotation, smoothstep};
use crate::pose::Sole;

/// A rigid motion of a foot: turned by `turn` (axis times angle) about its ball joint, then moved by `shift`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Correction {
    pub(super) turn: Vec3,
    pub(super) shift: Vec3,
    /// Whether the heel alone is held.
    pub(super) on_heel: bool,
}

impl Correction {
    /// The rotation of it.
    pub(super) fn rotation(&self) -> Rotation {
        Rotation::from_scaled_axis(self.turn)
    }

    /// Where a point of the foot goes whose ball joint is at `joint`.
    pub(super) fn apply(&self, point: Vec3, joint: Vec3) -> Vec3 {
        joint + self.shift + self.rotation() * (point - joint)
    }
}

/// One correction per frame. `blend` is in frames.
///
/// Frames in which heel and ball touch lay the foot flat and fix where it points and stands; those in which one touches
/// fix its place; the others are blended from their neighbours, so that a foot is on its way before it lands and long after it left.
pub(super) fn corrections(
    track: &[Sole],
    contacts: &[Contact],
    at_rest: Vec3,
    blend: usize,
) -> Vec<Correction> {
    let places = places(track, contacts, at_rest.length());
    let mut held: [Vec<Option<Vec3>>; 2] = [vec![None; track.len()], vec![None; track.len()]];
    for (contact, place) in contacts.iter().zip(&places) {
        held[contact.point as usize][contact.start..contact.end].fill(Some(*place));
    }
    let [heel, ball] = held;

    let turns = track.iter().zip(heel.iter().zip(&ball)).map(|(sole, held)| match held {
        (Some(heel), Some(ball)) => flat_turn(sole.rotation, at_rest, *ball - *heel),
        _ => None,
    });
    let turns = bridged(&turns.collect::<Vec<_>>(), blend);
    let shifts = track.iter().zip(&turns).zip(heel.iter().zip(&ball)).map(|((sole, turn), held)| {
        let of_heel =
            |place: Vec3| place + Rotation::from_scaled_axis(*turn) * (sole.joint - sole.heel) - sole.joint;
        match held {
            // Of a foot that lies flat the skin of the ball is straight under its joint.
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
    let moves = turns.into_iter().zip(shifts).zip(on_heel);
    moves.map(|((turn, shift), on_heel)| Correction { turn, shift, on_heel }).collect()
}

/// Where on the floor each contact is held: the longest where the point is on average; one that overlaps a held one of
/// the other point a foot's length from it, in the direction that the foot has half-way through the overlap.
fn places(track: &[Sole], contacts: &[Contact], sole_length: f32) -> Vec<Vec3> {
    let mut places: Vec<Option<Vec3>> = vec![None; contacts.len()];
    loop {
        let open = (0..contacts.len()).filter(|c| places[*c].is_none());
        // The open contact with the longest overlap with a held one, else the longest.
        let best = open
            .map(|c| {
                let beside = (0..contacts.len())
                    .filter(|h| places[*h].is_some() && contacts[*h].point != contacts[c].point)
                    .map(|h| (overlap(&contacts[c], &contacts[h]), h))
                    .filter(|((start, end), _)| start < end)
                    .max_by_key(|((start, end), h)| (end - start, std::cmp::Reverse(*h)));
                let length = contacts[c].end - contacts[c].start;
                (beside.map_or(0, |((start, end), _)| end - start), length, std::cmp::Reverse(c), beside)
            })
            .max_by_key(|(overlap, length, c, _)| (*overlap, *length, *c));
        let Some((_, _, std::cmp::Reverse(c), beside)) = best else { break };
        let contact = &contacts[c];
        let held = beside.and_then(|((start, end), h)| Some((&track[(start + end) / 2], places[h]?)));
        let place = match held {
            Some((sole, place)) => {
                let along = (sole.ball - sole.heel).with_y(0.0).normalize_or_zero() * sole_length;
                if contact.point == FootPoint::Ball { place + along } else { place - along }
            }
            None => {
                let frames = &track[contact.start..contact.end];
                frames.iter().map(|sole| contact.point.of(sole)).sum::<Vec3>() / frames.len().max(1) as f32
            }
        };
        places[c] = Some(place.with_y(0.0));
    }
    places.into_iter().map(Option::unwrap_or_default).collect()
}

fn overlap(a: &Contact, b: &Contact) -> (usize, usize) {
    (a.start.max(b.start), a.end.min(b.end))
}

/// What turns a foot from `turn` to flat on the floor and pointing along `sole`, axis times angle; none when a
/// direction has no length.
fn flat_turn(turn: Rotation, at_rest: Vec3, sole: Vec3) -> Option<Vec3> {
    let ahead = Rotation::from_rotation_arc(at_rest.try_normalize()?, sole.try_normalize()?);
    let by = ahead * turn.conjugate();
    Some((if by.w < 0.0 { -by } else { by }).to_scaled_axis())
}

/// Fills the frames without a value: values of the neighbouring runs fade out over `blend` frames, or over the gap
/// when it is shorter, smoothly.
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

/// Raises values, and none more than it must, so that from one frame to the next they change by `most`.
pub(super) fn ramped(values: &mut [f32], most: f32) {
    for frame in 1..values.len() {
        values[frame] = values[frame].max(values[frame - 1] - most);
    }
    for frame in (1..values.len()).rev() {
        values[frame - 1] = values[frame - 1].max(values[frame] - most);
    }
}
