//! Errors of the command and their exit codes.

use std::fmt;
use std::path::Path;

/// What the command's fallible functions return.
pub(crate) type Result<T> = std::result::Result<T, Failure>;

/// Why the command failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line is wrong or contradicts itself: exit code 2.
    Usage(String),
    /// The work could not be done: exit code 1.
    Failed(String),
}

impl Failure {
    pub(crate) fn usage(message: impl Into<String>) -> Self {
        Self::Usage(message.into())
    }

    pub(crate) fn failed(message: impl Into<String>) -> Self {
        Self::Failed(message.into())
    }

    /// The system's refusal to `action` (read, write, create) a file.
    pub(crate) fn io(action: &str, path: &Path, error: &std::io::Error) -> Self {
        Self::Failed(format!("{}: cannot {action}: {error}", path.display()))
    }

    /// An error in a file, with its path.
    pub(crate) fn in_file(path: &Path, error: &impl fmt::Display) -> Self {
        Self::Failed(format!("{}: {error}", path.display()))
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
            Self::Failed(_) => 1,
            Self::Usage(_) => 2,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usage(message) | Self::Failed(message) => f.write_str(message),
        }
    }
}

impl From<anthronet::Error> for Failure {
    fn from(error: anthronet::Error) -> Self {
        Self::Failed(error.to_string())
    }
}

#[cfg(feature = "train")]
impl From<anthronet_trainer::Error> for Failure {
    fn from(error: anthronet_trainer::Error) -> Self {
        Self::failed(error.to_string())
    }
}
