//! The populations that a model has priors of.

use serde::{Deserialize, Serialize};

use super::Prior;
use crate::{Error, Result};

/// Whose measures fill what a request leaves open, and judge what is unusual.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Population {
    /// The people of ANSUR II: soldiers of the United States, 2010 to 2012 (Gordon et al. 2014).
    #[default]
    Ansur2,
    /// The bodies that the model was trained on: of every build and stature alike, which no population is.
    Synthetic,
}

impl Population {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Ansur2, Self::Synthetic];

    /// `ansur2` or `synthetic`, as in JSON and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ansur2 => "ansur2",
            Self::Synthetic => "synthetic",
        }
    }

    /// What its members are called in sentences.
    pub(crate) fn members(self) -> &'static str {
        match self {
            Self::Ansur2 => "people of ANSUR II",
            Self::Synthetic => "bodies of the training",
        }
    }
}

impl std::str::FromStr for Population {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|population| population.name() == text).ok_or_else(|| {
            Error::request("population", format!("expected ansur2 or synthetic, got `{text}`"))
        })
    }
}

/// The priors of all populations.
#[derive(Clone, Debug)]
pub struct Priors([Prior; 2]);

impl Priors {
    /// From the priors in the order of [`Population::ALL`].
    pub fn new(priors: [Prior; 2]) -> Self {
        Self(priors)
    }

    /// The prior of one population.
    pub fn of(&self, population: Population) -> &Prior {
        let [ansur2, synthetic] = &self.0;
        match population {
            Population::Ansur2 => ansur2,
            Population::Synthetic => synthetic,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back_and_others_refused() {
        for population in Population::ALL {
            assert_eq!(population.name().parse::<Population>().unwrap(), population);
            assert_eq!(serde_json::to_string(&population).unwrap(), format!("\"{}\"", population.name()));
        }
        let error = "martians".parse::<Population>().unwrap_err().to_string();
        assert!(error.contains("expected ansur2 or synthetic, got `martians`"), "{error}");
    }
}
