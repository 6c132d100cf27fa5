//! `anthronet measure`: the measures of a character file.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anthronet::format::{Purpose, measure_file};
use anthronet::measure::{Landmark, Mass, MeasureId};
use anthronet::model::Model;
use clap::Args;
use glam::DVec3;
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
#[command(
    after_help = "Examples:\n  anthronet measure anna.glb\n  anthronet measure anna.obj --json\n  anthronet measure anna.glb --landmarks"
)]
pub(crate) struct Arguments {
    /// The file: .glb, .gltf, .vrm, .usd, .usda, .usdc, .usdz or .obj.
    file: PathBuf,

    /// Print JSON: {"measures": [{"name", "value"}, …], "mass_kg", "volume_m3", "bmi"}; metres, kilograms.
    #[arg(long)]
    json: bool,

    /// Print the landmarks too, in JSON {"landmarks": [{"name", "position": [x, y, z]}, …]}; metres, +Y up, +X to the
    /// person's left, +Z forward. `anthronet info` says where each lies.
    #[arg(long)]
    landmarks: bool,
}

/// The measures of a body; metres, kilograms.
#[derive(Debug, Serialize)]
struct Measured {
    measures: Vec<NamedValue>,
    mass_kg: f64,
    volume_m3: f64,
    bmi: f64,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    landmarks: Vec<NamedPosition>,
}

impl Measured {
    /// Measures the body of a file: its first mesh, at any level of detail.
    fn of_file(model: &Model, path: &Path, with_landmarks: bool) -> Result<Self> {
        let file = measure_file(model, path)?;
        for warning in &file.warnings {
            eprintln!("warning: {}: {warning}", path.display());
        }
        let Mass { volume_m3, mass_kg, bmi } = file.mass;
        let named = MeasureId::all().zip(file.measurements);
        let measures = named.map(|(id, value)| NamedValue { name: id.name(), value }).collect();
        let landmarks = model.landmarks().iter().zip(&file.landmarks).filter(|_| with_landmarks);
        let position = |(landmark, position): (&Landmark, &DVec3)| NamedPosition {
            name: landmark.name.clone(),
            position: position.to_array(),
        };
        Ok(Self { measures, mass_kg, volume_m3, bmi, landmarks: landmarks.map(position).collect() })
    }
}

/// One measure and its value in metres.
#[derive(Debug, Serialize)]
struct NamedValue {
    name: &'static str,
    value: f64,
}

/// A landmark and its position in metres.
#[derive(Debug, Serialize)]
struct NamedPosition {
    name: String,
    position: [f64; 3],
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    check_extension("", &arguments.file, &extensions(Purpose::ReadMeshes))?;
    let measured = Measured::of_file(&Model::from_environment()?, &arguments.file, arguments.landmarks)?;
    if arguments.json {
        let json = serde_json::to_string_pretty(&measured)?;
        return print(&(json + "\n"));
    }
    print(&table(&measured))
}

fn table(measured: &Measured) -> String {
    let mut out = String::new();
    let names = measured.measures.iter().map(|m| m.name.len());
    let width = names.chain(measured.landmarks.iter().map(|l| l.name.len())).max().unwrap_or(0);
    for NamedValue { name, value } in &measured.measures {
        // Writing to a string cannot fail.
        let _ = writeln!(out, "{name:width$}  {value:7.4} m");
    }
    let _ = writeln!(out, "{:width$}  {:7.2} kg", "mass", measured.mass_kg);
    let _ = writeln!(out, "{:width$}  {:7.2} kg/m²", "bmi", measured.bmi);
    for NamedPosition { name, position: [x, y, z] } in &measured.landmarks {
        let _ = writeln!(out, "{name:width$}  {x:7.4} {y:7.4} {z:7.4} m");
    }
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
            landmarks: Vec::new(),
        };
        assert_eq!(table(&measured), "height   1.7000 m\nmass      65.00 kg\nbmi       22.50 kg/m²\n");
        let json = serde_json::to_value(&measured).unwrap();
        assert_eq!(json["measures"][0]["value"], 1.7);
        assert!(json.get("landmarks").is_none());
        let menton = NamedPosition { name: "menton".into(), position: [0.0, 1.48, 0.1] };
        let measured = Measured { landmarks: vec![menton], ..measured };
        assert!(table(&measured).ends_with("menton   0.0000  1.4800  0.1000 m\n"));
    }
}
