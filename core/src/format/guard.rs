//! Third-party parsers may panic on damaged files: the panic becomes an error.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::error::ParserError;

thread_local! {
    /// Whether this thread is inside [`guarded`].
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Whether a panic on this thread is caught and returned as an error about a damaged file, so it needs no report.
///
/// The USD parser promises errors, but it is young and may still panic on a damaged file; the library catches that.
/// Rust's panic hook still writes to standard error, which belongs to the program, as does the choice of hook. A program
/// that wants it quiet installs one at startup:
///
/// ```
/// let before = std::panic::take_hook();
/// std::panic::set_hook(Box::new(move |info| {
///     if !anthronet::format::panic_becomes_error() {
///         before(info);
///     }
/// }));
/// ```
pub fn panic_becomes_error() -> bool {
    GUARDED.get()
}

/// Runs a decoder of untrusted bytes: its errors, with their causes, and its panics become a [`ParserError`].
pub(super) fn guarded<T, E: std::error::Error>(
    decode: impl FnOnce() -> Result<T, E>,
) -> Result<T, ParserError> {
    let outer = GUARDED.replace(true);
    let decoded = catch_unwind(AssertUnwindSafe(decode));
    GUARDED.set(outer);
    match decoded {
        Ok(result) => result.map_err(|error| ParserError::Refused(chain(&error))),
        Err(_) => Err(ParserError::Panicked),
    }
}

/// The message of an error and of its causes.
fn chain(error: &dyn std::error::Error) -> String {
    let mut message = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        let next = error.to_string();
        if !message.contains(&next) {
            message = format!("{message}: {next}");
        }
        cause = error.source();
    }
    message
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_and_is_told_from_others() {
        assert!(!panic_becomes_error());
        let panicked = guarded(|| -> std::io::Result<()> {
            assert!(panic_becomes_error());
            panic!("said by a test, as it should be")
        });
        assert_eq!(panicked, Err(ParserError::Panicked));
        assert!(!panic_becomes_error());
        let fault = guarded(|| Err::<(), _>(std::io::Error::other("why"))).unwrap_err();
        assert_eq!(fault, ParserError::Refused("why".into()));
    }
}
