//! The declarations that Python calls, made from the text of the C header.
//!
//! cbindgen writes one form of every declaration, so that this reads no more C than that. What it does not know is an
//! error; `tests/python_declarations.py` compares what it made with what a C compiler makes of the header.

use std::fmt::Write as _;

use crate::tools::Outcome;

const PREAMBLE: &str = r#""""Declarations of libanthronet: what `include/anthronet.h` says, in the words of ctypes.

Made from ffi/src by `cargo xtask gen`; do not edit.
"""
"#;

/// What of ctypes may be needed, in the order in which Python's formatters want it.
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

/// The Python module that declares what the header declares.
pub(super) fn declarations(header: &str) -> Outcome<String> {
    let header = Header::parse(header)?;
    let mut text = "\n".to_owned();
    for (name, value) in &header.constants {
        let _ = writeln!(text, "{name} = {value}");
    }
    for (name, result, parameters) in &header.callbacks {
        let kinds = header.parameters(parameters)?;
        let _ = writeln!(text, "\n{} = CFUNCTYPE({}, {kinds})", class(name), header.result(result)?);
    }
    for (name, fields) in &header.structures {
        let _ = write!(text, "\n\nclass {}(Structure):\n    _fields_ = [\n", class(name));
        for field in fields {
            let (name, kind) = header.field(field)?;
            let _ = writeln!(text, "        (\"{name}\", {kind}),");
        }
        text.push_str("    ]\n");
    }
    text.push_str("\n\n# Name: what it returns, and what it takes.\nFUNCTIONS = {\n");
    for (name, result, parameters) in &header.functions {
        let kinds = header.parameters(parameters)?;
        let _ = writeln!(text, "    \"{name}\": ({}, [{kinds}]),", header.result(result)?);
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

type Function = (String, String, Vec<String>);

/// The declarations of the header, in order, each as its words.
#[derive(Default)]
struct Header {
    constants: Vec<(String, String)>,
    structures: Vec<(String, Vec<String>)>,
    callbacks: Vec<Function>,
    functions: Vec<Function>,
}

impl Header {
    fn parse(text: &str) -> Outcome<Self> {
        let mut header = Self::default();
        let text = text.split_once("*/").map_or(text, |(_, rest)| rest);
        let mut declarations = String::new();
        for line in text.lines() {
            let line = line.split("//").next().unwrap_or_default().trim();
            if let Some(definition) = line.strip_prefix("#define ") {
                if let Some((name, value)) = definition.split_once(' ') {
                    let name = name.strip_prefix("ANTHRONET_").unwrap_or(name);
                    header.constants.push((name.to_owned(), value.trim().to_owned()));
                }
            } else if !line.starts_with('#') && line != "extern \"C\" {" && !line.starts_with("}  //") {
                declarations.push_str(line);
                declarations.push(' ');
            }
        }
        let mut rest = declarations.as_str();
        while let Some(end) = rest.find([';', '{']) {
            let (head, tail) = (rest[..end].trim(), &rest[end + 1..]);
            rest = if rest.as_bytes()[end] == b'{' {
                let (body, tail) = tail.split_once('}').ok_or("a structure of the header does not end")?;
                let (name, tail) = tail.split_once(';').ok_or("a structure of the header has no name")?;
                let fields = body.split(';').map(|f| f.trim().to_owned()).filter(|f| !f.is_empty());
                header.structures.push((name.trim().to_owned(), fields.collect()));
                tail
            } else {
                header.declaration(head)?;
                tail
            };
        }
        Ok(header)
    }

    /// A declaration without braces: an alias, a callback, a function.
    fn declaration(&mut self, words: &str) -> Outcome {
        let parameters = |list: &str| -> Vec<String> {
            let list = list.trim_end_matches(')').split(',').map(|p| p.trim().to_owned());
            list.filter(|parameter| !parameter.is_empty() && parameter != "void").collect()
        };
        let unknown = || format!("do not know how to declare `{words}` in Python");
        if let Some(alias) = words.strip_prefix("typedef ") {
            if let Some((result, rest)) = alias.split_once(" (*") {
                let (name, list) = rest.split_once(")(").ok_or_else(unknown)?;
                self.callbacks.push((name.to_owned(), result.to_owned(), parameters(list)));
            } else if !alias.starts_with("struct ") && alias != "int32_t anthronet_status" {
                return Err(unknown());
            }
            return Ok(());
        }
        let (head, list) = words.split_once('(').ok_or_else(unknown)?;
        let (result, name) = head.rsplit_once(' ').ok_or_else(unknown)?;
        self.functions.push((name.to_owned(), result.to_owned(), parameters(list)));
        Ok(())
    }

    fn result(&self, kind: &str) -> Outcome<String> {
        if kind == "void" { Ok("None".to_owned()) } else { self.value(kind) }
    }

    /// A type that is passed by value: a number, a structure as a field, or a callback.
    fn value(&self, kind: &str) -> Outcome<String> {
        let kind = kind.strip_prefix("struct ").unwrap_or(kind);
        let number = match kind {
            "anthronet_status" | "int32_t" => "c_int32",
            "uint32_t" => "c_uint32",
            "uint64_t" => "c_uint64",
            "uint8_t" => "c_uint8",
            "float" => "c_float",
            "double" => "c_double",
            "char" => "c_char",
            _ if self.callbacks.iter().any(|(name, ..)| name == kind)
                || self.structures.iter().any(|(name, _)| name == kind) =>
            {
                return Ok(class(kind));
            }
            _ => return Err(format!("do not know the type `{kind}` in Python")),
        };
        Ok(number.to_owned())
    }

    fn parameters(&self, all: &[String]) -> Outcome<String> {
        let mut kinds = Vec::new();
        for (i, words) in all.iter().enumerate() {
            let counted = all.get(i + 1).is_some_and(|next| next.ends_with(" count"));
            kinds.push(self.parameter(words, counted)?);
        }
        Ok(kinds.join(", "))
    }

    /// Pointers to structures are typed and text is bytes; all others take handles, arrays and addresses alike, and so
    /// do those that a count follows.
    fn parameter(&self, words: &str, counted: bool) -> Outcome<String> {
        let Some((kind, name)) = words.rsplit_once('*') else {
            let (kind, _) = words.rsplit_once(' ').ok_or_else(|| format!("`{words}` has no name"))?;
            return self.value(kind);
        };
        let pointed = kind.trim().strip_prefix("const ").unwrap_or(kind).trim();
        let pointed_struct = pointed.strip_prefix("struct ").unwrap_or(pointed);
        if !counted && self.structures.iter().any(|(name, _)| name == pointed_struct) {
            return Ok(format!("POINTER({})", class(pointed_struct)));
        }
        // What a callback is given is not ended by a zero, as bytes would have to be.
        let text_in = pointed == "char" && !name.starts_with("out_") && name != "message";
        Ok(if text_in { "c_char_p" } else { "c_void_p" }.to_owned())
    }

    /// Name and type of a field.
    fn field(&self, words: &str) -> Outcome<(String, String)> {
        let unknown = || format!("do not know how to declare the field `{words}` in Python");
        if let Some((_, name)) = words.rsplit_once('*') {
            return Ok((name.to_owned(), "c_void_p".to_owned()));
        }
        let (kind, name) = words.rsplit_once(' ').ok_or_else(unknown)?;
        let Some((name, count)) = name.split_once('[') else {
            return Ok((name.to_owned(), self.value(kind)?));
        };
        let count = count.strip_suffix(']').ok_or_else(unknown)?;
        Ok((name.to_owned(), format!("{} * {count}", self.value(kind)?)))
    }
}

/// `anthronet_mesh_options` → `MeshOptions`.
fn class(name: &str) -> String {
    let words = name.strip_prefix("anthronet_").unwrap_or(name).split('_');
    words.map(|word| word[..1].to_uppercase() + &word[1..]).collect()
}
