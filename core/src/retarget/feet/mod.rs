//! Foot contact: finding contacts with the floor, measuring foot sliding, and planting feet.
//!
//! The sole of a foot has three points: heel, ball and tip of the toes. [`contacts()`] finds when heels and balls stand still
//! on the floor, [`measure`] tells how far they slide meanwhile and how deep they sink into it, and [`plant()`] holds them in
//! place (Kovar, Schreiner, Gleicher, "Footskate cleanup for motion capture editing", SCA 2002): the sole is moved rigidly
//! so that what touches the floor stays in place and rolls without slipping, the pelvis is lowered a little where a leg is
//! too short, and two-bone inverse kinematics bends the leg.
//!
//! Clips are of the rig. The floor is y = 0 in model space.

mod contacts;
mod hold;
mod plant;
mod roll;
mod shape;
mod soles;

use glam::Vec3;

use crate::clip::Clip;
use crate::math::RigidTransform;
use crate::pose::Leg;
use crate::skeleton::{Pose, model_from_some_joints, with_ancestors};
use crate::{Error, Result, Side};

pub use contacts::{Contact, Contacts, FootPoint, contacts};

pub use plant::{plant, plant_loop};

/// How contacts are found and feet are planted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeetOptions {
    /// A point touches the floor when it is below this height, metres, and until it is a quarter higher.
    pub height: f32,
    /// A point stands still when it is slower than this, metres per second, and until it is a quarter faster.
    pub speed: f32,
    /// Shorter contacts, and shorter gaps between contacts, are ignored, seconds.
    pub shortest: f32,
    /// A contact ends when its point is this far from where it began, metres; a new one may follow.
    pub stray: f32,
    /// How long before and after a contact a foot blends between its own motion and where it is held, seconds.
    pub blend: f32,
    /// How deep a point may sink into the floor, metres.
    pub depth: f32,
    /// How far the pelvis may be lowered so that a leg can reach, metres.
    pub pelvis_drop: f32,
    /// Whether to estimate the height of the floor from the feet and move the clip onto it; otherwise it is 0.
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

/// How well the feet of a clip stand; left, right.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct FeetMeasure {
    /// Number of contacts of heels and balls.
    pub contacts: [usize; 2],
    /// How far the touching part of the sole is along the floor from where a contact began, the most in any contact, metres; 0
    /// when it rolls without slipping. Trembling about one place adds nothing to it.
    pub worst_slide: [f32; 2],
    /// The mean of that distance over the contacts, metres.
    pub mean_slide: [f32; 2],
    /// How deep the lowest of heel, ball and tip is below the floor in any frame, metres; 0 when none is.
    pub deepest: [f32; 2],
}

/// The result of [`plant()`].
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct FeetReport {
    /// Height of the floor in the input, metres; it is 0 in the output.
    pub floor: f32,
    /// The input, relative to its floor.
    pub before: FeetMeasure,
    /// The output, at the same contacts.
    pub after: FeetMeasure,
    /// The most that the pelvis was lowered in any frame, metres.
    pub pelvis_drop: f32,
    /// The contacts: their frames are those of both clips, their floor is that of the input.
    #[serde(skip)]
    pub contacts: Contacts,
}

/// Measures the feet of a clip at contacts that were found in it or in the clip from which it was made.
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
        let steps = roll::steps(clip, &legs[foot], &contacts.feet[foot])?;
        let slides: Vec<f32> = steps.iter().map(|steps| drift(steps)).collect();
        out.contacts[foot] = slides.len();
        out.worst_slide[foot] = slides.iter().copied().fold(0.0, f32::max);
        out.mean_slide[foot] = slides.iter().fold(0.0, |sum, s| sum + s) / slides.len().max(1) as f32;
        let lowest = track.iter().map(|sole| sole.lowest()).fold(f32::INFINITY, f32::min);
        out.deepest[foot] = (-lowest).max(0.0);
    }
    Ok(out)
}

/// The farthest that a path of these steps leads from where it begins.
fn drift(steps: &[Vec3]) -> f32 {
    let places = steps.iter().scan(Vec3::ZERO, |place, step| {
        *place += *step;
        Some(place.length())
    });
    places.fold(0.0, f32::max)
}

/// A point of a sole that stands on the floor in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// Of which foot.
    pub side: Side,
    /// The point of the sole.
    pub point: FootPoint,
    /// Where it is in this frame, model space, metres.
    pub at: Vec3,
}

/// For every frame of a clip, the points that stand on the floor according to contacts that were found in it.
///
/// # Errors
/// [`Error::Invalid`] when a joint of the legs is missing.
pub fn standing_points(clip: &Clip, contacts: &Contacts) -> Result<Vec<Vec<Standing>>> {
    let legs = Leg::both(clip.skeleton())?;
    let tracks = soles::tracks(clip, &legs, 0.0);
    let mut frames = vec![Vec::new(); clip.frame_count()];
    for (side, (track, contacts)) in Side::ALL.into_iter().zip(tracks.iter().zip(&contacts.feet)) {
        for contact in contacts {
            let range = contact.start..contact.end.min(track.len());
            for (points, sole) in frames[range.clone()].iter_mut().zip(&track[range]) {
                points.push(Standing { side, point: contact.point, at: contact.point.of(sole) });
            }
        }
    }
    Ok(frames)
}

/// Visits the frames of a clip in order: pose and `model_from_joint`, both of the legs and the joints above them alone.
fn for_each_pose(clip: &Clip, legs: &[Leg], mut visit: impl FnMut(usize, &Pose, &[RigidTransform])) {
    let parents = clip.skeleton().parents();
    let joints = with_ancestors(parents, legs.iter().map(|leg| leg.ball));
    let (mut pose, mut model) = (clip.skeleton().rest_pose().clone(), Vec::new());
    for frame in 0..clip.frame_count() {
        let rotations = clip.rotations(frame);
        joints.iter().for_each(|&joint| pose.locals[joint].rotation = rotations[joint]);
        for track in clip.translations() {
            pose.locals[track.joint as usize].translation = track.values[frame];
        }
        model_from_some_joints(parents, &pose.locals, &joints, &mut model);
        visit(frame, &pose, &model);
    }
}

#[cfg(test)]
mod tests;
