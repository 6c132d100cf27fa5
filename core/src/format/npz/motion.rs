//! Converts the arrays of an archive to a motion of the body model with these joints.

use std::collections::BTreeSet;
use std::path::Path;

use glam::DVec3;

use super::array::Archive;
use super::names::{self, Frame, Named, Part, find};
use super::poses::{self, Poses, person_of, wrong};
use super::smpl::{self, BodyModel};
use crate::Error;
use crate::format::motion::raw::{RawMotion, Recorder};
use crate::format::motion::{Found, ReadOptions, check_start, clip_name, stand_on_floor};
use crate::format::npz::Result;
use crate::space::{Axis, Unit};

/// Reads an archive; the clip is named after the file.
pub(super) fn read(bytes: &[u8], path: &Path, options: &ReadOptions) -> crate::Result<RawMotion> {
    motion(bytes, &clip_name(path), options).map_err(|error| Error::file(path, error))
}

fn motion(bytes: &[u8], name: &str, options: &ReadOptions) -> Result<RawMotion> {
    motion_of(&mut open(bytes)?, name, options)
}

/// Opens the bytes of an archive.
pub(super) fn open(bytes: &[u8]) -> Result<Archive<'_>> {
    check_start(bytes, &[b"PK\x03\x04", b"PK\x05\x06"], "a zip archive")?;
    Archive::open(bytes)
}

/// The motion of an open archive.
pub(super) fn motion_of(archive: &mut Archive, name: &str, options: &ReadOptions) -> Result<RawMotion> {
    let mut warnings = vec![
        "the file has no skeleton: lengths of bones are assumed, those of a person of 1.70 m".to_owned(),
    ];
    let mut arrays: Vec<Named> = archive.names().iter().filter_map(|name| names::named(name)).collect();
    let asked = choose_person(&mut arrays, options.person, &mut warnings)?;
    let mut poses = poses::read(archive, &arrays, asked)?;
    warnings.append(&mut poses.warnings);
    let BodyModel { name: model, skeleton } = smpl::body_model(poses.joints)?;
    let places = read_places(archive, &arrays, &poses, &mut warnings)?;
    let (rate, rate_found) = read_rate(archive, options)?;

    let mut recorder = Recorder::new(skeleton.len());
    let rest = &skeleton.rest_pose().locals;
    let mut pose = rest.clone();
    for (frame, rotations) in poses.rotations.chunks_exact(skeleton.len()).enumerate() {
        for (local, rotation) in pose.iter_mut().zip(rotations) {
            local.rotation = *rotation;
        }
        if let Some((_, places)) = &places {
            pose[0].translation = places[frame].as_vec3();
        }
        recorder.push(&pose);
    }
    let take = recorder.take(name.to_owned(), rate, rest);
    match &places {
        Some((key, _)) => warnings.push(format!(
            "`{key}` is taken for the place of the pelvis: the {model} body model adds a constant of its own, by which the \
             whole clip is shifted"
        )),
        None => warnings.push(
            "the file has no place of the body (`trans`): it stays in its place, and its height is found from its lowest joint"
                .to_owned(),
        ),
    }
    let mut raw = RawMotion {
        format: model,
        skeleton,
        takes: vec![take],
        unit: Some(Unit::Metre),
        up: Some(Axis::Z),
        rest_is_upright: true,
        rate_found,
        warnings,
    };
    if places.is_none() {
        stand_on_floor(&mut raw, options.up);
    }
    Ok(raw)
}

/// Keeps the arrays of one person where their names say whose they are, and returns the index that is left to choose.
fn choose_person(
    arrays: &mut Vec<Named>,
    asked: Option<usize>,
    warnings: &mut Vec<String>,
) -> Result<Option<usize>> {
    let people: BTreeSet<u32> = arrays.iter().filter_map(|array| array.person).collect();
    let common =
        arrays.iter().any(|array| array.person.is_none() && matches!(array.part, Part::Whole | Part::Root));
    if people.is_empty() || common {
        arrays.retain(|array| array.person.is_none());
        return Ok(asked);
    }
    let chosen = people.iter().nth(person_of(people.len(), asked, warnings)?).copied();
    arrays.retain(|array| array.person.is_none() || array.person == chosen);
    Ok(None)
}

/// The array of the body's places in the axes of its root, with its name.
fn read_places(
    archive: &mut Archive,
    arrays: &[Named],
    poses: &Poses,
    warnings: &mut Vec<String>,
) -> Result<Option<(String, Vec<DVec3>)>> {
    let has_root = |frame| [Part::Whole, Part::Root].iter().any(|part| find(arrays, *part, frame).is_some());
    // Places whose axes are not said belong to a root in the world's only where it is the only one.
    let others: &[Frame] = match poses.frame {
        Frame::World if has_root(Frame::Unsaid) || has_root(Frame::Camera) => &[],
        Frame::World => &[Frame::Unsaid],
        Frame::Unsaid => &[Frame::Camera, Frame::World],
        Frame::Camera => &[Frame::Unsaid],
    };
    if poses.frame == Frame::World && has_root(Frame::Unsaid) {
        warnings.push("of two roots, the one in the world's axes is read".to_owned());
    }
    let named =
        std::iter::once(&poses.frame).chain(others).find_map(|frame| find(arrays, Part::Place, *frame));
    let Some(named) = named else { return Ok(None) };
    let (key, array) = (&named.name, archive.array(&named.name)?);
    let scale = if archive.names().iter().any(|name| name == "smpl_scaling") {
        archive.array("smpl_scaling")?.values.first().copied().filter(|scale| *scale > 0.0).unwrap_or(1.0)
    } else {
        1.0
    };
    if poses.lead.width(&array) != Some(3) {
        return wrong(key, format_args!("a shape of ({}, 3)", poses.lead.frames), &array);
    }
    let places = poses.lead.rows(&array, 3).map(|row| DVec3::from_slice(row) / scale).collect();
    Ok(Some((key.clone(), places)))
}

/// Names of the array of frames per second.
pub(super) const RATES: [&str; 5] = ["mocap_framerate", "mocap_frame_rate", "fps", "framerate", "frame_rate"];

/// Frames per second: as asked, or as the file says.
fn read_rate(archive: &mut Archive, options: &ReadOptions) -> Result<(f64, Found)> {
    if let Some(rate) = options.frames_per_second {
        return Ok((rate, Found::Asked));
    }
    let names = archive.names();
    let Some(key) = RATES.into_iter().find(|known| names.iter().any(|name| name == known)) else {
        return Err(archive.missing("mocap_framerate"));
    };
    match archive.array(key)?.values.as_slice() {
        [rate] if (0.1..=1000.0).contains(rate) => Ok((*rate, Found::File)),
        other => {
            let got = other.iter().take(3).collect::<Vec<_>>();
            wrong(key, "one number of 0.1 to 1000", format_args!("{got:?}"))
        }
    }
}
