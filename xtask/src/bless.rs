//! `cargo xtask bless`: the goldens, and how a file is compared with its golden.
//!
//! `tests/golden/hashes.json` maps the name of a request to the SHA-256 of the .glb made from it. The same request
//! and seed give the same bytes on every host, so the hashes change only with the model or the code.

use crate::requests::PEOPLE;
use crate::tools;
use anyhow::{Context as _, Result};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Name of the request to hexadecimal hash.
pub(crate) type Hashes = BTreeMap<String, String>;

pub(crate) fn run() -> Result<()> {
    let anthronet = tools::command_line()?;
    let scratch = tools::target().join("bless");
    tools::create_folder(&scratch)?;
    let mut hashes = Hashes::new();
    for person in PEOPLE {
        let file = scratch.join(format!("{}.glb", person.name));
        tools::run(Command::new(&anthronet).arg("generate").args(person.arguments).arg("-o").arg(&file))?;
        hashes.insert(person.name.to_owned(), hash(&file)?);
    }
    let before = golden()?.unwrap_or_default();
    for (name, new) in &hashes {
        match before.get(name) {
            Some(old) if old == new => println!("same     {name}"),
            Some(_) => println!("changed  {name}"),
            None => println!("new      {name}"),
        }
    }
    let text = serde_json::to_string_pretty(&hashes)?;
    tools::write(&golden_path(), &(text + "\n"))
}

fn golden_path() -> PathBuf {
    tools::root().join("tests/golden/hashes.json")
}

/// The committed hashes; `None` before the first `bless`.
pub(crate) fn golden() -> Result<Option<Hashes>> {
    let path = golden_path();
    if !path.exists() {
        return Ok(None);
    }
    let text = tools::read(&path)?;
    serde_json::from_str(&text).map(Some).with_context(|| path.display().to_string())
}

/// SHA-256 of a file in hexadecimal.
pub(crate) fn hash(path: &Path) -> Result<String> {
    let bytes = std::fs::read(path).with_context(|| format!("{}: cannot read", path.display()))?;
    let mut text = String::new();
    for byte in Sha256::digest(&bytes) {
        write!(text, "{byte:02x}")?;
    }
    Ok(text)
}
