//! A defect of the library, made on purpose: a code and a message for the caller, a line for the log, nothing on the
//! terminal.

#![expect(unsafe_code, reason = "calls a C ABI")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[allow(dead_code, reason = "each test uses its part of it")]
mod library;

use std::ffi::{c_char, c_void};
use std::process::Command;
use std::sync::Mutex;

use libloading::Library;
use library::{Error, ErrorOut, beside};

const PANIC: i32 = 901;
const LEVEL_ERROR: u32 = 2;

type TestPanic = unsafe extern "C" fn(ErrorOut) -> i32;
type Callback = unsafe extern "C" fn(u32, *const c_char, u64, *mut c_void);
type SetCallback = unsafe extern "C" fn(Option<Callback>, *mut c_void, ErrorOut) -> i32;

unsafe extern "C" fn hear(level: u32, message: *const c_char, length: u64, user: *mut c_void) {
    // SAFETY: `user` is the test's list, and the message is valid during the call.
    let (heard, message) = unsafe {
        let message = std::slice::from_raw_parts(message.cast::<u8>(), length as usize);
        (&*user.cast::<Mutex<Vec<(u32, String)>>>(), String::from_utf8_lossy(message).into_owned())
    };
    heard.lock().unwrap().push((level, message));
}

#[test]
fn a_panic_becomes_a_code_and_a_line_in_the_log() {
    // The one that was built with the hooks, whichever the others are asked to test.
    // SAFETY: opening it runs nothing; the declarations are those of ffi/src.
    unsafe {
        let library = Library::new(beside()).unwrap();
        let panic: libloading::Symbol<TestPanic> = library.get("anthronet_test_panic").unwrap();
        let set: libloading::Symbol<SetCallback> = library.get("anthronet_set_log_callback").unwrap();
        let heard = Mutex::new(Vec::<(u32, String)>::new());
        assert_eq!(set(Some(hear), (&raw const heard).cast_mut().cast(), std::ptr::null_mut()), 0);
        for _ in 0..3 {
            let mut error = Error { code: 0, message: [0; 512] };
            assert_eq!(panic(&raw mut error), PANIC);
            assert_eq!(error.code, PANIC);
            let message = std::ffi::CStr::from_bytes_until_nul(&error.message).unwrap().to_str().unwrap();
            assert!(message.contains("asked for by a test"), "{message}");
            assert!(message.contains("test_hooks.rs:"), "does not say where: {message}");
            let (level, line) = heard.lock().unwrap().pop().unwrap();
            assert_eq!((level, line.lines().next()), (LEVEL_ERROR, Some(message)));
        }
        assert_eq!(set(None, std::ptr::null_mut(), std::ptr::null_mut()), 0);
        assert_eq!(panic(std::ptr::null_mut()), PANIC);
        assert!(heard.lock().unwrap().is_empty());
    }
}

#[test]
fn nothing_is_printed() {
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["a_panic_becomes_a_code_and_a_line_in_the_log", "--exact", "--nocapture"])
        .output()
        .unwrap();
    assert!(output.status.success());
    let written = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert!(!written.contains("panicked") && !written.contains("asked for by a test"), "{written}");
    assert!(written.contains("1 passed"), "{written}");
}
