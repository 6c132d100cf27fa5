//! The package for C++: used from CMake and Ninja as its users do, run, and its files checked by third-party programs.

use anyhow::{Result, anyhow};
use std::path::Path;
use std::process::Command;

use super::Fixture;
use super::tally::Tally;
use crate::environment::Environment;
use crate::package::package_cpp;
use crate::tools;

/// A request with given measures and a seed.
const REQUEST: &str =
    r#"{"sex": "male", "measures": {"height": 1.78, "chest_circumference": 1.02}, "seed": 3}"#;

pub(crate) fn run(fixture: Fixture<'_>, tally: &mut Tally) -> Result<()> {
    let Fixture { anthronet, environment, folder } = fixture;
    tally.case("C++: the README's program is the compiled one", readme_is_compiled());
    let [cmake, ninja] = match ["cmake", "ninja"].map(|name| environment.program(name)) {
        [Ok(cmake), Ok(ninja)] => [cmake, ninja],
        [Err(reason), _] | [_, Err(reason)] => {
            tally.skip("the package for C++", &reason);
            return Ok(());
        }
    };
    let folder = folder.join("cpp");
    let build = folder.join("build");
    let (request, expected) = (folder.join("request.json"), folder.join("expected.glb"));
    let made = package_cpp().and_then(|package| {
        tools::write(&request, REQUEST)?;
        let from = request.to_string_lossy();
        super::generate(anthronet, &["--request", &from], &expected, None)?;
        let mut configure = Command::new(&cmake);
        configure.arg("-S").arg(tools::root().join("tests/cpp")).arg("-B").arg(&build).args(["-G", "Ninja"]);
        configure.args(["-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF"]);
        for (key, path) in [("CMAKE_PREFIX_PATH", &package), ("CMAKE_MAKE_PROGRAM", &ninja)] {
            configure.arg(format!("-D{key}={}", path.display()));
        }
        tools::output(&mut configure)?;
        tools::output(Command::new(&cmake).arg("--build").arg(&build))
    });
    let built = made.is_ok();
    tally.case("C++: the package is found by CMake and built against without a warning", made.map(drop));
    if !built {
        return Ok(());
    }
    let program = |name: &str| Command::new(build.join(name).with_extension(std::env::consts::EXE_EXTENSION));
    tally.script(
        "C++ checks",
        program("checks").args([&request, &expected, &folder, &tools::target().join("tmp/same_bytes")]),
    );

    let person = tools::output(program("person").current_dir(&folder));
    tally.case("C++: the README's program runs", person.and_then(|said| ends_in_metres(&said)));
    let walk = tools::output(program("walk").arg(&folder))
        .and_then(|said| tools::write(&folder.join("walk.txt"), &said));
    let walked = walk.is_ok();
    tally.case("C++: the example runs", walk);
    if walked {
        in_other_programs(environment, &folder, tally)?;
    }
    Ok(())
}

fn in_other_programs(environment: &Environment, folder: &Path, tally: &mut Tally) -> Result<()> {
    let [glb, usdc, person, text] =
        ["walk.glb", "walk.usdc", "person.glb", "walk.txt"].map(|name| folder.join(name));
    match environment.node_script("validate.mjs") {
        Ok(mut command) => tally.script("Khronos glTF validator, C++", command.args([&glb, &person])),
        Err(reason) => tally.skip("Khronos glTF validator, C++", &reason),
    }
    for (name, script, arguments) in [
        ("C++ by numpy", "cpp_check.py", [folder, text.as_path()]),
        ("Pixar's USD, C++", "usd_check.py", [usdc.as_path(), glb.as_path()]),
    ] {
        match environment.python_script(script) {
            Ok(mut command) => tally.script(name, command.args(arguments)),
            Err(reason) => tally.skip(name, &reason),
        }
    }
    Ok(())
}

fn readme_is_compiled() -> Result<()> {
    let [readme, example] =
        ["cxx/README.md", "cxx/examples/person.cpp"].map(|file| tools::read(&tools::root().join(file)));
    match readme?.contains(example?.trim_end()) {
        true => Ok(()),
        false => Err(anyhow!("cxx/README.md does not show cxx/examples/person.cpp")),
    }
}

fn ends_in_metres(said: &str) -> Result<()> {
    let metres = said.trim().strip_suffix(" m").and_then(|number| number.parse::<f64>().ok());
    match metres {
        Some(waist) if (0.4..1.5).contains(&waist) => Ok(()),
        _ => Err(anyhow!("expected the circumference of a waist, got `{}`", said.trim())),
    }
}
