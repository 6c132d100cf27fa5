//! `cargo xtask check`: formatting, layering, bindings, lints and documentation.

use crate::tools::{self, cargo};
use crate::{bindings, layering};
use anyhow::{Result, anyhow, bail};
use std::process::Command;

pub(crate) fn run() -> Result<()> {
    // The fast ones first; all are run, so that one round shows everything there is to fix.
    let mut failures = Vec::new();
    let mut keep = |result: Result<()>| failures.extend(result.err());
    let cargo_program = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    keep(tools::run(
        Command::new(cargo_program).current_dir(tools::root()).args(["fmt", "--all", "--check"]),
    ));
    keep(layers());
    keep(module_files());
    keep(bindings::check());
    // The same features for lints, documentation and tests, so that heavy dependencies are built once for each.
    keep(tools::run(cargo("clippy").args([
        "--workspace",
        "--all-targets",
        "--all-features",
        "--",
        "-D",
        "warnings",
    ])));
    // Libraries only: the command shares its name with the library, and its documentation is its --help; so does the C
    // ABI, whose documentation is its header.
    keep(tools::run(
        cargo("doc")
            .args(["--workspace", "--exclude", "anthronet-ffi", "--lib", "--no-deps", "--all-features"])
            .env("RUSTDOCFLAGS", "-D warnings"),
    ));
    tools::all_succeeded(&failures)
}

/// The crates whose sources are checked.
const CRATES: [&str; 6] = ["core", "cli", "trainer", "ffi", "cxx", "xtask"];

/// Long tests of `x` are in `x/tests.rs` beside `x/mod.rs`, which no lint checks.
fn module_files() -> Result<()> {
    for folder in CRATES {
        for file in tools::rust_files(&tools::root().join(folder))? {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            let with_path = tools::read(&file)?.lines().any(|line| line.trim_start().starts_with("#[path"));
            if with_path || name.ends_with("_tests.rs") {
                bail!("{}: expected x/tests.rs beside x/mod.rs, without `#[path]`", file.display());
            }
        }
    }
    println!("module files: long tests are in tests.rs beside mod.rs");
    Ok(())
}

/// The rooms of the library against the table of which may use which.
fn layers() -> Result<()> {
    let violations = layering::violations(&tools::root().join("core/src"))?;
    for violation in &violations {
        eprintln!("{violation}");
    }
    match violations.len() {
        0 => {
            println!("layering of core: no room uses one above it");
            Ok(())
        }
        n => Err(anyhow!("layering of core: {n} lines use a room that they may not use")),
    }
}

#[cfg(test)]
mod tests {
    use crate::tools::{self, read, root};
    use std::collections::BTreeSet;
    use std::process::Command;

    #[test]
    fn continuous_integration_calls_what_the_readme_says() {
        let command = "\ncargo xtask test\n";
        for file in ["README.md", ".ci/run"] {
            assert!(read(&root().join(file)).unwrap().contains(command), "{file} lacks `{}`", command.trim());
        }
    }

    #[test]
    fn every_dependency_has_its_reason_and_licence_documented() {
        let manifest = read(&root().join("Cargo.toml")).unwrap();
        let (_, dependencies) = manifest.split_once("[workspace.dependencies]\n").unwrap();
        let names = dependencies.lines().take_while(|line| !line.starts_with('[')).filter_map(|line| {
            let (name, value) = line.split_once(" = ")?;
            (!value.contains("path = ")).then_some(name)
        });
        let [reasons, licences] =
            ["CHANGELOG.md", "THIRD_PARTY.md"].map(|file| read(&root().join(file)).unwrap());
        for name in names {
            let quoted = format!("`{name}`");
            assert!(reasons.contains(&quoted), "CHANGELOG.md does not say what {quoted} is for");
            assert!(licences.contains(&format!("| {quoted} |")), "THIRD_PARTY.md does not list {quoted}");
        }
    }

    /// The library's dependencies, with their features, as cargo builds them for a package.
    fn below_the_library(package: &str) -> BTreeSet<String> {
        let mut tree = Command::new(std::env::var_os("CARGO").unwrap());
        tree.current_dir(root()).args(["tree", "--locked", "--edges", "normal,build", "--no-dedupe"]);
        tree.args(["--prefix", "depth", "--format", " {p} {f}", "--package", package]);
        let text = tools::output(&mut tree).unwrap();
        let lines = text.lines().map(|line| line.split_once(' ').unwrap());
        // The library's own line is less deep than its dependencies.
        let mut rest = lines.skip_while(|(_, shown)| !shown.starts_with("anthronet v"));
        let (top, _) = rest.next().unwrap();
        let deeper = |depth: &str| depth.parse::<u32>().unwrap() > top.parse().unwrap();
        rest.take_while(|(depth, _)| deeper(depth)).map(|(_, shown)| shown.to_owned()).collect()
    }

    #[test]
    fn command_c_abi_and_cpp_package_are_built_over_one_library() {
        let of_the_command = below_the_library("anthronet-cli");
        assert!(of_the_command.len() > 50, "{of_the_command:?}");
        for package in ["anthronet-ffi", "anthronet-cxx"] {
            let others = below_the_library(package);
            let differ: Vec<_> = of_the_command.symmetric_difference(&others).collect();
            assert!(differ.is_empty(), "{package}: name in workspace-hack/Cargo.toml: {differ:#?}");
        }
    }
}
