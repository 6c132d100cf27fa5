//! USD with UsdSkel: text, crate and package files.

mod character;
mod document;
pub(super) mod motion;
pub(crate) mod write;

use std::path::{Path, PathBuf};

use self::document::Document;
use super::kind::{Description, Holds, Write};
use super::motion::clip_name;
use crate::Error;
use crate::error::UsdError;

pub use write::{to_usda, to_usdc, to_usdz};

type Result<T> = std::result::Result<T, UsdError>;

pub(super) const USDA: Description = Description {
    extension: "usda",
    title: "USD, text",
    holds: Holds { meshes: true, skeleton: true, clips: true },
    read_motion: Some(|bytes, path, options| {
        opened(bytes, path, |d| motion::read(d, &clip_name(path), options))
    }),
    read_scene: Some(|bytes, path| opened(bytes, path, |document| character::scene(document, path))),
    read_meshes: Some(|bytes, path| opened(bytes, path, character::meshes)),
    write: Some(Write::Alone(|scene, _| to_usda(scene))),
};

/// Text or a crate, whichever it is; written as one or the other.
pub(super) const USD: Description =
    Description { extension: "usd", title: "USD, text or crate", write: None, ..USDA };

pub(super) const USDC: Description = Description {
    extension: "usdc",
    title: "USD, crate",
    write: Some(Write::Alone(|scene, _| to_usdc(scene))),
    ..USDA
};

pub(super) const USDZ: Description = Description {
    extension: "usdz",
    title: "USD, package",
    write: Some(Write::Alone(|scene, _| to_usdz(scene))),
    ..USDA
};

/// Parses a file and reads part of it.
fn opened<T>(bytes: &[u8], path: &Path, read: impl FnOnce(&Document) -> Result<T>) -> crate::Result<T> {
    Document::open(bytes, path).and_then(|document| read(&document)).map_err(|error| Error::file(path, error))
}

/// The layers and assets that a file refers to.
pub(super) fn files_beside(bytes: &[u8], path: &Path) -> Vec<PathBuf> {
    document::files(bytes, path)
}
