//! Bytes that the library made: files, JSON.

use crate::pointer::{Out, free, read};
use crate::status::{ANTHRONET_ERROR_OTHER, Fault, Outcome, anthronet_error, anthronet_status, guard};

/// Bytes that the library made: a file in memory, or JSON as UTF-8.
pub struct anthronet_bytes(pub(crate) Vec<u8>);

/// A value as JSON.
pub(crate) fn json(value: &impl serde::Serialize) -> Outcome<anthronet_bytes> {
    let bytes = serde_json::to_vec(value);
    bytes.map(anthronet_bytes).map_err(|e| Fault::new(ANTHRONET_ERROR_OTHER, e.to_string()))
}

/// Where the bytes are, and how many; valid until they are freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_bytes_data(
    bytes: *const anthronet_bytes,
    out_data: *mut *const u8,
    out_length: *mut u64,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let (data, length) = (Out::new(out_data, "out_data")?, Out::new(out_length, "out_length")?);
        let bytes = read(bytes, "bytes")?;
        data.write(bytes.0.as_ptr());
        length.write(bytes.0.len() as u64);
        Ok(())
    })
}

/// Frees bytes; NULL is nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_bytes_free(bytes: *mut anthronet_bytes) {
    free(bytes);
}
