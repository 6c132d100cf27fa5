//! Poses of the SMPL body models without a motion around them: one `.npy` array, numbers in JSON, or an archive whose arrays
//! have no axis of frames.
//!
//! A vector has 66 numbers (SMPL-X and SMPL-H without hands), 72 (SMPL), 156 (SMPL-H) or 165 (SMPL-X), axis-angle vectors joint
//! by joint from the pelvis on, or three times as many of rotation matrices. Objects and archives may divide them among
//! `global_orient` (3) and `body_pose` (63 or 69), under any of the names that archives of motion have.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use super::array::{Archive, Array, decode, refused};
use super::motion::{RATES, motion_of, open};
use super::names::{self, Part};
use super::smpl::MODELS;
use crate::Error;
use crate::error::Fault;
use crate::format::motion::raw::RawMotion;
use crate::format::motion::{ReadOptions, clip_name};
use crate::format::npz::Result;

/// Name of an array that has none.
const UNNAMED: &str = "poses";
/// Frames per second of poses without a rate, for the clip that they become.
const RATE: f64 = 30.0;
/// Deepest nesting of numbers in JSON: frames, joints, rows, columns.
const DEPTH: usize = 4;

/// Reads a `.npy`, `.json` or `.npz` file of one or more poses; the clip is named after it.
pub(in crate::format) fn read(bytes: &[u8], path: &Path, options: &ReadOptions) -> crate::Result<RawMotion> {
    let extension = path.extension().map(|e| e.to_ascii_lowercase());
    let arrays = match extension.as_ref().and_then(|e| e.to_str()) {
        Some("npy") => decode(bytes).map(|array| BTreeMap::from([(UNNAMED.to_owned(), array)])),
        Some("json") => of_json(bytes),
        _ => of_archive(bytes),
    };
    let read = arrays.and_then(|mut arrays| {
        arrays.iter_mut().for_each(|(name, array)| give_frames(name, array));
        let has_rate = RATES.iter().any(|name| arrays.contains_key(*name));
        let assumed = (!has_rate).then_some(RATE);
        let options = ReadOptions { frames_per_second: options.frames_per_second.or(assumed), ..*options };
        motion_of(&mut Archive::Memory(arrays), &clip_name(path), &options)
    });
    read.map_err(|error| Error::file(path, error))
}

/// The arrays of an archive that a motion is read from.
fn of_archive(bytes: &[u8]) -> Result<BTreeMap<String, Array>> {
    let mut archive = open(bytes)?;
    let wanted = |name: &String| {
        names::named(name).is_some() || RATES.contains(&name.as_str()) || name == "smpl_scaling"
    };
    let names: Vec<String> = archive.names().into_iter().filter(wanted).collect();
    if names.is_empty() {
        return Err(archive.missing("poses, or global_orient and body_pose"));
    }
    names.into_iter().map(|name| Ok((name.clone(), archive.array(&name)?))).collect()
}

/// The arrays of a JSON document: numbers, or an object of numbers by name.
fn of_json(bytes: &[u8]) -> Result<BTreeMap<String, Array>> {
    let document = serde_json::from_slice(bytes).map_err(|error| refused("is no JSON", error))?;
    let expected = "a list of numbers, or an object with poses, or with global_orient and body_pose";
    match document {
        Value::Array(_) => {
            let array = numbers(&document).ok_or_else(|| Fault::unexpected(expected, "another list"))?;
            Ok(BTreeMap::from([(UNNAMED.to_owned(), array)]))
        }
        Value::Object(fields) => Ok(fields
            .iter()
            .filter(|(name, _)| names::named(name).is_some())
            .filter_map(|(name, value)| Some((name.clone(), numbers(value)?)))
            .collect()),
        _ => Err(Fault::unexpected(expected, "another value").into()),
    }
}

/// Nested lists of numbers as an array; `None` for anything else and where lengths differ.
fn numbers(value: &Value) -> Option<Array> {
    let mut array = Array { shape: Vec::new(), dtype: "float64".to_owned(), values: Vec::new() };
    let mut level = value;
    while let Value::Array(items) = level {
        array.shape.push(items.len() as u64);
        level = items.first().filter(|_| array.shape.len() <= DEPTH)?;
    }
    collect(value, &array.shape, &mut array.values)?;
    Some(array)
}

fn collect(value: &Value, shape: &[u64], into: &mut Vec<f64>) -> Option<()> {
    match (value, shape.split_first()) {
        (Value::Array(items), Some((length, rest))) if items.len() as u64 == *length => {
            items.iter().try_for_each(|item| collect(item, rest, into))
        }
        (Value::Number(number), None) => {
            into.push(number.as_f64()?);
            Some(())
        }
        _ => None,
    }
}

/// Gives an array of a single frame the axis of frames that arrays of motion have first.
fn give_frames(name: &str, array: &mut Array) {
    let Some(named) = names::named(name) else { return };
    let joints: Vec<usize> = match named.part {
        Part::Whole => MODELS.iter().map(|joints| joints.count()).collect(),
        Part::Body => vec![21, 23],
        Part::Eyes => vec![2],
        Part::Hands => vec![30],
        Part::LeftHand | Part::RightHand => vec![15],
        _ => vec![1],
    };
    let count = array.values.len();
    let fits = |joints: &usize| count == 3 * joints || (count == 9 * joints && named.part != Part::Place);
    // A plain list is one pose, whatever its length, so that messages speak of its numbers.
    if joints.iter().any(fits) || (named.part == Part::Whole && array.shape.len() == 1) {
        array.shape = vec![1, count as u64];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn take(json: &str) -> crate::Result<RawMotion> {
        read(json.as_bytes(), Path::new("a/kneel.json"), &ReadOptions::default())
    }

    #[test]
    fn a_list_of_numbers_is_one_pose_of_the_model_with_as_many() {
        let mut numbers = vec![0.0; 72];
        numbers[3] = 0.25;
        for (text, joints) in [
            (format!("{numbers:?}"), 24),
            (format!("[{numbers:?}]"), 24),
            (format!("{:?}", numbers.chunks(3).collect::<Vec<_>>()), 24),
            (format!("{:?}", &numbers[..66]), 22),
            (format!("{{\"global_orient\": [0, 0, 0], \"body_pose\": {:?}}}", &numbers[3..66]), 22),
            (format!("{{\"smpl_pose\": {numbers:?}, \"betas\": [1, 2]}}"), 24),
        ] {
            let raw = take(&text).unwrap();
            assert_eq!((raw.skeleton.len(), raw.takes.len()), (joints, 1), "{text}");
            assert_eq!(raw.takes[0].name, "kneel");
        }
    }

    #[test]
    fn frames_of_poses_are_as_many_frames() {
        let two = format!("[{0:?}, {0:?}]", vec![0.0; 66]);
        let motion =
            crate::format::motion::units_and_axes::resolve(take(&two).unwrap(), &ReadOptions::default());
        assert_eq!(motion.unwrap().clips[0].frame_count(), 2);
    }

    #[test]
    fn what_is_no_pose_is_told() {
        for (text, expected) in [
            ("[1, 2", "is no JSON"),
            ("\"pose\"", "expected a list of numbers"),
            ("[[1, 2], [3]]", "got another list"),
            ("[1, \"two\"]", "got another list"),
            ("[]", "got another list"),
            ("{\"betas\": [1]}", "poses, or root_orient and pose_body"),
            ("{\"global_orient\": [0, 0, 0]}", "pose_body"),
            ("[1, 2, 3]", "66, 72, 156, 159 or 165 numbers"),
        ] {
            let message = take(text).err().map(|error| error.to_string()).unwrap_or_default();
            assert!(message.contains(expected) && message.contains("kneel.json"), "{text}: {message}");
        }
    }
}
