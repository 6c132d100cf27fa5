//! Outputs that are one file under two names, or an input, are refused before anything is written.

mod common;

use std::fs;
use std::path::Path;
use std::process::Command;

use common::{Run, folder, write};

/// Runs the command in a folder.
fn within(folder: &Path, arguments: &[&str]) -> Run {
    let mut command = Command::new(env!("CARGO_BIN_EXE_anthronet"));
    common::run(command.args(arguments).current_dir(folder).env_remove("ANTHRONET_MODEL"))
}

/// Names and bytes of the files of a folder.
fn content(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let names = common::files_in(folder).into_iter().filter(|name| folder.join(name).is_file());
    names.map(|name| (name.clone(), fs::read(folder.join(name)).expect("a file"))).collect()
}

#[test]
fn two_names_of_one_file_are_refused() {
    let folder = folder();
    let here = folder.path();
    write(&folder, "r.json", br#"{"sex": "male"}"#);
    write(&folder, "a.bin", br#"{"sex": "male"}"#);
    write(&folder, "m.bvh", b"HIERARCHY\n");
    fs::create_dir(here.join("d")).unwrap();
    within(here, &["generate", "--lod", "3", "-o", "p.gltf"]).succeeds();
    within(here, &["generate", "--lod", "3", "--clip", "walk", "-o", "p.usda"]).succeeds();
    let before = content(here);
    let generate = ["generate", "--lod", "3", "--clip", "walk", "-o"];
    for (name, options) in [
        ("./a.glb", &["a.glb", "--report", "./a.glb"][..]),
        ("a.glb", &["d/../a.glb", "--motion-report", "a.glb"]),
        ("a.bin", &["a.gltf", "--report", "a.bin"]),
        ("r.json", &["a.glb", "--report", "q.json", "--motion-report", "d/../q.json"]),
        ("r.json", &["a.glb", "--request", "r.json", "--report", "./r.json"]),
        ("a.bin", &["a.gltf", "--request", "a.bin"]),
        ("r.json", &["a.glb", "--interpolate", "r.json", "--at", "0.5", "--report", "r.json"]),
        ("m.bvh", &["a.glb", "--clip", "m.bvh", "--report", "m.bvh"]),
        ("r.json", &["a.glb", "--clip", "m.bvh", "--mapping", "r.json", "--motion-report", "r.json"]),
        ("p.bin", &["a.glb", "--clip", "p.gltf", "--motion-report", "p.bin"]),
    ] {
        let name = if options.contains(&"q.json") { "q.json" } else { name };
        within(here, &[&generate[..], options].concat()).fails(2, &[name, "is the same file as"]);
    }
    for arguments in [
        &["animate", "p.gltf", "--clip", "walk", "-o", "q.glb", "--motion-report", "p.bin"][..],
        &["animate", "p.gltf", "--clip", "p.gltf", "-o", "p.gltf"],
        &["convert", "p.gltf", "d/../p.gltf"],
        &["convert", "p.usda", "./p.usda"],
    ] {
        within(here, arguments).fails(2, &["is the same file as"]);
    }
    assert_eq!(content(here), before);
    // A character may be changed in place.
    within(here, &["convert", "p.gltf", "p.gltf", "--joint-names", "unity"]).succeeds();
}

#[cfg(unix)]
#[test]
fn links_are_followed() {
    use std::os::unix::fs::symlink;
    let folder = folder();
    let here = folder.path();
    write(&folder, "old.glb", b"old");
    symlink("old.glb", here.join("soft.glb")).unwrap();
    symlink("new.glb", here.join("dangling.glb")).unwrap();
    symlink("x.gltf", here.join("x.bin")).unwrap();
    fs::hard_link(here.join("old.glb"), here.join("hard.glb")).unwrap();
    let before = content(here);
    for (output, report) in
        [("old.glb", "soft.glb"), ("soft.glb", "hard.glb"), ("new.glb", "dangling.glb"), ("x.gltf", "r.json")]
    {
        within(here, &["generate", "--lod", "3", "-o", output, "--report", report])
            .fails(2, &["is the same file as"]);
    }
    assert_eq!(content(here), before);
}
