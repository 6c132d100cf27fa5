//! The MOTION section of a BVH file: one frame per line.

use glam::Vec3;

use super::hierarchy::{Channel, Hierarchy};
use super::lexer::{Lexer, shown};
use crate::clip::MAX_FRAMES;
use crate::error::Fault;
use crate::format::bvh::Result;
use crate::format::motion::bounds;
use crate::format::motion::raw::{Recorder, snapped_rate};
use crate::math::{RigidTransform, Rotation};

/// The frames of a file.
pub(super) struct Frames {
    pub(super) recorder: Recorder,
    /// Frames per second.
    pub(super) rate: f64,
    pub(super) warning: Option<String>,
}

/// Reads from after the keyword MOTION to the end of the file. A rate that was asked for overrides the file's.
///
/// Programs miscount their rows, mostly by one. All rows that are there are read, unless half of them are missing: such a
/// file was cut off.
pub(super) fn read(
    lexer: &mut Lexer,
    skeleton: &Hierarchy,
    rest: &[RigidTransform],
    asked: Option<f64>,
) -> Result<Frames> {
    let (said, rate) = read_head(lexer, asked)?;
    let width: usize = skeleton.channels.iter().map(Vec::len).sum();
    if width == 0 {
        return lexer.unexpected("a joint with channels", "none");
    }
    // Each number takes at least a digit and a separator.
    if (said / 2).saturating_mul(width) > lexer.remaining().div_ceil(2) {
        let bytes = lexer.remaining();
        let expected = format!("{said} frames of {width} channels");
        return lexer.fail(Fault::truncated(expected, format_args!("{bytes} bytes")));
    }
    let mut recorder = Recorder::new(rest.len());
    let (mut numbers, mut pose, mut frames) = (vec![0.0; width], rest.to_vec(), 0);
    while let Some(word) = lexer.next() {
        if frames >= said && lexer.parse(word, "a number").is_err() {
            let expected = format!("the end of the file after {said} frames");
            return lexer.unexpected(expected, shown(word));
        }
        if frames == MAX_FRAMES {
            return lexer.fail(Fault::too_many(format_args!("{MAX_FRAMES} frames"), "more"));
        }
        read_frame(lexer, word, &mut numbers)?;
        let mut next = numbers.iter();
        for ((local, at), channels) in pose.iter_mut().zip(rest).zip(&skeleton.channels) {
            *local = transform(lexer, at.translation, channels, &mut next)?;
        }
        recorder.push(&pose);
        frames += 1;
    }
    if frames == 0 || frames < said / 2 {
        return lexer.fail(Fault::truncated(format_args!("{said} frames"), frames));
    }
    let warning =
        (frames != said).then(|| format!("the file says {said} frames and has {frames}: all were read"));
    Ok(Frames { recorder, rate, warning })
}

/// The number of frames that the file states, and the rate.
fn read_head(lexer: &mut Lexer, asked: Option<f64>) -> Result<(usize, f64)> {
    lexer.expect("Frames:")?;
    let frames = lexer.count("a number of frames")?;
    if frames == 0 || frames > MAX_FRAMES {
        return lexer.unexpected(format_args!("1 to {MAX_FRAMES} frames"), frames);
    }
    lexer.end_of_line("Frames")?;
    lexer.expect("Frame")?;
    lexer.expect("Time:")?;
    if let Some(rate) = asked {
        while lexer.next_in_line().is_some() {}
        return Ok((frames, rate));
    }
    let seconds = lexer.number("seconds a frame")?;
    let rate = snapped_rate(1.0 / seconds);
    if !(0.1..=1000.0).contains(&rate) {
        return lexer.unexpected("a Frame Time of 0.001 to 10 seconds", seconds);
    }
    lexer.end_of_line("Frame Time")?;
    Ok((frames, rate))
}

/// Reads the numbers of one frame, of which the lexer has consumed the first.
fn read_frame(lexer: &mut Lexer, first: &[u8], numbers: &mut [f64]) -> Result<()> {
    let width = numbers.len();
    for (i, number) in numbers.iter_mut().enumerate() {
        let word = if i == 0 { Some(first) } else { lexer.next_in_line() };
        let Some(word) = word else { return lexer.unexpected(format_args!("{width} channels"), i) };
        *number = lexer.parse(word, "a number")?;
    }
    lexer.end_of_line(&format!("{width} channels"))
}

/// A joint's local transform: its channels applied in order, each in the axes left by those before it.
fn transform<'a>(
    lexer: &Lexer,
    offset: Vec3,
    channels: &[Channel],
    numbers: &mut impl Iterator<Item = &'a f64>,
) -> Result<RigidTransform> {
    let (mut translation, mut rotation) = (offset, Rotation::IDENTITY);
    for (channel, &number) in channels.iter().zip(numbers) {
        match *channel {
            Channel::Position(axis) => translation[axis] = number as f32,
            Channel::Rotation(axis) => {
                bounds::check_degrees(number).or_else(|fault| lexer.fail(fault))?;
                let (sin, cos) = libm::sincos(number.to_radians() / 2.0);
                let mut turn = [0.0, 0.0, 0.0, cos as f32];
                turn[axis] = sin as f32;
                rotation *= Rotation::from_array(turn);
            }
        }
    }
    Ok(RigidTransform { rotation, translation })
}
