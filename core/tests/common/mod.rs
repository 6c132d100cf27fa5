//! What tests of motion files share.

use std::io::Write;
use std::path::PathBuf;

/// The motion files of the folder `data/clips` of the shared data, beside the repository or where `ANTHRONET_SHARED` says.
/// Where there are none, the test has nothing to do and says so past the harness, which keeps the output of tests that
/// pass to itself.
pub(crate) fn clips(test: &str) -> Vec<PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared");
    let shared = std::env::var_os("ANTHRONET_SHARED").map_or_else(|| beside.into(), PathBuf::from);
    let folder = std::fs::read_dir(shared.join("data/clips"));
    let mut files: Vec<PathBuf> = folder.into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    files.retain(|path| path.extension().is_some_and(|e| e == "bvh" || e == "fbx"));
    files.sort();
    if files.is_empty() {
        let line = format!("\nskipped {test}: no folder shared/data/clips beside the repository\n");
        let _ = std::io::stdout().write_all(line.as_bytes());
    }
    files
}
