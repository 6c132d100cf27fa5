//! `anthronet preview`: a shaded picture of a character.

use std::path::PathBuf;

use clap::Args;

use crate::backend::{self, Model};
use crate::failure::{Failure, Result};
use crate::render::{LitFigure, View, draw_views};
use crate::request::{RequestArguments, check_ending, dotted, ending};
use crate::units::parse_size;

/// Directions that the light is gathered from.
const QUALITY: usize = 256;

/// Draw a character from several sides into a PNG.
///
/// The views stand side by side at one scale. The picture has the same bytes on every machine.
#[derive(Args)]
#[command(after_help = "Examples:\n  \
    anthronet preview anna.glb -o anna.png\n  \
    anthronet preview request.json -o person.png --size 2400x1000\n  \
    anthronet preview anna.glb -o head.png --views face,face-three-quarter,profile")]
pub(crate) struct Arguments {
    /// A .glb, .gltf, .vrm, .usda, .usdc, .usdz or .obj, or a .json request to generate first.
    input: PathBuf,

    /// The picture to write, a .png.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    output: PathBuf,

    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "1600x720", value_parser = parse_size)]
    size: (usize, usize),

    /// What to show, from left to right, separated by commas.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "front,side,back")]
    views: Vec<View>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    check_ending("-o", &arguments.output, &["png"])?;
    if arguments.views.len() > 16 {
        return Err(Failure::usage(format!("--views: expected at most 16, got {}", arguments.views.len())));
    }
    let figure = match ending(&arguments.input).as_str() {
        "json" => {
            let from = RequestArguments { request: Some(arguments.input.clone()), ..Default::default() };
            let request = backend::request(&from)?;
            Model::open()?.generate(&request, &from)?.figure(0, None)?
        }
        ending if backend::surface_endings().contains(&ending) => {
            backend::figure_from_file(&arguments.input)?
        }
        _ => {
            let (input, known) = (arguments.input.display(), dotted(&backend::surface_endings()));
            return Err(Failure::usage(format!("{input}: unknown ending, expected one of {known} .json")));
        }
    };
    let (width, height) = arguments.size;
    let image = draw_views(&LitFigure::new(figure, QUALITY), &arguments.views, width, height);
    backend::write(&arguments.output, &image.to_png()?)
}
