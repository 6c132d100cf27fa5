//! The cross-boundary tests: files of the released command in third-party programs.
//!
//! The scripts lie in `tests/`. A script prints one line per case, `ok NAME`, `FAILED NAME: why` or
//! `skipped NAME: why`; other lines are for the reader. The tests of the Python package run under pytest, with the same
//! output from `tests/python/conftest.py`.

mod animation;
mod blender;
mod c;
mod cpp;
mod morph;
mod motion;
mod pose;
mod python;
mod skin;
mod tally;
mod unity;
mod usd;

use crate::environment::{self, Environment};
use crate::requests::PEOPLE;
use crate::tools::{self, Available};
use crate::{bless, requests};
use anyhow::{Context as _, Error, Result, anyhow};
use std::path::{Path, PathBuf};
use std::process::Command;
use tally::Tally;

pub(crate) fn run() -> Result<()> {
    let anthronet = tools::command_line()?;
    let environment = environment::prepare()?;
    let folder = tools::target().join("test-env/out");
    tools::remove_folder(&folder)?;
    tools::create_folder(&folder)?;

    let mut tally = Tally::default();
    println!("cross-boundary tests");
    without_networks(&anthronet, &mut tally);
    same_bytes(&anthronet, &folder, &mut tally)?;
    let files = files(&anthronet, &folder, &mut tally);
    in_other_programs(&anthronet, &environment, &folder, &files, &mut tally)?;
    skin::run(&environment, &folder, &mut tally)?;
    animation::run(&anthronet, &environment, &folder, &mut tally)?;
    usd::run(&anthronet, &environment, &folder, &mut tally)?;
    pose::run(&anthronet, &environment, &folder, &mut tally)?;
    morph::run(&environment, &folder, &mut tally)?;
    motion::run(&anthronet, &mut tally);
    c::run(&environment.c, &folder, &mut tally)?;
    cpp::run(&anthronet, &environment, &folder, &mut tally)?;
    python::run(&anthronet, &environment, &folder, &mut tally)?;
    blender::run(&anthronet, &environment, &folder, &mut tally)?;
    unity::run(&folder, &mut tally)?;
    close(&tally)
}

/// Only the programs that use the C ABI.
pub(crate) fn run_c() -> Result<()> {
    let mut tally = Tally::default();
    c::run(&environment::c_programs(), &tools::target().join("test-env/out"), &mut tally)?;
    close(&tally)
}

/// Only the package for C++.
pub(crate) fn run_cpp() -> Result<()> {
    let (anthronet, environment) = (tools::command_line()?, environment::prepare()?);
    c::byte_lists()?;
    let mut tally = Tally::default();
    cpp::run(&anthronet, &environment, &tools::target().join("test-env/out"), &mut tally)?;
    close(&tally)
}

/// Only the Python package.
pub(crate) fn run_python() -> Result<()> {
    let (anthronet, environment) = (tools::command_line()?, environment::prepare()?);
    c::byte_lists()?;
    let mut tally = Tally::default();
    python::run(&anthronet, &environment, &tools::target().join("test-env/out"), &mut tally)?;
    close(&tally)
}

/// Only the Unity package.
pub(crate) fn run_unity() -> Result<()> {
    c::byte_lists()?;
    let mut tally = Tally::default();
    unity::run(&tools::target().join("test-env/out"), &mut tally)?;
    close(&tally)
}

/// Only the Blender extension.
pub(crate) fn run_blender() -> Result<()> {
    let mut tally = Tally::default();
    let folder = tools::target().join("test-env/out");
    blender::run(&tools::command_line()?, &environment::prepare()?, &folder, &mut tally)?;
    close(&tally)
}

/// Renders the picture of the Blender extension into a folder.
pub(crate) fn blender_picture(folder: &Path) -> Result<Available<PathBuf>> {
    blender::picture(&tools::command_line()?, &environment::prepare()?, folder)
}

/// Only the table of motion.
pub(crate) fn run_motion() -> Result<()> {
    let mut tally = Tally::default();
    motion::run(&tools::command_line()?, &mut tally);
    close(&tally)
}

/// Prints the counts.
fn close(tally: &Tally) -> Result<()> {
    println!("{} passed, {} failed, {} skipped", tally.passed, tally.failed, tally.skipped);
    match tally.failed {
        0 => Ok(()),
        n => Err(anyhow!("{n} cross-boundary tests failed")),
    }
}

/// `anthronet generate` with these arguments into a file.
fn generate(anthronet: &Path, arguments: &[&str], file: &Path, threads: Option<u32>) -> Result<()> {
    let mut command = Command::new(anthronet);
    // Paths of motion files are relative to the root.
    command.current_dir(tools::root()).arg("generate").args(arguments).arg("-o").arg(file);
    if let Some(threads) = threads {
        command.env("RAYON_NUM_THREADS", threads.to_string());
    }
    tools::output(&mut command).map(drop)
}

/// The command as users build it has no networks and says how to get them; the workspace's tests build it with networks.
fn without_networks(anthronet: &Path, tally: &mut Tally) {
    for arguments in [&["evaluate"][..], &["train", "generator"], &["train", "scores"]] {
        let text = arguments.join(" ");
        let result = Command::new(anthronet).args(arguments).output();
        let result = result.map_err(Error::from).and_then(|output| {
            let said = String::from_utf8_lossy(&output.stderr);
            let expected = format!("this build has no networks: run `cargo anthronet-train {text}`");
            let right = output.status.code() == Some(2) && said.contains(&expected);
            right.then_some(()).with_context(|| format!("{}: {said}", output.status))
        });
        tally.case(&format!("without networks: {text}"), result);
    }
}

/// The same request gives the same bytes, whatever the number of threads, and the bytes of the golden.
fn same_bytes(anthronet: &Path, folder: &Path, tally: &mut Tally) -> Result<()> {
    let golden = bless::golden()?;
    for person in PEOPLE {
        let hash = |threads| -> Result<String> {
            let file = folder.join(format!("{}_{threads}_threads.glb", person.name));
            generate(anthronet, person.arguments, &file, Some(threads))?;
            bless::hash(&file)
        };
        let hashes = [1, 2, 8].into_iter().map(hash).collect::<Result<Vec<_>>>();
        let hashes = match hashes {
            Ok(hashes) => hashes,
            Err(why) => {
                tally.case(&format!("generate {}", person.name), Err(why));
                continue;
            }
        };
        let same = hashes.iter().all(|hash| *hash == hashes[0]);
        let differ = || format!("1, 2 and 8 threads gave {}", hashes.join(", "));
        tally.case(
            &format!("same bytes over threads: {}", person.name),
            same.then_some(()).with_context(differ),
        );

        let name = format!("same bytes as the golden: {}", person.name);
        match golden.as_ref().map(|golden| golden.get(person.name)) {
            None => tally.skip(&name, "tests/golden/hashes.json is missing, `cargo xtask bless` writes it"),
            Some(None) => tally.case(&name, Err(anyhow!("not in tests/golden/hashes.json"))),
            Some(Some(expected)) => {
                let differs = || format!("expected {expected}, got {}", hashes[0]);
                tally.case(&name, (*expected == hashes[0]).then_some(()).with_context(differs));
            }
        }
    }
    Ok(())
}

/// One file of every kind: all people, all levels of detail, both numbers of influences, both containers.
fn files(anthronet: &Path, folder: &Path, tally: &mut Tally) -> Vec<PathBuf> {
    let mut wanted: Vec<(String, Vec<&str>)> = Vec::new();
    for person in PEOPLE {
        for lod in ["0", "1", "2", "3"] {
            let arguments = [person.arguments, &["--lod", lod]].concat();
            wanted.push((format!("{}_lod{lod}.glb", person.name), arguments));
        }
        let arguments = [person.arguments, &["--influences", "8"]].concat();
        wanted.push((format!("{}_8_influences.glb", person.name), arguments));
    }
    wanted.push(("readme.gltf".to_owned(), requests::README.to_vec()));
    let mut files = Vec::new();
    for (name, arguments) in wanted {
        let file = folder.join(&name);
        match generate(anthronet, &arguments, &file, None) {
            Ok(()) => files.push(file),
            Err(why) => tally.case(&format!("generate {name}"), Err(why)),
        }
    }
    files
}

/// The Khronos validator, numpy and scipy, three.js, Blender.
fn in_other_programs(
    anthronet: &Path,
    environment: &Environment,
    folder: &Path,
    files: &[PathBuf],
    tally: &mut Tally,
) -> Result<()> {
    match environment.node_script("validate.mjs")? {
        Ok(mut command) => tally.script("Khronos glTF validator", command.args(files)),
        Err(reason) => tally.skip("Khronos glTF validator", &reason),
    }
    if let Err(reason) = &environment.python {
        for name in ["measures by numpy and scipy", "three.js", "Blender"] {
            tally.skip(name, reason);
        }
        return Ok(());
    }
    let python = |script| environment.python_script(script);
    tally.script("measures by numpy and scipy", python("measure_glb.py")?.arg(anthronet).arg(folder));

    // The reference for the two programs below, once per file.
    for (stem, arguments) in [
        ("posed_4", [requests::README, &["--influences", "4"]].concat()),
        ("posed_8", [requests::README, &["--influences", "8"]].concat()),
    ] {
        let file = folder.join(format!("{stem}.glb"));
        if let Err(why) = generate(anthronet, &arguments, &file, None) {
            tally.case(&format!("generate {stem}.glb"), Err(why));
            continue;
        }
        tally.script(&format!("reference skinning of {stem}.glb"), python("pose_reference.py")?.arg(&file));
        // three.js reads no more than four influences.
        if stem == "posed_4" {
            match environment.node_script("threejs.mjs")? {
                Ok(mut command) => tally.script("three.js", command.arg(&file)),
                Err(reason) => tally.skip("three.js", &reason),
            }
        }
        let name = format!("Blender, {stem}.glb");
        match &environment.blender {
            Ok(()) => {
                let picture = (stem == "posed_4").then(|| folder.join("blender.png"));
                tally.script(&name, python("blender_import.py")?.arg(&file).args(picture));
            }
            Err(reason) => tally.skip(&name, reason),
        }
    }
    Ok(())
}
