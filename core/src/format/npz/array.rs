//! Arrays of a numpy archive, in C order, as `f64`. A few bytes of such a file can demand any amount of memory or recursion
//! depth; therefore headers are checked before the `npyz` crate parses them, and data is read up to a limit.

use std::io::{Cursor, Read};

use npyz::npz::NpzArchive;
use npyz::{NpyFile, Order};

use crate::error::{Fault, NpzError, ParserError, Within};
use crate::format::npz::Result;

/// Maximum size of one array, bytes: an hour of SMPL-X at 100 frames per second takes 475 MB as `f64`.
const MAX_BYTES: u64 = 1 << 29;
/// Longest header of a plain array, bytes; numpy pads headers to 64 or 128.
const MAX_HEADER: usize = 1024;

/// An array in memory.
pub(super) struct Array {
    /// Lengths of its axes.
    pub(super) shape: Vec<u64>,
    /// C order: the last axis is the fastest.
    pub(super) values: Vec<f64>,
}

impl Array {
    /// Length of the first axis; 1 for a scalar.
    pub(super) fn rows(&self) -> usize {
        self.shape.first().map_or(1, |&rows| rows as usize)
    }

    /// Number of values per step along the first axis.
    pub(super) fn width(&self) -> usize {
        self.values.len().checked_div(self.rows()).unwrap_or(0)
    }
}

/// An open archive.
pub(super) struct Archive<'a> {
    zip: NpzArchive<Cursor<&'a [u8]>>,
}

impl<'a> Archive<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self> {
        let zip = NpzArchive::new(Cursor::new(bytes));
        Ok(Self { zip: zip.map_err(|e| refused("is not a zip archive, or truncated", e))? })
    }

    /// The error for a missing array.
    pub(super) fn missing(&self, wanted: &str) -> NpzError {
        let mut names: Vec<&str> = self.zip.array_names().collect();
        names.sort_unstable();
        let more = names.len().saturating_sub(20);
        names.truncate(20);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let has = names.join(", ");
        Fault::missing(format_args!("array {wanted}; the file has {}{more}", has.escape_debug())).into()
    }

    /// The first of these arrays that exists, with its name.
    pub(super) fn first(&mut self, names: &[&'static str]) -> Result<Option<(&'static str, Array)>> {
        for &name in names {
            if self.zip.array_names().any(|n| n == name) {
                return self.array(name).map(|array| Some((name, array))).within(name);
            }
        }
        Ok(None)
    }

    fn array(&mut self, name: &str) -> Result<Array> {
        let file = self.zip.zip_archive().by_name(&npyz::npz::file_name_from_array_name(name));
        let mut bytes = Vec::new();
        let file = file.map_err(|e| refused("cannot be unpacked", e))?;
        file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(|e| refused("cannot be unpacked", e))?;
        if bytes.len() as u64 > MAX_BYTES {
            return Err(Fault::too_many(format_args!("{MAX_BYTES} bytes"), "more").into());
        }
        decode(&bytes)
    }
}

/// The error for bytes that a parser crate refuses.
fn refused(what: &str, error: impl std::fmt::Display) -> ParserError {
    ParserError::refused(format_args!("{what}: {error}"))
}

/// Decodes the bytes of a `.npy` file.
pub(super) fn decode(bytes: &[u8]) -> Result<Array> {
    check_header(bytes)?;
    let mut data = bytes;
    let file = NpyFile::new(&mut data).map_err(|e| refused("is not an array", e))?;
    let (shape, order, dtype) = (file.shape().to_vec(), file.order(), file.dtype());
    let count = file.len();
    let expected = dtype.num_bytes().and_then(|size| (size as u64).checked_mul(count));
    let into = file.into_inner();
    if expected != Some(into.len() as u64) {
        let found = format!("{} bytes", into.len());
        return Err(Fault::truncated(format_args!("an array of shape {shape:?}"), found).into());
    }
    let file = || NpyFile::new(bytes);
    let descr = dtype.descr();
    let values = match descr.trim_matches('\'') {
        "<f8" | ">f8" => file().and_then(NpyFile::into_vec::<f64>),
        "<f4" | ">f4" => file().and_then(NpyFile::into_vec::<f32>).map(widened),
        "<i8" | ">i8" => {
            file().and_then(NpyFile::into_vec::<i64>).map(|v| v.into_iter().map(|x| x as f64).collect())
        }
        "<i4" | ">i4" => file().and_then(NpyFile::into_vec::<i32>).map(widened),
        other => return Err(Fault::unexpected("floating-point or whole numbers", other).into()),
    };
    let mut values = values.map_err(|e| refused("is not an array", e))?;
    // Arrays of one axis or none are the same in both orders.
    if order == Order::Fortran && shape.len() > 1 {
        let [rows, columns] = shape.as_slice() else {
            let found = format!("a shape of {shape:?}");
            return Err(Fault::unexpected("two axes of an array in Fortran order", found).into());
        };
        let (rows, columns) = (*rows as usize, *columns as usize);
        values = (0..values.len()).map(|i| values[(i % columns) * rows + i / columns]).collect();
    }
    Ok(Array { shape, values })
}

fn widened<T: Into<f64>>(values: Vec<T>) -> Vec<f64> {
    values.into_iter().map(Into::into).collect()
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
