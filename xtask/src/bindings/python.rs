//! The declarations for Python, as ctypes.
//!
//! An unsupported type is an error; `tests/python/test_declarations.py` compares the generated layouts with those that a C
//! compiler gives the header.

use super::declared::{Declared, Function, Type};
use anyhow::{Context as _, Result, bail};
use std::fmt::Write as _;

const PREAMBLE: &str = r#""""Declarations of libanthronet: what `include/anthronet.h` says, in the words of ctypes.

Made from ffi/src by `cargo xtask gen`; do not edit.
"""
"#;

/// The names of ctypes that may be needed, in the order of Python's formatters.
const CTYPES: [&str; 12] = [
    "CFUNCTYPE",
    "POINTER",
    "Structure",
    "c_char",
    "c_char_p",
    "c_double",
    "c_float",
    "c_int32",
    "c_uint8",
    "c_uint32",
    "c_uint64",
    "c_void_p",
];

/// The Python module for these declarations.
pub(super) fn declarations(declared: &Declared) -> Result<String> {
    let mut text = "\n".to_owned();
    for (name, value) in &declared.constants {
        let _ = writeln!(text, "{} = {value}", name.strip_prefix("ANTHRONET_").unwrap_or(name));
    }
    for callback in &declared.callbacks {
        // Text for a callback is not NUL-terminated, as c_char_p requires.
        let kinds = parameters(declared, callback, "c_void_p")?;
        let result = result(declared, callback)?;
        let _ = writeln!(text, "\n{} = CFUNCTYPE({result}, {kinds})", class(&callback.name));
    }
    for (name, fields) in in_order_of_use(declared) {
        let _ = write!(text, "\n\nclass {}(Structure):\n    _fields_ = [\n", class(name));
        for (name, kind) in fields {
            let _ = writeln!(text, "        (\"{name}\", {}),", field(declared, kind)?);
        }
        text.push_str("    ]\n");
    }
    text.push_str("\n\n# Name: what it returns, and what it takes.\nFUNCTIONS = {\n");
    for function in &declared.functions {
        let kinds = parameters(declared, function, "c_char_p")?;
        let result = result(declared, function)?;
        let _ = writeln!(text, "    \"{}\": ({result}, [{kinds}]),", function.name);
    }
    text.push_str("}\n");
    let mut imports = String::new();
    for name in CTYPES {
        if text.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == name) {
            let _ = writeln!(imports, "    {name},");
        }
    }
    Ok(format!("{PREAMBLE}\nfrom ctypes import (\n{imports})\n{text}"))
}

type Structure<'a> = (&'a str, &'a [(String, Type)]);

/// The structures in the order in which the functions use them, each after those it contains: the header's order.
fn in_order_of_use(declared: &Declared) -> Vec<Structure<'_>> {
    fn add<'a>(declared: &'a Declared, kind: &'a Type, found: &mut Vec<Structure<'a>>) {
        let name = match kind {
            Type::Pointer { to: inner, .. } | Type::Array(inner, _) => return add(declared, inner, found),
            Type::Named(name) => name,
        };
        if let Some(fields) = declared.fields(name)
            && found.iter().all(|(other, _)| other != name)
        {
            fields.iter().for_each(|(_, kind)| add(declared, kind, found));
            found.push((name, fields));
        }
    }
    let mut found = Vec::new();
    for (_, kind) in declared.functions.iter().flat_map(|function| &function.parameters) {
        add(declared, kind, &mut found);
    }
    found
}

fn result(declared: &Declared, function: &Function) -> Result<String> {
    function.result.as_ref().map_or_else(|| Ok("None".to_owned()), |kind| value(declared, kind))
}

/// A type that is passed by value: a number, a structure as a field, or a callback.
fn value(declared: &Declared, kind: &Type) -> Result<String> {
    let Type::Named(name) = kind else {
        bail!("pointers and arrays are not passed by value");
    };
    let number = match name.as_str() {
        "i32" => "c_int32",
        "u32" => "c_uint32",
        "u64" => "c_uint64",
        "u8" => "c_uint8",
        "f32" => "c_float",
        "f64" => "c_double",
        "c_char" => "c_char",
        _ if declared.fields(name).is_some() || declared.callbacks.iter().any(|c| c.name == *name) => {
            return Ok(class(name));
        }
        _ => {
            let meant = declared.aliases.get(name);
            return value(
                declared,
                meant.with_context(|| format!("do not know the type `{name}` in Python"))?,
            );
        }
    };
    Ok(number.to_owned())
}

/// The types of all parameters; `text` is the type of text that the function reads.
fn parameters(declared: &Declared, function: &Function, text: &str) -> Result<String> {
    let mut kinds = Vec::new();
    for (i, (_, kind)) in function.parameters.iter().enumerate() {
        let counted = function.parameters.get(i + 1).is_some_and(|(next, _)| next == "count");
        kinds.push(parameter(declared, kind, counted, text).with_context(|| function.name.clone())?);
    }
    Ok(kinds.join(", "))
}

/// Pointers to structures are typed and text is bytes; all others are void pointers, for handles, arrays and addresses, as
/// are those that a count follows.
fn parameter(declared: &Declared, kind: &Type, counted: bool, text: &str) -> Result<String> {
    let Type::Pointer { constant, to } = kind else { return value(declared, kind) };
    Ok(match &**to {
        Type::Named(name) if !counted && declared.fields(name).is_some() => {
            format!("POINTER({})", class(name))
        }
        Type::Named(name) if *constant && name == "c_char" => text.to_owned(),
        _ => "c_void_p".to_owned(),
    })
}

fn field(declared: &Declared, kind: &Type) -> Result<String> {
    match kind {
        Type::Pointer { .. } => Ok("c_void_p".to_owned()),
        Type::Array(of, count) => Ok(format!("{} * {count}", value(declared, of)?)),
        Type::Named(_) => value(declared, kind),
    }
}

/// `anthronet_mesh_options` → `MeshOptions`.
fn class(name: &str) -> String {
    let words = name.strip_prefix("anthronet_").unwrap_or(name).split('_');
    words.map(|word| word[..1].to_uppercase() + &word[1..]).collect()
}
