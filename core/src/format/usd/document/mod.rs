//! A parsed file: one layer, composed of those that it refers to, with its prims by type.

mod compose;
pub(super) mod layer;
pub(super) mod skeleton;
mod text;
pub(super) mod values;
pub(super) mod xform;

use std::path::{Path as FilePath, PathBuf};

use openusd::sdf::{FieldKey, Path};

use self::layer::Layer;
use self::skeleton::Skeleton;
use crate::format::usd::Result;

/// One layer, composed of those that it refers to in its own folder or below.
pub(super) struct Document {
    /// Its values are decoded on demand.
    pub(super) layer: Layer,
    /// All active, defined prims in file order, parents first.
    pub(super) prims: Vec<Path>,
    /// Prims of type `Skeleton`, `SkelAnimation` and `Mesh`.
    skeletons: Vec<Path>,
    pub(super) animations: Vec<Path>,
    pub(super) meshes: Vec<Path>,
    /// What could not be composed, one sentence each.
    pub(super) missing: Vec<String>,
    /// Prims with value clips, which are not read.
    pub(super) value_clips: Vec<Path>,
}

impl Document {
    /// Parses the bytes of a text, crate or package file, identified by their first bytes; `path` locates the layers that
    /// it refers to.
    pub(super) fn open(bytes: &[u8], path: &FilePath) -> Result<Self> {
        let (layer, missing, mut value_clips) = Layer::open(bytes, path)?;
        let prims = layer.prims()?;
        let (mut skeletons, mut animations, mut meshes) = (Vec::new(), Vec::new(), Vec::new());
        for prim in &prims {
            if layer.field(prim, FieldKey::Clips.as_str())?.is_some() {
                value_clips.push(prim.clone());
            }
            match layer.type_name(prim)?.as_str() {
                "Skeleton" => skeletons.push(prim.clone()),
                "SkelAnimation" => animations.push(prim.clone()),
                "Mesh" => meshes.push(prim.clone()),
                _ => {}
            }
        }
        Ok(Self { layer, prims, skeletons, animations, meshes, missing, value_clips })
    }

    /// Number of skeletons, of which one is read.
    pub(super) fn skeleton_count(&self) -> usize {
        self.skeletons.len()
    }

    /// The first skeleton with a bound animation, or else the first.
    pub(super) fn skeleton(&self) -> Result<Option<Skeleton>> {
        Skeleton::read(&self.layer, &self.skeletons)
    }
}

/// The layers and assets that a file is made of or refers to.
pub(super) fn files(bytes: &[u8], path: &FilePath) -> Vec<PathBuf> {
    compose::files(bytes, path)
}
