//! The Blender extension: packed, installed and used in every Blender that it supports.

use super::tally::Tally;
use crate::environment::Environment;
use crate::package::package_blender;
use crate::tools::{self, Outcome};
use std::path::Path;
use std::process::Command;

pub(crate) fn run(anthronet: &Path, environment: &Environment, folder: &Path, tally: &mut Tally) -> Outcome {
    let archive = match package_blender(environment, anthronet)? {
        Ok(archive) => archive,
        Err(reason) => {
            tally.skip("Blender extension", &reason);
            return Ok(());
        }
    };
    let script = |name, python: &Path| {
        let mut command = Command::new(python);
        // The library has to come from the extension, not from a developer's folder.
        command.env("PYTHONDONTWRITEBYTECODE", "1").env_remove("ANTHRONET_LIBRARY");
        command.arg(tools::root().join("tests").join(name)).arg(&archive);
        command
    };
    for (version, python) in environment.blenders()? {
        let name = format!("Blender extension in {version}");
        match python {
            Ok(python) => {
                tally.script(&name, script("blender_addon.py", &python).arg(folder.join(version)));
                tally.script(&format!("its panels in {version}"), &mut script("blender_panels.py", &python));
            }
            Err(reason) => tally.skip(&name, &reason),
        }
    }
    Ok(())
}
