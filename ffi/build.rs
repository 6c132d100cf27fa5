//! How the shared library is linked on Linux, so that it shows `anthronet_…` and nothing else, and needs glibc and
//! nothing else.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "linux") {
        // What dependencies export, of their archives alone: the entries are in this crate's own object files.
        println!("cargo::rustc-cdylib-link-arg=-Wl,--exclude-libs,ALL");
        carry_cpp();
    }
}

/// The compressor of meshes is C++. The few functions that it takes from libstdc++ are linked in where the compiler has
/// the archive: a file of the shared one's name that the linker finds first says where that is.
fn carry_cpp() {
    println!("cargo::rerun-if-env-changed=CXX");
    let compiler = std::env::var("CXX").unwrap_or_else(|_| "c++".to_owned());
    let asked = Command::new(compiler).arg("-print-file-name=libstdc++.a").output();
    let (Ok(asked), Some(folder)) = (asked, std::env::var_os("OUT_DIR")) else { return };
    let answer = String::from_utf8_lossy(&asked.stdout);
    // A compiler that has none answers with the name alone.
    let archive = Path::new(answer.trim());
    let native = std::env::var("HOST") == std::env::var("TARGET");
    if !native || !archive.is_absolute() || !archive.exists() {
        return;
    }
    let script = Path::new(&folder).join("libstdc++.so");
    if std::fs::write(script, format!("INPUT(\"{}\")\n", archive.display())).is_ok() {
        println!("cargo::rustc-link-search=native={}", Path::new(&folder).display());
    }
}
