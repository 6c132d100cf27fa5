//! Surveys of real people: reading their rows, and the statistics of them that are committed.
//!
//! Rows never enter the project; `statistics.json` holds means, deviations, correlations and quantiles of every column,
//! made by `anthronet train surveys`.

mod rows;
mod statistics;

pub use rows::{Rows, Survey};
pub use statistics::{Column, QUANTILES, Regression, SexStatistics, SurveyStatistics, committed};

/// A survey's column that is one of our measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mapping {
    /// The measure's name without its side.
    pub measure: &'static str,
    /// The survey's column.
    pub column: &'static str,
}

impl Survey {
    /// The measures that a column of this survey *is*, by [`anthronet::measure::MeasureId::standard`]: those that are only near one are left
    /// out. A measure of both sides counts once, as surveys take one side.
    pub fn mappings(self) -> Vec<Mapping> {
        let mut mappings: Vec<Mapping> = Vec::new();
        for id in anthronet::measure::MeasureId::all() {
            let column = id.standard().and_then(|standard| {
                standard
                    .split("; ")
                    .filter(|part| !part.ends_with(", near"))
                    .find_map(|part| part.strip_prefix(self.title()).map(str::trim_start))
            });
            let new = |mapping: &Mapping| mapping.measure != id.base_name();
            if let Some(column) = column.filter(|_| mappings.iter().all(new)) {
                mappings.push(Mapping { measure: id.base_name(), column });
            }
        }
        mappings
    }
}

#[cfg(test)]
mod tests;
