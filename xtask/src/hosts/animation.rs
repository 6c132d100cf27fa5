//! Animated glTF, plain and compressed, and VRM in third-party programs.

use super::{Fixture, Tally};
use crate::environment::Environment;
use crate::requests;
use crate::tools;
use anyhow::{Context as _, Result, anyhow};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Time limit for Godot to import one character.
const GODOT_LIMIT: Duration = Duration::from_secs(120);

/// The Khronos validator, numpy, three.js, three-vrm, Blender and Godot over files of `anthronet`.
pub(crate) fn run(fixture: Fixture<'_>, tally: &mut Tally) -> Result<()> {
    let Fixture { anthronet, environment, folder } = fixture;
    let mut made = Vec::new();
    let clips = ["--clip", "walk", "--clip", "wave", "--clip", requests::BVH];
    for (name, arguments) in [
        ("animated.glb", &clips[..]),
        ("animated_meshopt.glb", &[&clips[..], &["--compress"]].concat()),
        ("figure.vrm", &[]),
    ] {
        let file = folder.join(name);
        let arguments = [requests::README, arguments].concat();
        match super::generate(anthronet, &arguments, &file, None) {
            Ok(()) => made.push(file),
            Err(why) => tally.case(&format!("generate {name}"), Err(why)),
        }
    }
    let [plain, compressed, figure] = made.as_slice() else { return Ok(()) };
    same_again(anthronet, plain, tally);

    match environment.node_script("validate.mjs") {
        Ok(mut command) => {
            tally.script("Khronos glTF validator, animations", command.args([plain, compressed, figure]));
        }
        Err(reason) => tally.skip("Khronos glTF validator, animations", &reason),
    }
    match environment.node_script("vrm.mjs") {
        Ok(mut command) => tally.script("three-vrm", command.arg(figure)),
        Err(reason) => tally.skip("three-vrm", &reason),
    }
    match environment.python_script("animation_reference.py") {
        Ok(mut command) => {
            tally.script("reference of the animations", command.arg(plain));
            in_viewers(environment, plain, compressed, tally)?;
        }
        Err(reason) => tally.skip("animations in three.js and Blender", &reason),
    }
    match &environment.godot {
        Ok(godot) => in_godot(godot, plain, folder, tally)?,
        Err(reason) => tally.skip("Godot", reason),
    }
    Ok(())
}

/// Converting a file to its own format gives the same bytes.
fn same_again(anthronet: &Path, file: &Path, tally: &mut Tally) {
    let again = file.with_extension("again.glb");
    let mut command = Command::new(anthronet);
    let converted = tools::output(command.arg("convert").arg(file).arg(&again));
    let compared = converted.and_then(|_| {
        let [a, b] = [file, &again].map(|f| std::fs::read(f).with_context(|| f.display().to_string()));
        if a? == b? { Ok(()) } else { Err(anyhow!("the bytes differ")) }
    });
    tally.case("convert to the same format gives the same bytes", compared);
}

fn in_viewers(environment: &Environment, plain: &Path, compressed: &Path, tally: &mut Tally) -> Result<()> {
    for file in [plain, compressed] {
        let name = format!("three.js plays {}", file.file_name().unwrap_or_default().display());
        match environment.node_script("animation_threejs.mjs") {
            Ok(mut command) => tally.script(&name, command.arg(file).arg(plain)),
            Err(reason) => tally.skip(&name, &reason),
        }
    }
    let blender = environment.blender.clone();
    match blender.and_then(|()| environment.python_script("animation_blender.py")) {
        Ok(mut command) => tally.script("Blender plays", command.arg(plain)),
        Err(reason) => tally.skip("Blender plays", &reason),
    }
    Ok(())
}

/// Godot imports the file as a resource of a project, and a script checks it there.
fn in_godot(godot: &Path, file: &Path, folder: &Path, tally: &mut Tally) -> Result<()> {
    let project = folder.join("godot");
    tools::create_folder(&project)?;
    for name in ["project.godot", "check.gd", "figure.glb.import"] {
        let text = tools::read(&tools::root().join("tests/godot").join(name))?;
        tools::write(&project.join(name), &text)?;
    }
    tools::copy(file, &project.join("figure.glb"))?;
    let expected = PathBuf::from(format!("{}.expected.json", file.display()));
    tools::copy(&expected, &project.join("expected.json"))?;
    tally.case("Godot imports", import(godot, &project));
    tally.script("Godot", Command::new(godot).arg("--path").arg(&project).args(["--script", "check.gd"]));
    Ok(())
}

/// Opens the project in the editor until the character is imported. Debian's build of the editor never exits by itself: on
/// quitting it repeats an error endlessly.
fn import(godot: &Path, project: &Path) -> Result<()> {
    let mut command = Command::new(godot);
    command.arg("--path").arg(project).args(["--editor", "--quit"]);
    let mut editor = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .context("did not start")?;
    let start = Instant::now();
    // The last file that the import writes.
    let imported = || -> Option<PathBuf> {
        let mut files = std::fs::read_dir(project.join(".import")).ok()?.flatten().map(|entry| entry.path());
        files.find(|path| path.extension().is_some_and(|extension| extension == "md5"))
    };
    let done = loop {
        let ended = editor.try_wait()?.is_some();
        if imported().is_some() || ended || start.elapsed() > GODOT_LIMIT {
            break imported();
        }
        std::thread::sleep(Duration::from_millis(100));
    };
    // It may have exited in the meantime.
    let _ = editor.kill();
    editor.wait()?;
    done.map(drop).with_context(|| format!("not imported after {:.0} s", start.elapsed().as_secs_f64()))
}
