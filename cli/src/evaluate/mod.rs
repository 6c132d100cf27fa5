//! `anthronet evaluate`: how good the model and the retargeting are. The tables of the model need the feature `train`.

mod motion;
mod soles;
mod table;

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::failure::{Failure, Result};
use crate::terminal::print;

/// Which table to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Table {
    /// Errors of the generator on bodies it was not fitted to.
    Generator,
    /// Mean, deviation, least and most of every measure over the sampled bodies.
    Statistics,
    /// How motion files come onto bodies from small to tall: directions, joint limits, feet.
    Motion,
}

/// Bodies that no network was fitted to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Split {
    /// The bodies that scores are told on.
    HeldOut,
    /// The bodies that settings are chosen on.
    Validation,
}

/// Score the model against bodies it has not seen, or print the statistics of the sampled ones.
#[derive(Args)]
#[command(
    after_help = "Examples:\n  cargo anthronet-train evaluate\n  cargo anthronet-train evaluate --split validation --json\n  \
                  cargo anthronet-train evaluate --table statistics\n  \
                  cargo anthronet evaluate --table motion --clips DIR"
)]
pub(crate) struct Arguments {
    /// Which table.
    #[arg(long, default_value = "generator")]
    table: Table,

    /// Which bodies the generator is scored on.
    #[arg(long, default_value = "held-out")]
    split: Split,

    /// Print JSON; errors in millimetres.
    #[arg(long)]
    json: bool,

    /// Folder of motion files, required for the table of motion.
    #[arg(long, value_name = "DIR")]
    clips: Option<PathBuf>,

    /// How many bodies; of motion, 10.
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
        _ => commands::Table::Statistics,
    };
    print(&commands::evaluate(table, arguments.json)?)
}
