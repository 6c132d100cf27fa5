//! `anthronet train`: training and scoring of networks. Built only with the feature `train`; without it the command says
//! how to get it.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use crate::failure::Result;

/// Train a network from scratch. Takes long; shows its progress and can be resumed.
#[derive(Args)]
#[command(after_help = "Examples:\n  cargo anthronet-train train generator --resume\n  \
                        cargo anthronet-train train generator --plain --fourier 8 --sigma 0.03 --out /tmp/paper")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) network: Network,
}

#[derive(Subcommand)]
pub(crate) enum Network {
    Generator(GeneratorArguments),
    /// Fit the slider centres to the paper's mean measures and write trainer/src/sampling_bias.json. The generator must
    /// be retrained afterwards.
    Biases,
    /// Define landmarks and measures on the mean body again and write model/landmarks.json and model/measures.json. Where
    /// measures change, the generator must be retrained afterwards.
    Measures,
    /// Compute the statistics of two surveys of people and write trainer/src/survey/statistics.json.
    Surveys(SurveysArguments),
    /// Evaluate the committed generator again and write the scores into its file.
    Scores,
}

/// The conditional autoencoder that makes bodies from measures.
#[derive(Args)]
pub(crate) struct GeneratorArguments {
    /// Resume from the last checkpoint.
    #[arg(long)]
    pub(crate) resume: bool,

    /// Number of epochs; by default that of the configuration.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) epochs: Option<u32>,

    /// Folder for the model and its checkpoints; by default the model of the source tree is replaced.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// The paper's plain network, without the linear skip.
    #[arg(long)]
    pub(crate) plain: bool,

    /// Number of Fourier features per measure, 0 for none; by default that of the configuration.
    #[arg(long, value_name = "F")]
    pub(crate) fourier: Option<usize>,

    /// Standard deviation σ of their frequencies, cycles per standard deviation of the measure; by default that of the
    /// configuration.
    #[arg(long, value_name = "S")]
    pub(crate) sigma: Option<f64>,
}

/// Folders of surveys; each holds `female.csv` and `male.csv`.
#[derive(Args)]
pub(crate) struct SurveysArguments {
    /// Folder of ANSUR II, the public release, millimetres.
    #[arg(long, value_name = "DIR")]
    pub(crate) ansur2: PathBuf,

    /// Folder of NHANES 2017 to March 2020, adults, centimetres, with sample weights.
    #[arg(long, value_name = "DIR")]
    pub(crate) nhanes: PathBuf,
}

#[cfg(not(feature = "train"))]
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    Err(crate::failure::Failure::without_networks(match &arguments.network {
        Network::Generator(_) => "train generator",
        Network::Biases => "train biases",
        Network::Measures => "train measures",
        Network::Surveys(_) => "train surveys",
        Network::Scores => "train scores",
    }))
}

#[cfg(feature = "train")]
pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    use std::path::Path;

    use anthronet_trainer::commands;
    use anthronet_trainer::survey::Survey;
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
        Network::Measures => commands::define_measures(Path::new("model")),
        Network::Surveys(surveys) => commands::compute_surveys(
            [(Survey::Ansur2, &surveys.ansur2), (Survey::Nhanes, &surveys.nhanes)],
            Path::new("trainer/src/survey/statistics.json"),
        ),
        Network::Scores => commands::rescore(),
    }?;
    Ok(())
}
