//! The Python package: its wheel in a clean environment of every Python on the machine, measures by numpy and scipy, and
//! speed against its limits.

use anyhow::Result;
use std::path::Path;
use std::process::Command;

use super::Fixture;
use super::tally::Tally;
use crate::environment;
use crate::package;
use crate::tools;

pub(crate) fn run(fixture: Fixture<'_>, tally: &mut Tally) -> Result<()> {
    let Fixture { anthronet, environment, folder } = fixture;
    let python = match &environment.python {
        Ok(python) => python,
        Err(reason) => {
            tally.skip("the Python package", reason);
            return Ok(());
        }
    };
    let wheel = match package::wheel() {
        Ok(wheel) => wheel,
        Err(why) => {
            tally.case("the Python wheel", Err(why));
            return Ok(());
        }
    };
    let folder = folder.join("python");
    tools::create_folder(&folder)?;
    let mut of_the_wheel = pytest(python, "test_wheel.py", &folder.join("wheel"));
    tally.script("the Python wheel", of_the_wheel.arg("--wheel").arg(&wheel));
    let mut types = pytest(python, "test_types.py", &folder.join("types"));
    tally.script("type hints of the Python package", &mut types);
    let (mut scripts, mut speed) = (Vec::new(), None);
    for version in environment::PYTHONS {
        let clean = match environment::python_with(version, &wheel)? {
            Ok(clean) => clean,
            Err(reason) => {
                tally.skip(&format!("the Python package in Python {version}"), &reason);
                continue;
            }
        };
        let mut case = |what: &str, tests: &str, arguments: &[&Path]| {
            let folder = folder.join(format!("{version}-{}", tests.trim_end_matches(".py")));
            let mut command = pytest(&clean, tests, &folder);
            command.args(arguments);
            scripts.push((format!("Python {version}: {what}"), command));
        };
        case("interface", "interface", &[]);
        case("memory and threads", "test_memory.py", &[]);
        case("README", "test_readme.py", &[]);
        // None of these depends on the version of Python.
        if version == environment::PYTHONS[0] {
            case("declarations", "test_declarations.py", &[]);
            case("files", "test_files.py", &[Path::new("--anthronet"), anthronet]);
            // Written before the parts run.
            let same_bytes = tools::target().join("tmp/same_bytes");
            case("same bytes", "test_same_bytes.py", &[Path::new("--same-bytes"), &same_bytes]);
            speed = Some(pytest(&clean, "test_speed.py", &folder.join("speed")));
        }
    }
    tally.scripts(scripts);
    if let Some(mut speed) = speed {
        tally.script("speed of the Python package", &mut speed);
    }
    let mut measures = pytest(python, "test_measures.py", &folder.join("measures"));
    measures.env("PYTHONPATH", tools::root().join("python")).env("ANTHRONET_LIBRARY", package::library()?);
    tally.script("measures of Python's bodies by numpy and scipy", &mut measures);
    Ok(())
}

/// Runs a file or folder of `tests/python` on the package installed in this Python; its output files go to `folder`.
fn pytest(python: &Path, tests: &str, folder: &Path) -> Command {
    let mut command = Command::new(python);
    command.env("PYTHONDONTWRITEBYTECODE", "1").env_remove("PYTHONPATH").env_remove("ANTHRONET_LIBRARY");
    command.args(["-m", "pytest", "--basetemp"]).arg(folder);
    command.arg(tools::root().join("tests/python").join(tests));
    command
}
