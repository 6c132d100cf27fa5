//! `anthronet convert`: a character file in another format.

use std::path::PathBuf;

use anthronet::format::{Purpose, read_scene};
use anthronet::skeleton::humanoid::JointNames;
use clap::Args;

use crate::choice;
use crate::failure::Result;
use crate::file_set::FileSet;
use crate::files::{check_extension, extension, extensions, holds_meshes, holds_motion, write_scene};
use crate::motion::rename_joints;

/// Convert a character file to another format, with its skin, joints, materials and clips.
#[derive(Args)]
#[command(after_help = "Examples:\n  \
    anthronet convert walking.glb walking.usdz\n  \
    anthronet convert anna.usdc anna.vrm\n  \
    anthronet convert anna.glb unity.glb --joint-names unity")]
pub(crate) struct Arguments {
    /// The character: .glb, .gltf, .vrm, .usd, .usda, .usdc or .usdz.
    input: PathBuf,

    /// The file to write, also the input itself; its extension chooses the format: .glb, .gltf, .vrm, .vrma (skeleton
    /// and clips), .usda, .usdc, .usdz or .obj.
    output: PathBuf,

    /// Naming scheme of the joints; by default that of the input.
    #[arg(long, value_parser = choice::joint_names())]
    joint_names: Option<JointNames>,

    /// Write a .glb or .gltf with EXT_meshopt_compression.
    #[arg(long)]
    compress: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    check_extension("OUTPUT", &arguments.output, &extensions(Purpose::WriteScene))?;
    FileSet::default().converts(&arguments.input, "OUTPUT", &arguments.output).check()?;
    let mut scene = read_scene(&arguments.input)?;
    if let Some(names) = arguments.joint_names {
        rename_joints(&mut scene, names)?;
    }
    if !holds_motion(&arguments.output) && !scene.clips.is_empty() {
        eprintln!(
            "warning: {}: the format holds no motion, the clips are left out",
            arguments.output.display()
        );
        scene.clear_clips();
    }
    if scene.pose.is_some() && ["vrm", "vrma"].contains(&extension(&arguments.output).as_str()) {
        eprintln!(
            "warning: {}: the format demands the T-pose, the pose is left out",
            arguments.output.display()
        );
        scene.pose = None;
    }
    if !holds_meshes(&arguments.output) {
        eprintln!("warning: {}: the format holds no meshes, they are left out", arguments.output.display());
    }
    write_scene(&scene, &arguments.output, arguments.compress)
}
