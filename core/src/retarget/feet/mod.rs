//! Feet on the floor: when they touch it, how far they slide, and how to hold them.
//!
//! Each foot has three points on its sole: heel, ball and tip of the toes. [`contacts`] finds when heels and balls
//! stand still on the floor, [`measure`] says how far they slide meanwhile and how deep they sink, and [`plant`] holds
//! them in place (Kovar, Schreiner, Gleicher, "Footskate cleanup for motion capture editing", SCA 2002): the sole is
//! moved rigidly so that what touches stays where it is and rolls without slipping, the pelvis sinks a little where a
//! leg is too short, and two-bone inverse kinematics bends the leg.
//!
//! All of it is about clips of our rig. The floor is y = 0 in model space.

mod contacts;
mod hold;
mod plant;
mod roll;
mod soles;

use crate::clip::Clip;
use crate::pose::Leg;
use crate::skeleton::Pose;
use crate::{Error, Result};

pub use contacts::{Contact, Contacts, FootPoint, contacts};

pub use plant::{plant, plant_loop};

/// How contacts are found and feet are held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeetOptions {
    /// A point touches the floor below this height, metres; until it is a quarter higher.
    pub height: f32,
    /// A point stands still below this speed, metres a second; until it is a quarter faster.
    pub speed: f32,
    /// Contacts that are shorter are none, and shorter gaps between contacts neither, seconds.
    pub shortest: f32,
    /// A contact that has slid this far ends, metres: the foot is put down anew.
    pub stray: f32,
    /// Before and after a contact a foot leaves its own way for the place it is held at, seconds.
    pub blend: f32,
    /// How deep a point may sink under the floor, metres.
    pub depth: f32,
    /// The farthest that the pelvis sinks so that a leg can reach, metres.
    pub pelvis_drop: f32,
    /// Find the floor from the feet and put the clip on it; otherwise the floor is at 0.
    pub find_floor: bool,
}

impl Default for FeetOptions {
    fn default() -> Self {
        Self {
            height: 0.03,
            speed: 0.25,
            shortest: 0.1,
            stray: 0.08,
            blend: 0.2,
            depth: 0.005,
            pelvis_drop: 0.12,
            find_floor: true,
        }
    }
}

impl FeetOptions {
    fn check(&self) -> Result<()> {
        let fields = [
            ("height", self.height),
            ("speed", self.speed),
            ("shortest", self.shortest),
            ("stray", self.stray),
            ("blend", self.blend),
            ("depth", self.depth),
            ("pelvis_drop", self.pelvis_drop),
        ];
        match fields.iter().find(|(_, value)| !(0.0..=100.0).contains(value)) {
            None => Ok(()),
            Some((field, value)) => {
                Err(Error::request(format!("feet.{field}"), format!("expected 0 to 100, got {value}")))
            }
        }
    }
}

/// How well the feet of a clip stand, left and right.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct FeetMeasure {
    /// Number of contacts of heels and balls.
    pub contacts: [usize; 2],
    /// The longest path over the floor of the place of the sole that touches, within one contact, metres; a sole that rolls
    /// without slipping has none.
    pub worst_slide: [f32; 2],
    /// That path, mean over the contacts.
    pub mean_slide: [f32; 2],
    /// How far the lowest point of a sole is under the floor, over all frames, metres; 0 when none is.
    pub deepest: [f32; 2],
}

/// What [`plant`] found and did.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct FeetReport {
    /// Height of the floor in the clip that came in, metres; it is at 0 in the one that goes out.
    pub floor: f32,
    /// The clip that came in, moved to the floor.
    pub before: FeetMeasure,
    /// The clip that goes out, at the same contacts.
    pub after: FeetMeasure,
    /// The farthest that the pelvis sank, metres.
    pub pelvis_drop: f32,
    /// The contacts: their frames are those of both clips, their floor that of the one that came in.
    #[serde(skip)]
    pub contacts: Contacts,
}

/// Measures a clip at contacts that were found on it or on the clip that it was made of.
///
/// # Errors
/// [`Error::Invalid`] when a joint of the legs is missing or a contact is beyond the last frame.
pub fn measure(clip: &Clip, contacts: &Contacts) -> Result<FeetMeasure> {
    let legs = Leg::both(clip.skeleton())?;
    let last = contacts.feet.iter().flatten().map(|c| c.end).max().unwrap_or(0);
    if last > clip.frame_count() {
        let message = format!("contacts up to frame {last} of a clip of {}", clip.frame_count());
        return Err(Error::invalid("feet", message));
    }
    let mut out = FeetMeasure::default();
    let tracks = soles::tracks(clip, &legs, contacts.floor);
    for (foot, track) in tracks.iter().enumerate() {
        let steps = roll::steps(clip, &legs[foot], &contacts.feet[foot]);
        let slides: Vec<f32> = steps.iter().map(|of| of.iter().map(|step| step.length()).sum()).collect();
        out.contacts[foot] = slides.len();
        out.worst_slide[foot] = slides.iter().copied().fold(0.0, f32::max);
        out.mean_slide[foot] = slides.iter().fold(0.0, |sum, s| sum + s) / slides.len().max(1) as f32;
        let lowest = track.iter().map(|sole| sole.lowest()).fold(f32::INFINITY, f32::min);
        out.deepest[foot] = (-lowest).max(0.0);
    }
    Ok(out)
}

/// The poses of a clip, one after the other, in one buffer.
fn for_each_pose(clip: &Clip, mut visit: impl FnMut(usize, &Pose)) {
    let mut pose = Pose::default();
    for frame in 0..clip.frame_count() {
        clip.pose_into(frame, &mut pose);
        visit(frame, &pose);
    }
}

#[cfg(test)]
mod tests;
