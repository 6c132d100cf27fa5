//! `anthronet animate`: a character file of ours, with motion.

use std::path::PathBuf;

use clap::Args;

use crate::backend;
use crate::failure::{Failure, Result};
use crate::generate::JointNamesChoice;
use crate::motion::MotionArguments;
use crate::request::check_ending;

/// Put motion onto a character that `anthronet generate` made.
///
/// The motion may come from any skeleton of a person: joints are matched by their names, or by where they are when
/// the names are unknown. Motions that the file holds already stay.
#[derive(Args)]
#[command(after_help = "Examples:\n  \
    anthronet animate anna.glb --clip walk -o walking.glb\n  \
    anthronet animate anna.glb --clip dance.bvh --clip wave.fbx --fps 24 -o moves.usdc\n  \
    anthronet animate anna.glb --clip run.bvh --in-place --loop --motion-report - -o run.glb")]
pub(crate) struct Arguments {
    /// The character: a .glb or .gltf, or a .usda, .usdc or .usdz, with our skeleton.
    input: PathBuf,

    #[command(flatten)]
    motion: MotionArguments,

    /// The file to write; its ending chooses the format: .glb, .gltf, .usda, .usdc or .usdz.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    output: PathBuf,

    /// What the joints are called; left out, as in the input.
    #[arg(long)]
    joint_names: Option<JointNamesChoice>,

    /// Write a .glb or .gltf with EXT_meshopt_compression.
    #[arg(long)]
    compress: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    check_ending("-o", &arguments.output, &backend::written_endings())?;
    arguments.motion.check(&arguments.output)?;
    if arguments.motion.clips.is_empty() {
        return Err(Failure::usage("--clip: expected at least one motion, got none"));
    }
    let mut scene = backend::motion::open(&arguments.input)?;
    if let Some(names) = arguments.joint_names {
        backend::motion::rename_joints(&mut scene, names);
    }
    backend::motion::animate(&mut scene, &arguments.motion)?;
    backend::write_scene(&scene, &arguments.output, arguments.compress)
}
