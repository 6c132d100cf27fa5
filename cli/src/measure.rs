//! `anthronet measure`: the tape over a file.

use std::fmt::Write;
use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use crate::backend::{self, Model};
use crate::failure::{Failure, Result};
use crate::progress::print;
use crate::request::{dotted, ending};

/// Read all 36 measures, mass and body mass index off a character file.
///
/// FILE is one of ours at any level of detail, or another whose body has our vertex order. The body is measured in its
/// bind pose.
#[derive(Args)]
#[command(after_help = "Examples:\n  anthronet measure anna.glb\n  anthronet measure anna.obj --json")]
pub(crate) struct Arguments {
    /// The file: .glb, .gltf, .vrm, .usda, .usdc, .usdz or .obj.
    file: PathBuf,

    /// Print JSON: {"measures": [{"name", "value"}, …], "mass_kg", "volume_m3", "bmi"}; metres, kilograms.
    #[arg(long)]
    json: bool,
}

/// What was read; metres, kilograms.
#[derive(Debug, Serialize)]
pub(crate) struct Measured {
    pub(crate) measures: Vec<NamedValue>,
    pub(crate) mass_kg: f64,
    pub(crate) volume_m3: f64,
    pub(crate) bmi: f64,
}

/// One measure and its value in metres.
#[derive(Debug, Serialize)]
pub(crate) struct NamedValue {
    pub(crate) name: &'static str,
    pub(crate) value: f64,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let known = backend::surface_endings();
    if !known.contains(&ending(&arguments.file).as_str()) {
        let (file, known) = (arguments.file.display(), dotted(&known));
        return Err(Failure::usage(format!("{file}: unknown ending, expected one of {known}")));
    }
    let measured = backend::measure_file(&Model::open()?, &arguments.file)?;
    if arguments.json {
        let json = serde_json::to_string_pretty(&measured).map_err(|e| Failure::failed(e.to_string()))?;
        return print(&(json + "\n"));
    }
    print(&table(&measured))
}

fn table(measured: &Measured) -> String {
    let mut out = String::new();
    let width = measured.measures.iter().map(|m| m.name.len()).max().unwrap_or(0);
    for NamedValue { name, value } in &measured.measures {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{name:width$}  {value:7.4} m");
    }
    let _ = writeln!(out, "{:width$}  {:7.2} kg", "mass", measured.mass_kg);
    let _ = writeln!(out, "{:width$}  {:7.2} kg/m²", "bmi", measured.bmi);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_and_json() {
        let measured = Measured {
            measures: vec![NamedValue { name: "height", value: 1.7 }],
            mass_kg: 65.0,
            volume_m3: 0.064,
            bmi: 22.5,
        };
        assert_eq!(table(&measured), "height   1.7000 m\nmass      65.00 kg\nbmi       22.50 kg/m²\n");
        let json = serde_json::to_value(&measured).unwrap();
        assert_eq!(json["measures"][0]["value"], 1.7);
    }
}
