//! Fixtures for tests of several rooms: small bodies, skeletons, clips and scenes that need no model file.

pub(crate) mod bodies;
pub(crate) mod clips;
pub(crate) mod fuzz;
pub(crate) mod memory;
pub(crate) mod person;
pub(crate) mod scene;
