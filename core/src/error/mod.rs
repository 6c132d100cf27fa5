//! The error type of the library: every variant names what was wrong, what was expected and what came.

mod fault;
mod format;

use std::path::{Path, PathBuf};

pub use fault::{Fault, ParserError};
pub use format::{BvhError, FbxError, FormatError, GltfError, NpzError, ObjError, UsdError};
pub(crate) use format::{Located, Within};

/// What the library's fallible functions return.
pub type Result<T> = std::result::Result<T, Error>;

/// Everything that can go wrong, grouped by what the caller can do about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A field of a request is unknown, not finite, out of range or of the wrong size.
    #[error("{field}: {message}")]
    Request {
        /// The field as the caller wrote it, such as `height` or `z`.
        field: String,
        /// What was expected and what came, with a hint where there is one.
        message: String,
    },
    /// The given measures cannot belong to one person.
    #[error("{0}")]
    Infeasible(Infeasible),
    /// The model file is damaged, of another version or does not match this library.
    #[error("model {origin}: {message}")]
    Model {
        /// Path of the file, or `(embedded)`, or `(memory)`.
        origin: String,
        /// What was expected and what came.
        message: String,
    },
    /// A file that was read is not what it should be.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What was expected and what came, with line or offset where known.
        source: FormatError,
    },
    /// The operating system refused to read or write.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What was tried: `read`, `write`, `create`.
        action: &'static str,
        /// The system's error.
        source: std::io::Error,
    },
    /// Data handed to an exporter or a constructor contradicts itself.
    #[error("{what}: {message}")]
    Invalid {
        /// The thing that is wrong, such as `joint weights`.
        what: &'static str,
        /// What was expected and what came.
        message: String,
    },
}

/// Why a request is refused that nobody can meet; prints as one sentence per conflict.
#[derive(Clone, Debug, PartialEq)]
pub struct Infeasible {
    /// What quarrels, worst first; never empty.
    pub conflicts: Vec<Conflict>,
}

/// Given measures that do not go together, or that do not fit beside earlier conflicts; a measure is in one conflict
/// only.
///
/// The set is minimal: whichever name is left out, the rest does go together. One of up to four names is also among the
/// smallest that there are. Only a request that is wrong all over ends with a conflict of all its measures.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Conflict {
    /// The measures, in order.
    pub measures: Vec<ConflictMeasure>,
    /// A sentence for people.
    pub message: String,
}

/// One measure of a [`Conflict`], metres.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ConflictMeasure {
    /// Identifier, with its side.
    pub name: &'static str,
    /// What the request gives.
    pub asked: f64,
    /// What would do.
    pub nearest: f64,
}

impl std::fmt::Display for Infeasible {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (i, conflict) in self.conflicts.iter().enumerate() {
            write!(f, "{}{}", if i > 0 { "; " } else { "" }, conflict.message)?;
        }
        Ok(())
    }
}

impl Error {
    /// An error about one field of a request.
    pub fn request(field: impl Into<String>, message: impl Into<String>) -> Self {
        Self::Request { field: field.into(), message: message.into() }
    }

    /// An error about the content of a file.
    pub fn file(path: impl AsRef<Path>, source: impl Into<FormatError>) -> Self {
        Self::File { path: path.as_ref().to_path_buf(), source: source.into() }
    }

    /// An error about data that contradicts itself.
    pub fn invalid(what: &'static str, message: impl Into<String>) -> Self {
        Self::Invalid { what, message: message.into() }
    }
}

/// How unlike two names are, to suggest the one that was meant: Levenshtein distance in characters. Only the first 64 are
/// looked at: a name is never longer.
pub(crate) fn edit_distance(a: &str, b: &str) -> usize {
    let characters = |name: &str| name.chars().take(64).collect::<Vec<char>>();
    strsim::generic_levenshtein(&characters(a), &characters(b))
}

#[cfg(test)]
mod tests {
    use super::edit_distance;

    #[test]
    fn names_are_as_far_apart_as_the_characters_to_change() {
        assert_eq!(edit_distance("thig_l", "thigh_l"), 1);
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "é—"), 2);
        let long = "x".repeat(64);
        assert_eq!(edit_distance(&format!("{long}a"), &format!("{long}bcd")), 0, "of names longer than any");
    }
}
