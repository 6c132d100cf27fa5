//! The kinds of faults that files of all formats share.

use std::fmt::Display;

/// What is wrong at one place of a file, without the place.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// A word, number, type or size other than the format allows.
    #[error("expected {expected}, got {found}")]
    Unexpected {
        /// What the format allows there.
        expected: String,
        /// What the file has.
        found: String,
    },
    /// The file, or a part of it, ends too early.
    #[error("truncated: expected {expected}, got {found}")]
    Truncated {
        /// What should have come.
        expected: String,
        /// What came.
        found: String,
    },
    /// A part that has to be there is not.
    #[error("has no {what}")]
    Missing {
        /// The part.
        what: String,
    },
    /// A number is infinite or not a number.
    #[error("{what}: {found} is not finite")]
    NotFinite {
        /// What the number belongs to.
        what: String,
        /// The number, or those around it.
        found: String,
    },
    /// More of something than is read.
    #[error("expected at most {most}, got {found}")]
    TooMany {
        /// The limit and what it limits.
        most: String,
        /// What the file has, or asks for.
        found: String,
    },
    /// The file refers to something that it does not have.
    #[error("{what} {index} does not exist, there are {count}")]
    Dangling {
        /// What is referred to.
        what: String,
        /// Its place, as the file counts.
        index: i64,
        /// How many there are.
        count: usize,
    },
    /// The format allows it, but it is not read here.
    #[error("{what} is not supported")]
    Unsupported {
        /// The part of the format.
        what: String,
    },
    /// Parts of the file contradict each other.
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

/// The error of a parser for bytes that it cannot read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ParserError {
    /// It refused them, with this message.
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
