//! `anthronet preview`: a shaded picture of a character, still or moving.

mod moving;

use std::path::PathBuf;

use anthronet::format::{Purpose, read_scene, write_atomic};
use anthronet::mesh::Lod;
use anthronet::model::Model;
use anthronet::scene::{Scene, SceneOptions};
use clap::Args;

use crate::failure::{Failure, Result};
use crate::figure;
use crate::file_set::FileSet;
use crate::files::{check_extension, extension, extensions};
use crate::motion::MotionArguments;
use crate::pose::PoseArguments;
use crate::render::{LitFigure, View, draw_views};
use crate::request::RequestArguments;
use crate::units::parse_size;

/// Number of directions that light is gathered from.
const QUALITY: usize = 256;
/// Size of a still picture without `--size`, pixels.
const SIZE: (usize, usize) = (1600, 720);

/// Draw a character from several sides, standing, in a pose or in motion.
///
/// A .png shows the character as its file stands, a pose, a moment of a motion, or several in a sheet; a .gif or .apng
/// plays the motion. Pictures of poses and motions have a grid on the floor and marks where heels (behind) and balls (in
/// front) of the feet stand, orange for the left foot, blue for the right: a foot that floats or slides has none. The
/// views are side by side at one scale. The picture has the same bytes on every machine.
#[derive(Args)]
#[command(after_help = "Examples:\n  \
    anthronet preview anna.glb -o anna.png\n  \
    anthronet preview request.json -o person.png --size 2400x1000\n  \
    anthronet preview anna.glb -o head.png --views face,face-three-quarter,profile\n  \
    anthronet preview anna.glb --clip dance.bvh -o dance.gif\n  \
    anthronet preview anna.glb --clip walk --frames 12 --views side -o walk.png\n  \
    anthronet preview walking.glb --time 0.5 -o moment.png\n  \
    anthronet preview anna.glb --pose sitting -o sitting.png")]
pub(crate) struct Arguments {
    /// A .glb, .gltf, .vrm, .usd, .usda, .usdc, .usdz or .obj, or a .json request to generate first.
    input: PathBuf,

    /// The picture to write: a .png, or a .gif or .apng that plays the motion.
    #[arg(short = 'o', long = "output", value_name = "FILE")]
    output: PathBuf,

    /// Width and height in pixels [default: 1600x720; 480x480 for what plays; 320x320 for each frame of a sheet].
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(usize, usize)>,

    /// Views from left to right, separated by commas [default: front,side,back; three-quarter for sheets and what plays].
    #[arg(long, value_enum, value_delimiter = ',')]
    views: Vec<View>,

    #[command(flatten)]
    pose: PoseArguments,

    #[command(flatten)]
    moments: Moments,

    #[command(flatten)]
    motion: MotionArguments,
}

/// Which moments of a motion are shown.
#[derive(Args, Clone, Copy, Debug, Default)]
#[command(next_help_heading = "Moments")]
struct Moments {
    /// One moment of the motion: seconds from its start. Without --clip, the motion is the first of the file.
    #[arg(long, value_name = "SECONDS", conflicts_with_all = ["frame", "frames"])]
    time: Option<f64>,

    /// One frame of the motion, from 0.
    #[arg(long, value_name = "N", conflicts_with = "frames")]
    frame: Option<usize>,

    /// Number of moments, evenly spaced over the motion: frames of a .gif or .apng, which otherwise has 20 a second, or
    /// of a sheet, which otherwise has 8.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=600))]
    frames: Option<u16>,

    /// Follow the character over the ground instead of showing all the way that it goes.
    #[arg(long)]
    follow: bool,
}

impl Moments {
    /// The option that was given, if any.
    fn given(&self) -> Option<&'static str> {
        let options = [
            ("--time", self.time.is_some()),
            ("--frame", self.frame.is_some()),
            ("--frames", self.frames.is_some()),
            ("--follow", self.follow),
        ];
        options.into_iter().find(|(_, given)| *given).map(|(option, _)| option)
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    check_extension("-o", &arguments.output, &["png", "gif", "apng"])?;
    if arguments.views.len() > 16 {
        return Err(Failure::usage(format!("--views: expected at most 16, got {}", arguments.views.len())));
    }
    arguments.check_motion()?;
    let files = FileSet::default().model().reads("", Some(&arguments.input));
    let files = arguments.pose.add_files(arguments.own_clips_apart().add_files(files));
    files.writes("-o", Some(&arguments.output)).check()?;
    if arguments.moves() || arguments.pose.pose.is_some() {
        return moving::draw(arguments);
    }
    let figure = match extension(&arguments.input).as_str() {
        "json" => figure::from_scene(&arguments.generated(Lod::Lod0)?)?,
        _ => {
            check_extension(
                "",
                &arguments.input,
                &[&extensions(Purpose::ReadMeshes)[..], &["json"]].concat(),
            )?;
            figure::from_file(&arguments.input)?
        }
    };
    let (width, height) = arguments.size.unwrap_or(SIZE);
    let views = arguments.views(&[View::Front, View::Side, View::Back]);
    let image = draw_views(&LitFigure::new(figure, QUALITY), views, width, height);
    Ok(write_atomic(&arguments.output, &image.to_png()?)?)
}

impl Arguments {
    /// Whether the picture is of a motion.
    fn moves(&self) -> bool {
        !self.motion.clips.is_empty() || self.moments.given().is_some() || self.plays()
    }

    /// Whether the file plays.
    fn plays(&self) -> bool {
        extension(&self.output) != "png"
    }

    fn views<'a>(&'a self, default: &'a [View]) -> &'a [View] {
        if self.views.is_empty() { default } else { &self.views }
    }

    /// Refuses options that contradict each other.
    fn check_motion(&self) -> Result<()> {
        if self.motion.clips.len() > 1 {
            let got = self.motion.clips.len();
            return Err(Failure::usage(format!("--clip: expected one for a picture, got {got}")));
        }
        self.motion.check_sources(self.pose.moving_source())?;
        self.pose.check_source()?;
        if self.pose.pose.is_some() && self.moves() {
            let other = if self.motion.clips.is_empty() { self.moments.given() } else { Some("--clip") };
            let other = other.unwrap_or("a file that plays");
            return Err(Failure::usage(format!(
                "--pose: expected without {other}, a picture shows one of them"
            )));
        }
        let one = [("--time", self.moments.time.is_some()), ("--frame", self.moments.frame.is_some())];
        if let Some((option, _)) = one.iter().find(|(_, given)| *given && self.plays()) {
            let extension = extension(&self.output);
            return Err(Failure::usage(format!(
                "{option}: shows one moment, expected a .png, got a .{extension}"
            )));
        }
        let still = self.pose.pose.is_none() && !self.moves();
        match self.views.iter().find(|view| view.is_head()) {
            Some(view) if !still => {
                let view = format!("{view:?}").to_lowercase();
                Err(Failure::usage(format!(
                    "--views: {view} shows a head, expected whole bodies of a pose or motion"
                )))
            }
            _ => Ok(()),
        }
    }

    /// The motion options without clips that are not files: names of clips in the character's own file.
    fn own_clips_apart(&self) -> MotionArguments {
        let mut motion = self.motion.clone();
        motion.clips.retain(|clip| std::path::Path::new(clip).exists());
        motion
    }

    /// The body of the request that is the input.
    fn generated(&self, lod: Lod) -> Result<Scene> {
        let from = RequestArguments { request: Some(self.input.clone()), ..Default::default() };
        let request = from.to_request()?;
        let model = Model::from_environment()?;
        let body = model.generate(&request).map_err(|error| from.failure(error))?;
        Ok(Scene::from_body(&body, &SceneOptions { lod, ..SceneOptions::default() })?)
    }

    /// The character with its joints.
    fn character(&self, lod: Lod) -> Result<Scene> {
        if extension(&self.input) == "json" {
            return self.generated(lod);
        }
        check_extension("", &self.input, &[&extensions(Purpose::ReadScene)[..], &["json"]].concat())?;
        Ok(read_scene(&self.input)?)
    }
}
