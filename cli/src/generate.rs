//! `anthronet generate`: a person from measures, as a file.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::backend::{self, Model};
use crate::failure::{Failure, Result};
use crate::motion::MotionArguments;
use crate::request::{RequestArguments, check_ending};

/// What the file's joints are called.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum JointNamesChoice {
    Native,
    Unity,
    Mixamo,
    Vrm,
    Blender,
}

/// Make a person from tape measures and write the rigged, skinned character to a file.
///
/// Any subset of the 36 measures will do. The body has exactly the given ones; the report says how the others were
/// filled in, with the interval that holds 90 % of such people. The same request gives the same bytes everywhere.
#[derive(Args)]
#[command(after_help = "Examples:\n  \
    anthronet generate --sex female -m height=170cm -m waist_circumference=72cm -o anna.glb\n  \
    anthronet generate -m height=6ft1in -m chest_circumference=40in --joint-names mixamo -o bob.glb\n  \
    anthronet generate --sex male --fill sample --seed 7 --lod 1 -o someone.obj --report -\n  \
    anthronet generate --sex female -m height=170cm --clip walk --clip dance.bvh -o moves.glb\n  \
    anthronet generate --request slim.json --interpolate heavy.json --at 0.5 -o between.glb")]
pub(crate) struct Arguments {
    #[command(flatten)]
    request: RequestArguments,

    /// A second JSON request: make the body between the two (needs --at).
    #[arg(long, value_name = "FILE", requires = "at")]
    interpolate: Option<PathBuf>,

    /// Where between the two: 0 is the first, 1 the second.
    #[arg(long, value_name = "T", requires = "interpolate", value_parser = parse_share)]
    at: Option<f64>,

    /// Level of detail: 0 has 53,514 vertices, 1 has 13,380, 2 about a quarter of that, 3 a sixteenth.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=3), help_heading = "File")]
    lod: u8,

    /// Most joints that may move a vertex: 4 works everywhere, 8 is smoother where it is read.
    #[arg(long, default_value = "4", value_parser = ["4", "8"], help_heading = "File")]
    influences: String,

    /// What the joints are called.
    #[arg(long, default_value = "native", help_heading = "File")]
    joint_names: JointNamesChoice,

    /// Skin colour: 1 (light) to 10 (dark) on the Monk scale, or #rrggbb.
    #[arg(long, value_name = "TONE", help_heading = "File")]
    skin_tone: Option<String>,

    #[command(flatten)]
    motion: MotionArguments,

    /// The file to write; its ending chooses the format: .glb, .gltf (with a .bin beside it), .vrm, .usda, .usdc,
    /// .usdz or .obj.
    #[arg(short = 'o', long = "output", value_name = "FILE", help_heading = "File")]
    output: PathBuf,

    /// Write a .glb or .gltf with EXT_meshopt_compression.
    #[arg(long, help_heading = "File")]
    compress: bool,

    /// Write the report of all 36 measures as JSON, to a file or with `-` to standard output; also when the request is
    /// refused because nobody can have such measures, with what conflicts.
    #[arg(long, value_name = "FILE", help_heading = "File")]
    report: Option<PathBuf>,
}

/// How the file is to be.
pub(crate) struct FileChoice<'a> {
    pub(crate) lod: u8,
    pub(crate) influences: usize,
    pub(crate) joint_names: JointNamesChoice,
    pub(crate) skin_tone: Option<&'a str>,
}

fn parse_share(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(t) if (0.0..=1.0).contains(&t) => Ok(t),
        _ => Err(format!("expected a number from 0 to 1, got `{text}`")),
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    check_ending("-o", &arguments.output, &backend::written_endings())?;
    arguments.motion.check(&arguments.output)?;
    if arguments.report.as_deref() == Some(&*arguments.output) {
        return Err(Failure::usage("--report: expected another file than that of -o"));
    }
    let choice = FileChoice {
        lod: arguments.lod,
        influences: if arguments.influences == "8" { 8 } else { 4 },
        joint_names: arguments.joint_names,
        skin_tone: arguments.skin_tone.as_deref(),
    };
    backend::check_choice(&choice)?;
    let request = backend::request(&arguments.request)?;
    let second = match arguments.interpolate.as_deref() {
        Some(path) => Some((backend::request_file(path)?, path)),
        None => None,
    };

    let model = Model::open()?;
    let made = match (&second, arguments.at) {
        (Some((second, path)), Some(t)) => {
            model.interpolate((&request, &arguments.request), (second, path), t)
        }
        _ => model.generate(&request, &arguments.request),
    };
    let person = match made {
        Ok(person) => person,
        Err(failure) => {
            let requests = [Some(&request), second.as_ref().map(|(request, _)| request)];
            let refusal = requests.into_iter().flatten().find_map(|request| model.refusal(request));
            if let (Some(path), Some(refusal)) = (&arguments.report, refusal) {
                backend::write_or_print(path, &(refusal + "\n"))?;
            }
            return Err(failure);
        }
    };
    let mut scene = person.scene(&choice)?;
    backend::motion::animate(&mut scene, &arguments.motion)?;
    backend::write_scene(&scene, &arguments.output, arguments.compress)?;
    if let Some(path) = &arguments.report {
        backend::write_or_print(path, &(person.report_json() + "\n"))?;
    }

    let summary = person.summary();
    for warning in &summary.warnings {
        eprintln!("warning: {warning}");
    }
    let residual = summary
        .worst_residual_mm
        .map(|(name, mm)| format!("measures within {mm:.3} mm ({name})"))
        .unwrap_or_else(|| if second.is_some() { "between two" } else { "no measure given" }.to_owned());
    eprintln!(
        "{}: {}, {:.3} m, {:.1} kg, {residual}",
        arguments.output.display(),
        summary.sex,
        summary.height,
        summary.mass_kg
    );
    Ok(())
}
