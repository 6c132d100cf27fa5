//! BVH, Biovision's hierarchy and motion in one text file.
//!
//! There is no standard but "Biovision BVH" (Meredith and Maddock, "Motion Capture File Formats Explained", 2001) and
//! the files. What they leave open is read as the programs do that write most of them: angles are degrees, turned one
//! after the other in the order of the channels, each about the axes that the one before has left (`R = R₁ R₂ R₃`); a
//! position channel replaces its number of the joint's OFFSET; a joint rests unturned at its OFFSET. Neither unit nor
//! up axis is said.

mod hierarchy;
mod lexer;
mod motion;

#[cfg(test)]
mod tests;

use super::raw::{self, Raw};
use super::{Found, ReadOptions};
use crate::error::Outcome;
use crate::math::RigidTransform;
use lexer::Lexer;

/// Reads the text of a file; the clip is named `name`.
pub(super) fn read(bytes: &[u8], name: &str, options: &ReadOptions) -> Outcome<Raw> {
    let mut lexer = Lexer::new(bytes);
    let mut skeleton = hierarchy::read(&mut lexer)?;
    let mut warnings = Vec::new();
    raw::make_unique(&mut skeleton.names, &mut warnings);
    let rest: Vec<RigidTransform> = skeleton
        .offsets
        .iter()
        .map(|&translation| RigidTransform { rotation: glam::Quat::IDENTITY, translation })
        .collect();
    let mut take = motion::read(&mut lexer, &skeleton, &rest, name)?;
    let mut rate_found = Found::File;
    if let Some(rate) = options.frames_per_second {
        (take.frames_per_second, rate_found) = (rate, Found::Asked);
    }
    Ok(Raw {
        format: "BVH",
        names: skeleton.names,
        parents: skeleton.parents,
        rest,
        ends: skeleton.ends,
        takes: vec![take],
        unit: None,
        up: None,
        rest_is_upright: false,
        rate_found,
        warnings,
    })
}
