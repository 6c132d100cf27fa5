//! Errors of the command and their exit codes.

use std::error::Error;
use std::path::{Path, PathBuf};

/// What the command's fallible functions return.
pub(crate) type Result<T> = std::result::Result<T, Failure>;

/// Why the command failed. The kind decides the exit code.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// The command line is wrong or contradicts itself: exit code 2.
    #[error("{0}")]
    Usage(String),
    /// The work could not be done.
    #[error("{0}")]
    Failed(String),
    /// The library refused something.
    #[error(transparent)]
    Library(#[from] anthronet::Error),
    /// The trainer failed.
    #[cfg(feature = "train")]
    #[error(transparent)]
    Trainer(#[from] anthronet_trainer::Error),
    /// What an input describes, a file or a person of several, is wrong.
    #[error("{input}: {source}")]
    Input { input: String, source: Box<dyn Error + Send + Sync> },
    /// The system refused to `action` (read, write, create) a file.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io { path: PathBuf, action: &'static str, source: std::io::Error },
    /// A result could not be written as JSON.
    #[error("cannot write JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A picture could not be written as PNG.
    #[error("cannot encode the PNG: {0}")]
    Png(#[from] png::EncodingError),
    /// Pictures could not be written as GIF.
    #[error("cannot encode the GIF: {0}")]
    Gif(#[from] gif::EncodingError),
}

impl Failure {
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self::Usage(message.into())
    }

    pub(crate) fn failed(message: impl Into<String>) -> Self {
        Self::Failed(message.into())
    }

    /// The system's refusal to `action` (read, write, create) a file.
    pub(crate) fn io(action: &'static str, path: &Path, source: std::io::Error) -> Self {
        Self::Io { path: path.to_path_buf(), action, source }
    }

    /// An error in a file, with its path.
    pub(crate) fn in_file(path: &Path, error: impl Error + Send + Sync + 'static) -> Self {
        Self::Input { input: path.display().to_string(), source: Box::new(error) }
    }

    /// A command that needs the networks of the feature `train`, in a build without them.
    #[cfg(not(feature = "train"))]
    pub(crate) fn without_networks(command: &str) -> Self {
        Self::Usage(format!(
            "this build has no networks: run `cargo anthronet-train {command}` in the source tree"
        ))
    }

    /// 1 failed, 2 bad usage.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            _ => 1,
        }
    }
}

/// Why the value of an option is refused; clap prints it after the option's name.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(crate) enum InvalidValue {
    /// The value is not of the form that the option takes.
    #[error("expected {expected}, got `{got}`")]
    Form { expected: &'static str, got: String },
    /// The length of this measure is wrong.
    #[error("{measure}: {source}")]
    Measure { measure: String, source: Box<InvalidValue> },
    /// The library refuses the value.
    #[error("{0}")]
    Refused(String),
}

impl InvalidValue {
    pub(crate) fn form(expected: &'static str, got: &str) -> Self {
        Self::Form { expected, got: got.to_owned() }
    }
}
