//! USD in Pixar's own library and in Blender, against the .glb of the same person and motion.

use anyhow::{Context as _, Result};
use std::path::Path;

use super::Fixture;
use super::generate;
use super::tally::Tally;
use crate::requests::{BVH, README};

/// One file of every extension; quads and triangles, both numbers of influences, several clips.
const FILES: [(&str, &str, &[&str]); 3] = [
    ("quads", "usdc", &["--clip", "walk", "--clip", "wave", "--clip", BVH]),
    ("8_influences", "usda", &["--influences", "8", "--lod", "1", "--clip", "squat"]),
    ("triangles", "usdz", &["--lod", "2", "--clip", "range_of_motion"]),
];

pub(crate) fn run(fixture: Fixture<'_>, tally: &mut Tally) -> Result<()> {
    let Fixture { anthronet, environment, folder } = fixture;
    for (name, extension, arguments) in FILES {
        let arguments = [README, arguments].concat();
        let file = folder.join(format!("usd_{name}.{extension}"));
        let again = folder.join(format!("usd_{name}_1_thread.{extension}"));
        let reference = folder.join(format!("usd_{name}.glb"));
        let made = generate(anthronet, &arguments, &file, None)
            .and_then(|()| generate(anthronet, &arguments, &again, Some(1)))
            .and_then(|()| generate(anthronet, &arguments, &reference, None));
        if let Err(why) = made {
            tally.case(&format!("generate usd_{name}.{extension}"), Err(why));
            continue;
        }
        let read = |path: &Path| std::fs::read(path).with_context(|| path.display().to_string());
        let same = read(&file)? == read(&again)?;
        tally.case(
            &format!("bytes of usd_{name}.{extension}"),
            same.then_some(()).context("differ from those of one thread"),
        );

        let title = format!("Pixar's USD, {name}.{extension}");
        match environment.python_script("usd_check.py") {
            Ok(mut command) => tally.script(&title, command.arg(&file).arg(&reference)),
            Err(reason) => tally.skip(&title, &reason),
        }
        let title = format!("Blender, {name}.{extension}");
        match environment.blender.clone().and_then(|()| environment.python_script("usd_check.py")) {
            Ok(mut command) => tally.script(&title, command.arg(&file).arg(&reference).arg("--blender")),
            Err(reason) => tally.skip(&title, &reason),
        }
    }
    Ok(())
}
