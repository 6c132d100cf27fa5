//! What only tests call.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::options::choice;
use crate::status::{anthronet_error, anthronet_status, guard};

static PANIC_IN_A_JOB: AtomicBool = AtomicBool::new(false);

/// Panics inside the guard.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_test_panic(error: *mut anthronet_error) -> anthronet_status {
    guard(error, || panic!("asked for by a test"))
}

/// Lets a thread of the library panic later, once: 0 where it makes the next body of a job, 1 where it skins next.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_test_panic_later(
    place: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        if choice(&[false, true], place, "place")? {
            anthronet::skin::test_hooks::panic_in_the_next_chunk();
        } else {
            PANIC_IN_A_JOB.store(true, Ordering::Relaxed);
        }
        Ok(())
    })
}

pub(crate) fn before_a_body() {
    assert!(!PANIC_IN_A_JOB.swap(false, Ordering::Relaxed), "asked for by a test of jobs");
}
