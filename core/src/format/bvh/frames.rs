//! The MOTION section of a BVH file: one frame per line.

use glam::Vec3;

use super::hierarchy::{Channel, Hierarchy};
use super::lexer::{Lexer, shown};
use crate::clip::MAX_FRAMES;
use crate::error::Fault;
use crate::format::bvh::Result;
use crate::format::motion::raw::{Recorder, Take, snapped_rate};
use crate::math::{RigidTransform, Rotation};

/// Reads from after the keyword MOTION to the end of the file.
pub(super) fn read(
    lexer: &mut Lexer,
    skeleton: &Hierarchy,
    rest: &[RigidTransform],
    name: &str,
) -> Result<Take> {
    lexer.expect("Frames:")?;
    let frames = lexer.count("a number of frames")?;
    if frames == 0 || frames > MAX_FRAMES {
        return lexer.unexpected(format_args!("1 to {MAX_FRAMES} frames"), frames);
    }
    lexer.end_of_line("Frames")?;
    lexer.expect("Frame")?;
    lexer.expect("Time:")?;
    let seconds = lexer.number("seconds a frame")?;
    let rate = snapped_rate(1.0 / seconds);
    if !(0.1..=1000.0).contains(&rate) {
        return lexer.unexpected("a Frame Time of 0.001 to 10 seconds", seconds);
    }
    lexer.end_of_line("Frame Time")?;

    let width: usize = skeleton.channels.iter().map(Vec::len).sum();
    if width == 0 {
        return lexer.unexpected("a joint with channels", "none");
    }
    // Each number takes at least a digit and a separator.
    if frames.saturating_mul(width) > lexer.remaining().div_ceil(2) {
        let bytes = lexer.remaining();
        let expected = format!("{frames} frames of {width} channels");
        return lexer.fail(Fault::truncated(expected, format_args!("{bytes} bytes")));
    }
    let mut recorder = Recorder::new(rest.len());
    let (mut numbers, mut pose) = (vec![0.0; width], rest.to_vec());
    for frame in 0..frames {
        read_frame(lexer, &mut numbers, frame, frames)?;
        let mut next = numbers.iter();
        for ((local, at), channels) in pose.iter_mut().zip(rest).zip(&skeleton.channels) {
            *local = transform(at.translation, channels, &mut next);
        }
        recorder.push(&pose);
    }
    if let Some(word) = lexer.next() {
        let expected = format!("the end of the file after {frames} frames");
        return lexer.unexpected(expected, shown(word));
    }
    Ok(recorder.take(name.to_owned(), rate, rest))
}

/// Reads the numbers of one frame.
fn read_frame(lexer: &mut Lexer, numbers: &mut [f64], frame: usize, frames: usize) -> Result<()> {
    let width = numbers.len();
    for (i, number) in numbers.iter_mut().enumerate() {
        let word = if i == 0 { lexer.next() } else { lexer.next_in_line() };
        let Some(word) = word else {
            return match i {
                0 => lexer.fail(Fault::truncated(format_args!("{frames} frames"), frame)),
                _ => lexer.unexpected(format_args!("{width} channels"), i),
            };
        };
        *number = lexer.parse(word, "a number")?;
    }
    lexer.end_of_line(&format!("{width} channels"))
}

/// A joint's local transform: its channels applied in order, each in the axes left by those before it.
fn transform<'a>(
    offset: Vec3,
    channels: &[Channel],
    numbers: &mut impl Iterator<Item = &'a f64>,
) -> RigidTransform {
    let (mut translation, mut rotation) = (offset, Rotation::IDENTITY);
    for (channel, &number) in channels.iter().zip(numbers) {
        match *channel {
            Channel::Position(axis) => translation[axis] = number as f32,
            Channel::Rotation(axis) => {
                let (sin, cos) = libm::sincos(number.to_radians() / 2.0);
                let mut turn = [0.0, 0.0, 0.0, cos as f32];
                turn[axis] = sin as f32;
                rotation *= Rotation::from_array(turn);
            }
        }
    }
    RigidTransform { rotation, translation }
}
