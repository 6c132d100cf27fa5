//! From a request to the network's condition, and from the decoded body to one that has exactly the given measures.
//!
//! [`Request`] → [`Prepared`] (checked, judged by [`Feasibility`], filled and projected by the [`Prior`]) → decoder →
//! [`solve()`] for the given measures → [`Report`].

mod chi_squared;
mod error;
mod feasibility;
mod prepare;
mod prior;
mod report;
mod request;
mod solve;
mod text;

pub use crate::error::{Conflict, ConflictMeasure};
pub use error::{FEASIBILITY_NOISE, FILL_NOISE, PROJECTION_NOISE};
pub use feasibility::{Feasibility, Limits};
pub use prepare::Prepared;
pub use prior::{Conditional, GivenMeasures, Population, Prior, Priors, QUANTILE_COUNT, SexPrior};
pub use report::{Filled, MeasureReport, Report, refusal_json};
pub use request::{Fill, LATENT_LIMIT, MeasureRange, Request};
pub use solve::{MeasuredShape, SolveOptions, SolveOutcome, solve};

#[cfg(test)]
mod test_prior;
