//! The Unity package: compiled by mono against stand-ins for Unity's own API and run with the real library.
//!
//! Unity itself is not run: `tests/unity/signatures.txt` lists what the stand-ins assume of it.

use super::tally::Tally;
use crate::bindings::HEADER;
use crate::environment;
use crate::package::{package_unity, packed_library};
use crate::tools;
use anyhow::{Context as _, Result, anyhow};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Compiled into one assembly, so that the tests see all of the package.
const SOURCES: [&str; 5] = [
    "unity_plugin/Runtime",
    "unity_plugin/Editor",
    "unity_plugin/Samples~",
    "unity_plugin/Tests",
    "tests/unity",
];
/// Sources that players compile: without the editor, and without the Burst package.
const PLAYER: [&str; 3] = ["unity_plugin/Runtime", "unity_plugin/Samples~", "tests/unity/stubs"];
/// Number of characters in the measurement of speed.
const CROWD: &str = "1000";

pub(crate) fn run(folder: &Path, tally: &mut Tally) -> Result<()> {
    let archive = package_unity();
    match environment::python() {
        Ok(python) => {
            let mut command = Command::new(python);
            let script = tools::root().join("tests/unity_package.py");
            command.env("PYTHONDONTWRITEBYTECODE", "1").arg(script).args(archive.as_deref().ok());
            tally.script("Unity package", &mut command);
        }
        Err(reason) => tally.skip("Unity package", &reason),
    }
    tally.case("the Unity package is built", archive.map(drop));
    if let Err(reason) = environment::mono() {
        tally.skip("the Unity package under mono", &reason);
        return Ok(());
    }
    let folder = folder.join("unity");
    tools::create_folder(&folder)?;
    let player = compile(&folder.join("player.dll"), &PLAYER, &["-target:library"]);
    tally.case("the Unity package compiles for players", player);
    let program = folder.join("anthronet-unity-tests.exe");
    let whole = ["-d:UNITY_EDITOR", "-d:ANTHRONET_BURST", "-r:System.Xml.dll", environment::NUNIT];
    let compiled = compile(&program, &SOURCES, &whole);
    let broken = compiled.is_err();
    tally.case("the Unity package compiles with its tests", compiled);
    if broken {
        return Ok(());
    }
    let library = packed_library();
    tally.case(
        "the Unity package's library exports the C interface and the entries that Unity calls",
        exports(&library),
    );
    let with_library = |program: &str| {
        let mut command = Command::new(program);
        command.env("LD_LIBRARY_PATH", library.parent().unwrap_or(Path::new("."))).current_dir(&folder);
        command
    };
    let results = folder.join("results.xml");
    let mut nunit = with_library("nunit-console");
    nunit.args(["-nologo", "-nodots", "-domain=None", "-process=Single", "-noshadow", "-nothread"]);
    nunit.arg(format!("-xml={}", results.display())).arg(&program);
    nunit.env("ANTHRONET_SAME_BYTES", tools::target().join("tmp/same_bytes"));
    nunit.env("ANTHRONET_CLIPS", tools::root().join("../shared/data/clips"));
    match environment::c_programs() {
        Ok(()) => {
            let source = tools::output(with_library("mono").arg(&program).arg("--layout-source"));
            match source.and_then(|source| layout(&source, &folder)) {
                Ok(file) => drop(nunit.env("ANTHRONET_LAYOUT", file)),
                Err(why) => tally.case("Unity: structures in C", Err(why)),
            }
        }
        Err(reason) => {
            tally.skip("Unity: structures are laid out as in C", &reason);
            nunit.arg("-exclude=NeedsC");
        }
    }
    if results.exists() {
        std::fs::remove_file(&results).with_context(|| format!("{}: cannot remove", results.display()))?;
    }
    // Failed tests are in the results; the output is kept for debugging.
    let console = tools::output(&mut nunit).unwrap_or_else(|error| format!("{error:#}"));
    tools::write(&folder.join("console.txt"), &console)?;
    let mut report = with_library("mono");
    report.arg(&program).arg("--report").arg(&results);
    tally.script("the Unity package under mono, by NUnit", &mut report);
    println!("-- speed of the Unity package under mono");
    let speed = tools::run(with_library("mono").arg(&program).args(["--speed", CROWD]));
    tally.case("Unity: speed is measured", speed);
    Ok(())
}

/// Exports beside the functions of the header: those that Unity calls, and accessors of their state.
const ENTRIES: [&str; 4] =
    ["UnityPluginLoad", "UnityPluginUnload", "anthronet_unity_interfaces", "anthronet_unity_render_event"];

fn exports(library: &Path) -> Result<()> {
    let symbols = tools::output(Command::new("nm").args(["-D", "--defined-only"]).arg(library))?;
    let shown: BTreeSet<_> = symbols.lines().filter_map(|line| line.split(' ').next_back()).collect();
    let header = tools::read(&tools::root().join(HEADER))?;
    let promised = super::c::functions(&header).into_iter().chain(ENTRIES).collect();
    let differ: Vec<_> = shown.symmetric_difference(&promised).copied().collect();
    if differ.is_empty() {
        Ok(())
    } else {
        Err(anyhow!("not in both library and header: {}", differ.join(", ")))
    }
}

/// Compiles scripts. Unity 2021 supports a newer language version; mono's compiler does not.
fn compile(out: &Path, sources: &[&str], arguments: &[&str]) -> Result<()> {
    let mut command = Command::new("mcs");
    command.args(["-nologo", "-unsafe", "-langversion:7.2", "-warn:4", "-warnaserror"]);
    command.args(["-r:System.dll", "-r:System.Core.dll"]).args(arguments);
    command.arg(format!("-out:{}", out.display()));
    for source in sources {
        command.arg(format!("-recurse:{}/*.cs", tools::root().join(source).display()));
    }
    tools::run(&mut command)
}

/// Writes sizes and offsets of the structures, according to a C compiler, to a file.
fn layout(text: &str, folder: &Path) -> Result<PathBuf> {
    let [source, program, file] = ["layout.c", "layout", "layout.txt"].map(|name| folder.join(name));
    tools::write(&source, text)?;
    let include = tools::root().join("ffi/include");
    tools::run(Command::new("gcc").arg("-I").arg(include).arg("-o").arg(&program).arg(&source))?;
    tools::write(&file, &tools::output(&mut Command::new(&program))?)?;
    Ok(file)
}
