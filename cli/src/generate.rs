//! `anthronet generate`: a person from measures, as a file.

use std::path::PathBuf;

use anthronet::condition::{Report, Request, refusal_json};
use anthronet::measure::MeasureId;
use anthronet::mesh::Lod;
use anthronet::model::Model;
use anthronet::scene::{Scene, SceneOptions, SkinTone};
use anthronet::skeleton::humanoid::JointNames;
use anthronet::{Body, Error};
use clap::Args;

use crate::choice;
use crate::failure::{Failure, InvalidValue, Result};
use crate::file_set::FileSet;
use crate::files::{check_extension, extensions, write_scene, write_text};
use crate::motion::{MotionArguments, add_clips};
use crate::pose::PoseArguments;
use crate::request::{RequestArguments, read_request};
use anthronet::format::Purpose;

/// Make a person from tape measures and write the rigged, skinned character to a file.
///
/// Give any subset of the measures. The body matches them exactly; the report lists how the others were filled in,
/// with the interval that contains 90 % of such people. The same request gives the same bytes on every machine.
#[derive(Args)]
#[command(after_help = "Examples:\n  \
    anthronet generate --sex female -m height=170cm -m waist_circumference=72cm -o anna.glb\n  \
    anthronet generate -m height=6ft1in -m chest_circumference=40in --joint-names mixamo -o bob.glb\n  \
    anthronet generate --sex male --fill sample --seed 7 --lod 1 -o someone.obj --report -\n  \
    anthronet generate --sex female -m height=170cm --clip walk --clip dance.bvh -o moves.glb\n  \
    anthronet generate --sex male -m height=182cm --pose sitting -o sitting.glb\n  \
    anthronet generate -m height=168cm --pose dance.bvh@1.5 --ground -o moment.obj\n  \
    anthronet generate --request slim.json --interpolate heavy.json --at 0.5 -o between.glb")]
pub(crate) struct Arguments {
    #[command(flatten)]
    request: RequestArguments,

    /// A second JSON request; the body is interpolated between the two (needs --at).
    #[arg(long, value_name = "FILE", requires = "at")]
    interpolate: Option<PathBuf>,

    /// Position between the two requests: 0 is the first, 1 the second.
    #[arg(long, value_name = "T", requires = "interpolate", value_parser = parse_share)]
    at: Option<f64>,

    /// Level of detail: 0 has 53,514 vertices, 1 has 13,380, 2 about a quarter of that, 3 a sixteenth.
    #[arg(long, default_value = "0", value_parser = choice::lod(), help_heading = "File")]
    lod: Lod,

    /// Maximum number of joint influences per vertex: 4 works everywhere, 8 deforms more smoothly where it is supported.
    #[arg(long, default_value = "4", value_parser = choice::influences(), help_heading = "File")]
    influences: usize,

    /// Naming scheme of the joints.
    #[arg(long, default_value = "native", value_parser = choice::joint_names(), help_heading = "File")]
    joint_names: JointNames,

    /// Skin colour: 1 (light) to 10 (dark) on the Monk scale, or #rrggbb.
    #[arg(long, value_name = "TONE", value_parser = parse_skin_tone, help_heading = "File")]
    skin_tone: Option<SkinTone>,

    #[command(flatten)]
    pose: PoseArguments,

    #[command(flatten)]
    motion: MotionArguments,

    /// The file to write; its extension chooses the format: .glb, .gltf (with a .bin beside it), .vrm, .vrma
    /// (skeleton and clips), .usda, .usdc, .usdz or .obj.
    #[arg(short = 'o', long = "output", value_name = "FILE", help_heading = "File")]
    output: PathBuf,

    /// Write a .glb or .gltf with EXT_meshopt_compression.
    #[arg(long, help_heading = "File")]
    compress: bool,

    /// Write the report of all measures as JSON, to a file or with `-` to standard output. It is also written when the
    /// request is refused as infeasible, and then lists the conflicting measures.
    #[arg(long, value_name = "FILE", help_heading = "File")]
    report: Option<PathBuf>,
}

fn parse_share(text: &str) -> std::result::Result<f64, InvalidValue> {
    match text.parse::<f64>() {
        Ok(t) if (0.0..=1.0).contains(&t) => Ok(t),
        _ => Err(InvalidValue::form("a number from 0 to 1", text)),
    }
}

fn parse_skin_tone(text: &str) -> std::result::Result<SkinTone, InvalidValue> {
    text.parse().map_err(|error| match error {
        // Without the field, as clap names the option.
        Error::Request { message, .. } => InvalidValue::Refused(message),
        other => InvalidValue::Refused(other.to_string()),
    })
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    check_extension("-o", &arguments.output, &extensions(Purpose::WriteScene))?;
    arguments.motion.check(&arguments.output, arguments.pose.moving_source())?;
    arguments.pose.check(&arguments.output)?;
    arguments.files().check()?;
    let request = arguments.request.to_request()?;
    let second = arguments.interpolate.as_deref().map(read_request).transpose()?;
    let model = Model::from_environment()?;
    let body = match arguments.body(&model, &request, second.as_ref()) {
        Ok(body) => body,
        Err(failure) => {
            let requests = [Some(&request), second.as_ref()];
            let refusal = requests.into_iter().flatten().find_map(|request| refusal(&model, request));
            if let (Some(path), Some(refusal)) = (&arguments.report, refusal) {
                write_text(path, &(refusal + "\n"))?;
            }
            return Err(failure);
        }
    };
    let mut scene = Scene::from_body(&body, &arguments.scene_options())?;
    scene.pose = arguments.pose.of(&scene, &arguments.motion)?;
    add_clips(&mut scene, &arguments.motion)?;
    write_scene(&scene, &arguments.output, arguments.compress)?;
    let report = body.report();
    if let Some(path) = &arguments.report {
        write_text(path, &(report.to_json() + "\n"))?;
    }
    for warning in &report.warnings {
        eprintln!("warning: {warning}");
    }
    let fit = match worst_residual(report) {
        Some((name, metres)) => format!("measures within {:.3} mm ({name})", metres * 1000.0),
        None if second.is_some() => "interpolated".to_owned(),
        None => "no measure given".to_owned(),
    };
    let height = report.measures[MeasureId::HEIGHT.index()].obtained;
    let (output, sex, mass) = (arguments.output.display(), report.sex, report.mass_kg);
    eprintln!("{output}: {sex}, {height:.3} m, {mass:.1} kg, {fit}");
    Ok(())
}

impl Arguments {
    fn files(&self) -> FileSet {
        let files = FileSet::default()
            .model()
            .reads("--request", self.request.request.as_deref())
            .reads("--interpolate", self.interpolate.as_deref())
            .writes_scene("-o", &self.output)
            .writes("--report", self.report.as_deref());
        self.pose.add_files(self.motion.add_files(files))
    }

    /// The body of a request, or of an interpolation between two.
    fn body(&self, model: &Model, request: &Request, second: Option<&Request>) -> Result<Body> {
        let (Some(second), Some(file), Some(t)) = (second, &self.interpolate, self.at) else {
            return model.generate(request).map_err(|error| self.request.failure(error));
        };
        model.interpolate(request, second, t).map_err(|error| {
            // Which of the two requests is wrong: the first if it fails alone.
            match model.solve(request) {
                Ok(_) => Failure::in_file(file, error),
                Err(own) => self.request.failure(own),
            }
        })
    }

    fn scene_options(&self) -> SceneOptions {
        SceneOptions {
            lod: self.lod,
            influences: self.influences,
            joint_names: self.joint_names,
            skin_tone: self.skin_tone.unwrap_or_default(),
            ..SceneOptions::default()
        }
    }
}

/// The JSON report of an infeasible request; `None` for any other.
fn refusal(model: &Model, request: &Request) -> Option<String> {
    match model.solve(request) {
        Err(Error::Infeasible(why)) => Some(refusal_json(request, &why)),
        _ => None,
    }
}

/// The given measure that the body misses by most, and by how many metres; `None` when none was given.
fn worst_residual(report: &Report) -> Option<(&'static str, f64)> {
    let residuals = report.measures.iter().filter_map(|m| m.residual.map(|r| (m.name, r.abs())));
    residuals.max_by(|a, b| a.1.total_cmp(&b.1))
}
