//! Makes the model of `anthronet`: source bodies (CC0), sampling, data set, basis, networks, evaluation.
//!
//! The tour, in the order in which data flows: [`assets`] reads the MakeHuman data, [`sampling`] draws people,
//! [`tpose`] straightens their arms, [`dataset`] measures a hundred thousand of them in the coefficients of
//! [`basis`].

pub mod assets;
mod error;
pub mod sampling;
pub mod tpose;

pub use error::{Error, Result};
