//! What can go wrong while making a model.

/// What the trainer's fallible functions return.
pub type Result<T> = std::result::Result<T, Error>;

/// An error of the trainer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The library refused something.
    #[error(transparent)]
    Core(#[from] anthronet::Error),
    /// candle failed.
    #[error("candle: {0}")]
    Candle(#[from] candle_core::Error),
    /// The source of bodies could not be fetched or is not what it should be.
    #[error("source of bodies: {0}")]
    Source(String),
    /// A file could not be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: String,
        /// The system's error.
        source: std::io::Error,
    },
    /// Inputs or settings contradict each other, or a computation failed.
    #[error("{0}")]
    Invalid(String),
}

impl Error {
    /// An input or output error about a path.
    pub fn io(path: impl AsRef<std::path::Path>) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.as_ref().display().to_string();
        move |source| Self::Io { path, source }
    }
}
