//! `cargo xtask gen`: the bindings, and the pictures in `docs/`, made by the commands that a user has.

use crate::tools::{self, Outcome};
use crate::{bindings, hosts, requests};
use std::process::Command;

/// What can be generated alone.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Kind {
    /// The C header and the bindings of C# and Python
    Bindings,
    /// The pictures in docs
    Pictures,
}

pub(crate) fn run(only: Option<Kind>) -> Outcome {
    if only != Some(Kind::Pictures) {
        bindings::write()?;
    }
    if only != Some(Kind::Bindings) {
        pictures()?;
    }
    Ok(())
}

fn pictures() -> Outcome {
    let anthronet = tools::command_line()?;
    let root = tools::root();
    let scratch = tools::target().join("gen");
    for folder in [&scratch, &root.join("docs")] {
        std::fs::create_dir_all(folder).map_err(|e| format!("{}: cannot create: {e}", folder.display()))?;
    }
    let person = scratch.join("person.glb");
    tools::run(Command::new(&anthronet).arg("generate").args(requests::README).arg("-o").arg(&person))?;
    let person = person.to_string_lossy();
    let pictures: [(&[&str], &str); 3] = [
        (&["preview", &person], "docs/preview.png"),
        (&["contact-sheet"], "docs/people.png"),
        (&["contact-sheet", "--close", "--count", "10", "--columns", "1"], "docs/closeups.png"),
    ];
    for (arguments, picture) in pictures {
        let picture = root.join(picture);
        tools::run(Command::new(&anthronet).args(arguments).arg("-o").arg(&picture))?;
        if !picture.is_file() {
            return Err(format!("{}: the command succeeded and wrote nothing", picture.display()));
        }
    }
    match hosts::blender_picture(&scratch)? {
        Ok(picture) => {
            let copy = root.join("docs/blender.png");
            std::fs::copy(&picture, &copy).map_err(|e| format!("{}: cannot copy: {e}", picture.display()))?;
        }
        Err(reason) => println!("skipped docs/blender.png: {reason}"),
    }
    println!("look at the pictures in docs before you commit them");
    Ok(())
}
