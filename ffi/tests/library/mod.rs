//! The library as a program finds it: a file that is opened.

use std::path::PathBuf;
use std::sync::OnceLock;

use libloading::Library;

/// `anthronet_error *`.
pub(crate) type ErrorOut = *mut Error;

/// `anthronet_error`.
#[repr(C)]
pub(crate) struct Error {
    pub(crate) code: i32,
    pub(crate) message: [u8; 512],
}

/// The file that the environment variable `ANTHRONET_LIBRARY` names, or what cargo has built beside the test. It is never
/// closed, as a host should have it: what it has made once would be lost.
pub(crate) fn library() -> &'static Library {
    static LIBRARY: OnceLock<Library> = OnceLock::new();
    LIBRARY.get_or_init(open)
}

fn open() -> Library {
    let path = std::env::var_os("ANTHRONET_LIBRARY").map_or_else(beside, PathBuf::from);
    // SAFETY: it runs nothing when it is opened.
    unsafe { Library::new(&path) }.unwrap_or_else(|e| {
        panic!(
            "{}: {e}; build it with `cargo build --workspace --all-features --lib --ignore-rust-version` \
             or name another with ANTHRONET_LIBRARY",
            path.display()
        )
    })
}

/// In the folder of the profile that the test was built with.
pub(crate) fn beside() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    test.ancestors().nth(2).unwrap().join(libloading::library_filename("anthronet"))
}
