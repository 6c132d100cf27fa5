//! Procedural clips for any body of the rig, so that there is something to play at once.
//!
//! Lengths scale with the body: stride and speed with the leg, stance with the hips. Feet stand on the floor, joints stay
//! within their limits, and every clip loops.

mod idle;
mod range_of_motion;
mod squat;
mod walk;
mod wave;

use std::sync::Arc;

use super::Clip;
use super::edit::clip_of_poses;
use crate::math::smoothstep;
use crate::pose::figure::Figure;
use crate::skeleton::{Pose, Skeleton};
use crate::{Error, Result};

/// Names of the clips, as [`builtin`] takes them.
pub const BUILTIN: [&str; 5] = ["idle", "walk", "wave", "squat", "range_of_motion"];

/// Frames per second.
const RATE: f64 = 30.0;

/// A procedural clip for a body of the rig, at 30 frames per second:
/// - `idle` stands, breathes and shifts its weight;
/// - `walk` is one stride of two steps forwards, with root motion on the root joint;
/// - `wave` greets with the right hand;
/// - `squat` goes down and comes up, the arms stretched forward;
/// - `range_of_motion` takes joint after joint through much of its range, for judging the skinning.
///
/// The last pose equals the first but for root motion.
///
/// # Errors
/// [`Error::Request`] when the name is not one of [`BUILTIN`], [`Error::Invalid`] naming a joint of the rig that is missing,
/// or when a leg has no length.
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

/// Interpolates keys (time, value), in order of time, by smoothstep; the first and the last value are held.
fn keyed(keys: &[(f32, f32)], at: f32) -> f32 {
    for pair in keys.windows(2) {
        let [(from, a), (to, b)] = [pair[0], pair[1]];
        if at < to {
            return a + (b - a) * smoothstep((at - from) / (to - from));
        }
    }
    keys.last().map_or(0.0, |key| key.1)
}
