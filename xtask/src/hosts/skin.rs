//! Skinning against Blender's Armature modifier, UsdSkel, three.js, and its definition in double precision.

use std::path::Path;

use super::tally::Tally;
use super::{node_script, python_script};
use crate::environment::Environment;
use crate::tools::{self, Outcome, cargo};

pub(crate) fn run(environment: &Environment, folder: &Path, tally: &mut Tally) -> Outcome {
    let folder = folder.join("skin");
    // Of the profile that the unit tests were built in; results do not depend on it.
    let dump =
        cargo("run").args(["--package", "anthronet", "--example", "skin_dump", "--"]).arg(&folder).status();
    if !dump.is_ok_and(|status| status.success()) {
        tally.case("skinned arrays", Err("the example skin_dump failed".to_owned()));
        return Ok(());
    }
    match &environment.python {
        Ok(program) => {
            let mut compare = |name: &str, with: &str| {
                tally.script(name, python_script(program, "skin_reference.py").arg(&folder).arg(with));
            };
            compare("skinning by numpy", "numpy");
            compare("skinning by UsdSkel", "usd");
            if environment.blender.is_ok() {
                compare("skinning by Blender", "blender");
            }
        }
        Err(reason) => tally.skip("skinning by numpy, UsdSkel", reason),
    }
    if let Err(reason) = &environment.blender {
        tally.skip("skinning by Blender", reason);
    }
    match node_script(environment, "skin_threejs.mjs")? {
        Ok(mut command) => tally.script("skinning by three.js", command.arg(&folder)),
        Err(reason) => tally.skip("skinning by three.js", &reason),
    }
    Ok(())
}
