//! Morph targets in the Khronos validator, three.js, Pixar's USD and Blender.

use anyhow::Result;
use std::process::Command;

use super::Fixture;
use super::tally::Tally;
use crate::tools;

/// Files of the example; no character of the library has morph targets that the command could write.
const FILES: [&str; 5] = ["morph.glb", "morph_meshopt.glb", "morph.vrm", "morph.usda", "morph.usdc"];

pub(crate) fn run(fixture: Fixture<'_>, tally: &mut Tally) -> Result<()> {
    let Fixture { environment, folder, .. } = fixture;
    let folder = folder.join("morph");
    // Built before the parts run.
    let program =
        tools::target().join("debug/examples/morph_dump").with_extension(std::env::consts::EXE_EXTENSION);
    if let Err(why) = tools::run(Command::new(program).arg(&folder)) {
        tally.case("files with morph targets", Err(why));
        return Ok(());
    }
    match environment.node_script("validate.mjs") {
        Ok(mut command) => {
            let gltf = FILES.iter().filter(|name| !name.contains(".usd")).map(|name| folder.join(name));
            tally.script("Khronos glTF validator, morph targets", command.args(gltf));
        }
        Err(reason) => tally.skip("Khronos glTF validator, morph targets", &reason),
    }
    for name in FILES.into_iter().filter(|name| name.ends_with(".glb")) {
        let title = format!("three.js morphs {name}");
        match environment.node_script("morph_threejs.mjs") {
            Ok(mut command) => tally.script(&title, command.arg(&folder).arg(name)),
            Err(reason) => tally.skip(&title, &reason),
        }
    }
    for name in FILES.into_iter().filter(|name| name.contains(".usd")) {
        let title = format!("Pixar's USD morphs {name}");
        match environment.python_script("morph_check.py") {
            Ok(mut command) => tally.script(&title, command.arg(&folder).arg(name)),
            Err(reason) => tally.skip(&title, &reason),
        }
    }
    for name in ["morph.glb", "morph.usdc"] {
        let title = format!("Blender morphs {name}");
        match environment.blender.clone().and_then(|()| environment.python_script("morph_check.py")) {
            Ok(mut command) => tally.script(&title, command.arg(&folder).arg(name).arg("--blender")),
            Err(reason) => tally.skip(&title, &reason),
        }
    }
    Ok(())
}
