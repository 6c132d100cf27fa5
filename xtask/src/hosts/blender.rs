//! The Blender extension: packaged, installed and used in every Blender that it supports.

use super::Fixture;
use super::tally::Tally;
use crate::environment::Environment;
use crate::package::{package_blender, package_python, wheel};
use crate::tools::{self, Available};
use anyhow::Result;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The picture that the tests render into their folder.
const PICTURE: &str = "blender_people.png";

pub(crate) fn run(fixture: Fixture<'_>, tally: &mut Tally) -> Result<()> {
    let Fixture { anthronet, environment, folder } = fixture;
    let archive = match package_blender(environment, anthronet, |_| wheel())? {
        Ok(archive) => archive,
        Err(reason) => {
            tally.skip("Blender extension", &reason);
            return Ok(());
        }
    };
    for (version, python) in environment.blenders()? {
        let name = format!("Blender extension in {version}");
        match python {
            Ok(python) => {
                let mut addon = script("blender_addon.py", &python, &archive);
                tally.script(&name, addon.arg(folder.join(version)));
                let mut panels = script("blender_panels.py", &python, &archive);
                tally.script(&format!("its panels in {version}"), &mut panels);
            }
            Err(reason) => tally.skip(&name, &reason),
        }
    }
    Ok(())
}

/// The picture of the documentation, as the tests render it.
pub(crate) fn picture(
    anthronet: &Path,
    environment: &Environment,
    folder: &Path,
) -> Result<Available<PathBuf>> {
    let archive = match package_blender(environment, anthronet, package_python)? {
        Ok(archive) => archive,
        Err(reason) => return Ok(Err(reason)),
    };
    let python = environment.python.clone()?;
    tools::run(script("blender_addon.py", &python, &archive).arg(folder).arg("picturing"))?;
    Ok(Ok(folder.join(PICTURE)))
}

/// A script of `tests` in a Blender, with the extension as its first argument.
fn script(name: &str, python: &Path, archive: &Path) -> Command {
    let mut command = Command::new(python);
    // The library must come from the extension, not from a developer's folder.
    command.env("PYTHONDONTWRITEBYTECODE", "1").env_remove("ANTHRONET_LIBRARY");
    command.arg(tools::root().join("tests").join(name)).arg(archive);
    command
}
