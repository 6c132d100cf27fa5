//! Reads the rows of a survey.

use std::path::Path;

use anthronet::measure::Sex;

use crate::{Error, Result};

/// A survey of which a model knows columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Survey {
    /// ANSUR II: the United States Army's anthropometric survey of 2010 to 2012 (Gordon et al. 2014).
    Ansur2,
    /// NHANES 2017 to March 2020: the adults of the United States, with sample weights.
    Nhanes,
}

impl Survey {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Ansur2, Self::Nhanes];

    /// The name that [`anthronet::measure::MeasureId::standard`] uses.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Ansur2 => "ANSUR II",
            Self::Nhanes => "NHANES",
        }
    }

    /// The name in files and options.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ansur2 => "ansur2",
            Self::Nhanes => "nhanes",
        }
    }

    /// The column of people's weight.
    pub const fn weight(self) -> &'static str {
        match self {
            Self::Ansur2 => "weightkg",
            Self::Nhanes => "bmxwt",
        }
    }

    /// Reads the people of one sex of this survey; [`Rows::read`] takes either survey.
    ///
    /// # Errors
    /// As [`Rows::read`]; [`Error::Invalid`] for the other survey.
    pub fn read(self, folder: &Path, sex: Sex) -> Result<Rows> {
        let rows = Rows::read(folder, sex)?;
        if rows.survey != self {
            let [expected, got] = [self, rows.survey].map(Self::title);
            return Err(Error::Invalid(format!("{}: expected {expected}, got {got}", folder.display())));
        }
        Ok(rows)
    }

    /// What a column's numbers are multiplied by to be metres or kilograms; `None` for a column that is no measure.
    fn unit(self, column: &str) -> Option<f64> {
        match (self, column) {
            (Self::Ansur2, "weightkg") => Some(0.1),
            (Self::Ansur2, "interpupillarybreadth") => Some(1e-4),
            (Self::Ansur2, column) => (!ANSUR2_NO_MEASURES.contains(&column)).then_some(1e-3),
            (Self::Nhanes, "bmxwt") => Some(1.0),
            (Self::Nhanes, column) => column.starts_with("bmx").then_some(0.01),
        }
    }
}

/// Columns of ANSUR II that are facts about a person, not measures.
const ANSUR2_NO_MEASURES: [&str; 15] = [
    "subjectid",
    "gender",
    "date",
    "installation",
    "component",
    "branch",
    "primarymos",
    "subjectsbirthlocation",
    "subjectnumericrace",
    "ethnicity",
    "dodrace",
    "age",
    "heightin",
    "weightlbs",
    "writingpreference",
];

/// Column of NHANES that says for how many people a person stands.
const SAMPLE_WEIGHT: &str = "wtmecprp";

/// The people of one sex in a survey.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// The survey.
    pub survey: Survey,
    /// Their sex.
    pub sex: Sex,
    /// Names of the measures, in the file's order.
    pub columns: Vec<String>,
    /// Per person, a value per column in metres or kilograms; `None` where it was not taken.
    pub people: Vec<Vec<Option<f64>>>,
    /// Per person, the number of people that they stand for.
    pub weights: Vec<f64>,
}

impl Rows {
    /// Reads `female.csv` or `male.csv` of a folder; the survey is recognised by its column of weight.
    ///
    /// # Errors
    /// [`Error::Io`] when the file cannot be read, [`Error::Invalid`] naming file, line and column of what is no number, and for
    /// a file that is of none of the surveys.
    pub fn read(folder: &Path, sex: Sex) -> Result<Self> {
        let path = folder.join(format!("{sex}.csv"));
        let text = std::fs::read_to_string(&path).map_err(Error::io(&path))?;
        Self::parse(&text, &path.display().to_string(), sex)
    }

    /// Parses the text of such a file; errors name `file`.
    ///
    /// # Errors
    /// As [`Rows::read`].
    pub fn parse(text: &str, file: &str, sex: Sex) -> Result<Self> {
        let invalid = |message: String| Error::Invalid(format!("{file}: {message}"));
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let titles = reader.headers().map_err(|e| invalid(e.to_string()))?.clone();
        let has = |survey: &Survey| titles.iter().any(|title| title == survey.weight());
        let Some(survey) = Survey::ALL.into_iter().find(has) else {
            let weights = Survey::ALL.map(Survey::weight).join(" or ");
            return Err(invalid(format!("expected a survey with the column {weights}")));
        };
        let units: Vec<Option<f64>> = titles.iter().map(|title| survey.unit(title)).collect();
        let sample_weight = titles.iter().position(|title| title == SAMPLE_WEIGHT);
        let mut rows = Self { survey, sex, columns: Vec::new(), people: Vec::new(), weights: Vec::new() };
        rows.columns =
            titles.iter().zip(&units).filter(|(_, u)| u.is_some()).map(|(t, _)| t.to_owned()).collect();
        for (line, record) in (2..).zip(reader.records()) {
            let record = record.map_err(|e| invalid(e.to_string()))?;
            let number = |column: usize| -> Result<Option<f64>> {
                let text = record.get(column).unwrap_or_default().trim();
                if text.is_empty() {
                    return Ok(None);
                }
                let wrong = || {
                    let title = titles.get(column).unwrap_or_default();
                    invalid(format!("line {line}, {title}: expected a positive number, got {text:?}"))
                };
                let value: f64 = text.parse().map_err(|_| wrong())?;
                if value > 0.0 && value.is_finite() { Ok(Some(value)) } else { Err(wrong()) }
            };
            let mut person = Vec::with_capacity(rows.columns.len());
            for (column, unit) in units.iter().enumerate() {
                if let Some(unit) = unit {
                    person.push(number(column)?.map(|value| value * unit));
                }
            }
            rows.people.push(person);
            rows.weights.push(sample_weight.map_or(Ok(Some(1.0)), number)?.unwrap_or(0.0));
        }
        if rows.people.len() < 2 {
            return Err(invalid(format!("expected at least two people, got {}", rows.people.len())));
        }
        Ok(rows)
    }

    /// Position of a column.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a column that the survey does not have.
    pub fn column(&self, name: &str) -> Result<usize> {
        let missing = || Error::Invalid(format!("{} has no column {name}", self.survey.title()));
        self.columns.iter().position(|column| column == name).ok_or_else(missing)
    }
}
