//! Panics, which are defects of the library, reported where a host can show them.
//!
//! Programs that the library lives in have no terminal, or one that is not ours to write on: what the standard hook
//! prints goes to the log callback instead, and the code of the call that failed carries the message and the place.

use std::any::Any;
use std::backtrace::{Backtrace, BacktraceStatus};
use std::panic::PanicHookInfo;
use std::sync::{Mutex, Once, PoisonError};

/// What the last panic said, and where it was: a worker's panic arrives at the guard without its place.
static LAST: Mutex<Option<(String, String)>> = Mutex::new(None);

/// Sees to it that panics are heard by [`hook`]. The hook is that of the library's own copy of the standard library: a
/// host that is a Rust program keeps its own.
pub(crate) fn listen() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| std::panic::set_hook(Box::new(hook)));
}

fn hook(info: &PanicHookInfo<'_>) {
    if anthronet::format::panic_becomes_error() {
        return;
    }
    let (said, place) = (said(info.payload()), info.location().map(ToString::to_string).unwrap_or_default());
    *LAST.lock().unwrap_or_else(PoisonError::into_inner) = Some((said.to_owned(), place.clone()));
    let mut message = text(said, &place);
    // Only where the environment asks for one, as in any other Rust program.
    let trace = Backtrace::capture();
    if trace.status() == BacktraceStatus::Captured {
        message = format!("{message}\n{trace}");
    }
    crate::log::error(&message);
}

/// What a caught panic said and where it was.
pub(crate) fn describe(panic: &(dyn Any + Send)) -> String {
    let said = said(panic);
    let last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    let place = last.as_ref().filter(|(text, _)| text == said).map_or("", |(_, place)| place.as_str());
    text(said, place)
}

fn said(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref().copied()).unwrap_or("no message")
}

fn text(said: &str, place: &str) -> String {
    format!(
        "a defect of the library at {}: {said}",
        if place.is_empty() { "an unknown place" } else { place }
    )
}
