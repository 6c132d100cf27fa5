//! The options that describe a person, shared by the commands that make one.

use std::path::{Path, PathBuf};

use anthronet::condition::{Fill, Population, Request};
use anthronet::measure::Sex;
use anthronet::{Error, Side};
use clap::Args;

use crate::choice;
use crate::failure::{Failure, Result};
use crate::files::read_text;
use crate::units::parse_measure;

/// Options that describe a person. They override the request file.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Person")]
pub(crate) struct RequestArguments {
    /// Sex of the body; by default inferred from the measures.
    #[arg(long, value_parser = choice::sex())]
    pub(crate) sex: Option<Sex>,

    /// A measure, such as height=1.7, height=170cm, waist_circumference="38 1/2 in" or height=5ft7in; a plain number
    /// is metres, a hyphen as in 5'-7" is no sign. May be repeated. `anthronet info` lists the names.
    #[arg(short = 'm', long = "measure", value_name = "NAME=VALUE", value_parser = parse_measure)]
    pub(crate) measures: Vec<(String, f64)>,

    /// A JSON request: {"sex": "female", "measures": {"height": 1.7}, "seed": 7}; lengths in metres.
    #[arg(long, value_name = "FILE")]
    pub(crate) request: Option<PathBuf>,

    /// Selects one of the people with these measures; 0 is the most likely [default: 0].
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) seed: Option<u64>,

    /// The latent vector, instead of one drawn from the seed. `anthronet info` gives its length; values of most people
    /// lie between -3 and 3, the limits are -6 and 6.
    #[arg(long, value_name = "A,B,…", value_delimiter = ',', allow_hyphen_values = true)]
    pub(crate) z: Option<Vec<f64>>,

    /// How missing measures are filled in [default: mean].
    #[arg(long, value_parser = choice::fill())]
    pub(crate) fill: Option<Fill>,

    /// Whose measures fill the missing ones and tell what is unusual: the people of a survey, or the bodies of the training,
    /// of every build and stature alike [default: ansur2].
    #[arg(long, value_parser = choice::population())]
    pub(crate) population: Option<Population>,

    /// If the measures cannot belong to one person, use the nearest feasible ones instead of failing.
    #[arg(long)]
    pub(crate) nearest: bool,
}

impl RequestArguments {
    /// The request that the options describe: that of the file, overridden by typed options.
    pub(crate) fn to_request(&self) -> Result<Request> {
        let mut request = match &self.request {
            Some(path) => read_request(path)?,
            None => Request::default(),
        };
        if let Some(sex) = self.sex {
            request.sex = Some(sex);
        }
        for (name, metres) in self.sorted_measures()? {
            request.set(name, metres).map_err(|error| match error {
                Error::Request { .. } => Failure::usage(error.to_string()),
                other => other.into(),
            })?;
        }
        if let Some(seed) = self.seed {
            request.seed = seed;
        }
        if let Some(z) = &self.z {
            request.z = Some(z.clone());
        }
        if let Some(fill) = self.fill {
            request.fill = fill;
        }
        if let Some(population) = self.population {
            request.population = population;
        }
        request.nearest |= self.nearest;
        Ok(request)
    }

    /// The failure of this request: a wrong field that was typed is bad usage; a wrong field of the file, or infeasible
    /// measures, are failures that name the file.
    pub(crate) fn failure(&self, error: Error) -> Failure {
        let typed = match &error {
            Error::Request { field, .. } => self.request.is_none() || self.typed(field),
            _ => false,
        };
        match (&error, &self.request) {
            _ if typed => Failure::usage(error.to_string()),
            (Error::Request { .. } | Error::Infeasible(_), Some(file)) => Failure::in_file(file, error),
            _ => error.into(),
        }
    }

    /// The given measures, those without a side first, so that `arm_length_left` refines `arm_length`.
    fn sorted_measures(&self) -> Result<Vec<(&str, f64)>> {
        let mut measures: Vec<(&str, f64)> = Vec::new();
        for (name, value) in &self.measures {
            if measures.iter().any(|(known, _)| known == name) {
                return Err(Failure::usage(format!("{name}: given twice, expected once")));
            }
            measures.push((name, *value));
        }
        measures.sort_by_key(|(name, _)| Side::split_measure_name(name).1.is_some());
        Ok(measures)
    }

    /// Whether a field of the request was typed rather than read from the file. Sides count as one: a value typed for
    /// both may be wrong on one of them.
    fn typed(&self, field: &str) -> bool {
        let base = |name| Side::split_measure_name(name).0;
        match field {
            "z" => self.z.is_some(),
            _ => self.measures.iter().any(|(name, _)| base(name) == base(field)),
        }
    }
}

/// The request in a JSON file.
pub(crate) fn read_request(path: &Path) -> Result<Request> {
    Request::from_json(&read_text(path)?).map_err(|error| Failure::in_file(path, error))
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
    fn options_override_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("r.json");
        std::fs::write(
            &file,
            r#"{"sex": "male", "measures": {"height": 1.8, "arm_length": 0.33}, "seed": 3}"#,
        )
        .unwrap();
        let arguments = RequestArguments {
            request: Some(file),
            sex: Some(Sex::Female),
            measures: vec![("height".into(), 1.7)],
            ..RequestArguments::default()
        };
        let request = arguments.to_request().unwrap();
        assert_eq!(request.sex, Some(Sex::Female));
        assert_eq!(request.measures[3], Some(1.7));
        assert_eq!(request.seed, 3);
        assert_eq!(request.given().count(), 3);
    }
}
