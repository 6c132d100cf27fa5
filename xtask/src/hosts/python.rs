//! The Python package: its wheel in a clean environment of every Python that is there, measures by numpy and scipy,
//! speed beside its bars.

use std::path::Path;
use std::process::Command;

use super::tally::Tally;
use crate::environment::{self, Environment};
use crate::tools::{self, Outcome};
use crate::{bindings, package};

pub(crate) fn run(anthronet: &Path, environment: &Environment, folder: &Path, tally: &mut Tally) -> Outcome {
    let python = match &environment.python {
        Ok(python) => python,
        Err(reason) => {
            tally.skip("the Python package", reason);
            return Ok(());
        }
    };
    let wheel = match package::package_python(python) {
        Ok(wheel) => wheel,
        Err(why) => {
            tally.case("the Python wheel", Err(why));
            return Ok(());
        }
    };
    tally.script("the Python wheel", environment.python_script("python_wheel.py")?.arg(&wheel));
    let folder = folder.join("python");
    tally.script(
        "type hints of the Python package",
        environment.python_script("python_types.py")?.arg(&folder),
    );
    let header = tools::root().join(bindings::HEADER);
    let same_bytes = tools::target().join("tmp/same_bytes");
    let (mut scripts, mut speed) = (Vec::new(), None);
    for version in environment::PYTHONS {
        let clean = match environment::python_with(version, &wheel)? {
            Ok(clean) => clean,
            Err(reason) => {
                tally.skip(&format!("the Python package in Python {version}"), &reason);
                continue;
            }
        };
        let folder = folder.join(version);
        std::fs::create_dir_all(&folder).map_err(|e| format!("{}: cannot create: {e}", folder.display()))?;
        let script = |name: &str, arguments: &[&Path]| {
            let mut command = Command::new(&clean);
            command
                .env("PYTHONDONTWRITEBYTECODE", "1")
                .env_remove("PYTHONPATH")
                .env_remove("ANTHRONET_LIBRARY");
            command.arg(tools::root().join("tests").join(name)).args(arguments);
            command
        };
        let mut case = |what: &str, name: &str, arguments: &[&Path]| {
            scripts.push((format!("Python {version}: {what}"), script(name, arguments)));
        };
        case("interface", "python_api.py", &[&header, &folder]);
        case("memory and threads", "python_memory.py", &[&folder]);
        case("README", "python_readme.py", &[&folder]);
        // None of these depends on the version of Python.
        if version == environment::PYTHONS[0] {
            case("declarations", "python_declarations.py", &[&header]);
            case("files", "python_files.py", &[anthronet, &folder]);
            // The consumers in C, which come first, have left the list.
            case("same bytes", "python_same_bytes.py", &[&same_bytes]);
            speed = Some(script("python_speed.py", &[]));
        }
    }
    tally.scripts(scripts);
    if let Some(mut speed) = speed {
        tally.script("speed of the Python package", &mut speed);
    }
    let mut measures = environment.python_script("python_measures.py")?;
    measures.env("PYTHONPATH", tools::root().join("python")).env("ANTHRONET_LIBRARY", package::library()?);
    tally.script("measures of Python's bodies by numpy and scipy", &mut measures);
    Ok(())
}
