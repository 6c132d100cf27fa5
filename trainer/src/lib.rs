//! Makes the model of `anthronet`: source bodies (CC0), sampling, data set, basis, networks, evaluation.
//!
//! The tour, in the order in which data flows: [`assets`] reads the MakeHuman data, [`sampling`] draws people,
//! [`tpose`] straightens their arms, [`dataset`] measures a hundred thousand of them in the coefficients of
//! [`basis`].

pub mod assets;
pub mod basis;
mod checkpoint;
pub mod corpus;
pub mod dataset;
mod error;
pub mod generator;
pub mod landmarks;
mod losses;
mod progress;
pub mod sampling;
pub mod tpose;
pub mod training;

pub use error::{Error, Result};
