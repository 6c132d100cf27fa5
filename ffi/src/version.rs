//! What this library is.

use crate::pointer::{Out, anthronet_text};
use crate::status::{anthronet_error, anthronet_status, guard};

/// The version of this interface. Raised when a caller that was compiled for an older one would misunderstand.
pub const ANTHRONET_ABI_VERSION: u32 = 1;

/// The `ANTHRONET_ABI_VERSION` that the library was compiled with; a caller that was compiled with another one must
/// stop.
#[unsafe(no_mangle)]
pub extern "C" fn anthronet_abi_version() -> u32 {
    ANTHRONET_ABI_VERSION
}

/// The version of the library, such as `0.1.0`; always valid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_version(
    out_version: *mut anthronet_text,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        Out::new(out_version, "out_version")?.write(anthronet_text::of(env!("CARGO_PKG_VERSION")));
        Ok(())
    })
}
