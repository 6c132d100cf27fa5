//! From a request to the condition of the network, and from its answer to exactly the asked measures.
//!
//! [`Request`] → [`Prepared`] (checked, [`Feasibility`], filled and projected by the [`Prior`]) → the network decodes →
//! [`solve()`] on the given measures → [`Report`].

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
pub use error::{FILL_ERROR, JUDGING_ERROR, PROJECTION_ERROR};
pub use feasibility::{Feasibility, Limits};
pub use prepare::Prepared;
pub use prior::{Conditional, GivenMeasures, Prior, QUANTILE_COUNT, SexPrior};
pub use report::{Filled, MeasureReport, Report, refusal_json};
pub use request::{Fill, LATENT_LIMIT, MeasureRange, Request};
pub use solve::{MeasuredShape, SolveOptions, SolveOutcome, solve};

#[cfg(test)]
mod test_prior;
