//! Messages beside errors: warnings of reports, joints that drive nothing, defects caught while freeing.

use std::ffi::{c_char, c_void};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::status::{anthronet_error, anthronet_status, guard};

/// Information.
pub const ANTHRONET_LOG_INFO: u32 = 0;
/// A warning: a result may not be as intended.
pub const ANTHRONET_LOG_WARNING: u32 = 1;
/// A defect that no call could return.
pub const ANTHRONET_LOG_ERROR: u32 = 2;

/// Receives a message: its level, `length` bytes of UTF-8 that are valid only during the call, and the `user` pointer of
/// the callback. Called from any thread, one call at a time; it must not call the library.
pub type anthronet_log_callback =
    Option<unsafe extern "C" fn(level: u32, message: *const c_char, length: u64, user: *mut c_void)>;

struct Listener {
    callback: unsafe extern "C" fn(u32, *const c_char, u64, *mut c_void),
    user: *mut c_void,
}

// SAFETY: that `user` may be used from any thread is the callback's contract.
unsafe impl Send for Listener {}

static LISTENER: Mutex<Option<Listener>> = Mutex::new(None);

fn listener() -> MutexGuard<'static, Option<Listener>> {
    LISTENER.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sets the callback that receives messages; NULL for none, which is the default. When it returns, the former callback is not running
/// and will not be called again. `user` is handed to every call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_set_log_callback(
    callback: anthronet_log_callback,
    user: *mut c_void,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        *listener() = callback.map(|callback| Listener { callback, user });
        Ok(())
    })
}

fn say(level: u32, message: &str) {
    if let Some(listener) = &*listener() {
        // SAFETY: the text is valid during the call; the rest is the callback's contract.
        unsafe {
            (listener.callback)(level, message.as_ptr().cast(), message.len() as u64, listener.user);
        }
    }
}

pub(crate) fn info(message: &str) {
    say(ANTHRONET_LOG_INFO, message);
}

pub(crate) fn warning(message: &str) {
    say(ANTHRONET_LOG_WARNING, message);
}

pub(crate) fn error(message: &str) {
    say(ANTHRONET_LOG_ERROR, message);
}
