//! The HIERARCHY section of a BVH file: joints, offsets, channels. Nesting is kept in a list, not on the call stack, so
//! that any depth is safe.

use glam::Vec3;

use super::lexer::{Lexer, shown};
use crate::error::Fault;
use crate::format::bvh::Result;
use crate::skeleton::MAX_JOINTS;

/// The meaning of one value of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channel {
    /// Translation along an axis.
    Position(usize),
    /// Rotation about an axis, degrees.
    Rotation(usize),
}

/// Joints in file order, in which parents come first.
#[derive(Debug, Default)]
pub(super) struct Hierarchy {
    pub(super) names: Vec<String>,
    pub(super) parents: Vec<Option<u32>>,
    pub(super) offsets: Vec<Vec3>,
    pub(super) ends: Vec<Option<Vec3>>,
    /// Per joint, in the order of a frame's numbers.
    pub(super) channels: Vec<Vec<Channel>>,
}

/// An open block.
struct Open {
    /// `None` in an end site.
    joint: Option<usize>,
    offset: bool,
    channels: bool,
}

/// Reads up to and including the keyword MOTION.
pub(super) fn read(lexer: &mut Lexer) -> Result<Hierarchy> {
    lexer.expect("HIERARCHY")?;
    let mut found = Hierarchy::default();
    let mut open: Vec<Open> = Vec::new();
    loop {
        let Some(word) = lexer.next() else {
            return lexer.fail(Fault::truncated("MOTION", "the end of the file"));
        };
        let keyword = word.to_ascii_uppercase();
        match (keyword.as_slice(), open.last_mut()) {
            (b"ROOT", None) | (b"JOINT", Some(Open { joint: Some(_), .. })) => {
                let parent = open.last().and_then(|o| o.joint);
                let joint = found.add_joint(lexer, parent)?;
                lexer.expect("{")?;
                open.push(Open { joint: Some(joint), offset: false, channels: false });
            }
            (b"END", Some(Open { joint: Some(_), .. })) => {
                lexer.expect("Site")?;
                lexer.expect("{")?;
                open.push(Open { joint: None, offset: false, channels: false });
            }
            (b"OFFSET", Some(block)) if !block.offset => {
                block.offset = true;
                let (offset, site) = (vector(lexer)?, block.joint.is_none());
                let joint = open.iter().rev().find_map(|o| o.joint).unwrap_or_default();
                if site {
                    // The first of several end sites gives the bone's direction.
                    found.ends[joint].get_or_insert(offset);
                } else {
                    found.offsets[joint] = offset;
                }
            }
            (b"CHANNELS", Some(Open { joint: Some(joint), channels, .. })) if !*channels => {
                *channels = true;
                found.channels[*joint] = read_channels(lexer)?;
            }
            (b"}", Some(Open { joint, offset, channels })) => {
                let missing = [(*offset, "OFFSET"), (*channels || joint.is_none(), "CHANNELS")];
                if let Some((_, what)) = missing.iter().find(|(there, _)| !there) {
                    let name = joint.map_or("the end site", |j| found.names[j].as_str());
                    return lexer.unexpected(format_args!("{what} of `{name}`"), "none");
                }
                open.pop();
            }
            (b"MOTION", None) if !found.names.is_empty() => return Ok(found),
            (_, block) => {
                let expected = match block {
                    None => "ROOT or MOTION",
                    Some(Open { joint: Some(_), .. }) => "one OFFSET, one CHANNELS, JOINT, End Site or }",
                    Some(_) => "one OFFSET or }",
                };
                return lexer.unexpected(expected, shown(word));
            }
        }
    }
}

impl Hierarchy {
    fn add_joint(&mut self, lexer: &mut Lexer, parent: Option<usize>) -> Result<usize> {
        let joint = self.names.len();
        if joint == MAX_JOINTS {
            return lexer.fail(Fault::too_many(format_args!("{MAX_JOINTS} joints"), "more"));
        }
        self.names.push(lexer.name()?);
        self.parents.push(parent.map(|p| p as u32));
        self.offsets.push(Vec3::ZERO);
        self.ends.push(None);
        self.channels.push(Vec::new());
        Ok(joint)
    }
}

fn vector(lexer: &mut Lexer) -> Result<Vec3> {
    let mut vector = [0.0; 3];
    for number in &mut vector {
        *number = lexer.number("three numbers after OFFSET")? as f32;
    }
    lexer.end_of_line("OFFSET")?;
    Ok(vector.into())
}

fn read_channels(lexer: &mut Lexer) -> Result<Vec<Channel>> {
    let count = lexer.count("a number of channels")?;
    if count > 6 {
        return lexer.fail(Fault::too_many("6 channels", count));
    }
    let mut channels = Vec::with_capacity(count);
    for i in 0..count {
        let Some(word) = lexer.next_in_line() else {
            return lexer.unexpected(format_args!("{count} channels"), i);
        };
        let channel = match word.to_ascii_lowercase().as_slice() {
            [axis @ b'x'..=b'z', b'p', b'o', b's', b'i', b't', b'i', b'o', b'n'] => {
                Channel::Position(usize::from(axis - b'x'))
            }
            [axis @ b'x'..=b'z', b'r', b'o', b't', b'a', b't', b'i', b'o', b'n'] => {
                Channel::Rotation(usize::from(axis - b'x'))
            }
            _ => {
                let expected = "Xposition, Yposition, Zposition, Xrotation, Yrotation or Zrotation";
                return lexer.unexpected(expected, shown(word));
            }
        };
        if channels.contains(&channel) {
            return lexer.fail(Fault::inconsistent(format_args!("channel {} twice", shown(word))));
        }
        channels.push(channel);
    }
    lexer.end_of_line(&format!("{count} channels"))?;
    Ok(channels)
}
