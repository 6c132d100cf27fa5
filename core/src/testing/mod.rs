//! What tests of several rooms share: small bodies, people, clips and scenes that need no model file.

pub(crate) mod bodies;
pub(crate) mod clips;
pub(crate) mod person;
pub(crate) mod scene;
