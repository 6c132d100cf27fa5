//! The C header and the bindings for C# and Python, generated from the sources of `ffi`.

mod declared;
mod python;

use crate::tools;
use anyhow::{Context as _, Error, Result, anyhow, bail};
use std::path::{Path, PathBuf};

/// The header that C and C++ include.
pub(crate) const HEADER: &str = "ffi/include/anthronet.h";
/// The declarations for C#.
pub(crate) const CSHARP: &str = "unity_plugin/Runtime/Native/NativeMethods.g.cs";

/// The declarations for Python.
pub(crate) const PYTHON: &str = "python/anthronet/_native.py";

/// The files of `ffi/src` in the order of their declarations: a type comes before its users.
const SOURCES: [&str; 19] = [
    "version",
    "status",
    "pointer",
    "options",
    "log",
    "bytes",
    "model",
    "measure",
    "request",
    "body",
    "job",
    "skeleton",
    "mesh",
    "blend_shape",
    "context",
    "clip",
    "motion",
    "skin",
    "export",
];

/// All of them, with their paths in the source tree.
fn all() -> Result<[(&'static str, String); 3]> {
    let python = python::declarations(&declared::Declared::read(sources())?)?;
    Ok([(HEADER, header()?), (CSHARP, csharp()?), (PYTHON, python)])
}

/// Writes them into the source tree.
pub(crate) fn write() -> Result<()> {
    for (path, text) in all()? {
        tools::write(&tools::root().join(path), &text)?;
    }
    Ok(())
}

/// Fails unless the files in the source tree equal the generated ones, byte by byte.
pub(crate) fn check() -> Result<()> {
    for (path, text) in all()? {
        let there = tools::read(&tools::root().join(path))?;
        if there != text {
            bail!("{path}: differs from what ffi/src generates: run `cargo xtask gen` and commit it");
        }
    }
    println!("bindings: {HEADER}, {CSHARP} and {PYTHON} are up to date");
    Ok(())
}

fn sources() -> impl Iterator<Item = PathBuf> {
    let folder = tools::root().join("ffi/src");
    SOURCES.into_iter().map(move |name| folder.join(name).with_extension("rs"))
}

fn header() -> Result<String> {
    let root = tools::root().join("ffi");
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).map_err(Error::msg)?;
    let builder = sources().fold(cbindgen::Builder::new().with_config(config), |b, file| b.with_src(file));
    let bindings = builder.generate().context(HEADER)?;
    let mut bytes = Vec::new();
    bindings.write(&mut bytes);
    String::from_utf8(bytes).context(HEADER)
}

fn csharp() -> Result<String> {
    let scratch = tools::target().join("gen").join(Path::new(CSHARP).file_name().unwrap_or_default());
    tools::write(&scratch, "")?;
    sources()
        .fold(csbindgen::Builder::default(), |b, file| b.input_extern_file(file))
        .csharp_dll_name("anthronet")
        .csharp_dll_name_if("(UNITY_IOS || UNITY_WEBGL) && !UNITY_EDITOR", "__Internal")
        .csharp_namespace("Anthronet.Native")
        .csharp_class_name("NativeMethods")
        .csharp_use_nint_types(false)
        .csharp_use_function_pointer(false)
        .csharp_generate_const_filter(|name| name.starts_with("ANTHRONET_"))
        .generate_csharp_file(&scratch)
        .map_err(|error| anyhow!("{CSHARP}: {error}"))?;
    tools::read(&scratch)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_declaration_is_an_error_with_its_line() {
        let made = |source: &str| -> Result<String> {
            let file = tempfile::NamedTempFile::new().unwrap();
            std::fs::write(file.path(), source).unwrap();
            let declared = declared::Declared::read(std::iter::once(file.path().to_path_buf()))?;
            let text = python::declarations(&declared)?;
            Ok(text.split_once("FUNCTIONS = {\n").unwrap().1.to_owned())
        };
        let good = made("pub extern \"C\" fn f(a: *const c_char, b: *mut c_char, c: u8) -> f32 { 0.0 }");
        assert_eq!(good.unwrap(), "    \"f\": (c_float, [c_char_p, c_void_p, c_uint8]),\n}\n");
        for (source, why) in [
            ("\npub const A: u32 = 1 + 1;", ":2: a whole number is expected, written out"),
            ("pub extern \"C\" fn f(a: &str) {}", ":1: a type that is not known in C"),
            ("pub extern \"C\" fn f(a: u16) {}", "f: do not know the type `u16` in Python"),
            ("pub extern \"C\" fn f() { ", ":1: "),
        ] {
            let error = format!("{:#}", made(source).unwrap_err());
            assert!(error.contains(why), "`{error}` lacks `{why}`");
        }
    }
}
