//! `anthronet measure`: the measures of a character file.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anthronet::format::{Purpose, measure_file};
use anthronet::measure::{Mass, MeasureId};
use anthronet::model::Model;
use clap::Args;
use serde::Serialize;

use crate::failure::Result;
use crate::files::{check_extension, extensions};
use crate::terminal::print;

/// Measure a character file: all measures, mass and body mass index.
///
/// FILE was made by AnthroNet, at any level of detail, or has a body with the same vertex order. The body is measured in
/// its bind pose. Another unit than metres or other axes than +Y up are detected, and a warning says so; a mirrored body or
/// one whose vertices are in another order is refused.
#[derive(Args)]
#[command(after_help = "Examples:\n  anthronet measure anna.glb\n  anthronet measure anna.obj --json")]
pub(crate) struct Arguments {
    /// The file: .glb, .gltf, .vrm, .usd, .usda, .usdc, .usdz or .obj.
    file: PathBuf,

    /// Print JSON: {"measures": [{"name", "value"}, …], "mass_kg", "volume_m3", "bmi"}; metres, kilograms.
    #[arg(long)]
    json: bool,
}

/// The measures of a body; metres, kilograms.
#[derive(Debug, Serialize)]
struct Measured {
    measures: Vec<NamedValue>,
    mass_kg: f64,
    volume_m3: f64,
    bmi: f64,
}

impl Measured {
    /// Measures the body of a file: its first mesh, at any level of detail.
    fn of_file(model: &Model, path: &Path) -> Result<Self> {
        let file = measure_file(model, path)?;
        for warning in &file.warnings {
            eprintln!("warning: {}: {warning}", path.display());
        }
        let Mass { volume_m3, mass_kg, bmi } = file.mass;
        let named = MeasureId::all().zip(file.measurements);
        let measures = named.map(|(id, value)| NamedValue { name: id.name(), value }).collect();
        Ok(Self { measures, mass_kg, volume_m3, bmi })
    }
}

/// One measure and its value in metres.
#[derive(Debug, Serialize)]
struct NamedValue {
    name: &'static str,
    value: f64,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    check_extension("", &arguments.file, &extensions(Purpose::ReadMeshes))?;
    let measured = Measured::of_file(&Model::from_environment()?, &arguments.file)?;
    if arguments.json {
        let json = serde_json::to_string_pretty(&measured)?;
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
