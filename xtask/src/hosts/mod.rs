//! The cross-boundary tests: files of the released command in third-party programs.
//!
//! The scripts lie in `tests/`. A script prints one line per case, `ok NAME`, `FAILED NAME: why` or
//! `skipped NAME: why`; other lines are for the reader. The tests of the Python package run under pytest, with the same
//! output from `tests/python/conftest.py`.
//!
//! All parts together run two at a time ([`lanes`]), after what several of them use is made ([`prepare`]). Parts write to
//! different files.

mod animation;
mod blender;
mod c;
mod cpp;
mod files;
mod lanes;
mod morph;
mod motion;
mod pose;
mod python;
mod skin;
mod tally;
mod unity;
mod usd;

use crate::environment::{self, Environment};
use crate::package;
use crate::test::Part;
use crate::tools::{self, Available, cargo};
use anyhow::{Result, anyhow, bail};
pub(crate) use lanes::beside;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;
use tally::Tally;

/// What the tests of most parts work with.
#[derive(Clone, Copy)]
pub(crate) struct Fixture<'a> {
    /// The released command.
    anthronet: &'a Path,
    /// The other programs.
    environment: &'a Environment,
    /// Where to write.
    folder: &'a Path,
}

/// The longest first, so that both lanes end at about the same time.
const PARTS: [Part; 8] =
    [Part::C, Part::Blender, Part::Files, Part::Python, Part::Rust, Part::Unity, Part::Cpp, Part::Motion];

/// All parts; with the Rust tests, which are built already, if `rust`.
pub(crate) fn run(rust: bool) -> Result<()> {
    println!("cross-boundary tests{}", if rust { " and Rust tests" } else { "" });
    let parts: Vec<_> = PARTS.into_iter().filter(|part| rust || *part != Part::Rust).collect();
    tools::remove_folder(&folder())?;
    let mut tally = Tally::default();
    let start = Instant::now();
    prepare(&parts, &mut tally)?;
    println!("prepared in {:.1} s", start.elapsed().as_secs_f64());
    lanes::run(&parts, &folder().join("logs"), &mut tally)?;
    close(&tally)
}

/// One of the cross-boundary tests. `prepared`: what it uses is there already.
pub(crate) fn run_part(part: Part, prepared: bool) -> Result<()> {
    let mut tally = Tally::default();
    if !prepared {
        prepare(&[part], &mut tally)?;
    }
    let (anthronet, folder, tally) = (tools::command_path(), folder(), &mut tally);
    let with_fixture = |tests: &[fn(Fixture<'_>, &mut Tally) -> Result<()>], tally: &mut Tally| {
        let environment = environment::prepare()?;
        let fixture = Fixture { anthronet: &anthronet, environment: &environment, folder: &folder };
        tests.iter().try_for_each(|run| run(fixture, tally))
    };
    match part {
        Part::Files => {
            with_fixture(&[files::run, skin::run, animation::run, usd::run, pose::run, morph::run], tally)?;
        }
        Part::Cpp => with_fixture(&[cpp::run], tally)?,
        Part::Python => with_fixture(&[python::run], tally)?,
        Part::Blender => with_fixture(&[blender::run], tally)?,
        Part::C => c::run(&environment::c_programs(), &folder, tally)?,
        Part::Unity => unity::run(&folder, tally)?,
        Part::Motion => motion::run(&anthronet, tally),
        Part::Check | Part::Rust | Part::Hosts | Part::Release => {
            bail!("not one of the cross-boundary tests")
        }
    }
    close(tally)
}

/// Where the parts write.
fn folder() -> PathBuf {
    tools::target().join("test-env/out")
}

/// Makes what these parts use, so that none of them waits for another's build, and no two install or write the same.
fn prepare(parts: &[Part], tally: &mut Tally) -> Result<()> {
    let any = |some: &[Part]| parts.iter().any(|part| some.contains(part));
    tools::create_folder(&folder())?;
    prepare_release(parts, tally)?;
    if any(&[Part::Files]) {
        // With the packages, features and profile of the unit tests, which have built them by now. If that fails the part
        // reports it.
        let examples = ["--example", "skin_dump", "--example", "morph_dump"];
        let _ = tools::run(cargo("build").args(tools::EVERYTHING).args(examples));
    }
    if any(&[Part::C, Part::Cpp, Part::Python, Part::Unity]) {
        c::byte_lists(tally);
    }
    Ok(())
}

/// What all parts use of the release; the rest needs the development build.
pub(crate) fn release() -> Result<()> {
    let mut tally = Tally::default();
    prepare_release(&PARTS, &mut tally)?;
    if tally.failed == 0 { Ok(()) } else { close(&tally) }
}

/// What these parts use that is built in cargo's folder for releases, and what is installed.
fn prepare_release(parts: &[Part], tally: &mut Tally) -> Result<()> {
    let any = |some: &[Part]| parts.iter().any(|part| some.contains(part));
    if any(&[Part::Files, Part::Cpp, Part::Python, Part::Blender, Part::Motion]) {
        tools::command_line()?;
    }
    if any(&[Part::C, Part::Cpp, Part::Python, Part::Unity, Part::Blender]) {
        package::library()?;
    }
    if any(&[Part::Cpp]) {
        // If that fails the part reports it.
        let _ = package::build_cpp();
    }
    // The system's packages are installed by one process at a time. The parts say why something is missing.
    if any(&[Part::Unity]) {
        let _ = environment::mono();
    }
    if any(&[Part::C, Part::Unity]) {
        let _ = environment::c_programs();
    }
    if any(&[Part::Files, Part::Cpp, Part::Python, Part::Blender]) {
        let environment = environment::prepare()?;
        if any(&[Part::Blender]) {
            let _ = environment.blenders();
        }
        if let (true, Ok(python)) = (any(&[Part::Python, Part::Blender]), &environment.python)
            && let Err(why) = package::package_python(python)
        {
            tally.case("the Python wheel is built", Err(why));
        }
    }
    Ok(())
}

/// Renders the picture of the Blender extension into a folder.
pub(crate) fn blender_picture(folder: &Path) -> Result<Available<PathBuf>> {
    blender::picture(&tools::command_line()?, &environment::prepare()?, folder)
}

/// Prints the counts.
fn close(tally: &Tally) -> Result<()> {
    println!("{tally}");
    match tally.failed {
        0 => Ok(()),
        n => Err(anyhow!("{n} tests failed")),
    }
}

/// `anthronet generate` with these arguments into a file.
fn generate(anthronet: &Path, arguments: &[&str], file: &Path, threads: Option<u32>) -> Result<()> {
    let mut command = Command::new(anthronet);
    // Paths of motion files are relative to the root.
    command.current_dir(tools::root()).arg("generate").args(arguments).arg("-o").arg(file);
    if let Some(threads) = threads {
        command.env("RAYON_NUM_THREADS", threads.to_string());
    }
    tools::output(&mut command).map(drop)
}
