//! Makes the model of `anthronet`: source bodies (CC0), sampling, data set, basis, networks, evaluation.
//!
//! In the order of the data flow: [`assets`] reads the MakeHuman data, [`sampling`] draws bodies with slider values around
//! the centres that [`biases`] fits, [`tpose`] straightens their arms, [`corpus`] numbers them, [`landmarks`] and
//! [`measures`] are defined on their mean, [`dataset`] measures two hundred thousand of them and expresses them in the coefficients of
//! [`basis`], [`generator`] trains the network, [`reduce`] and [`pack`] make the model file, [`evaluation`] scores it
//! on such bodies and [`people`] on the real people of a [`survey`]; [`commands`] combines them.

pub mod assets;
pub mod basis;
pub mod biases;
mod checkpoint;
pub mod commands;
pub mod corpus;
pub mod dataset;
mod error;
pub mod evaluation;
pub mod generator;
pub mod landmarks;
mod losses;
pub mod measures;
pub mod pack;
pub mod people;
pub mod population;
mod progress;
pub mod reduce;
pub mod sampling;
pub mod smoothness;
pub mod survey;
pub mod tpose;
pub mod training;

pub use error::{Error, Result};
