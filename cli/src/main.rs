//! The `anthronet` command: tape measures in, a rigged character file out.
//!
//! One file per command; the others hold what commands share: `request` reads a request from the options, `motion` adds
//! clips to a scene, `pose` reads static poses, `figure` and `render` make pictures, `file_set` keeps files apart, `files` and `terminal` read and
//! write, `length` and `units` read
//! lengths and picture sizes.
//! Exit codes: 0 done, 1 failed, 2 bad usage. Files appear whole or not at all.

mod animate;
mod choice;
mod contact_sheet;
mod convert;
mod evaluate;
mod failure;
mod figure;
mod file_set;
mod files;
mod generate;
mod info;
mod length;
mod measure;
mod motion;
mod pose;
mod preview;
mod render;
mod request;
mod terminal;
mod train;
mod units;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::failure::Result;

/// Type tape measures, get a person: rigged, skinned, ready for Blender, Unity or the web.
///
/// Lengths are metres unless a unit follows: 1.7, 170cm, 1700mm, 1m70, 67in, 5ft7in. `anthronet info` lists the
/// measures; one without its side, such as arm_length, sets both sides. Measures that are not given are predicted from
/// those that are.
#[derive(Parser)]
#[command(
    name = "anthronet",
    version,
    max_term_width = 100,
    after_help = "Examples:\n  \
        anthronet generate --sex female -m height=170cm -m waist_circumference=72cm -o anna.glb\n  \
        anthronet preview anna.glb -o anna.png\n  \
        anthronet measure anna.glb\n  \
        anthronet animate anna.glb --clip walk -o walking.glb\n\n\
        Exit codes: 0 done, 1 failed, 2 bad usage. ANTHRONET_MODEL names a model file to use instead of the built-in one."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Generate(generate::Arguments),
    Measure(measure::Arguments),
    Info(info::Arguments),
    Preview(preview::Arguments),
    ContactSheet(contact_sheet::Arguments),
    Animate(animate::Arguments),
    Convert(convert::Arguments),
    Evaluate(evaluate::Arguments),
    Train(train::Arguments),
}

fn run(command: &Command) -> Result<()> {
    match command {
        Command::Generate(arguments) => generate::run(arguments),
        Command::Measure(arguments) => measure::run(arguments),
        Command::Info(arguments) => info::run(arguments),
        Command::Preview(arguments) => preview::run(arguments),
        Command::ContactSheet(arguments) => contact_sheet::run(arguments),
        Command::Animate(arguments) => animate::run(arguments),
        Command::Convert(arguments) => convert::run(arguments),
        Command::Evaluate(arguments) => evaluate::run(arguments),
        Command::Train(arguments) => train::run(arguments),
    }
}

/// What becomes an error about a damaged file is reported there and not as a panic.
fn keep_caught_panics_quiet() {
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if !anthronet::format::panic_becomes_error() {
            before(info);
        }
    }));
}

fn main() -> ExitCode {
    keep_caught_panics_quiet();
    match run(&Arguments::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("error: {failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        super::Arguments::command().debug_assert();
    }
}
