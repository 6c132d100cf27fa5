//! Status codes, the error that a caller may pass, and the guard around every entry.

use std::ffi::c_char;
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};

use anthronet::Error;

/// What every call that can fail returns: `ANTHRONET_OK` or one of `ANTHRONET_ERROR_…`.
pub type anthronet_status = i32;

/// Done.
pub const ANTHRONET_OK: i32 = 0;
/// A required pointer is NULL, a pointer is not aligned, or a buffer overlaps one that the call writes.
pub const ANTHRONET_ERROR_POINTER: i32 = 101;
/// A size, count, stride or `struct_size` is not what it must be.
pub const ANTHRONET_ERROR_SIZE: i32 = 102;
/// A number is not a value of its enumeration.
pub const ANTHRONET_ERROR_ENUM: i32 = 103;
/// An index is beyond the last.
pub const ANTHRONET_ERROR_INDEX: i32 = 104;
/// A text is not UTF-8.
pub const ANTHRONET_ERROR_TEXT: i32 = 105;
/// A field of a request is unknown, not finite, or out of range.
pub const ANTHRONET_ERROR_REQUEST: i32 = 201;
/// The measures of a request cannot belong to one person.
pub const ANTHRONET_ERROR_INFEASIBLE: i32 = 202;
/// A model file is damaged or of another version.
pub const ANTHRONET_ERROR_MODEL: i32 = 301;
/// A file is damaged or not of its format.
pub const ANTHRONET_ERROR_FILE: i32 = 401;
/// The operating system refused to read or write.
pub const ANTHRONET_ERROR_IO: i32 = 402;
/// Data contradicts itself: counts that differ, numbers that are not finite, a pose of another skeleton.
pub const ANTHRONET_ERROR_INVALID: i32 = 501;
/// The job is still running.
pub const ANTHRONET_ERROR_BUSY: i32 = 601;
/// The job was cancelled before the body was made.
pub const ANTHRONET_ERROR_CANCELLED: i32 = 602;
/// The body was taken before.
pub const ANTHRONET_ERROR_TAKEN: i32 = 603;
/// Any other error.
pub const ANTHRONET_ERROR_OTHER: i32 = 900;
/// A defect of the library, caught; the message says where. Please report it.
pub const ANTHRONET_ERROR_PANIC: i32 = 901;

/// Bytes of a message with its terminating zero.
const MESSAGE: usize = 512;

/// What went wrong. The caller's own; may be NULL in every call. Written only on failure.
#[repr(C)]
pub struct anthronet_error {
    /// The status that the call returned.
    pub code: i32,
    /// A sentence in English, UTF-8, ended by a zero; longer ones are cut.
    pub message: [c_char; 512],
}

/// Why an entry fails.
#[derive(Debug)]
pub(crate) struct Fault {
    pub(crate) code: i32,
    pub(crate) message: String,
}

/// What the body of an entry returns.
pub(crate) type Outcome<T = ()> = Result<T, Fault>;

impl Fault {
    pub(crate) fn new(code: i32, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }

    /// A pointer that has to be given is NULL.
    pub(crate) fn null(what: &str) -> Self {
        Self::new(ANTHRONET_ERROR_POINTER, format!("{what}: expected a pointer, got NULL"))
    }

    /// A size or count does not fit.
    pub(crate) fn size(what: &str, message: impl Display) -> Self {
        Self::new(ANTHRONET_ERROR_SIZE, format!("{what}: {message}"))
    }

    /// A size that no memory has.
    pub(crate) fn beyond_memory(what: &str, size: u64) -> Self {
        Self::size(what, format_args!("{size} is more than memory holds"))
    }

    /// A number or name of a request is not one that it may have.
    pub(crate) fn request(what: &str, message: impl Display) -> Self {
        Self::new(ANTHRONET_ERROR_REQUEST, format!("{what}: {message}"))
    }
}

impl From<Error> for Fault {
    fn from(error: Error) -> Self {
        let code = match &error {
            Error::Request { .. } => ANTHRONET_ERROR_REQUEST,
            Error::Infeasible(_) => ANTHRONET_ERROR_INFEASIBLE,
            Error::Model { .. } => ANTHRONET_ERROR_MODEL,
            Error::File { .. } => ANTHRONET_ERROR_FILE,
            Error::Io { .. } => ANTHRONET_ERROR_IO,
            Error::Invalid { .. } => ANTHRONET_ERROR_INVALID,
            _ => ANTHRONET_ERROR_OTHER,
        };
        Self { code, message: error.to_string() }
    }
}

/// Runs an entry: errors and panics become a code, and a message where the caller wants one.
pub(crate) fn guard(error: *mut anthronet_error, entry: impl FnOnce() -> Outcome) -> anthronet_status {
    let Err(Fault { code, message }) = caught(entry) else { return ANTHRONET_OK };
    if !error.is_null() {
        // SAFETY: the caller's own, as the preamble asks; it need not even be aligned.
        unsafe { error.write_unaligned(anthronet_error { code, message: cut(&message) }) };
    }
    code
}

/// Runs what may have a defect, which becomes a fault.
pub(crate) fn caught<T>(work: impl FnOnce() -> Outcome<T>) -> Outcome<T> {
    crate::panic::listen();
    // A panic leaves nothing half done that a caller could reach: entries write their results last.
    catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|panic| Err(Fault::new(ANTHRONET_ERROR_PANIC, crate::panic::describe(&*panic))))
}

/// Cuts at a character's end and terminates.
fn cut(message: &str) -> [c_char; MESSAGE] {
    let mut out = [0; MESSAGE];
    let mut end = message.len().min(MESSAGE - 1);
    while !message.is_char_boundary(end) {
        end -= 1;
    }
    for (to, from) in out.iter_mut().zip(&message.as_bytes()[..end]) {
        *to = *from as c_char;
    }
    out
}
