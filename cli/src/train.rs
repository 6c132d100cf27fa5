//! `anthronet train` and `anthronet evaluate`, the commands that need networks. Built only with the feature `train`;
//! without it they say how to get it.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};

use crate::failure::Result;

/// Which table to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Table {
    /// Errors of the generator on bodies it was not fitted to.
    Generator,
    /// Mean, deviation, least and most of every measure over the sampled bodies.
    Statistics,
    /// How motion files come onto bodies from small to tall: directions, joint limits, feet.
    Motion,
}

/// Bodies that no network was fitted to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Split {
    /// The bodies that scores are told on.
    HeldOut,
    /// The bodies that settings are chosen on.
    Validation,
}

/// Score the model against bodies it has not seen, or print the statistics of the sampled ones.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  cargo anthronet-train evaluate\n  cargo anthronet-train evaluate --split validation --json\n  \
                  cargo anthronet-train evaluate --table statistics"
)]
pub(crate) struct EvaluateArguments {
    /// Which table.
    #[arg(long, default_value = "generator")]
    pub(crate) table: Table,

    /// Which bodies the generator is scored on.
    #[arg(long, default_value = "held-out")]
    pub(crate) split: Split,

    /// Print JSON; errors in millimetres.
    #[arg(long)]
    pub(crate) json: bool,

    /// Folder of motion files, for the table of motion [default: ../shared/data/clips].
    #[arg(long, value_name = "DIR")]
    pub(crate) clips: Option<PathBuf>,

    /// How many bodies; of motion, 10.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) bodies: Option<u32>,
}

/// Train a network from nothing. Long; shows its progress and can be resumed.
#[derive(Args)]
#[command(after_help = "Examples:\n  cargo anthronet-train train generator --resume\n  \
                        cargo anthronet-train train generator --plain --fourier 8 --sigma 0.03 --out /tmp/paper")]
pub(crate) struct TrainArguments {
    #[command(subcommand)]
    pub(crate) network: Network,
}

#[derive(Subcommand)]
pub(crate) enum Network {
    Generator(GeneratorArguments),
    /// Fit the middles of the sliders to the paper's mean measures: writes trainer/src/sampling_bias.json. The generator
    /// must be trained after it.
    Biases,
    /// Lay the measures on the mean body anew: writes model/measures.json. The generator must be trained after it.
    Measures,
    /// Score the committed generator again and write the scores into its file.
    Scores,
}

/// The conditional autoencoder that makes bodies from measures.
#[derive(Args)]
pub(crate) struct GeneratorArguments {
    /// Go on from the last checkpoint.
    #[arg(long)]
    pub(crate) resume: bool,

    /// Passes over the bodies; left out, as configured.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) epochs: Option<u32>,

    /// Folder for the model and its checkpoints; left out, as configured.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// The paper's plain network, without the linear skip.
    #[arg(long)]
    pub(crate) plain: bool,

    /// Fourier components f of a measure, 0 for none; left out, as configured.
    #[arg(long, value_name = "F")]
    pub(crate) fourier: Option<usize>,

    /// Deviation σ of their frequencies, cycles per deviation of the measure; left out, as configured.
    #[arg(long, value_name = "S")]
    pub(crate) sigma: Option<f64>,
}

#[cfg(not(feature = "train"))]
fn no_networks(command: &str) -> crate::failure::Failure {
    crate::failure::Failure::usage(format!(
        "this build has no networks: run `cargo anthronet-train {command}` in the source tree"
    ))
}

/// `anthronet evaluate`. The table of motion needs no network.
pub(crate) fn evaluate(arguments: &EvaluateArguments) -> Result<()> {
    if arguments.table == Table::Motion { motion(arguments) } else { networks(arguments) }
}

fn motion(arguments: &EvaluateArguments) -> Result<()> {
    let folder = arguments.clips.as_deref().unwrap_or(Path::new("../shared/data/clips"));
    let bodies = arguments.bodies.map_or(10, |n| n as usize);
    let table = crate::evaluate::motion::motion_table(folder, bodies)?;
    crate::terminal::print(&if arguments.json { table.to_json()? } else { table.to_text() })
}

#[cfg(not(feature = "train"))]
fn networks(_: &EvaluateArguments) -> Result<()> {
    Err(no_networks("evaluate"))
}

#[cfg(not(feature = "train"))]
pub(crate) fn train(arguments: &TrainArguments) -> Result<()> {
    Err(no_networks(match &arguments.network {
        Network::Generator(_) => "train generator",
        Network::Biases => "train biases",
        Network::Measures => "train measures",
        Network::Scores => "train scores",
    }))
}

#[cfg(feature = "train")]
fn networks(arguments: &EvaluateArguments) -> Result<()> {
    use anthronet_trainer::{commands, corpus};
    let split = match arguments.split {
        Split::HeldOut => corpus::Split::HeldOut,
        Split::Validation => corpus::Split::Validation,
    };
    let bodies = arguments.bodies.map(|n| n as usize);
    let table = match arguments.table {
        Table::Generator => commands::Table::Generator { split, bodies },
        _ => commands::Table::Statistics,
    };
    let text = commands::evaluate(table, arguments.json)?;
    crate::terminal::print(&text)
}

#[cfg(feature = "train")]
pub(crate) fn train(arguments: &TrainArguments) -> Result<()> {
    use anthronet_trainer::commands;
    match &arguments.network {
        Network::Generator(generator) => commands::train_generator(&commands::GeneratorOptions {
            resume: generator.resume,
            epochs: generator.epochs.map(|n| n as usize),
            out: generator.out.clone(),
            plain: generator.plain,
            fourier: generator.fourier,
            sigma: generator.sigma,
        }),
        Network::Biases => {
            let table = commands::fit_biases(Path::new("trainer/src/sampling_bias.json"))?;
            return crate::terminal::print(&table);
        }
        Network::Measures => commands::lay_measures(Path::new("model/measures.json")),
        Network::Scores => commands::rescore(),
    }?;
    Ok(())
}

#[cfg(feature = "train")]
impl From<anthronet_trainer::Error> for crate::failure::Failure {
    fn from(error: anthronet_trainer::Error) -> Self {
        Self::failed(error.to_string())
    }
}
