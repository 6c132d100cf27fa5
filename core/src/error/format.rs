//! The errors of the file readers, one type per format: a [`Fault`] or the message of a parser, and its location in the
//! file.

use std::fmt::Display;

use super::{Error, Fault, ParserError};

/// Why the content of a file was refused: the source of [`Error::File`].
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The file extension is not that of a format supported for the purpose.
    #[error("unknown file extension, expected one of {expected}")]
    Extension {
        /// The supported extensions, with their dots.
        expected: String,
    },
    /// A BVH file.
    #[error(transparent)]
    Bvh(#[from] BvhError),
    /// An FBX file.
    #[error(transparent)]
    Fbx(#[from] FbxError),
    /// A glTF or VRM file.
    #[error(transparent)]
    Gltf(#[from] GltfError),
    /// An archive of numpy arrays.
    #[error(transparent)]
    Npz(#[from] NpzError),
    /// A Wavefront OBJ file.
    #[error(transparent)]
    Obj(#[from] ObjError),
    /// A USD file.
    #[error(transparent)]
    Usd(#[from] UsdError),
    /// A fault that is not specific to a format.
    #[error(transparent)]
    Fault(#[from] Fault),
    /// A joint mapping.
    #[error(r#"expected {{"source joint": "joint of ours" or null}}: {0}"#)]
    Mapping(serde_json::Error),
    /// The file could be read, but its content is inconsistent or unsuitable for its use.
    #[error(transparent)]
    Content(#[from] Box<Error>),
}

impl FormatError {
    /// The kind of fault, regardless of format and location; `None` where the message is from a parser or from another part of
    /// the library.
    pub fn fault(&self) -> Option<&Fault> {
        match self {
            Self::Bvh(error) => Some(&error.fault),
            Self::Fbx(error) => error.fault(),
            Self::Gltf(error) => error.fault(),
            Self::Npz(error) => error.fault(),
            Self::Obj(error) => Some(error.fault()),
            Self::Usd(error) => error.fault(),
            Self::Fault(fault) => Some(fault),
            Self::Extension { .. } | Self::Mapping(_) | Self::Content(_) => None,
        }
    }
}

/// An error that can state its location in the file.
pub(crate) trait Located: Sized {
    /// The error inside an enclosing part: `place` is prepended to the location.
    fn within(self, place: String) -> Self;
}

/// [`Located`] errors of results.
pub(crate) trait Within {
    /// States the part of the file that an error, if any, is in.
    fn within(self, place: impl Display) -> Self;
}

impl<T, E: Located> Within for Result<T, E> {
    fn within(self, place: impl Display) -> Self {
        self.map_err(|error| error.within(place.to_string()))
    }
}

/// Declares the error type of a format whose parts are identified by a path within the file.
macro_rules! located_error {
    ($(#[$doc:meta])* $name:ident { $($(#[$attribute:meta])* $variant:ident($($content:tt)*),)* }) => {
        $(#[$doc])*
        #[derive(Debug, thiserror::Error)]
        #[non_exhaustive]
        pub enum $name {
            /// Something is wrong in a part of the file.
            #[error("{path}: {source}")]
            In {
                /// The part, from the outermost to the innermost.
                path: String,
                /// What is wrong there.
                source: Box<Self>,
            },
            /// Something is wrong with the whole file, or with the part stated by an enclosing [`In`](Self::In).
            #[error(transparent)]
            Fault(#[from] Fault),
            $($(#[$attribute])* $variant($($content)*),)*
        }

        impl $name {
            /// The kind of fault, regardless of location; `None` for the message of a parser.
            pub fn fault(&self) -> Option<&Fault> {
                match self {
                    Self::In { source, .. } => source.fault(),
                    Self::Fault(fault) => Some(fault),
                    $(Self::$variant(..) => None,)*
                }
            }
        }

        impl Located for $name {
            fn within(self, place: String) -> Self {
                match self {
                    Self::In { path, source } => Self::In { path: format!("{place}: {path}"), source },
                    other => Self::In { path: place, source: Box::new(other) },
                }
            }
        }
    };
}

/// Something is wrong on a line of a BVH file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {fault}")]
pub struct BvhError {
    /// The line, from 1.
    pub line: usize,
    /// What is wrong there.
    #[source]
    pub fault: Fault,
}

/// Something is wrong in a Wavefront OBJ file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ObjError {
    /// On one line.
    #[error("line {line}: {fault}")]
    Line {
        /// The line, from 1.
        line: usize,
        /// What is wrong there.
        #[source]
        fault: Fault,
    },
    /// In the file as a whole.
    #[error(transparent)]
    Whole(#[from] Fault),
}

impl ObjError {
    /// The kind of fault, regardless of location.
    pub fn fault(&self) -> &Fault {
        match self {
            Self::Line { fault, .. } | Self::Whole(fault) => fault,
        }
    }
}

located_error! {
    /// Something is wrong in an archive of numpy arrays; parts are identified by the name of the array.
    NpzError {
        /// The parser cannot read the archive or an array.
        #[error("{0}")]
        Parser(#[from] ParserError),
        /// The joints are inconsistent.
        #[error("{0}")]
        Content(#[from] Box<Error>),
    }
}

located_error! {
    /// Something is wrong in an FBX file; parts are identified by the names of animations and nodes.
    FbxError {
        /// The parser cannot read it.
        #[error("is damaged or truncated: {0}")]
        Parser(#[from] ParserError),
        /// The joints are inconsistent.
        #[error("{0}")]
        Content(#[from] Box<Error>),
    }
}

located_error! {
    /// Something is wrong in a glTF or VRM file; parts are identified as in `nodes[3].mesh: POSITION: accessor 7`.
    GltfError {
        /// The JSON is not a valid glTF document.
        #[error("is neither a binary glTF nor valid glTF JSON: {0}")]
        Json(#[from] gltf_json::Error),
        /// A compressed buffer view cannot be decoded.
        #[error("{0}")]
        Parser(#[from] ParserError),
        /// The document could be read, but its skeleton, clips or meshes are inconsistent.
        #[error("{0}")]
        Content(#[from] Box<Error>),
    }
}

located_error! {
    /// Something is wrong in a USD file; parts are identified by the path of the prim or property.
    UsdError {
        /// The parser cannot read it.
        #[error("{0}")]
        Parser(#[from] ParserError),
        /// The layer could be read, but its skeleton, clips or meshes are inconsistent.
        #[error("{0}")]
        Content(#[from] Box<Error>),
    }
}
