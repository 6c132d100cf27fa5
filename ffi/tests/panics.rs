//! A defect of the library, made on purpose: a code and a message for the caller, a line for the log, nothing on the
//! terminal.

#![expect(unsafe_code, reason = "calls a C ABI")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[allow(dead_code, reason = "each test uses its part of it")]
mod library;

use std::ffi::{c_char, c_void};
use std::process::Command;
use std::sync::{Mutex, PoisonError};

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

/// The log has one listener, and hears what any thread says.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

#[test]
fn a_panic_becomes_a_code_and_a_line_in_the_log() {
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
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

type PanicLater = unsafe extern "C" fn(u32, ErrorOut) -> i32;
type Make = unsafe extern "C" fn(*mut Handle, ErrorOut) -> i32;
type MakeOf = unsafe extern "C" fn(Handle, Handle, *mut Handle, ErrorOut) -> i32;
type Count = unsafe extern "C" fn(Handle, *mut u32, ErrorOut) -> i32;
type SkinnerNew = unsafe extern "C" fn(Handle, u32, *mut Handle, ErrorOut) -> i32;
type JobStart = unsafe extern "C" fn(Handle, *const Handle, u32, *mut Handle, ErrorOut) -> i32;
type JobTake = unsafe extern "C" fn(Handle, u32, *mut Handle, ErrorOut) -> i32;
type Summarise = unsafe extern "C" fn(Handle, *mut Summary, ErrorOut) -> i32;
type Skin = unsafe extern "C" fn(Handle, *const SkinJob, u32, ErrorOut) -> i32;
type Free = unsafe extern "C" fn(Handle);
type Handle = *mut c_void;

/// `anthronet_body_summary`.
#[repr(C)]
#[derive(Clone, Copy, Default)]
struct Summary {
    struct_size: u32,
    sex: u32,
    seed: u64,
    numbers: [f64; 4],
    iterations: u32,
    converged: u32,
    joint_count: u32,
    warning_count: u32,
}

/// `anthronet_skin_job`.
#[repr(C)]
struct SkinJob {
    struct_size: u32,
    method: u32,
    skinner: Handle,
    joints: *const [f32; 7],
    joint_count: u32,
    offset_count: u32,
    offsets: *const f32,
    positions: *mut f32,
    position_bytes: u64,
    position_stride: u64,
    normals: *mut f32,
    normal_bytes: u64,
    normal_stride: u64,
}

#[test]
fn a_panic_of_a_worker_becomes_the_code_of_its_call() {
    const BUSY: i32 = 601;
    let _alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let nobody: ErrorOut = std::ptr::null_mut();
    let null: Handle = std::ptr::null_mut();
    // SAFETY: the declarations are those of ffi/src, and handles are freed once.
    unsafe {
        let library = Library::new(beside()).unwrap();
        macro_rules! of {
            ($name:literal as $kind:ty) => {
                library.get::<$kind>($name).unwrap()
            };
        }
        let later = of!("anthronet_test_panic_later" as PanicLater);
        let free = |name: &str, handle: Handle| library.get::<Free>(name).unwrap()(handle);
        let [mut model, mut request, mut body, mut mesh, mut skinner, mut job] = [null; 6];
        let mut context = null;
        assert_eq!(of!("anthronet_model_open_embedded" as Make)(&raw mut model, nobody), 0);
        assert_eq!(of!("anthronet_request_new" as Make)(&raw mut request, nobody), 0);

        // The first of two bodies of a job; the second is made.
        assert_eq!(later(0, nobody), 0);
        let start = of!("anthronet_job_start" as JobStart);
        assert_eq!(start(model, [request, request].as_ptr(), 2, &raw mut job, nobody), 0);
        let take = of!("anthronet_job_take" as JobTake);
        let mut error = Error { code: 0, message: [0; 512] };
        let took = |index, body: &mut Handle, error: ErrorOut| loop {
            match take(job, index, body, error) {
                BUSY => std::thread::yield_now(),
                code => break code,
            }
        };
        assert_eq!(took(0, &mut body, &raw mut error), PANIC);
        assert!(body.is_null());
        let message = std::ffi::CStr::from_bytes_until_nul(&error.message).unwrap().to_str().unwrap();
        assert!(
            message.contains("asked for by a test of jobs") && message.contains("test_hooks.rs:"),
            "{message}"
        );
        assert_eq!(took(1, &mut body, nobody), 0);
        free("anthronet_job_free", job);

        // One piece of the surface, on whatever thread; the next call is well again.
        let mut summary = Summary { struct_size: size_of::<Summary>() as u32, ..Summary::default() };
        assert_eq!(of!("anthronet_body_summarise" as Summarise)(body, &raw mut summary, nobody), 0);
        assert_eq!(of!("anthronet_mesh_new" as MakeOf)(body, null, &raw mut mesh, nobody), 0);
        assert_eq!(of!("anthronet_skinner_new" as SkinnerNew)(mesh, 0, &raw mut skinner, nobody), 0);
        let mut vertices = 0;
        assert_eq!(of!("anthronet_skinner_vertex_count" as Count)(skinner, &raw mut vertices, nobody), 0);
        let pose = vec![[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]; summary.joint_count as usize];
        let mut positions = vec![0.0; 3 * vertices as usize];
        let asked = SkinJob {
            struct_size: size_of::<SkinJob>() as u32,
            method: 0,
            skinner,
            joints: pose.as_ptr(),
            joint_count: summary.joint_count,
            offset_count: 0,
            offsets: std::ptr::null(),
            positions: positions.as_mut_ptr(),
            position_bytes: 12 * u64::from(vertices),
            position_stride: 0,
            normals: std::ptr::null_mut(),
            normal_bytes: 0,
            normal_stride: 0,
        };
        let skin = of!("anthronet_skin" as Skin);
        assert_eq!(later(1, nobody), 0);
        assert_eq!(of!("anthronet_context_new" as Make)(&raw mut context, nobody), 0);
        assert_eq!(skin(context, &raw const asked, 1, &raw mut error), PANIC);
        let message = std::ffi::CStr::from_bytes_until_nul(&error.message).unwrap().to_str().unwrap();
        assert!(message.contains("asked for by a test of skinning"), "{message}");
        assert_eq!(skin(context, &raw const asked, 1, nobody), 0);
        for (name, handle) in [
            ("body", body),
            ("mesh", mesh),
            ("skinner", skinner),
            ("context", context),
            ("request", request),
            ("model", model),
        ] {
            free(&format!("anthronet_{name}_free"), handle);
        }
    }
}

#[test]
fn nothing_is_printed() {
    let output =
        Command::new(std::env::current_exe().unwrap()).args(["a_panic", "--nocapture"]).output().unwrap();
    assert!(output.status.success());
    let written = String::from_utf8_lossy(&output.stdout) + String::from_utf8_lossy(&output.stderr);
    assert!(!written.contains("panicked") && !written.contains("asked for by a test"), "{written}");
    assert!(written.contains("2 passed"), "{written}");
}
