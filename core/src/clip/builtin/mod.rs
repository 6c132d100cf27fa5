//! Clips made by code for any body of our rig, so that there is something to play at once.
//!
//! Lengths are shares of the body's own: stride and pace from the leg, stance from the hips. Feet stand on the floor,
//! joints stay within their limits, and all but `range_of_motion`, `squat` and `wave` loop by construction; those begin
//! and end in the same pose, so that they loop as well.

mod figure;
mod idle;
mod range_of_motion;
mod squat;
mod walk;
mod wave;

use std::sync::Arc;

use super::Clip;
use super::edit::clip_of_poses;
use crate::skeleton::{Pose, Skeleton};
use crate::{Error, Result};
use figure::Figure;

/// Names of the clips, as [`builtin`] takes them.
pub const BUILTIN: [&str; 5] = ["idle", "walk", "wave", "squat", "range_of_motion"];

/// Frames a second.
const RATE: f64 = 30.0;

/// A clip made by code for a body of our rig, at 30 frames a second:
/// - `idle` stands, breathes and shifts its weight;
/// - `walk` is one stride of two steps ahead, with the way on the root's translation;
/// - `wave` greets with the right hand;
/// - `squat` goes down and comes up, the arms stretched forward;
/// - `range_of_motion` turns joint after joint through much of its range, for judging how the skin follows.
///
/// The last frame is the first again, but for the way that was walked.
///
/// # Errors
/// [`Error::Request`] when the name is not one of [`BUILTIN`], [`Error::Invalid`] naming a joint of our rig that is
/// missing or has no length.
pub fn builtin(name: &str, rest: &Arc<Skeleton>) -> Result<Clip> {
    let figure = Figure::new(rest)?;
    let poses: Vec<Pose> = match name {
        "idle" => idle::poses(&figure),
        "walk" => walk::poses(&figure),
        "wave" => wave::poses(&figure),
        "squat" => squat::poses(&figure),
        "range_of_motion" => range_of_motion::poses(&figure),
        _ => {
            let known = BUILTIN.join(", ");
            return Err(Error::request("clip", format!("expected one of {known}, got `{name}`")));
        }
    };
    clip_of_poses(name, rest, RATE, poses)
}

/// From 0 to 1 with level ends.
fn smooth(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Straight between points (time, value) in order, with level ends at each; the ends are held.
fn keyed(keys: &[(f32, f32)], at: f32) -> f32 {
    for pair in keys.windows(2) {
        let [(from, a), (to, b)] = [pair[0], pair[1]];
        if at < to {
            return a + (b - a) * smooth((at - from) / (to - from));
        }
    }
    keys.last().map_or(0.0, |key| key.1)
}
