//! The caller's memory: every pointer that a caller passes is checked here.

use std::ffi::{c_char, c_void};
use std::mem::MaybeUninit;

use crate::status::{ANTHRONET_ERROR_INDEX, ANTHRONET_ERROR_POINTER, ANTHRONET_ERROR_TEXT, Fault, Outcome};

/// A text that the library owns: UTF-8, not ended by a zero, valid as long as the object that it was read from.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_text {
    /// The first byte.
    pub data: *const c_char,
    /// Number of bytes.
    pub length: u64,
}

impl anthronet_text {
    pub(crate) fn of(text: &str) -> Self {
        Self { data: text.as_ptr().cast(), length: text.len() as u64 }
    }
}

/// Refuses a pointer that is NULL or not aligned.
pub(crate) fn usable<T>(pointer: *const T, what: &str) -> Outcome {
    if pointer.is_null() {
        return Err(Fault::null(what));
    }
    if !pointer.is_aligned() {
        let message = format!("{what}: expected a pointer aligned to {} bytes", align_of::<T>());
        return Err(Fault::new(ANTHRONET_ERROR_POINTER, message));
    }
    Ok(())
}

/// A handle or descriptor that is read.
pub(crate) fn read<'a, T>(pointer: *const T, what: &str) -> Outcome<&'a T> {
    usable(pointer, what)?;
    // SAFETY: not NULL, aligned; that it is alive is the preamble's contract.
    Ok(unsafe { &*pointer })
}

/// A handle that is changed.
pub(crate) fn change<'a, T>(pointer: *mut T, what: &str) -> Outcome<&'a mut T> {
    usable(pointer, what)?;
    // SAFETY: as `read`; `T*` is not shared between threads by contract.
    Ok(unsafe { &mut *pointer })
}

/// Where one result goes. Checked before the work and written after it, so that failures leave it as it was.
pub(crate) struct Out<T>(*mut T);

impl<T> Out<T> {
    pub(crate) fn new(pointer: *mut T, what: &str) -> Outcome<Self> {
        usable(pointer, what)?;
        Ok(Self(pointer))
    }

    /// `None` for NULL: a result that the caller does not want.
    pub(crate) fn optional(pointer: *mut T, what: &str) -> Outcome<Option<Self>> {
        if pointer.is_null() { Ok(None) } else { Self::new(pointer, what).map(Some) }
    }

    pub(crate) fn write(self, value: T) {
        // SAFETY: not NULL and aligned; large enough by contract. What was there is not read.
        unsafe { self.0.write(value) }
    }
}

impl<T> Out<*mut T> {
    /// A new handle of the caller's.
    pub(crate) fn give(self, handle: T) {
        self.write(Box::into_raw(Box::new(handle)));
    }
}

/// Takes a handle back and drops it; NULL is nothing.
pub(crate) fn free<T>(handle: *mut T) {
    // A defect is logged, as there is no status to return.
    let _ = crate::status::caught(|| {
        if !handle.is_null() {
            // SAFETY: from `Out::give`, once, by contract.
            drop(unsafe { Box::from_raw(handle) });
        }
        Ok(())
    });
}

fn length<T>(count: u64, what: &str) -> Outcome<usize> {
    let bytes = usize::try_from(count).ok().and_then(|n| n.checked_mul(size_of::<T>().max(1)));
    match bytes {
        Some(bytes) if bytes <= isize::MAX as usize => Ok(count as usize),
        _ => Err(Fault::beyond_memory(what, count)),
    }
}

/// An array that is read. NULL is an empty array and nothing else.
pub(crate) fn slice<'a, T>(pointer: *const T, count: u64, what: &str) -> Outcome<&'a [T]> {
    let count = length::<T>(count, what)?;
    if count == 0 {
        return Ok(&[]);
    }
    usable(pointer, what)?;
    // SAFETY: not NULL, aligned, of a length that can be; that it is that long is the contract.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// An array that is written, each number once, in order. No reference to its memory is made: that may hold nothing yet,
/// and a careless caller's may lie in another array of the call.
pub(crate) struct OutSlice<T> {
    next: *mut T,
    left: usize,
}

impl<T> OutSlice<T> {
    pub(crate) fn new(pointer: *mut T, count: u64, what: &str) -> Outcome<Self> {
        let left = length::<T>(count, what)?;
        if left > 0 {
            usable(pointer, what)?;
        }
        Ok(Self { next: pointer, left })
    }

    /// Writes values as far as there is room.
    pub(crate) fn write(&mut self, values: impl IntoIterator<Item = T>) {
        for value in values.into_iter().take(self.left) {
            // SAFETY: not NULL, aligned, and one of the `left` places that are there by contract.
            unsafe {
                self.next.write(value);
                self.next = self.next.add(1);
            }
            self.left -= 1;
        }
    }
}

/// A buffer of bytes that is written and may hold nothing yet.
pub(crate) fn buffer<'a>(pointer: *mut c_void, bytes: u64, what: &str) -> Outcome<&'a mut [MaybeUninit<u8>]> {
    let count = length::<u8>(bytes, what)?;
    if count == 0 {
        return Ok(&mut []);
    }
    usable(pointer.cast::<u8>(), what)?;
    // SAFETY: as `slice`, and the caller's alone; what it holds is not read.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer.cast(), count) })
}

/// Most bytes of a text: above every path, name and mapping of joints.
const MAX_TEXT: u64 = 1 << 20;
/// Most bytes of a file in memory: as of one on the disk.
const MAX_FILE: u64 = 1 << 30;
/// Most entries of a list that nothing else limits: requests, jobs, clips.
pub(crate) const MAX_LIST: u64 = 1 << 20;

/// Text of the caller's: `length` bytes of UTF-8.
pub(crate) fn text<'a>(data: *const c_char, length: u64, what: &str) -> Outcome<&'a str> {
    at_most(what, "bytes", MAX_TEXT, length)?;
    let bytes: &[u8] = slice(data.cast(), length, what)?;
    std::str::from_utf8(bytes).map_err(|error| {
        let message = format!("{what}: expected UTF-8, got another byte at {}", error.valid_up_to());
        Fault::new(ANTHRONET_ERROR_TEXT, message)
    })
}

/// A file of the caller's in memory.
pub(crate) fn file<'a>(data: *const u8, length: u64, what: &str) -> Outcome<&'a [u8]> {
    at_most(what, "bytes", MAX_FILE, length)?;
    slice(data, length, what)
}

/// A list of the caller's whose length only the caller knows.
pub(crate) fn list<'a, T>(pointer: *const T, count: u32, what: &str) -> Outcome<&'a [T]> {
    at_most(what, "entries", MAX_LIST, count.into())?;
    slice(pointer, count.into(), what)
}

/// Refuses a count that is larger than what it counts can be, before anything is looked at.
pub(crate) fn at_most(what: &str, unit: &str, most: u64, got: u64) -> Outcome {
    if got <= most {
        return Ok(());
    }
    Err(Fault::size(what, format_args!("expected at most {most} {unit}, got {got}")))
}

/// Refuses an array that is not as long as it has to be.
pub(crate) fn exactly(what: &str, expected: usize, got: u64) -> Outcome {
    if got == expected as u64 {
        return Ok(());
    }
    Err(Fault::size(what, format_args!("expected {expected}, got {got}")))
}

/// Refuses infinities and what is not a number.
pub(crate) fn finite(what: &str, value: f64) -> Outcome {
    if value.is_finite() {
        return Ok(());
    }
    Err(Fault::request(what, format_args!("expected a finite number, got {value}")))
}

/// The element at a place.
pub(crate) fn at<'a, T>(list: &'a [T], index: u32, what: &str) -> Outcome<&'a T> {
    list.get(index as usize).ok_or_else(|| beyond(what, index, list.len()))
}

pub(crate) fn beyond(what: &str, index: u32, count: usize) -> Fault {
    Fault::new(
        ANTHRONET_ERROR_INDEX,
        format!("{what}: expected 0 to {}, got {index}", count.saturating_sub(1)),
    )
}

fn short_stride(what: &str, least: u64, got: u64) -> Fault {
    Fault::size(what, format_args!("expected a stride of at least {least} bytes, got {got}"))
}

/// Writes packed rows to a caller's buffer of `bytes` bytes, `stride` bytes from row to row; 0 stands for packed.
pub(crate) fn write_rows(
    rows: &[u8],
    width: usize,
    out: *mut c_void,
    bytes: u64,
    stride: u64,
    what: &str,
) -> Outcome {
    let stride = if stride == 0 { width } else { length::<u8>(stride, what)? };
    let count = rows.len() / width.max(1);
    if stride < width {
        return Err(short_stride(what, width as u64, stride as u64));
    }
    let needed = count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(width));
    if needed.is_none_or(|needed| needed as u64 > bytes) {
        let expected = needed.map_or("more bytes than memory holds".to_owned(), |n| format!("{n} bytes"));
        let message = format!(
            "expected {expected} for {count} rows of {width} bytes with stride {stride}, got {bytes} bytes"
        );
        return Err(Fault::size(what, message));
    }
    let out = buffer(out, needed.unwrap_or_default() as u64, what)?;
    if stride == width {
        out.write_copy_of_slice(rows);
        return Ok(());
    }
    for (from, to) in rows.chunks_exact(width).zip(out.chunks_mut(stride)) {
        to[..width].write_copy_of_slice(from);
    }
    Ok(())
}

/// Reads `count` vectors of three floats, `stride` bytes from one to the next; 0 stands for packed.
pub(crate) fn read_vectors(
    data: *const c_void,
    count: u64,
    stride: u64,
    what: &str,
) -> Outcome<Vec<glam::Vec3>> {
    const WIDTH: u64 = 12;
    let stride = if stride == 0 { WIDTH } else { stride };
    if stride < WIDTH {
        return Err(short_stride(what, WIDTH, stride));
    }
    let Some(last) = count.checked_sub(1) else { return Ok(Vec::new()) };
    let bytes = last.checked_mul(stride).and_then(|b| b.checked_add(WIDTH));
    let bytes: &[u8] = slice(data.cast(), bytes.unwrap_or(u64::MAX), what)?;
    let stride = length::<u8>(stride, what)?;
    Ok(bytes
        .chunks(stride)
        .map(|row| glam::Vec3::from_array(bytemuck::pod_read_unaligned(&row[..WIDTH as usize])))
        .collect())
}
