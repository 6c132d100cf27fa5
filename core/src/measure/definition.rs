//! Where each measure lies on the body: data over the vertices of the finest level of detail.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::catalogue::CATALOGUE;
use super::names::MeasureId;
use crate::{Error, Result};

/// How a measure is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Perimeter of the convex hull of the points, projected along the normal.
    Tape,
    /// Perimeter of the convex hull of the cut of the triangulated surface by the plane through the mean of the
    /// points with the normal; only the listed edges are cut.
    Slice,
    /// Distance between two points, or how far apart they are along the axis.
    Length,
}

/// A place on the surface: a weighted sum of vertices, weights summing to one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Point(pub Vec<(u32, f64)>);

/// One measure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Definition {
    /// Identifier.
    pub name: String,
    /// How it is read.
    pub kind: Kind,
    /// A loop's points, a slice's landmarks or a length's two ends.
    pub points: Vec<Point>,
    /// Unit normal of the plane of a tape or slice; zero for a length.
    pub normal: DVec3,
    /// Unit axis that a length is measured along; `None` for the straight distance.
    pub axis: Option<DVec3>,
    /// Edges, diagonals 0–2 of the quads included, that a slice cuts; empty otherwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub edges: Vec<[u32; 2]>,
}

/// What errors are about.
const WHAT: &str = "measure definitions";

impl Definition {
    /// The nearest measure of ISO 8559-1, ISO 7250-1 or ANSUR II, where one exists.
    pub fn standard(&self) -> Option<&'static str> {
        MeasureId::from_name(&self.name)?.standard()
    }

    /// Every vertex that the measure depends on.
    pub fn vertices(&self) -> impl Iterator<Item = u32> + '_ {
        let points = self.points.iter().flat_map(|p| p.0.iter().map(|t| t.0));
        points.chain(self.edges.iter().flatten().copied())
    }

    fn validate(&self, vertex_count: usize) -> Result<()> {
        let fault = |message: String| Err(Error::invalid(WHAT, format!("{}: {message}", self.name)));
        let need = match self.kind {
            Kind::Tape => 3,
            Kind::Slice => 1,
            Kind::Length => 2,
        };
        if self.points.len() < need || (self.kind == Kind::Length && self.points.len() != 2) {
            return fault(format!("{} points do not make a {:?}", self.points.len(), self.kind));
        }
        if let Some(v) = self.vertices().find(|v| *v as usize >= vertex_count) {
            return fault(format!("vertex {v} of {vertex_count}"));
        }
        for point in &self.points {
            let sum: f64 = point.0.iter().map(|t| t.1).sum();
            if !sum.is_finite() || (sum - 1.0).abs() > 1e-6 {
                return fault(format!("weights of a point sum to {sum}, not 1"));
            }
        }
        let unit = |v: DVec3| (v.length() - 1.0).abs() < 1e-6;
        if self.kind != Kind::Length && !unit(self.normal) {
            return fault(format!("normal {} is not of unit length", self.normal));
        }
        if self.axis.is_some_and(|a| !unit(a)) {
            return fault("axis is not of unit length".into());
        }
        if self.kind == Kind::Slice && self.edges.is_empty() {
            return fault("a slice needs edges to cut".into());
        }
        Ok(())
    }
}

/// The definitions of all measures, in the order of [`MeasureId`].
#[derive(Clone, Debug, PartialEq)]
pub struct Definitions {
    list: Vec<Definition>,
    hash: String,
}

/// Vertices of the surface that the definitions index.
const SURFACE_VERTICES: usize = 53_514;

impl Definitions {
    /// The definitions of this version of the library: `model/measures.json`.
    ///
    /// # Errors
    /// Never for the file that the library is built with; a test holds that.
    pub fn embedded() -> Result<Self> {
        Self::from_json(include_str!("../../../model/measures.json"), SURFACE_VERTICES)
    }

    /// Reads definitions over a surface of so many vertices.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the measure that is missing, out of order or inconsistent.
    pub fn from_json(json: &str, vertex_count: usize) -> Result<Self> {
        let list = read_list(json, CATALOGUE.names(), vertex_count)?;
        let hash = Sha256::digest(json.as_bytes()).iter().map(|b| format!("{b:02x}")).collect();
        Ok(Self { list, hash })
    }

    /// The definition of a measure.
    pub fn get(&self, id: MeasureId) -> &Definition {
        &self.list[id.index()]
    }

    /// All of them, in order.
    pub fn iter(&self) -> impl Iterator<Item = (MeasureId, &Definition)> {
        MeasureId::all().zip(&self.list)
    }

    /// SHA-256 of the file they came from, as hexadecimal digits: a model records which it was trained with.
    pub fn hash(&self) -> &str {
        &self.hash
    }
}

/// Reads the definitions of these measures, in this order, over a surface of so many vertices.
pub(super) fn read_list<'a>(
    json: &str,
    names: impl ExactSizeIterator<Item = &'a str>,
    vertex_count: usize,
) -> Result<Vec<Definition>> {
    let fail = |message: String| Error::invalid(WHAT, message);
    let list: Vec<Definition> = serde_json::from_str(json).map_err(|e| fail(e.to_string()))?;
    if list.len() != names.len() {
        return Err(fail(format!("expected {} measures, got {}", names.len(), list.len())));
    }
    for (name, definition) in names.zip(&list) {
        if definition.name != name {
            return Err(fail(format!("expected {name}, got {}", definition.name)));
        }
        definition.validate(vertex_count)?;
    }
    Ok(list)
}
