//! Arrays of a numpy archive, in C order, as `f64`. A few bytes of such a file can demand any amount of memory or recursion
//! depth; therefore headers are checked before the `npyz` crate parses them, and data is read up to a limit.

use std::collections::BTreeMap;
use std::fmt;
use std::io::{Cursor, Read};

use half::f16;
use npyz::npz::NpzArchive;
use npyz::{NpyFile, Order};

use crate::error::{Fault, NpzError, ParserError, Within};
use crate::format::npz::Result;

/// Maximum size of one array, bytes: an hour of SMPL-X at 100 frames per second takes 475 MB as `f64`.
const MAX_BYTES: u64 = 1 << 29;
/// Longest header of a plain array, bytes; numpy pads headers to 64 or 128.
const MAX_HEADER: usize = 1024;
/// Arrays that a message lists.
const LISTED: usize = 20;

/// An array in memory.
#[derive(Clone)]
pub(super) struct Array {
    /// Lengths of its axes.
    pub(super) shape: Vec<u64>,
    /// Type of its numbers, as numpy calls it: `float32`.
    pub(super) dtype: String,
    /// C order: the last axis is the fastest.
    pub(super) values: Vec<f64>,
}

impl Array {
    /// Length of the first axis; 1 for a scalar.
    pub(super) fn rows(&self) -> usize {
        self.shape.first().map_or(1, |&rows| rows as usize)
    }
}

impl fmt::Display for Array {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} of {}", self.shape, self.dtype)
    }
}

/// An open archive.
pub(super) enum Archive<'a> {
    /// A file.
    Zip(NpzArchive<Cursor<&'a [u8]>>),
    /// Arrays that have been read already, by name.
    Memory(BTreeMap<String, Array>),
}

impl<'a> Archive<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self> {
        let zip = NpzArchive::new(Cursor::new(bytes));
        Ok(Self::Zip(zip.map_err(|e| refused("is not a zip archive, or truncated", e))?))
    }

    /// The names of its arrays, in order.
    pub(super) fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = match self {
            Self::Zip(zip) => zip.array_names().map(str::to_owned).collect(),
            Self::Memory(arrays) => arrays.keys().cloned().collect(),
        };
        names.sort_unstable();
        names
    }

    /// The error for a missing array; it lists those that are there, with shape and type.
    pub(super) fn missing(&mut self, wanted: &str) -> NpzError {
        let mut names = self.names();
        let more = names.len().saturating_sub(LISTED);
        names.truncate(LISTED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let has: Vec<String> =
            names.iter().map(|name| format!("{} {}", name.escape_debug(), self.outline(name))).collect();
        let has = if has.is_empty() { "none".to_owned() } else { has.join(", ") };
        Fault::missing(format_args!("array {wanted}; the file has {has}{more}")).into()
    }

    /// Shape and type of an array, in brackets, for messages.
    fn outline(&mut self, name: &str) -> String {
        if let Self::Memory(arrays) = self {
            return arrays.get(name).map_or_else(String::new, |array| format!("({array})"));
        }
        let mut header = Vec::new();
        let read = self.read(name, &mut header, MAX_HEADER as u64 + 12);
        let outline = read.and_then(|()| check_header(&header)).and_then(|()| {
            let file = NpyFile::new(header.as_slice()).map_err(|e| refused("is not an array", e))?;
            Ok(format!("({:?} of {})", file.shape(), dtype_name(&file.dtype().descr())))
        });
        outline.unwrap_or_else(|_| "(unreadable)".to_owned())
    }

    /// The array of this name.
    pub(super) fn array(&mut self, name: &str) -> Result<Array> {
        if let Self::Memory(arrays) = self
            && let Some(array) = arrays.get(name)
        {
            return Ok(array.clone());
        }
        let mut bytes = Vec::new();
        let read = self.read(name, &mut bytes, MAX_BYTES + 1).and_then(|()| {
            if bytes.len() as u64 > MAX_BYTES {
                return Err(Fault::too_many(format_args!("{MAX_BYTES} bytes"), "more").into());
            }
            decode(&bytes)
        });
        read.within(name)
    }

    /// Unpacks up to `most` bytes of an array.
    fn read(&mut self, name: &str, into: &mut Vec<u8>, most: u64) -> Result<()> {
        let Self::Zip(zip) = self else { return Err(Fault::missing(name).into()) };
        let file = zip.zip_archive().by_name(&npyz::npz::file_name_from_array_name(name));
        let file = file.map_err(|e| refused("cannot be unpacked", e))?;
        file.take(most).read_to_end(into).map_err(|e| refused("cannot be unpacked", e))?;
        Ok(())
    }
}

/// The error for bytes that a parser crate refuses.
pub(super) fn refused(what: &str, error: impl fmt::Display) -> ParserError {
    ParserError::refused(format_args!("{what}: {error}"))
}

/// Decodes the bytes of a `.npy` file.
pub(super) fn decode(bytes: &[u8]) -> Result<Array> {
    check_header(bytes)?;
    let mut data = bytes;
    let file = NpyFile::new(&mut data).map_err(|e| refused("is not an array", e))?;
    let (shape, order, descr) = (file.shape().to_vec(), file.order(), file.dtype().descr());
    let (size, count) = (file.dtype().num_bytes(), file.len());
    let into = file.into_inner();
    let dtype = dtype_name(&descr);
    if dtype == "object" {
        let found = format!("a shape of {shape:?} of Python objects, which only Python reads");
        return Err(Fault::unexpected("an array of numbers", found).into());
    }
    let expected = size.and_then(|size| (size as u64).checked_mul(count));
    if expected != Some(into.len() as u64) {
        let found = format!("{} bytes", into.len());
        return Err(Fault::truncated(format_args!("an array of shape {shape:?}"), found).into());
    }
    let Some(mut values) = numbers(descr.trim_matches('\''), into) else {
        let found = format!("a shape of {shape:?} of {dtype}");
        return Err(Fault::unexpected("floating-point or whole numbers", found).into());
    };
    // Arrays of one axis or none are the same in both orders.
    if order == Order::Fortran && shape.len() > 1 {
        values = c_order(&values, &shape);
    }
    Ok(Array { shape, dtype, values })
}

/// Values in Fortran order, whose first axis is the fastest, in C order.
fn c_order(values: &[f64], shape: &[u64]) -> Vec<f64> {
    let mut steps = Vec::with_capacity(shape.len());
    let mut step = 1;
    for &length in shape {
        steps.push(step);
        step *= length as usize;
    }
    let mut place = vec![0usize; shape.len()];
    let mut next = || {
        let at: usize = place.iter().zip(&steps).map(|(i, step)| i * step).sum();
        for (i, &length) in place.iter_mut().zip(shape).rev() {
            *i += 1;
            if *i < length as usize {
                break;
            }
            *i = 0;
        }
        values[at]
    };
    (0..values.len()).map(|_| next()).collect()
}

/// Numbers of a numpy type; `None` for types that are none.
fn numbers(descr: &str, bytes: &[u8]) -> Option<Vec<f64>> {
    fn all<const N: usize>(bytes: &[u8], big: bool, number: impl Fn([u8; N]) -> f64) -> Vec<f64> {
        let (numbers, _) = bytes.as_chunks::<N>();
        let little = |mut bytes: [u8; N]| {
            if big {
                bytes.reverse();
            }
            bytes
        };
        numbers.iter().map(|bytes| number(little(*bytes))).collect()
    }
    let (order, kind) = descr.split_at_checked(1)?;
    let big = order == ">";
    Some(match kind {
        "f8" => all(bytes, big, f64::from_le_bytes),
        "f4" => all(bytes, big, |b| f32::from_le_bytes(b).into()),
        "f2" => all(bytes, big, |b| f16::from_le_bytes(b).to_f64()),
        "i8" => all(bytes, big, |b| i64::from_le_bytes(b) as f64),
        "i4" => all(bytes, big, |b| i32::from_le_bytes(b).into()),
        "i2" => all(bytes, big, |b| i16::from_le_bytes(b).into()),
        "i1" => all(bytes, big, |b| i8::from_le_bytes(b).into()),
        "u8" => all(bytes, big, |b| u64::from_le_bytes(b) as f64),
        "u4" => all(bytes, big, |b| u32::from_le_bytes(b).into()),
        "u2" => all(bytes, big, |b| u16::from_le_bytes(b).into()),
        "u1" => all(bytes, big, |b| u8::from_le_bytes(b).into()),
        _ => return None,
    })
}

/// What numpy calls a type: `float32` of `<f4`.
fn dtype_name(descr: &str) -> String {
    let plain = descr.trim_matches('\'').trim_start_matches(['<', '>', '|', '=']);
    let named = |kind: &str| {
        plain.get(1..).and_then(|n| n.parse::<u32>().ok()).map(|n| format!("{kind}{}", n.saturating_mul(8)))
    };
    let name = match plain.get(..1) {
        Some("f") => named("float"),
        Some("i") => named("int"),
        Some("u") => named("uint"),
        Some("b") => Some("bool".to_owned()),
        Some("O") => Some("object".to_owned()),
        Some("U" | "S") => Some("text".to_owned()),
        _ => None,
    };
    name.unwrap_or_else(|| plain.escape_debug().to_string())
}

/// Refuses headers that are longer, more deeply nested or with larger numbers than those of a plain array.
fn check_header(bytes: &[u8]) -> Result<()> {
    let length = match bytes {
        [0x93, b'N', b'U', b'M', b'P', b'Y', 1, 0, a, b, ..] => usize::from(u16::from_le_bytes([*a, *b])),
        [0x93, b'N', b'U', b'M', b'P', b'Y', 2 | 3, 0, a, b, c, d, ..] => {
            u32::from_le_bytes([*a, *b, *c, *d]) as usize
        }
        _ => return Err(Fault::unexpected("the header of a numpy array", "other bytes").into()),
    };
    let start = if bytes[6] == 1 { 10 } else { 12 };
    let header = bytes.get(start..).and_then(|rest| rest.get(..length)).filter(|_| length <= MAX_HEADER);
    let Some(header) = header else {
        let most = format!("a header of {MAX_HEADER} bytes, and no more than are there");
        return Err(Fault::too_many(most, length).into());
    };
    let brackets = header.iter().filter(|c| b"([{".contains(c)).count();
    // The product of numbers with this many digits in total fits in 64 bits.
    let digits = header.iter().filter(|c| c.is_ascii_digit()).count();
    if brackets > 4 || digits > 18 {
        return Err(Fault::unexpected("a plain array", header.trim_ascii_end().escape_ascii()).into());
    }
    Ok(())
}
