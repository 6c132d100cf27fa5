//! The rotations of an archive: one array of all joints or one per part, as axis-angle vectors or matrices, of one person or
//! several.

use std::fmt::Display;

use glam::{DMat3, DVec3, Mat3, Vec3};

use super::array::{Archive, Array};
use super::names::{Frame, Named, Part, find, find_any};
use super::smpl::{Joints, MODELS};
use crate::clip::MAX_FRAMES;
use crate::error::{Fault, Located, NpzError, Within};
use crate::format::motion::bounds;
use crate::format::npz::Result;
use crate::math::Rotation;

/// Numbers of a rotation: of an axis-angle vector and of a matrix.
const FORMS: [usize; 2] = [3, 9];
/// How far a rotation matrix may be from an orthonormal one: half precision is not exact.
const ORTHONORMAL: f64 = 0.02;

/// The first axes of the arrays: frames, and people where there are several.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lead {
    pub(super) frames: usize,
    pub(super) people: usize,
    /// The first axis counts people.
    people_first: bool,
    /// The person that is read.
    person: usize,
}

/// Rotations of every joint in every frame.
pub(super) struct Poses {
    pub(super) joints: Joints,
    pub(super) lead: Lead,
    /// Frames × joints.
    pub(super) rotations: Vec<Rotation>,
    /// The axes of the root.
    pub(super) frame: Frame,
    /// Which arrays were read and which not.
    pub(super) warnings: Vec<String>,
}

/// An array of one part, with its name.
type Piece = (String, Array);

/// The error for an array with unexpected content.
pub(super) fn wrong<T>(array: &str, expected: impl Display, found: impl Display) -> Result<T> {
    Err(NpzError::from(Fault::unexpected(expected, found)).within(array.to_owned()))
}

impl Lead {
    /// The first axes of an array that has `widths` numbers, of any of these, for each frame and person.
    fn of(key: &str, array: &Array, widths: &[usize]) -> Result<Option<Self>> {
        let product = |axes: &[u64]| axes.iter().map(|&n| n as usize).product::<usize>();
        let axes = (1..=2usize.min(array.shape.len())).find(|&axes| {
            let (_, rest) = array.shape.split_at(axes);
            !rest.is_empty() && widths.contains(&product(rest))
        });
        let (frames, people, people_first) = match (axes, array.shape.as_slice()) {
            (Some(1), [frames, ..]) => (*frames, 1, false),
            // There are fewer people than frames.
            (Some(_), [a, b, ..]) if a <= b => (*b, *a, true),
            (Some(_), [a, b, ..]) => (*a, *b, false),
            _ => return Ok(None),
        };
        check_frames(key, array, frames)?;
        Ok(Some(Self { frames: frames as usize, people: people as usize, people_first, person: 0 }))
    }

    /// Chooses a person.
    fn choose(&mut self, asked: Option<usize>, warnings: &mut Vec<String>) -> Result<()> {
        self.person = person_of(self.people, asked, warnings)?;
        Ok(())
    }

    /// Numbers per frame and person; `None` where the array is of other axes.
    pub(super) fn width(&self, array: &Array) -> Option<usize> {
        let leading = if self.people_first { [self.people, self.frames] } else { [self.frames, self.people] };
        // Axes of length 1 may be anywhere.
        let counted = |axes: &mut dyn Iterator<Item = usize>| axes.filter(|n| *n != 1).collect::<Vec<_>>();
        let expected = counted(&mut leading.into_iter());
        let found = counted(&mut array.shape.iter().map(|&n| n as usize));
        let width = array.values.len().checked_div(self.frames * self.people).filter(|width| *width > 0)?;
        let fits = found.starts_with(&expected) && width * self.frames * self.people == array.values.len();
        fits.then_some(width)
    }

    /// The numbers of the person in every frame, of an array with this [`width`](Self::width).
    pub(super) fn rows<'a>(
        &self,
        array: &'a Array,
        width: usize,
    ) -> impl Iterator<Item = &'a [f64]> + use<'a> {
        let Self { frames, people, people_first, person } = *self;
        let row =
            move |frame: usize| if people_first { person * frames + frame } else { frame * people + person };
        (0..frames).map(move |frame| &array.values[row(frame) * width..][..width])
    }
}

/// The person of several that is read, by index.
pub(super) fn person_of(people: usize, asked: Option<usize>, warnings: &mut Vec<String>) -> Result<usize> {
    let person = asked.unwrap_or(0);
    if person >= people {
        return Err(Fault::unexpected(format_args!("an index of a person below {people}"), person).into());
    }
    if people > 1 && asked.is_none() {
        warnings
            .push(format!("of {people} people the first was read, person 0; another is read if asked for"));
    }
    Ok(person)
}

/// Reads the rotations of one array of all joints, or of one array per part.
pub(super) fn read(archive: &mut Archive, arrays: &[Named], asked: Option<usize>) -> Result<Poses> {
    for frame in [Frame::World, Frame::Unsaid, Frame::Camera] {
        let root = find(arrays, Part::Root, frame);
        if let Some(whole) = find(arrays, Part::Whole, frame) {
            let (key, array) = (&whole.name, archive.array(&whole.name)?);
            match read_whole(key, &array, whole.frame, asked)? {
                Some(poses) => return Ok(poses),
                // A `pose` beside the parts is something else, such as a camera's.
                None if root.is_some() => {}
                None => return Err(no_model(key, &array)),
            }
        }
        if let Some(root) = root {
            return read_parts(archive, arrays, root, asked);
        }
    }
    Err(archive.missing("poses, or root_orient and pose_body"))
}

/// Reads an array of all joints; `None` where it has as many numbers as no model.
fn read_whole(key: &str, array: &Array, frame: Frame, asked: Option<usize>) -> Result<Option<Poses>> {
    let widths: Vec<usize> =
        FORMS.iter().flat_map(|form| MODELS.map(|joints| joints.count() * form)).collect();
    let Some(mut lead) = Lead::of(key, array, &widths)? else {
        check_frames(key, array, array.shape.first().copied().unwrap_or_default())?;
        return Ok(None);
    };
    let mut warnings = Vec::new();
    lead.choose(asked, &mut warnings)?;
    let width = lead.width(array).unwrap_or_default();
    let mut forms = FORMS.into_iter().flat_map(|form| MODELS.map(|joints| (joints, form)));
    let Some((joints, form)) = forms.find(|(joints, form)| joints.count() * form == width) else {
        return Ok(None);
    };
    let mut rotations = Vec::with_capacity(lead.frames * joints.count());
    for row in lead.rows(array, width) {
        add(row, form, &mut rotations).within(key)?;
    }
    Ok(Some(Poses { joints, lead, rotations, frame, warnings }))
}

/// The error for an array of all joints that has as many numbers as no model.
fn no_model(key: &str, array: &Array) -> NpzError {
    let expected =
        "66, 72, 156, 159 or 165 numbers a frame (SMPL, SMPL-H, SMPL-X), or three times as many of matrices";
    let hint = match array.shape.iter().skip(1).product::<u64>() {
        69 | 207 => ", which lacks the pelvis",
        67..156 => {
            ", perhaps with hands as components of a PCA, which are not read: save them as axis-angle vectors"
        }
        _ => "",
    };
    let found = format_args!("a shape of {array}{hint}");
    NpzError::from(Fault::unexpected(expected, found)).within(key.to_owned())
}

fn read_parts(archive: &mut Archive, arrays: &[Named], root: &Named, asked: Option<usize>) -> Result<Poses> {
    let frame = root.frame;
    let Some(body) = find_any(arrays, Part::Body, frame) else { return Err(archive.missing("pose_body")) };
    let mut load = |named: &Named| Ok::<Piece, NpzError>((named.name.clone(), archive.array(&named.name)?));
    let (root, body) = (load(root)?, load(body)?);
    check_frames(&root.0, &root.1, root.1.rows() as u64)?;
    let bodies = [21, 23];
    let widths: Vec<usize> = FORMS.iter().flat_map(|form| bodies.map(|joints| joints * form)).collect();
    let Some(mut lead) = Lead::of(&body.0, &body.1, &widths)? else {
        let expected =
            "63 or 69 numbers a frame (SMPL's 21 or 23 joints), or three times as many of matrices";
        return wrong(&body.0, expected, format_args!("a shape of {}", body.1));
    };
    let mut warnings = Vec::new();
    lead.choose(asked, &mut warnings)?;
    if lead.width(&root.1).is_none_or(|width| !FORMS.contains(&width)) {
        if root.1.rows() != lead.frames && lead.people == 1 {
            let expected = format!("{} frames", root.1.rows());
            return wrong(&body.0, expected, format_args!("a shape of {}", body.1));
        }
        let expected = format!("3 numbers, or 9 of a matrix, for each of {} frames", lead.frames);
        return wrong(&root.0, expected, format_args!("a shape of {}", root.1));
    }
    let palms = lead.width(&body.1).is_some_and(|width| FORMS.map(|form| 23 * form).contains(&width));
    let mut pieces = vec![(root, 1), (body, if palms { 23 } else { 21 })];
    let mut optional = |parts: &[(Part, usize)]| -> Result<bool> {
        let found: Vec<_> = parts
            .iter()
            .filter_map(|(part, joints)| Some((find_any(arrays, *part, frame)?, *joints)))
            .collect();
        if found.len() != parts.len() {
            return Ok(false);
        }
        let start = pieces.len();
        for (named, joints) in found {
            let (key, array) = load(named)?;
            match lead.width(&array) {
                Some(width) if FORMS.contains(&(width / joints)) && width % joints == 0 => {
                    pieces.push(((key, array), joints));
                }
                Some(width) if joints >= 15 && width < 3 * joints => {
                    warnings.push(format!(
                        "`{key}` has {width} numbers a frame, components of a PCA whose basis belongs to the body model: hands are \
                         left relaxed"
                    ));
                    pieces.truncate(start);
                    return Ok(false);
                }
                _ => {
                    let expected = format!("{} numbers for each of {} frames", 3 * joints, lead.frames);
                    let has = if array.rows() == lead.frames {
                        expected
                    } else {
                        format!("{} frames", lead.frames)
                    };
                    return wrong(&key, has, format_args!("a shape of {array}"));
                }
            }
        }
        Ok(true)
    };
    let jaw = optional(&[(Part::Jaw, 1)])?;
    let eyes = optional(&[(Part::Eyes, 2)])? || optional(&[(Part::LeftEye, 1), (Part::RightEye, 1)])?;
    let hands = optional(&[(Part::Hands, 30)])? || optional(&[(Part::LeftHand, 15), (Part::RightHand, 15)])?;
    let joints = Joints { palms, jaw, eyes, hands };
    Ok(Poses { joints, rotations: join(&lead, &pieces)?, lead, frame, warnings })
}

/// The rotations of all pieces, frame by frame.
fn join(lead: &Lead, pieces: &[(Piece, usize)]) -> Result<Vec<Rotation>> {
    let mut columns = Vec::new();
    for ((key, array), joints) in pieces {
        let width = lead.width(array).unwrap_or_default();
        let mut column = Vec::with_capacity(lead.frames * joints);
        for row in lead.rows(array, width) {
            add(row, width / joints, &mut column).within(key)?;
        }
        columns.push((column, *joints));
    }
    let mut rotations = Vec::with_capacity(columns.iter().map(|(column, _)| column.len()).sum());
    for frame in 0..lead.frames {
        for (column, joints) in &columns {
            rotations.extend_from_slice(&column[frame * joints..][..*joints]);
        }
    }
    Ok(rotations)
}

/// Adds rotations of this many numbers each.
fn add(row: &[f64], form: usize, rotations: &mut Vec<Rotation>) -> Result<()> {
    for numbers in row.chunks_exact(form) {
        rotations.push(if form == 3 { of_vector(DVec3::from_slice(numbers))? } else { of_matrix(numbers)? });
    }
    Ok(())
}

/// The rotation of an axis-angle vector, whose length is the angle; `NaN` where it is not finite.
fn of_vector(turn: DVec3) -> Result<Rotation> {
    let angle = turn.length();
    bounds::check_degrees(angle.to_degrees())?;
    let (sin, cos) = libm::sincos(angle / 2.0);
    // sin(a/2) / a, which tends to one half at 0.
    let scale = if angle < 1e-9 { 0.5 } else { sin / angle };
    let axis: Vec3 = (turn * scale).as_vec3();
    Ok(Rotation::from_xyzw(axis.x, axis.y, axis.z, cos as f32))
}

/// The rotation of a matrix, row by row.
fn of_matrix(numbers: &[f64]) -> Result<Rotation> {
    let matrix = DMat3::from_cols_slice(numbers).transpose();
    let off = (matrix * matrix.transpose() - DMat3::IDENTITY)
        .to_cols_array()
        .iter()
        .fold(0.0, |a: f64, b| a.max(b.abs()));
    if !(matrix.is_finite() && off < ORTHONORMAL && matrix.determinant() > 0.0) {
        return Err(Fault::unexpected("rotation matrices", format_args!("{matrix}")).into());
    }
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(DVec3::as_vec3);
    Ok(Rotation::from_mat3(&Mat3::from_cols(x, y, z)).normalize())
}

fn check_frames(key: &str, array: &Array, frames: u64) -> Result<()> {
    if array.shape.len() < 2 || frames == 0 || frames > MAX_FRAMES as u64 {
        let expected = format!("1 to {MAX_FRAMES} frames by joints");
        return wrong(key, expected, format_args!("a shape of {array}"));
    }
    Ok(())
}
