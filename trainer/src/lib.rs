//! Makes the model.
