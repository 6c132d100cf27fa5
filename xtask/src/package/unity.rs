//! `cargo xtask package unity`: the package as Unity's package manager installs it from a file.

use super::library;
use crate::tools;
use anyhow::Result;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Path of this system's library in `Runtime/Plugins`.
const PLUGIN: &[&str] = if cfg!(windows) {
    &["Windows", "x86_64", "anthronet.dll"]
} else if cfg!(target_os = "macos") {
    &["macOS", "libanthronet.dylib"]
} else {
    &["Linux", "x86_64", "libanthronet.so"]
};

/// Makes `target/dist/com.anthronet.unity-<version>.tgz` from `unity_plugin` and the library of this system, with its
/// import settings from `Plugins~`.
pub(crate) fn package_unity() -> Result<PathBuf> {
    let library = library()?;
    let dist = tools::target().join("dist");
    let stage = dist.join("stage/unity");
    tools::remove_folder(&stage)?;
    let package = stage.join("package");
    tools::copy(&tools::root().join("unity_plugin"), &package)?;
    let (mut from, mut to) = (package.join("Plugins~"), package.join("Runtime/Plugins"));
    for name in PLUGIN {
        tools::create_folder(&to)?;
        (from, to) = (from.join(name), to.join(name));
        tools::copy(&with_meta(&from), &with_meta(&to))?;
    }
    link(&library, &to)?;
    // Unity needs no .meta files in this folder.
    for name in ["LICENSE-APACHE", "LICENSE-MIT", "THIRD_PARTY.md"] {
        tools::copy(&tools::root().join(name), &package.join("Documentation~").join(name))?;
    }
    let archive = dist.join(format!("com.anthronet.unity-{}.tgz", env!("CARGO_PKG_VERSION")));
    let plain = ["--sort=name", "--owner=0", "--group=0", "--numeric-owner", "--mtime=@0", "-czf"];
    tools::run(Command::new("tar").args(plain).arg(&archive).arg("-C").arg(&stage).arg("package"))?;
    Ok(archive)
}

/// The library of the package. On Linux it also has the entries of a rendering plugin: the static library, linked with a
/// file of C.
fn link(library: &Path, to: &Path) -> Result<()> {
    if !cfg!(target_os = "linux") {
        return tools::copy(library, to);
    }
    let root = tools::root();
    let sources = root.join("unity_plugin/Plugins~");
    let mut command = Command::new("cc");
    command.args(["-shared", "-fPIC", "-O2", "-std=c99", "-Wall", "-Wextra", "-Werror", "-I"]);
    command.arg(root.join("ffi/include")).arg("-o").arg(to).arg(sources.join("UnityPlugin.c"));
    command.arg("-Wl,--whole-archive").arg(library.with_extension("a")).arg("-Wl,--no-whole-archive");
    command.arg(format!("-Wl,--version-script={}", sources.join("UnityPlugin.map").display()));
    command.args([
        "-Wl,--gc-sections",
        "-Wl,-s",
        "-Wl,-Bstatic",
        "-lstdc++",
        "-Wl,-Bdynamic",
        "-lgcc_s",
        "-lpthread",
    ]);
    tools::run(command.args(["-ldl", "-lm"]))
}

/// Path of this system's library after packaging.
pub(crate) fn packed_library() -> PathBuf {
    PLUGIN
        .iter()
        .fold(tools::target().join("dist/stage/unity/package/Runtime/Plugins"), |path, name| path.join(name))
}

fn with_meta(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".meta");
    name.into()
}
