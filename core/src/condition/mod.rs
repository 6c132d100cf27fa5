//! From a request to the condition of the network.

pub mod fourier;
