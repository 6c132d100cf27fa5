//! What is known of the skeleton.

pub mod humanoid;
