//! The error type of the library: every variant says what is wrong, what was expected and what was found.

mod fault;
mod format;

use std::path::{Path, PathBuf};

pub use fault::{Fault, ParserError};
pub use format::{BvhError, FbxError, FormatError, GltfError, NpzError, ObjError, UsdError};
pub(crate) use format::{Located, Within};

/// The result of the library's fallible functions.
pub type Result<T> = std::result::Result<T, Error>;

/// Everything that can go wrong, grouped by what the caller can do about it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A field of a request is unknown, not finite, out of range or of the wrong size.
    #[error("{field}: {message}")]
    Request {
        /// The field as named by the caller, such as `height` or `z`.
        field: String,
        /// What was expected and what was found, with a hint where possible.
        message: String,
    },
    /// The given measures cannot belong to one person.
    #[error("{0}")]
    Infeasible(Infeasible),
    /// The model file is damaged, has another version or does not match this library.
    #[error("model {origin}: {message}")]
    Model {
        /// Path of the file, or `(embedded)`, or `(memory)`.
        origin: String,
        /// What was expected and what was found.
        message: String,
    },
    /// The content of a file is not what it should be.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What was expected and what was found, and where in the file.
        source: FormatError,
    },
    /// The operating system refused to read or write.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The operation that failed: `read`, `write`, `create`.
        action: &'static str,
        /// The operating system's error.
        source: std::io::Error,
    },
    /// Data passed to an exporter or a constructor is inconsistent.
    #[error("{what}: {message}")]
    Invalid {
        /// The invalid item, such as `joint weights`.
        what: &'static str,
        /// What was expected and what was found.
        message: String,
    },
}

/// Why no body can meet a request; displays as one sentence per conflict.
#[derive(Clone, Debug, PartialEq)]
pub struct Infeasible {
    /// The conflicts, in the order in which they were found; not empty in an [`Error::Infeasible`].
    pub conflicts: Vec<Conflict>,
}

/// Requested measures that contradict each other, or contradict the corrected values of earlier conflicts; no measure is in
/// more than one conflict.
///
/// The set is minimal: without any one of its measures, the rest is feasible. A conflict of up to four measures is also one
/// of the smallest possible. Only a request with more than three conflicts ends with one of all remaining measures.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Conflict {
    /// The measures, in order.
    pub measures: Vec<ConflictMeasure>,
    /// The conflict as an English sentence.
    pub message: String,
}

/// One measure of a [`Conflict`], metres.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ConflictMeasure {
    /// Identifier of the measure, including its side.
    pub name: &'static str,
    /// The value in the request.
    pub asked: f64,
    /// The value in the nearest feasible request.
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

    /// An error about inconsistent data.
    pub fn invalid(what: &'static str, message: impl Into<String>) -> Self {
        Self::Invalid { what, message: message.into() }
    }
}

/// Levenshtein distance of two names in characters, for suggesting the intended one. Only the first 64 characters are
/// compared: no known name is longer.
pub(crate) fn edit_distance(a: &str, b: &str) -> usize {
    let characters = |name: &str| name.chars().take(64).collect::<Vec<char>>();
    strsim::generic_levenshtein(&characters(a), &characters(b))
}

#[cfg(test)]
mod tests {
    use super::edit_distance;

    #[test]
    fn distances_count_the_characters_to_change() {
        assert_eq!(edit_distance("thig_l", "thigh_l"), 1);
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "é—"), 2);
        let long = "x".repeat(64);
        assert_eq!(edit_distance(&format!("{long}a"), &format!("{long}bcd")), 0, "of names longer than any");
    }
}
