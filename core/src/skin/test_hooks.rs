//! What only tests use: a defect in the middle of the work.

use std::sync::atomic::{AtomicBool, Ordering};

static PANIC: AtomicBool = AtomicBool::new(false);

/// Lets the next piece of work of whichever thread panic.
pub fn panic_in_the_next_chunk() {
    PANIC.store(true, Ordering::Relaxed);
}

pub(super) fn before_a_chunk() {
    assert!(!PANIC.swap(false, Ordering::Relaxed), "asked for by a test of skinning");
}
