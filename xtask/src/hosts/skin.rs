//! Skinning against Blender's Armature modifier, UsdSkel, three.js, and its definition in double precision.

use std::path::Path;

use super::tally::Tally;
use crate::environment::Environment;
use crate::tools::{Outcome, cargo};

pub(crate) fn run(environment: &Environment, folder: &Path, tally: &mut Tally) -> Outcome {
    let folder = folder.join("skin");
    // Of the profile that the unit tests were built in; results do not depend on it.
    let dump =
        cargo("run").args(["--package", "anthronet", "--example", "skin_dump", "--"]).arg(&folder).status();
    if !dump.is_ok_and(|status| status.success()) {
        tally.case("skinned arrays", Err("the example skin_dump failed".to_owned()));
        return Ok(());
    }
    for (name, with) in
        [("skinning by numpy", "numpy"), ("skinning by UsdSkel", "usd"), ("skinning by Blender", "blender")]
    {
        match environment.python_script("skin_reference.py") {
            Ok(_) if with == "blender" && environment.blender.is_err() => {}
            Ok(mut command) => tally.script(name, command.arg(&folder).arg(with)),
            Err(reason) => tally.skip(name, &reason),
        }
    }
    if let Err(reason) = &environment.blender {
        tally.skip("skinning by Blender", reason);
    }
    match environment.node_script("skin_threejs.mjs")? {
        Ok(mut command) => tally.script("skinning by three.js", command.arg(&folder)),
        Err(reason) => tally.skip("skinning by three.js", &reason),
    }
    Ok(())
}
