//! For tests only: a panic in the middle of the work.

use std::sync::atomic::{AtomicBool, Ordering};

static PANIC: AtomicBool = AtomicBool::new(false);

/// Makes the next chunk panic, on whichever thread it runs.
pub fn panic_in_the_next_chunk() {
    PANIC.store(true, Ordering::Relaxed);
}

pub(super) fn before_a_chunk() {
    assert!(!PANIC.swap(false, Ordering::Relaxed), "asked for by a test of skinning");
}
