//! Landmarks and tape measures: their names, their definitions on the body and their evaluation.
//!
//! A [`Definition`] is data: landmarks, loops and planes over the vertices of LOD 0. A circumference is what a tailor's
//! tape reads, the perimeter of the convex hull of its points, because a tape spans hollows; the raw edge loop is 50 mm
//! longer at the hip. A measure is taken in the T-pose or on the [`Standing`] body. Every measure has an analytic gradient, which the exact solve needs.

mod catalogue;
mod definition;
mod hull;
mod landmark;
mod mass;
mod names;
mod read;
mod standing;

pub use catalogue::{BodyPart, MEASURE_COUNT};
pub use definition::{Definition, Definitions, Kind, Point, Stance};
pub use landmark::{Landmark, Landmarks};
pub use mass::{BODY_DENSITY, Mass, enclosed_volume};
pub use names::{MeasureId, Measurements, Sex, expand_name};
pub use read::{Gradient, Reading};
pub use standing::{Placed, Skin, Standing, Turn};
