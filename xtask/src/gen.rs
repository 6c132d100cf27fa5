//! `cargo xtask gen`: the bindings, and the pictures in `docs/`, made with the command as users run it.

use crate::tools;
use crate::{bindings, hosts, requests};
use anyhow::{Result, bail};
use std::process::Command;

/// The kinds of generated files.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Kind {
    /// The C header and the bindings of C# and Python
    Bindings,
    /// The pictures in docs
    Pictures,
}

pub(crate) fn run(only: Option<Kind>) -> Result<()> {
    if only != Some(Kind::Pictures) {
        bindings::write()?;
    }
    if only != Some(Kind::Bindings) {
        pictures()?;
    }
    Ok(())
}

fn pictures() -> Result<()> {
    let anthronet = tools::command_line()?;
    let root = tools::root();
    let scratch = tools::target().join("gen");
    for folder in [&scratch, &root.join("docs")] {
        tools::create_folder(folder)?;
    }
    let person = scratch.join("person.glb");
    tools::run(Command::new(&anthronet).arg("generate").args(requests::README).arg("-o").arg(&person))?;
    // Small figures need no more than the cage.
    let small = scratch.join("small.glb");
    let lod = [requests::README, &["--lod", "1"]].concat();
    tools::run(Command::new(&anthronet).arg("generate").args(lod).arg("-o").arg(&small))?;
    let (person, small) = (person.to_string_lossy(), small.to_string_lossy());
    let pictures: [(&[&str], &str); 5] = [
        (&["preview", &person], "docs/preview.png"),
        (&["preview", &small, "--pose", "sitting", "--size", "900x420"], "docs/sitting.png"),
        (&["preview", &small, "--clip", "walk", "--views", "side", "--size", "960x560"], "docs/walk.png"),
        (&["contact-sheet"], "docs/people.png"),
        (&["contact-sheet", "--close", "--count", "10", "--columns", "1"], "docs/closeups.png"),
    ];
    for (arguments, picture) in pictures {
        let picture = root.join(picture);
        tools::run(Command::new(&anthronet).args(arguments).arg("-o").arg(&picture))?;
        if !picture.is_file() {
            bail!("{}: the command succeeded and wrote nothing", picture.display());
        }
    }
    match hosts::blender_picture(&scratch)? {
        Ok(picture) => {
            let copy = root.join("docs/blender.png");
            tools::copy(&picture, &copy)?;
        }
        Err(reason) => println!("skipped docs/blender.png: {reason}"),
    }
    println!("look at the pictures in docs before you commit them");
    Ok(())
}
