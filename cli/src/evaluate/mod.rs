//! `anthronet evaluate`: how good the model and the retargeting are. The tables of the model need the feature `train`.

mod motion;
mod soles;
mod table;

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::failure::{Failure, Result};
use crate::terminal::print;

/// The table to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Table {
    /// Errors of the generator on bodies it was not trained on.
    Generator,
    /// Mean, standard deviation, minimum and maximum of every measure over the sampled bodies.
    Statistics,
    /// Bodies made from a part of real people's measures, beside those people: bias, spread, intervals, mass.
    People,
    /// Motion files retargeted to bodies from short to tall: bone directions, joint limits, feet.
    Motion,
}

/// Bodies that no network was trained on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Split {
    /// The bodies of the published scores.
    HeldOut,
    /// The bodies that hyperparameters are chosen on.
    Validation,
}

/// Evaluate the generator on unseen bodies or retargeting on motion files, or print statistics of the sampled bodies.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  cargo anthronet-train evaluate\n  cargo anthronet-train evaluate --split validation --json\n  \
                  cargo anthronet-train evaluate --table statistics\n  \
                  cargo anthronet-train evaluate --table people --survey DIR\n  \
                  cargo anthronet evaluate --table motion --clips DIR"
)]
pub(crate) struct Arguments {
    /// The table to print.
    #[arg(long, default_value = "generator")]
    table: Table,

    /// The bodies that the generator is evaluated on.
    #[arg(long, default_value = "held-out")]
    split: Split,

    /// Print JSON; errors in millimetres.
    #[arg(long)]
    json: bool,

    /// Folder of motion files, required for the table of motion.
    #[arg(long, value_name = "DIR")]
    clips: Option<PathBuf>,

    /// Folder with the rows of a survey, required for the table of people: `female.csv` and `male.csv` of ANSUR II or of
    /// NHANES.
    #[arg(long, value_name = "DIR")]
    survey: Option<PathBuf>,

    /// Number of bodies; 10 for the table of motion.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    bodies: Option<u32>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    if arguments.table != Table::Motion {
        return networks(arguments);
    }
    let Some(folder) = &arguments.clips else {
        return Err(Failure::usage("--table motion: expected --clips with a folder of motion files"));
    };
    let table = motion::table(folder, arguments.bodies.map_or(10, |n| n as usize))?;
    print(&if arguments.json { table.to_json()? } else { table.to_text() })
}

#[cfg(not(feature = "train"))]
fn networks(_: &Arguments) -> Result<()> {
    Err(Failure::without_networks("evaluate"))
}

#[cfg(feature = "train")]
fn networks(arguments: &Arguments) -> Result<()> {
    use anthronet_trainer::{commands, corpus};
    let split = match arguments.split {
        Split::HeldOut => corpus::Split::HeldOut,
        Split::Validation => corpus::Split::Validation,
    };
    let bodies = arguments.bodies.map(|n| n as usize);
    let table = match arguments.table {
        Table::Generator => commands::Table::Generator { split, bodies },
        Table::People => match &arguments.survey {
            Some(folder) => commands::Table::People(folder.clone()),
            None => return Err(Failure::usage("--table people: expected --survey with a folder of rows")),
        },
        _ => commands::Table::Statistics,
    };
    print(&commands::evaluate(&table, arguments.json)?)
}
