//! `anthronet preview`: a shaded picture of a character.

use std::path::PathBuf;

use anthronet::format::{Purpose, write_atomic};
use anthronet::model::Model;
use anthronet::scene::{Scene, SceneOptions};
use clap::Args;

use crate::failure::{Failure, Result};
use crate::figure;
use crate::file_set::FileSet;
use crate::files::{check_extension, extension, extensions};
use crate::render::{LitFigure, View, draw_views};
use crate::request::RequestArguments;
use crate::units::parse_size;

/// Number of directions that light is gathered from.
const QUALITY: usize = 256;

/// Draw a character from several sides into a PNG.
///
/// The views are side by side at one scale. The picture has the same bytes on every machine.
#[derive(Args)]
#[command(after_help = "Examples:\n  \
    anthronet preview anna.glb -o anna.png\n  \
    anthronet preview request.json -o person.png --size 2400x1000\n  \
    anthronet preview anna.glb -o head.png --views face,face-three-quarter,profile")]
pub(crate) struct Arguments {
    /// A .glb, .gltf, .vrm, .usd, .usda, .usdc, .usdz or .obj, or a .json request to generate first.
    input: PathBuf,

    /// The picture to write, a .png.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    output: PathBuf,

    /// Width and height in pixels.
    #[arg(long, value_name = "WxH", default_value = "1600x720", value_parser = parse_size)]
    size: (usize, usize),

    /// Views from left to right, separated by commas.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "front,side,back")]
    views: Vec<View>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    check_extension("-o", &arguments.output, &["png"])?;
    if arguments.views.len() > 16 {
        return Err(Failure::usage(format!("--views: expected at most 16, got {}", arguments.views.len())));
    }
    let files = FileSet::default().model().reads("", Some(&arguments.input));
    files.writes("-o", Some(&arguments.output)).check()?;
    let figure = match extension(&arguments.input).as_str() {
        "json" => {
            let from = RequestArguments { request: Some(arguments.input.clone()), ..Default::default() };
            let request = from.to_request()?;
            let model = Model::from_environment()?;
            let body = model.generate(&request).map_err(|error| from.failure(error))?;
            figure::from_scene(&Scene::from_body(&body, &SceneOptions::default())?)?
        }
        _ => {
            check_extension(
                "",
                &arguments.input,
                &[&extensions(Purpose::ReadMeshes)[..], &["json"]].concat(),
            )?;
            figure::from_file(&arguments.input)?
        }
    };
    let (width, height) = arguments.size;
    let image = draw_views(&LitFigure::new(figure, QUALITY), &arguments.views, width, height);
    Ok(write_atomic(&arguments.output, &image.to_png()?)?)
}
