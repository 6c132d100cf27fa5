//! `cargo xtask package cpp`: a folder for CMake's `find_package(anthronet)`.
//!
//! ```text
//! target/dist/cpp/include/anthronet/{anthronet.hpp, bridge.h}   include/rust/cxx.h
//! target/dist/cpp/lib/libanthronet_cxx.a                        lib/cmake/anthronet/anthronet-config{,-version}.cmake
//! target/dist/cpp/examples                                      README.md, licences
//! ```
//!
//! It does not contain the C ABI's header: the archive lacks those functions, and two Rust archives in one program would
//! duplicate the runtime.

use crate::tools::{self, cargo};
use anyhow::{Context as _, Result, bail};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// The results of building the crate.
#[derive(Default)]
pub(crate) struct Built {
    archive: PathBuf,
    /// The folder with the generated headers.
    include: PathBuf,
    /// System libraries that the archive needs, as CMake links them.
    libraries: Vec<String>,
}

/// Builds the archive, assembles the package and returns its folder.
pub(crate) fn package_cpp() -> Result<PathBuf> {
    let built = build_cpp()?;
    let source = tools::root().join("cxx");
    let package = tools::target().join("dist/cpp");
    tools::remove_folder(&package)?;
    let archive = built.archive.file_name().unwrap_or_default().to_string_lossy().into_owned();
    tools::copy(&built.archive, &package.join("lib").join(&archive))?;
    tools::copy(
        &source.join("include/anthronet/anthronet.hpp"),
        &package.join("include/anthronet/anthronet.hpp"),
    )?;
    tools::copy(
        &built.include.join("anthronet-cxx/src/bridge.rs.h"),
        &package.join("include/anthronet/bridge.h"),
    )?;
    tools::copy(&built.include.join("rust/cxx.h"), &package.join("include/rust/cxx.h"))?;
    for name in ["README.md", "examples/person.cpp", "examples/walk.cpp"] {
        tools::copy(&source.join(name), &package.join(name))?;
    }
    for name in ["LICENSE-APACHE", "LICENSE-MIT", "THIRD_PARTY.md"] {
        tools::copy(&tools::root().join(name), &package.join(name))?;
    }
    let version = env!("CARGO_PKG_VERSION");
    let numbers: Vec<_> = version.split('.').collect();
    let values = [
        ("@ARCHIVE@", archive.as_str()),
        ("@LIBRARIES@", &built.libraries.join(";")),
        ("@VERSION@", version),
        ("@MAJOR@", numbers[0]),
        ("@MINOR@", numbers[1]),
        ("@POINTER@", &size_of::<usize>().to_string()),
        ("@BITS@", &usize::BITS.to_string()),
    ];
    for name in ["anthronet-config.cmake", "anthronet-config-version.cmake"] {
        let mut text = tools::read(&source.join("cmake").join(name).with_extension("cmake.in"))?;
        for (key, value) in values {
            text = text.replace(key, value);
        }
        tools::write(&package.join("lib/cmake/anthronet").join(name), &text)?;
    }
    println!("{}", package.display());
    Ok(package)
}

/// Builds the archive.
pub(crate) fn build_cpp() -> Result<Built> {
    // Cargo reports the paths of its outputs as JSON, and rustc the archive's system libraries in a note; cargo repeats both
    // when everything is up to date.
    let mut command = cargo("rustc");
    command
        .args(["--release", "--package", "anthronet-cxx", "--message-format=json"])
        .args(["--", "--print", "native-static-libs"])
        .stderr(Stdio::inherit());
    let output = command.output().context("cargo did not start")?;
    let mut built = Built::default();
    for line in String::from_utf8_lossy(&output.stdout).lines() {
        let message: Value = serde_json::from_str(line).context("cargo's messages")?;
        let ours = message["package_id"].as_str().is_some_and(|id| id.contains("anthronet-cxx"));
        match message["reason"].as_str() {
            Some("compiler-message") if ours => {
                let said = &message["message"];
                match said["message"].as_str().unwrap_or_default().strip_prefix("native-static-libs: ") {
                    Some(words) => built.libraries = libraries(words),
                    None if said["level"] == "note" => {}
                    None => eprint!("{}", said["rendered"].as_str().unwrap_or_default()),
                }
            }
            Some("build-script-executed") if ours => {
                let folder = message["out_dir"].as_str().unwrap_or_default();
                built.include = Path::new(folder).join("cxxbridge/include");
            }
            Some("compiler-artifact") if ours && message["target"]["kind"][0] == "staticlib" => {
                built.archive = message["filenames"][0].as_str().unwrap_or_default().into();
            }
            _ => {}
        }
    }
    if !output.status.success() {
        bail!("cargo rustc --package anthronet-cxx failed: {}", output.status);
    }
    if built.libraries.is_empty() || built.include.as_os_str().is_empty() || !built.archive.is_file() {
        bail!("cargo did not say where anthronet-cxx is and what it needs");
    }
    Ok(built)
}

/// `-lm -lpthread -framework X kernel32.lib` as CMake expects them, each once.
fn libraries(words: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let mut words = words.split_whitespace();
    while let Some(word) = words.next() {
        let library = match word {
            "-framework" => format!("-framework {}", words.next().unwrap_or_default()),
            _ => word.strip_prefix("-l").unwrap_or(word).to_owned(),
        };
        if !found.contains(&library) {
            found.push(library);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::libraries;

    #[test]
    fn libraries_are_written_as_cmake_links_them() {
        assert_eq!(libraries("-lstdc++ -lm -lpthread -lm"), ["stdc++", "m", "pthread"]);
        assert_eq!(libraries("-framework Security -liconv"), ["-framework Security", "iconv"]);
        assert_eq!(libraries("kernel32.lib ntdll.lib"), ["kernel32.lib", "ntdll.lib"]);
    }
}
