//! The kinds of faults common to all file formats.

use std::fmt::Display;

/// What is wrong at some location in a file, without the location.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// A word, number, type or size that the format does not allow.
    #[error("expected {expected}, got {found}")]
    Unexpected {
        /// What the format allows.
        expected: String,
        /// What the file contains.
        found: String,
    },
    /// The file, or a part of it, ends too early.
    #[error("truncated: expected {expected}, got {found}")]
    Truncated {
        /// What was expected.
        expected: String,
        /// What was found.
        found: String,
    },
    /// A required part is missing.
    #[error("has no {what}")]
    Missing {
        /// The part.
        what: String,
    },
    /// A number is infinite or not a number.
    #[error("{what}: {found} is not finite")]
    NotFinite {
        /// The quantity.
        what: String,
        /// The number, or the value that contains it.
        found: String,
    },
    /// A number beyond anything that can be meant.
    #[error("{what}: {found} is too large, expected {most}")]
    TooLarge {
        /// The quantity.
        what: String,
        /// The number.
        found: String,
        /// What it is expected to be.
        most: String,
    },
    /// More of something than the reader's limit.
    #[error("expected at most {most}, got {found}")]
    TooMany {
        /// The limit and what it limits.
        most: String,
        /// What the file contains or demands.
        found: String,
    },
    /// The file references an element that does not exist.
    #[error("{what} {index} does not exist, there are {count}")]
    Dangling {
        /// The kind of element.
        what: String,
        /// Its index, as counted in the file.
        index: i64,
        /// Number of such elements.
        count: usize,
    },
    /// Valid in the format, but not supported by this reader.
    #[error("{what} is not supported")]
    Unsupported {
        /// The feature.
        what: String,
    },
    /// Parts of the file are inconsistent with each other.
    #[error("{0}")]
    Inconsistent(String),
}

impl Fault {
    pub(crate) fn unexpected(expected: impl Display, found: impl Display) -> Self {
        Self::Unexpected { expected: expected.to_string(), found: found.to_string() }
    }

    pub(crate) fn truncated(expected: impl Display, found: impl Display) -> Self {
        Self::Truncated { expected: expected.to_string(), found: found.to_string() }
    }

    pub(crate) fn missing(what: impl Display) -> Self {
        Self::Missing { what: what.to_string() }
    }

    pub(crate) fn not_finite(what: impl Display, found: impl Display) -> Self {
        Self::NotFinite { what: what.to_string(), found: found.to_string() }
    }

    pub(crate) fn too_large(what: impl Display, found: impl Display, most: impl Display) -> Self {
        Self::TooLarge { what: what.to_string(), found: found.to_string(), most: most.to_string() }
    }

    pub(crate) fn too_many(most: impl Display, found: impl Display) -> Self {
        Self::TooMany { most: most.to_string(), found: found.to_string() }
    }

    pub(crate) fn dangling(what: impl Display, index: usize, count: usize) -> Self {
        Self::Dangling { what: what.to_string(), index: i64::try_from(index).unwrap_or(i64::MAX), count }
    }

    pub(crate) fn unsupported(what: impl Display) -> Self {
        Self::Unsupported { what: what.to_string() }
    }

    pub(crate) fn inconsistent(message: impl Display) -> Self {
        Self::Inconsistent(message.to_string())
    }
}

/// The error of a third-party parser for bytes that it cannot read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ParserError {
    /// It returned an error with this message.
    #[error("{0}")]
    Refused(String),
    /// It panicked.
    #[error("is damaged in a way that the parser does not understand")]
    Panicked,
}

impl ParserError {
    pub(crate) fn refused(message: impl Display) -> Self {
        Self::Refused(message.to_string())
    }
}
