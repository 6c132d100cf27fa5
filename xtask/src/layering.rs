//! Who may use whom inside the library: the table, held against the paths that the code really names.
//!
//! A room is a folder or a file directly under `core/src`. Every path that starts at the crate's root is looked at,
//! wherever it stands: `use crate::mesh::…`, `crate::mesh::…` in an expression, `use crate::{mesh, rig::…}`, and
//! chains of `super` that climb as far. Names that the root re-exports count as the room they come from.

use crate::tools::{self, Outcome};
use std::collections::BTreeMap;
use std::path::Path;

/// A room and the rooms it may use, each of which stands above it; `lib.rs` may use everybody.
const TABLE: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("random", &[]),
    ("side", &[]),
    ("space", &[]),
    ("math", &["space"]),
    ("mesh", &[]),
    ("measure", &["mesh"]),
    ("skeleton", &["math", "mesh", "space"]),
    ("pose", &["math", "skeleton", "space"]),
    ("network", &["measure"]),
    ("condition", &["math", "measure", "mesh"]),
    ("model", &["condition", "math", "measure", "mesh", "network", "skeleton"]),
    ("body", &["condition", "measure", "mesh", "model", "skeleton"]),
    ("skin", &["math", "mesh", "pose", "skeleton"]),
    ("clip", &["math", "pose", "skeleton"]),
    ("retarget", &["clip", "math", "pose", "skeleton"]),
    ("scene", &["body", "clip", "math", "measure", "mesh", "model", "skeleton", "space"]),
    (
        "format",
        &["clip", "math", "measure", "mesh", "model", "pose", "retarget", "scene", "skeleton", "space"],
    ),
    (
        "testing",
        &[
            "space",
            "math",
            "mesh",
            "measure",
            "skeleton",
            "pose",
            "network",
            "condition",
            "model",
            "body",
            "skin",
            "clip",
            "retarget",
            "scene",
        ],
    ),
];

/// Rooms that everybody may use: those without a view of bodies, left and right, and what tests share.
const OPEN: &[&str] = &["error", "random", "side", "testing"];

/// One line per use of a room that the table does not grant: `path:line: …`.
pub(crate) fn violations(source: &Path) -> Outcome<Vec<String>> {
    let root_names = root_names(&tools::read(&source.join("lib.rs"))?);
    let mut files = Vec::new();
    rust_files(source, &mut Vec::new(), &mut files)?;
    let mut violations = Vec::new();
    for modules in files {
        let Some(room) = modules.first() else { continue };
        let path = file_of(source, &modules);
        let shown = path.strip_prefix(tools::root()).unwrap_or(&path).display().to_string();
        let Some((_, granted)) = TABLE.iter().find(|(name, _)| name == room) else {
            violations
                .push(format!("{shown}:1: the room `{room}` is not in the table of xtask/src/layering.rs"));
            continue;
        };
        for (line, name) in root_uses(&tools::read(&path)?, modules.len()) {
            let used = root_names.get(&name).unwrap_or(&name);
            if used == room || OPEN.contains(&used.as_str()) || granted.contains(&used.as_str()) {
                continue;
            }
            let why = match TABLE.iter().any(|(room, _)| room == used) {
                true => format!("`{room}` may not use `{used}`"),
                false => {
                    format!("`{name}` is neither a room in the table of xtask/src/layering.rs nor one's name")
                }
            };
            violations.push(format!("{shown}:{line}: {why}"));
        }
    }
    Ok(violations)
}

/// Collects the module paths of all files below a folder, in order: `mesh/mod.rs` and `mesh.rs` are `[mesh]`.
fn rust_files(folder: &Path, modules: &mut Vec<String>, files: &mut Vec<Vec<String>>) -> Outcome {
    let complain = |e: std::io::Error| format!("{}: cannot read: {e}", folder.display());
    let mut entries =
        std::fs::read_dir(folder).map_err(complain)?.collect::<Result<Vec<_>, _>>().map_err(complain)?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let path = entry.path();
        let Some(stem) = path.file_stem().map(|s| s.to_string_lossy().into_owned()) else { continue };
        if path.is_dir() {
            modules.push(stem);
            rust_files(&path, modules, files)?;
            modules.pop();
        } else if path.extension().is_some_and(|e| e == "rs") && !(modules.is_empty() && stem == "lib") {
            let mut own = modules.clone();
            if stem != "mod" {
                own.push(stem);
            }
            files.push(own);
        }
    }
    Ok(())
}

/// The file of a module path.
fn file_of(source: &Path, modules: &[String]) -> std::path::PathBuf {
    let base = modules.iter().fold(source.to_path_buf(), |path, module| path.join(module));
    let file = base.with_extension("rs");
    if file.is_file() { file } else { base.join("mod.rs") }
}

/// What the root re-exports: name to room, from lines such as `pub use error::{Error, Result};`.
fn root_names(lib: &str) -> BTreeMap<String, String> {
    let mut names = BTreeMap::new();
    let tokens = tokens(lib);
    for (i, token) in tokens.iter().enumerate() {
        let (true, Some(room)) = (token.text == "use", tokens.get(i + 1)) else { continue };
        let rest = tokens[i + 2..].iter().take_while(|t| t.text != ";");
        // Path segments before the last one are recorded too; nobody can name them through the root.
        for name in rest.filter(|t| t.is_word()) {
            names.insert(name.text.clone(), room.text.clone());
        }
    }
    names
}

/// The line and first segment of every path from the crate's root in a file that lies `depth` modules deep.
fn root_uses(source: &str, depth: usize) -> Vec<(usize, String)> {
    let tokens = tokens(source);
    let text = |i: usize| tokens.get(i).map_or("", |t| t.text.as_str());
    let mut uses = Vec::new();
    // For every open brace, whether it opened an inline module: those add to the depth.
    let mut braces = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        match text(i) {
            "{" => braces.push(i >= 2 && text(i - 2) == "mod"),
            "}" => drop(braces.pop()),
            "crate" | "super" if i == 0 || text(i - 1) != "::" => {
                let inline = braces.iter().filter(|&&module| module).count();
                let mut supers = 0;
                while text(i) == "super" && text(i + 1) == "::" {
                    (supers, i) = (supers + 1, i + 2);
                }
                let at_root = if supers == 0 { text(i + 1) == "::" } else { supers >= depth + inline };
                if supers == 0 {
                    i += if at_root { 2 } else { 1 };
                }
                if at_root {
                    uses.extend(first_segments(&tokens[i..]));
                }
                continue;
            }
            _ => {}
        }
        i += 1;
    }
    uses
}

/// `a::b` gives `a`; `{a::b, c::{d, e}}` gives `a` and `c`.
fn first_segments(tokens: &[Token]) -> Vec<(usize, String)> {
    let Some(first) = tokens.first() else { return Vec::new() };
    if first.text != "{" {
        return if first.is_word() { vec![(first.line, first.text.clone())] } else { Vec::new() };
    }
    let mut found = Vec::new();
    let mut open = 0;
    for (i, token) in tokens.iter().enumerate() {
        match token.text.as_str() {
            "{" => open += 1,
            "}" => open -= 1,
            _ if open == 1 && token.is_word() && matches!(tokens[i - 1].text.as_str(), "{" | ",") => {
                found.push((token.line, token.text.clone()));
            }
            _ => {}
        }
        if open == 0 {
            break;
        }
    }
    found
}

#[derive(Debug)]
struct Token {
    text: String,
    line: usize,
}

impl Token {
    fn is_word(&self) -> bool {
        self.text.starts_with(|c: char| c.is_alphabetic() || c == '_')
    }
}

/// Words, `::` and single punctuation marks; comments, strings and characters are left out.
fn tokens(source: &str) -> Vec<Token> {
    let chars: Vec<char> = source.chars().collect();
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    let mut tokens = Vec::new();
    let (mut i, mut line) = (0, 1);
    while i < chars.len() {
        let start = i;
        match at(i) {
            '/' if at(i + 1) == '/' => i += chars[i..].iter().take_while(|&&c| c != '\n').count(),
            '/' if at(i + 1) == '*' => {
                let mut open = 0;
                while i < chars.len() {
                    match (at(i), at(i + 1)) {
                        ('/', '*') => (open, i) = (open + 1, i + 2),
                        ('*', '/') => (open, i) = (open - 1, i + 2),
                        _ => i += 1,
                    }
                    if open == 0 {
                        break;
                    }
                }
            }
            '"' => {
                i += 1;
                while i < chars.len() && at(i) != '"' {
                    i += if at(i) == '\\' { 2 } else { 1 };
                }
                i += 1;
            }
            'r' | 'b' if raw_string_hashes(&chars[i..]).is_some() => {
                let (prefix, hashes) = raw_string_hashes(&chars[i..]).unwrap_or_default();
                i += prefix + hashes + 1;
                while i < chars.len() && !(at(i) == '"' && (1..=hashes).all(|k| at(i + k) == '#')) {
                    i += 1;
                }
                i += 1 + hashes;
            }
            // A character, not a lifetime: a quote closes it after one character or an escape.
            '\'' if at(i + 1) == '\\' => {
                i += 3;
                while i < chars.len() && at(i) != '\'' {
                    i += 1;
                }
                i += 1;
            }
            '\'' if at(i + 2) == '\'' => i += 3,
            c if c.is_alphanumeric() || c == '_' => {
                i += chars[i..].iter().take_while(|c| c.is_alphanumeric() || **c == '_').count();
                tokens.push(Token { text: chars[start..i].iter().collect(), line });
            }
            ':' if at(i + 1) == ':' => {
                i += 2;
                tokens.push(Token { text: "::".to_owned(), line });
            }
            c => {
                i += 1;
                if !c.is_whitespace() {
                    tokens.push(Token { text: c.to_string(), line });
                }
            }
        }
        i = i.min(chars.len());
        line += chars[start..i].iter().filter(|&&c| c == '\n').count();
    }
    tokens
}

/// Lengths of the prefix and of the run of `#` where a raw string starts.
fn raw_string_hashes(chars: &[char]) -> Option<(usize, usize)> {
    let prefix = match chars {
        ['b', 'r', ..] => 2,
        ['r', ..] => 1,
        _ => return None,
    };
    let hashes = chars[prefix..].iter().take_while(|&&c| c == '#').count();
    (chars.get(prefix + hashes) == Some(&'"')).then_some((prefix, hashes))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(source: &str, depth: usize) -> Vec<(usize, String)> {
        root_uses(source, depth)
    }

    #[test]
    fn the_library_keeps_to_the_table() {
        let violations = violations(&tools::root().join("core/src")).unwrap();
        assert!(violations.is_empty(), "\n{}", violations.join("\n"));
    }

    #[test]
    fn the_table_has_no_cycle_and_knows_its_rooms() {
        for (i, (room, granted)) in TABLE.iter().enumerate() {
            for used in *granted {
                let place = TABLE.iter().position(|(name, _)| name == used);
                assert!(
                    place.is_some_and(|p| p < i),
                    "`{room}` uses `{used}`, which is not above it in the table"
                );
            }
        }
    }

    #[test]
    fn every_way_to_name_the_root_is_seen() {
        let source = "use crate::mesh::Topology;\nuse crate::{\n  measure::{self, Sex}, rig::Skeleton,\n  Error};\n\
                      fn f() -> crate::Result<()> { crate::export::gltf::to_glb() }\npub(crate) fn g() {}";
        let found = names(source, 2);
        let expected = [(1, "mesh"), (3, "measure"), (3, "rig"), (4, "Error"), (5, "Result"), (5, "export")];
        assert_eq!(found, expected.map(|(line, name)| (line, name.to_owned())));
    }

    #[test]
    fn super_counts_only_where_it_reaches_the_root() {
        let source = "use super::names;\nuse super::super::body;\nmod tests { use super::super::names; \
                      use super::super::super::export; }";
        assert_eq!(names(source, 2), [(2, "body".to_owned()), (3, "export".to_owned())]);
    }

    #[test]
    fn comments_strings_and_characters_are_not_code() {
        let source = "// crate::body\n/* crate::body /* nested */ */\nlet s = \"crate::body\"; let r = r#\"crate::body\"#;\
                      \nlet c = '\"'; let d = '\\''; fn f<'a>(x: &'a str) { crate::mesh::g() }";
        assert_eq!(names(source, 1), [(4, "mesh".to_owned())]);
    }

    #[test]
    fn names_of_the_root_belong_to_their_rooms() {
        let names = root_names("pub mod body;\npub use body::Body;\npub use error::{Error, Result};");
        assert_eq!(names.get("Body").map(String::as_str), Some("body"));
        assert_eq!(names.get("Result").map(String::as_str), Some("error"));
    }
}
