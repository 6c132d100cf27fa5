//! Runs the built command and checks its output and the files that it leaves.
#![allow(dead_code, reason = "each test file uses its own part")]

use std::fs;
use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

/// What a run of the command came to.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) arguments: String,
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Run {
    /// The run failed with this exit code and one message that has these words; it did not panic or print a result.
    pub(crate) fn fails(&self, code: i32, words: &[&str]) {
        assert_eq!(self.code, Some(code), "{self:#?}");
        assert!(!self.err.contains("panicked"), "{self:#?}");
        assert!(self.out.is_empty(), "{self:#?}");
        let usage = self.err.contains("Usage") && code == 2;
        assert!(self.err.starts_with("error: ") || usage, "{self:#?}");
        for word in words {
            assert!(self.err.contains(word), "expected `{word}` in {self:#?}");
        }
    }

    /// The run succeeded.
    pub(crate) fn succeeds(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:#?}");
        self
    }
}

/// Runs the command with these arguments and environment variables.
pub(crate) fn anthronet(arguments: &[&str], environment: &[(&str, &str)]) -> Run {
    let mut command = Command::new(env!("CARGO_BIN_EXE_anthronet"));
    run(command.args(arguments).env_remove("ANTHRONET_MODEL").envs(environment.iter().copied()))
}

/// Runs a prepared command.
pub(crate) fn run(command: &mut Command) -> Run {
    let output = command.output().expect("the command starts");
    Run {
        arguments: format!("{command:?}"),
        code: output.status.code(),
        out: String::from_utf8_lossy(&output.stdout).into_owned(),
        err: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

/// Runs `generate` with options that must fail, into a fresh folder that must stay empty.
pub(crate) fn generate(options: &[&str]) -> Run {
    let folder = folder();
    let out = folder.path().join("out.glb");
    let mut all = vec!["generate"];
    all.extend_from_slice(options);
    let out = out.to_string_lossy().into_owned();
    all.extend(["-o", &out]);
    let run = anthronet(&all, &[]);
    assert_eq!(files_in(folder.path()), Vec::<String>::new(), "{options:?} left files behind");
    run
}

/// A fresh folder.
pub(crate) fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Writes a file and gives its path.
pub(crate) fn write(folder: &TempDir, name: &str, bytes: &[u8]) -> String {
    let path = folder.path().join(name);
    fs::write(&path, bytes).expect("the file can be written");
    path.to_string_lossy().into_owned()
}

/// The names in a folder, sorted.
pub(crate) fn files_in(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder can be read");
    let mut names: Vec<_> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
