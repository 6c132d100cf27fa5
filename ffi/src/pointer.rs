//! The caller's memory: every pointer that comes in is looked at here.

use std::ffi::{c_char, c_void};

use crate::status::{
    ANTHRONET_ERROR_INDEX, ANTHRONET_ERROR_POINTER, ANTHRONET_ERROR_SIZE, ANTHRONET_ERROR_TEXT, Fault,
    Outcome,
};

/// Text of the library's: UTF-8, not ended by a zero, valid as long as what it was asked of.
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

fn null(what: &str) -> Fault {
    Fault::new(ANTHRONET_ERROR_POINTER, format!("{what}: expected a pointer, got NULL"))
}

fn usable<T>(pointer: *const T, what: &str) -> Outcome {
    if pointer.is_null() {
        return Err(null(what));
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
    // A defect is logged; there is nobody to return it to.
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
        _ => Err(Fault::new(ANTHRONET_ERROR_SIZE, format!("{what}: {count} is more than memory holds"))),
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

/// An array that is written.
pub(crate) fn slice_mut<'a, T>(pointer: *mut T, count: u64, what: &str) -> Outcome<&'a mut [T]> {
    let count = length::<T>(count, what)?;
    if count == 0 {
        return Ok(&mut []);
    }
    usable(pointer, what)?;
    // SAFETY: as `slice`, and the caller's alone.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

/// A buffer of bytes that is written.
pub(crate) fn buffer<'a>(pointer: *mut c_void, bytes: u64, what: &str) -> Outcome<&'a mut [u8]> {
    slice_mut(pointer.cast(), bytes, what)
}

/// Text of the caller's: `length` bytes of UTF-8.
pub(crate) fn text<'a>(data: *const c_char, length: u64, what: &str) -> Outcome<&'a str> {
    let bytes: &[u8] = slice(data.cast(), length, what)?;
    std::str::from_utf8(bytes).map_err(|error| {
        let message = format!("{what}: expected UTF-8, got another byte at {}", error.valid_up_to());
        Fault::new(ANTHRONET_ERROR_TEXT, message)
    })
}

/// Refuses an array that is not as long as it has to be.
pub(crate) fn exactly(what: &str, expected: usize, got: u64) -> Outcome {
    if got == expected as u64 {
        return Ok(());
    }
    Err(Fault::new(ANTHRONET_ERROR_SIZE, format!("{what}: expected {expected}, got {got}")))
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

/// Writes packed rows to a caller's buffer, `stride` bytes from row to row; 0 stands for packed.
pub(crate) fn write_rows(rows: &[u8], width: usize, out: &mut [u8], stride: u64, what: &str) -> Outcome {
    let stride = if stride == 0 { width } else { length::<u8>(stride, what)? };
    let count = rows.len() / width.max(1);
    if stride < width {
        let message = format!("{what}: expected a stride of at least {width} bytes, got {stride}");
        return Err(Fault::new(ANTHRONET_ERROR_SIZE, message));
    }
    let needed = count.checked_sub(1).map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(width));
    if needed.is_none_or(|needed| needed > out.len()) {
        let expected = needed.map_or("more bytes than memory holds".to_owned(), |n| format!("{n} bytes"));
        let message = format!(
            "{what}: expected {expected} for {count} rows of {width} bytes with stride {stride}, got {} bytes",
            out.len()
        );
        return Err(Fault::new(ANTHRONET_ERROR_SIZE, message));
    }
    if stride == width {
        out[..rows.len()].copy_from_slice(rows);
        return Ok(());
    }
    for (from, to) in rows.chunks_exact(width).zip(out.chunks_mut(stride)) {
        to[..width].copy_from_slice(from);
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
        let message = format!("{what}: expected a stride of at least {WIDTH} bytes, got {stride}");
        return Err(Fault::new(ANTHRONET_ERROR_SIZE, message));
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
