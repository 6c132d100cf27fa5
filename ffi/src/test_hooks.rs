//! What only tests call.

use crate::status::{anthronet_error, anthronet_status, guard};

/// Panics inside the guard.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_test_panic(error: *mut anthronet_error) -> anthronet_status {
    guard(error, || panic!("asked for by a test"))
}
