//! Panics that the library catches, of a damaged file's parser, are errors: standard error belongs to the program.

use std::panic::{set_hook, take_hook};
use std::sync::Once;

/// Sees to it that they are not printed too. The hook is that of the static library's own copy of the standard library;
/// panics that are defects end the program with the usual message, as those of `cxx` do.
pub(crate) fn keep_caught_ones_quiet() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |info| {
            if !anthronet::format::panic_becomes_error() {
                before(info);
            }
        }));
    });
}
