//! The options that describe a person, shared by the commands that make one.

use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::failure::{Failure, Result};
use crate::units::parse_measure;

/// Which of the two sexes the body is conditioned on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SexChoice {
    Female,
    Male,
}

/// How what is not given is filled in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum FillChoice {
    /// With the likeliest values beside the given ones.
    Mean,
    /// With a draw from what is plausible beside the given ones; `--seed` chooses which.
    Sample,
}

/// Options that describe a person. They go before what the request file says.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Person")]
pub(crate) struct RequestArguments {
    /// Sex of the body; left out, the measures decide.
    #[arg(long)]
    pub(crate) sex: Option<SexChoice>,

    /// A measure, such as height=1.7, height=170cm, waist_circumference=28in or height=5ft7in; a plain number is
    /// metres. May be repeated. `anthronet info` lists the names.
    #[arg(short = 'm', long = "measure", value_name = "NAME=VALUE", value_parser = parse_measure)]
    pub(crate) measures: Vec<(String, f64)>,

    /// A JSON request: {"sex": "female", "measures": {"height": 1.7}, "seed": 7}; lengths in metres.
    #[arg(long, value_name = "FILE")]
    pub(crate) request: Option<PathBuf>,

    /// Which of the people with these measures: 0 is the likeliest [default: 0].
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) seed: Option<u64>,

    /// The latent vector by hand instead of by seed: as many numbers as `anthronet info` says, most people's within -3
    /// and 3, none beyond 6.
    #[arg(long, value_name = "A,B,…", value_delimiter = ',', allow_hyphen_values = true)]
    pub(crate) z: Option<Vec<f64>>,

    /// How measures that are not given are filled in [default: mean].
    #[arg(long)]
    pub(crate) fill: Option<FillChoice>,

    /// When the measures cannot belong to one person, make the nearest possible one instead of failing.
    #[arg(long)]
    pub(crate) nearest: bool,
}

impl RequestArguments {
    /// The given measures, those without a side first, so that `arm_length_left` refines `arm_length`.
    pub(crate) fn sorted_measures(&self) -> Result<Vec<(&str, f64)>> {
        let mut measures: Vec<(&str, f64)> = Vec::new();
        for (name, value) in &self.measures {
            if measures.iter().any(|(known, _)| known == name) {
                return Err(Failure::usage(format!("{name}: given twice, expected once")));
            }
            measures.push((name, *value));
        }
        measures.sort_by_key(|(name, _)| name.ends_with("_left") || name.ends_with("_right"));
        Ok(measures)
    }

    /// Whether a field of the request was typed, and not read from the request's file. Sides count as one: what is
    /// typed for one may be told of both.
    pub(crate) fn typed(&self, field: &str) -> bool {
        fn stem(name: &str) -> &str {
            name.trim_end_matches("_left").trim_end_matches("_right")
        }
        match field {
            "z" => self.z.is_some(),
            _ => self.measures.iter().any(|(name, _)| stem(name) == stem(field)),
        }
    }
}

/// Reads a text file of at most 16 MB.
pub(crate) fn read_text(path: &Path) -> Result<String> {
    let size = fs::metadata(path).map_err(|e| Failure::io("read", path, &e))?.len();
    if size > 16 << 20 {
        return Err(Failure::failed(format!("{}: expected at most 16 MB, got {size} bytes", path.display())));
    }
    fs::read_to_string(path).map_err(|e| Failure::io("read", path, &e))
}

/// The ending of a path in lower case, without its dot; empty for none.
pub(crate) fn ending(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

/// Refuses an output path whose ending is not one of these.
pub(crate) fn check_ending(option: &str, path: &Path, known: &[&str]) -> Result<()> {
    if known.contains(&ending(path).as_str()) {
        return Ok(());
    }
    let (path, known) = (path.display(), dotted(known));
    Err(Failure::usage(format!("{option} {path}: unknown ending, expected one of {known}")))
}

/// Endings as messages list them: `.glb .gltf`.
pub(crate) fn dotted(endings: &[&str]) -> String {
    endings.iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_come_after_the_name_for_both_and_nothing_twice() {
        let mut arguments = RequestArguments {
            measures: vec![
                ("arm_length_left".into(), 0.3),
                ("arm_length".into(), 0.31),
                ("height".into(), 1.7),
            ],
            ..RequestArguments::default()
        };
        let names: Vec<_> = arguments.sorted_measures().unwrap().iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["arm_length", "height", "arm_length_left"]);
        arguments.measures.push(("height".into(), 1.8));
        assert_eq!(arguments.sorted_measures().unwrap_err().exit_code(), 2);
    }

    #[test]
    fn fields_are_typed_or_read() {
        let arguments = RequestArguments {
            measures: vec![("arm_length".into(), 0.31), ("foot_width_left".into(), 0.1)],
            z: Some(vec![0.0]),
            ..RequestArguments::default()
        };
        for typed in ["arm_length", "arm_length_left", "foot_width_left", "foot_width", "z"] {
            assert!(arguments.typed(typed), "{typed}");
        }
        assert!(!arguments.typed("height") && !RequestArguments::default().typed("z"));
    }

    #[test]
    fn endings() {
        assert!(check_ending("-o", Path::new("a/b.GLB"), &["glb"]).is_ok());
        for path in ["b", "b.", "glb", "b.glb.txt"] {
            assert!(check_ending("-o", Path::new(path), &["glb"]).is_err(), "{path}");
        }
    }
}
