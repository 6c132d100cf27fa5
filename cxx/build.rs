//! Compiles the C++ half of the bridge into the static library.

fn main() {
    cxx_build::bridge("src/bridge.rs").std("c++17").compile("anthronet-bridge");
    println!("cargo:rerun-if-changed=src/bridge.rs");
}
