//! Skinning against Blender's Armature modifier, UsdSkel, three.js, and its definition in double precision.

use anyhow::Result;
use std::process::Command;

use super::Fixture;
use super::tally::Tally;
use crate::tools;

pub(crate) fn run(fixture: Fixture<'_>, tally: &mut Tally) -> Result<()> {
    let Fixture { environment, folder, .. } = fixture;
    let folder = folder.join("skin");
    // Built before the parts run; results do not depend on the profile.
    let program =
        tools::target().join("debug/examples/skin_dump").with_extension(std::env::consts::EXE_EXTENSION);
    if let Err(why) = tools::run(Command::new(program).arg(&folder)) {
        tally.case("skinned arrays", Err(why));
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
    match environment.node_script("skin_threejs.mjs") {
        Ok(mut command) => tally.script("skinning by three.js", command.arg(&folder)),
        Err(reason) => tally.skip("skinning by three.js", &reason),
    }
    Ok(())
}
