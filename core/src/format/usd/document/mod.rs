//! A parsed file: one layer, with its prims by type.

pub(super) mod layer;
pub(super) mod skeleton;
pub(super) mod values;
pub(super) mod xform;

use openusd::sdf::Path;

use self::layer::Layer;
use self::skeleton::Skeleton;
use crate::format::usd::Result;

/// One layer; what it references in other files is not read.
pub(super) struct Document {
    /// Its values are decoded on demand.
    pub(super) layer: Layer,
    /// All active, defined prims in file order, parents first.
    pub(super) prims: Vec<Path>,
    /// Prims of type `Skeleton`, `SkelAnimation` and `Mesh`.
    skeletons: Vec<Path>,
    pub(super) animations: Vec<Path>,
    pub(super) meshes: Vec<Path>,
}

impl Document {
    /// Parses the bytes of a `.usda`, `.usdc` or `.usdz`, identified by their first bytes.
    pub(super) fn open(bytes: &[u8]) -> Result<Self> {
        let layer = Layer::open(bytes)?;
        let prims = layer.prims()?;
        let (mut skeletons, mut animations, mut meshes) = (Vec::new(), Vec::new(), Vec::new());
        for prim in &prims {
            match layer.type_name(prim)?.as_str() {
                "Skeleton" => skeletons.push(prim.clone()),
                "SkelAnimation" => animations.push(prim.clone()),
                "Mesh" => meshes.push(prim.clone()),
                _ => {}
            }
        }
        Ok(Self { layer, prims, skeletons, animations, meshes })
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
