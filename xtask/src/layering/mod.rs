//! Which rooms of the library may use which: the paths in the code, checked against the table.
//!
//! A room is a folder or a file directly under `core/src`. Every path that starts at the crate's root is checked,
//! wherever it occurs: `use crate::mesh::…`, `crate::mesh::…` in an expression, `use crate::{mesh, rig::…}`, and
//! chains of `super` that climb as far. Names that the root re-exports count as the room they come from.

mod paths;
mod table;

use crate::tools;
use anyhow::{Result, anyhow};
use std::collections::BTreeMap;
use std::path::Path;
use syn::{Item, ItemMod, Meta};

/// Where the table is, for error messages.
const TABLE: &str = "the table of xtask/src/layering/table.rs";

/// One line per use of a room that the table does not allow: `path:line: …`.
pub(crate) fn violations(source: &Path) -> Result<Vec<String>> {
    let lib = source.join("lib.rs");
    let shown = |path: &Path| path.strip_prefix(tools::root()).unwrap_or(path).display().to_string();
    let broken = |path: &Path, e: &syn::Error| anyhow!("{}:{}: {e}", shown(path), e.span().start().line);
    let root = syn::parse_file(&tools::read(&lib)?).map_err(|e| broken(&lib, &e))?;
    let root_names: BTreeMap<String, String> = paths::root_names(&root).into_iter().collect();
    let mut violations = Vec::new();
    if let Some(line) = open_beyond_tests(&root) {
        violations.push(format!(
            "{}:{line}: `{}` is for tests only: it needs `#[cfg(test)]`",
            shown(&lib),
            table::TESTING
        ));
    }
    for path in tools::rust_files(source)? {
        let modules = modules_of(source, &path);
        let Some(room) = modules.first() else { continue };
        if !table::is_room(room) {
            violations.push(format!("{}:1: the room `{room}` is not in {TABLE}", shown(&path)));
            continue;
        }
        let uses = paths::root_uses(&tools::read(&path)?, modules.len()).map_err(|e| broken(&path, &e))?;
        for (line, name) in uses {
            let used = root_names.get(&name).unwrap_or(&name);
            let why = match (table::is_room(used), table::may_use(room, used)) {
                (true, true) => continue,
                (true, false) => format!("`{room}` may not use `{used}`"),
                (false, _) => format!("`{name}` is neither a room in {TABLE} nor one's name"),
            };
            violations.push(format!("{}:{line}: {why}", shown(&path)));
        }
    }
    Ok(violations)
}

/// The line at which the root declares the room for tests without `#[cfg(test)]`.
fn open_beyond_tests(lib: &syn::File) -> Option<usize> {
    let for_tests = |module: &ItemMod| {
        module.attrs.iter().any(|attribute| match &attribute.meta {
            Meta::List(list) => list.path.is_ident("cfg") && list.tokens.to_string() == "test",
            _ => false,
        })
    };
    lib.items.iter().find_map(|item| match item {
        Item::Mod(module) if module.ident == table::TESTING && !for_tests(module) => {
            Some(module.ident.span().start().line)
        }
        _ => None,
    })
}

/// The module path of a file below the sources: `mesh/mod.rs` and `mesh.rs` are `[mesh]`, `lib.rs` is `[]`.
fn modules_of(source: &Path, file: &Path) -> Vec<String> {
    let inner = file.strip_prefix(source).unwrap_or(file).with_extension("");
    let mut modules: Vec<_> = inner.iter().map(|name| name.to_string_lossy().into_owned()).collect();
    if modules == ["lib"] || modules.last().is_some_and(|last| last == "mod") {
        modules.pop();
    }
    modules
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The violations in a library of these files.
    fn violations_in(files: &[(&str, &str)]) -> Vec<String> {
        let folder = tempfile::tempdir().unwrap();
        for (path, text) in files {
            tools::write(&folder.path().join(path), text).unwrap();
        }
        let found = violations(folder.path()).unwrap();
        let start = format!("{}/", folder.path().display());
        found.into_iter().map(|line| line.replace(&start, "")).collect()
    }

    #[test]
    fn the_library_keeps_to_the_table() {
        let violations = violations(&tools::root().join("core/src")).unwrap();
        assert!(violations.is_empty(), "\n{}", violations.join("\n"));
    }

    #[test]
    fn what_the_table_does_not_allow_is_reported_with_its_line() {
        let found = violations_in(&[
            ("lib.rs", "pub use error::Error;\npub use body::Body;"),
            ("error.rs", "fn f() {}"),
            ("attic/mod.rs", ""),
            ("mesh/mod.rs", "use crate::Error;\nuse crate::{Body, skin::Skinner};"),
            (
                "mesh/deep/down.rs",
                "\nuse super::super::super::pose;\nuse crate::nothing;\nuse super::super::body;",
            ),
        ]);
        let expected = [
            "attic/mod.rs:1: the room `attic` is not in the table of xtask/src/layering/table.rs",
            "mesh/deep/down.rs:2: `mesh` may not use `pose`",
            "mesh/deep/down.rs:3: `nothing` is neither a room in the table of xtask/src/layering/table.rs nor one's name",
            "mesh/mod.rs:2: `mesh` may not use `body`",
            "mesh/mod.rs:2: `mesh` may not use `skin`",
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn the_room_for_tests_needs_cfg_test() {
        let rest = [
            ("testing/mod.rs", "use crate::scene::Scene;"),
            ("mesh.rs", "#[cfg(test)]\nmod tests { use crate::testing::body; }"),
        ];
        let with = |lib| violations_in(&[&[("lib.rs", lib)], &rest[..]].concat());
        assert!(with("#[cfg(test)]\nmod testing;").is_empty());
        let reported = "lib.rs:2: `testing` is for tests only: it needs `#[cfg(test)]`";
        assert_eq!(with("\npub mod testing;"), [reported]);
        assert_eq!(with("#[cfg(any(test, unix))]\nmod testing;"), [reported]);
    }
}
