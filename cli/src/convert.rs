//! `anthronet convert`: a character from one file format to another.

use std::path::PathBuf;

use clap::Args;

use crate::backend;
use crate::failure::Result;
use crate::generate::JointNamesChoice;
use crate::request::{check_ending, ending};

/// Write a character file in another format, with its skin, joints, materials and motions.
#[derive(Args)]
#[command(after_help = "Examples:\n  \
    anthronet convert walking.glb walking.usdz\n  \
    anthronet convert anna.usdc anna.vrm\n  \
    anthronet convert anna.glb unity.glb --joint-names unity")]
pub(crate) struct Arguments {
    /// The character: .glb, .gltf, .vrm, .usda, .usdc or .usdz.
    input: PathBuf,

    /// The file to write; its ending chooses the format: .glb, .gltf, .vrm, .usda, .usdc, .usdz or .obj.
    output: PathBuf,

    /// What the joints are called; left out, as in the input.
    #[arg(long)]
    joint_names: Option<JointNamesChoice>,

    /// Write a .glb or .gltf with EXT_meshopt_compression.
    #[arg(long)]
    compress: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    check_ending("OUTPUT", &arguments.output, &backend::written_endings())?;
    let mut scene = backend::motion::open(&arguments.input)?;
    if let Some(names) = arguments.joint_names {
        backend::motion::rename_joints(&mut scene, names);
    }
    if !backend::moving_endings().contains(&ending(&arguments.output).as_str()) && !scene.clips.is_empty() {
        eprintln!("warning: {}: the format holds no motion, left out", arguments.output.display());
        scene.clear_clips();
    }
    backend::write_scene(&scene, &arguments.output, arguments.compress)
}
