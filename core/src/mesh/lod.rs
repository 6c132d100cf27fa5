//! Levels of detail.

use serde::{Deserialize, Serialize};

use crate::{Error, Result};

/// A level of detail of the body's mesh.
///
/// LOD 0 is the subdivided surface. The vertices of LOD 1 are the first vertices of LOD 0; LODs 2 and 3 are index lists
/// over those of LOD 1, with about 25 % and 6 % of its faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "u8", into = "u8")]
pub enum Lod {
    /// 53,514 vertices, the surface that measures are defined on.
    #[default]
    Lod0,
    /// 13,380 vertices.
    Lod1,
    /// About 3,300 vertices.
    Lod2,
    /// About 800 vertices.
    Lod3,
}

impl Lod {
    /// All levels, finest first.
    pub const ALL: [Self; 4] = [Self::Lod0, Self::Lod1, Self::Lod2, Self::Lod3];

    /// The level's number, 0 for the finest.
    pub fn index(self) -> usize {
        self as usize
    }
}

impl TryFrom<u8> for Lod {
    type Error = Error;

    fn try_from(level: u8) -> Result<Self> {
        Self::ALL
            .get(usize::from(level))
            .copied()
            .ok_or_else(|| Error::request("lod", format!("expected 0, 1, 2 or 3, got {level}")))
    }
}

impl From<Lod> for u8 {
    fn from(lod: Lod) -> Self {
        lod as u8
    }
}
