//! Files of the released command: their bytes against the goldens, and the files in the Khronos validator, numpy and scipy,
//! three.js and Blender.

use super::{Fixture, Tally, generate};
use crate::requests::PEOPLE;
use crate::{bless, requests};
use anyhow::{Context as _, Error, Result, anyhow};
use std::path::{Path, PathBuf};
use std::process::Command;

pub(crate) fn run(fixture: Fixture<'_>, tally: &mut Tally) -> Result<()> {
    let Fixture { anthronet, folder, .. } = fixture;
    without_networks(anthronet, tally);
    same_bytes(anthronet, folder, tally)?;
    let files = files(anthronet, folder, tally);
    in_other_programs(fixture, &files, tally)
}

/// The command as users build it has no networks and says how to get them; the workspace's tests build it with networks.
fn without_networks(anthronet: &Path, tally: &mut Tally) {
    for arguments in [&["evaluate"][..], &["train", "generator"], &["train", "scores"]] {
        let text = arguments.join(" ");
        let result = Command::new(anthronet).args(arguments).output();
        let result = result.map_err(Error::from).and_then(|output| {
            let said = String::from_utf8_lossy(&output.stderr);
            let expected = format!("this build has no networks: run `cargo anthronet-train {text}`");
            let right = output.status.code() == Some(2) && said.contains(&expected);
            right.then_some(()).with_context(|| format!("{}: {said}", output.status))
        });
        tally.case(&format!("without networks: {text}"), result);
    }
}

/// The same request gives the same bytes, whatever the number of threads, and the bytes of the golden.
fn same_bytes(anthronet: &Path, folder: &Path, tally: &mut Tally) -> Result<()> {
    let golden = bless::golden()?;
    for person in PEOPLE {
        let hash = |threads| -> Result<String> {
            let file = folder.join(format!("{}_{threads}_threads.glb", person.name));
            generate(anthronet, person.arguments, &file, Some(threads))?;
            bless::hash(&file)
        };
        let hashes = [1, 2, 8].into_iter().map(hash).collect::<Result<Vec<_>>>();
        let hashes = match hashes {
            Ok(hashes) => hashes,
            Err(why) => {
                tally.case(&format!("generate {}", person.name), Err(why));
                continue;
            }
        };
        let same = hashes.iter().all(|hash| *hash == hashes[0]);
        let differ = || format!("1, 2 and 8 threads gave {}", hashes.join(", "));
        tally.case(
            &format!("same bytes over threads: {}", person.name),
            same.then_some(()).with_context(differ),
        );

        let name = format!("same bytes as the golden: {}", person.name);
        match golden.as_ref().map(|golden| golden.get(person.name)) {
            None => tally.skip(&name, "tests/golden/hashes.json is missing, `cargo xtask bless` writes it"),
            Some(None) => tally.case(&name, Err(anyhow!("not in tests/golden/hashes.json"))),
            Some(Some(expected)) => {
                let differs = || format!("expected {expected}, got {}", hashes[0]);
                tally.case(&name, (*expected == hashes[0]).then_some(()).with_context(differs));
            }
        }
    }
    Ok(())
}

/// One file of every kind: all people, all levels of detail, both numbers of influences, both containers.
fn files(anthronet: &Path, folder: &Path, tally: &mut Tally) -> Vec<PathBuf> {
    let mut wanted: Vec<(String, Vec<&str>)> = Vec::new();
    for person in PEOPLE {
        for lod in ["0", "1", "2", "3"] {
            let arguments = [person.arguments, &["--lod", lod]].concat();
            wanted.push((format!("{}_lod{lod}.glb", person.name), arguments));
        }
        let arguments = [person.arguments, &["--influences", "8"]].concat();
        wanted.push((format!("{}_8_influences.glb", person.name), arguments));
    }
    wanted.push(("readme.gltf".to_owned(), requests::README.to_vec()));
    let mut files = Vec::new();
    for (name, arguments) in wanted {
        let file = folder.join(&name);
        match generate(anthronet, &arguments, &file, None) {
            Ok(()) => files.push(file),
            Err(why) => tally.case(&format!("generate {name}"), Err(why)),
        }
    }
    files
}

/// The Khronos validator, numpy and scipy, three.js, Blender.
fn in_other_programs(fixture: Fixture<'_>, files: &[PathBuf], tally: &mut Tally) -> Result<()> {
    let Fixture { anthronet, environment, folder } = fixture;
    match environment.node_script("validate.mjs") {
        Ok(mut command) => tally.script("Khronos glTF validator", command.args(files)),
        Err(reason) => tally.skip("Khronos glTF validator", &reason),
    }
    if let Err(reason) = &environment.python {
        for name in ["measures by numpy and scipy", "three.js", "Blender"] {
            tally.skip(name, reason);
        }
        return Ok(());
    }
    let python = |script| environment.python_script(script);
    tally.script("measures by numpy and scipy", python("measure_glb.py")?.arg(anthronet).arg(folder));

    // The reference for the two programs below, once per file.
    for (stem, arguments) in [
        ("posed_4", [requests::README, &["--influences", "4"]].concat()),
        ("posed_8", [requests::README, &["--influences", "8"]].concat()),
    ] {
        let file = folder.join(format!("{stem}.glb"));
        if let Err(why) = generate(anthronet, &arguments, &file, None) {
            tally.case(&format!("generate {stem}.glb"), Err(why));
            continue;
        }
        tally.script(&format!("reference skinning of {stem}.glb"), python("pose_reference.py")?.arg(&file));
        // three.js reads no more than four influences.
        if stem == "posed_4" {
            match environment.node_script("threejs.mjs") {
                Ok(mut command) => tally.script("three.js", command.arg(&file)),
                Err(reason) => tally.skip("three.js", &reason),
            }
        }
        let name = format!("Blender, {stem}.glb");
        match &environment.blender {
            Ok(()) => {
                let picture = (stem == "posed_4").then(|| folder.join("blender.png"));
                tally.script(&name, python("blender_import.py")?.arg(&file).args(picture));
            }
            Err(reason) => tally.skip(&name, reason),
        }
    }
    Ok(())
}
