//! `anthronet animate`: clips for an existing character file.

use std::path::PathBuf;

use anthronet::format::{Purpose, read_scene};
use anthronet::skeleton::humanoid::JointNames;
use clap::Args;

use crate::choice;
use crate::failure::{Failure, Result};
use crate::file_set::FileSet;
use crate::files::{check_extension, extensions, write_scene};
use crate::motion::{MotionArguments, add_clips, rename_joints};

/// Add clips to a character that `anthronet generate` made.
///
/// The motion may come from any humanoid skeleton: joints are matched by name, or by position when the names are
/// unknown. Clips that the file already has are kept.
#[derive(Args)]
#[command(after_help = "Examples:\n  \
    anthronet animate anna.glb --clip walk -o walking.glb\n  \
    anthronet animate anna.glb --clip dance.bvh --clip wave.fbx --fps 24 -o moves.usdc\n  \
    anthronet animate anna.glb --clip run.bvh --in-place --loop --motion-report - -o run.glb")]
pub(crate) struct Arguments {
    /// The character: a .glb, .gltf, .usd, .usda, .usdc or .usdz with AnthroNet's skeleton.
    input: PathBuf,

    #[command(flatten)]
    motion: MotionArguments,

    /// The file to write, also the input itself; its extension chooses the format: .glb, .gltf, .vrma (skeleton and
    /// clips), .usda, .usdc or .usdz.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    output: PathBuf,

    /// Naming scheme of the joints; by default that of the input.
    #[arg(long, value_parser = choice::joint_names())]
    joint_names: Option<JointNames>,

    /// Write a .glb or .gltf with EXT_meshopt_compression.
    #[arg(long)]
    compress: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    check_extension("-o", &arguments.output, &extensions(Purpose::WriteScene))?;
    arguments.motion.check(&arguments.output, None)?;
    if arguments.motion.clips.is_empty() {
        return Err(Failure::usage("--clip: expected at least one clip, got none"));
    }
    let files = FileSet::default().converts(&arguments.input, "-o", &arguments.output);
    arguments.motion.add_files(files).check()?;
    let mut scene = read_scene(&arguments.input)?;
    if let Some(names) = arguments.joint_names {
        rename_joints(&mut scene, names)?;
    }
    add_clips(&mut scene, &arguments.motion)?;
    write_scene(&scene, &arguments.output, arguments.compress)
}
