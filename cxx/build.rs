//! Compiles the C++ half of the bridge into the static library, with exceptions.

use std::env;
use std::path::{Path, PathBuf};

/// The flag that the workspace gives to other C++ code, see `.cargo/config.toml`.
const WITHOUT: &str = "-fno-exceptions";

fn main() {
    for (name, flags) in env::vars() {
        if name.starts_with("CXXFLAGS") && flags.contains(WITHOUT) {
            // SAFETY: nothing else runs in this program yet.
            #[allow(unsafe_code)]
            unsafe {
                env::set_var(name, flags.replace(WITHOUT, "-fexceptions"));
            }
        }
    }
    let mut bridge = cxx_build::bridge("src/bridge.rs");
    // The runtime of `cxx` was compiled by its own crate, where a text that is not UTF-8 would end the program instead of
    // throwing. Once more, before it in the archive: linkers take the first.
    if let Some(runtime) = runtime() {
        bridge.file(runtime);
    }
    bridge.std("c++17").compile("anthronet-bridge");
    println!("cargo:rerun-if-changed=src/bridge.rs");
}

fn runtime() -> Option<PathBuf> {
    let header = env::var_os("DEP_CXXBRIDGE1_HEADER")?;
    let source = Path::new(&header).parent()?.parent()?.join("src/cxx.cc");
    source.is_file().then_some(source)
}
