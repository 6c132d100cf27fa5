//! The Unity package: compiled by mono against stand-ins for Unity's own API and run with the real library.
//!
//! No Unity is run: `tests/unity/SIGNATURES.md` lists what the stand-ins take for granted.

use super::tally::Tally;
use crate::environment;
use crate::package::{library, package_unity};
use crate::tools::{self, Outcome};
use std::path::{Path, PathBuf};
use std::process::Command;

/// What is compiled together: what the tests see of the package is all of it.
const SOURCES: [&str; 4] =
    ["unity_plugin/Runtime", "unity_plugin/Editor", "unity_plugin/Samples~", "tests/unity"];

pub(crate) fn run(folder: &Path, tally: &mut Tally) -> Outcome {
    match environment::python() {
        Ok(python) => {
            let mut command = Command::new(python);
            let script = tools::root().join("tests/unity_package.py");
            tally.script("Unity package", command.env("PYTHONDONTWRITEBYTECODE", "1").arg(script));
        }
        Err(reason) => tally.skip("Unity package", &reason),
    }
    tally.case("the Unity package is packed", package_unity().map(drop));
    if let Err(reason) = environment::mono() {
        tally.skip("the Unity package under mono", &reason);
        return Ok(());
    }
    let program = match compile(&folder.join("unity")) {
        Ok(program) => program,
        Err(why) => {
            tally.case("the Unity package compiles", Err(why));
            return Ok(());
        }
    };
    tally.case("the Unity package compiles", Ok(()));
    let library = library()?;
    let mono = || {
        let mut command = Command::new("mono");
        command.env("LD_LIBRARY_PATH", library.parent().unwrap_or(Path::new("."))).arg(&program);
        command
    };
    let mut tests = mono();
    tests.arg("--same-bytes").arg(tools::target().join("tmp/same_bytes"));
    match environment::c_programs() {
        Ok(()) => match layout(&mono, &folder.join("unity")) {
            Ok(file) => {
                tests.arg("--layout").arg(file);
            }
            Err(why) => tally.case("Unity: structures in C", Err(why)),
        },
        Err(reason) => println!("without a compiler of C: {reason}"),
    }
    tally.script("the Unity package under mono", &mut tests);
    println!("-- speed of the Unity package under mono");
    tools::run(mono().args(["--speed", "100"]))?;
    Ok(())
}

/// The package and its tests as one program.
fn compile(folder: &Path) -> Outcome<PathBuf> {
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: cannot create: {e}", folder.display()))?;
    let program = folder.join("anthronet-unity-tests.exe");
    let mut command = Command::new("mcs");
    // Unity 2021 takes more than this language version; mono's compiler takes no more.
    command.args(["-nologo", "-unsafe", "-langversion:7.2", "-warn:4", "-warnaserror"]);
    command.args(["-r:System.dll", "-r:System.Core.dll"]).arg(format!("-out:{}", program.display()));
    for source in SOURCES {
        command.arg(format!("-recurse:{}/*.cs", tools::root().join(source).display()));
    }
    tools::run(&mut command)?;
    Ok(program)
}

/// Sizes and offsets as a compiler of C has them, in a file.
fn layout(mono: &impl Fn() -> Command, folder: &Path) -> Outcome<PathBuf> {
    let [source, program, file] = ["layout.c", "layout", "layout.txt"].map(|name| folder.join(name));
    tools::write(&source, &tools::output(mono().arg("--layout-source"))?)?;
    let include = tools::root().join("ffi/include");
    tools::run(Command::new("gcc").arg("-I").arg(include).arg("-o").arg(&program).arg(&source))?;
    tools::write(&file, &tools::output(&mut Command::new(&program))?)?;
    Ok(file)
}
