//! Where each measure is taken on the body: data over the vertices of LOD 0.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::catalogue::CATALOGUE;
use super::names::MeasureId;
use super::read::Reading;
use super::standing::{Standing, Turn};
use crate::{Error, Result};

/// How a measure is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Perimeter of the convex hull of the points, projected along the normal.
    Tape,
    /// Perimeter of the convex hull of a planar cut of the triangulated surface. The plane has the definition's normal
    /// and goes through the mean of the points; only the listed edges are cut.
    Slice,
    /// Distance between two points, or the absolute value of its component along the axis.
    Length,
    /// Distance along the axis between the two points that are furthest apart along it: a breadth, a depth, the stature.
    Extent,
}

/// The pose that a measure is taken in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stance {
    /// The T-pose, the bind pose: where a standing person measures the same.
    #[default]
    TPose,
    /// Upright with arms hanging and legs together: [`Standing`].
    Standing,
}

/// A point on the surface: vertices of LOD 0 with weights that sum to one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Point(pub Vec<(u32, f64)>);

impl Point {
    /// What is wrong with the point on a surface of `vertex_count` vertices.
    pub(super) fn validate(&self, vertex_count: usize) -> std::result::Result<(), String> {
        if let Some((v, _)) = self.0.iter().find(|(v, _)| *v as usize >= vertex_count) {
            return Err(format!("vertex {v} of {vertex_count}"));
        }
        let sum: f64 = self.0.iter().map(|t| t.1).sum();
        if !sum.is_finite() || (sum - 1.0).abs() > 1e-6 {
            return Err(format!("weights of a point sum to {sum}, not 1"));
        }
        Ok(())
    }
}

/// One measure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Definition {
    /// Identifier of the measure, with its side.
    pub name: String,
    /// How it is computed.
    pub kind: Kind,
    /// The pose that it is taken in.
    #[serde(default, skip_serializing_if = "is_t_pose")]
    pub stance: Stance,
    /// A loop's points, a slice's landmarks, a length's two ends or the points of an extent; in the T-pose.
    pub points: Vec<Point>,
    /// For the standing body: per point, the joint that carries it as bone does; `None` where it moves as skin. Empty for skin
    /// alone.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bones: Vec<Option<String>>,
    /// Unit normal, in model space, of the plane of a tape or slice; zero for lengths and extents.
    pub normal: DVec3,
    /// Unit axis, in model space, that a length or extent is measured along; `None` for the straight distance.
    pub axis: Option<DVec3>,
    /// Edges, diagonals 0–2 of the quads included, that a slice cuts; empty otherwise.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub edges: Vec<[u32; 2]>,
}

fn is_t_pose(stance: &Stance) -> bool {
    *stance == Stance::TPose
}

/// What errors are about.
const WHAT: &str = "measure definitions";

impl Definition {
    /// As [`MeasureId::standard`].
    pub fn standard(&self) -> Option<&'static str> {
        MeasureId::from_name(&self.name)?.standard()
    }

    fn validate(&self, vertex_count: usize) -> Result<()> {
        let fail = |message: String| Error::invalid(WHAT, format!("{}: {message}", self.name));
        let least = match self.kind {
            Kind::Tape => 3,
            Kind::Slice => 1,
            Kind::Length | Kind::Extent => 2,
        };
        if self.points.len() < least || (self.kind == Kind::Length && self.points.len() != 2) {
            return Err(fail(format!("{} points do not make a {:?}", self.points.len(), self.kind)));
        }
        if let Some(v) = self.edges.iter().flatten().find(|v| **v as usize >= vertex_count) {
            return Err(fail(format!("vertex {v} of {vertex_count}")));
        }
        for point in &self.points {
            point.validate(vertex_count).map_err(fail)?;
        }
        if !self.bones.is_empty() && (self.bones.len() != self.points.len() || self.stance == Stance::TPose) {
            let message = "bones: expected one per point of a measure of the standing body";
            return Err(fail(message.into()));
        }
        let unit = |v: DVec3| (v.length() - 1.0).abs() < 1e-6;
        if self.kind == Kind::Extent && self.axis.is_none() {
            return Err(fail("an extent needs an axis".into()));
        }
        if matches!(self.kind, Kind::Tape | Kind::Slice) && !unit(self.normal) {
            return Err(fail(format!("normal {} is not of unit length", self.normal)));
        }
        if self.axis.is_some_and(|a| !unit(a)) {
            return Err(fail("axis is not of unit length".into()));
        }
        if self.kind == Kind::Slice && self.edges.is_empty() {
            return Err(fail("a slice needs edges to cut".into()));
        }
        Ok(())
    }
}

/// The definitions of all measures, in the order of [`MeasureId`], ready to be read on bodies with a certain skin.
#[derive(Clone, Debug)]
pub struct Definitions {
    list: Vec<Definition>,
    readings: Vec<Reading>,
    turns: Vec<Turn>,
    hash: String,
}

/// Number of vertices of LOD 0, which the definitions index.
pub(super) const SURFACE_VERTICES: usize = 53_514;

impl Definitions {
    /// The definitions of this version of the library: `model/measures.json`.
    ///
    /// # Errors
    /// None for the file that the library is built with; a test reads it.
    pub fn embedded(standing: &Standing<'_>) -> Result<Self> {
        Self::from_json(include_str!("../../../model/measures.json"), SURFACE_VERTICES, standing)
    }

    /// Parses definitions over a surface of `vertex_count` vertices.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the measure that is missing, out of order or inconsistent.
    pub fn from_json(json: &str, vertex_count: usize, standing: &Standing<'_>) -> Result<Self> {
        let list = read_list(json, CATALOGUE.names(), vertex_count)?;
        let readings = list.iter().map(|d| Reading::new(d, standing)).collect::<Result<_>>()?;
        let mut hash = Sha256::new();
        hash.update(json);
        for turn in standing.turns() {
            hash.update(serde_json::to_string(turn).unwrap_or_default());
        }
        let hash = hash.finalize().iter().map(|b| format!("{b:02x}")).collect();
        Ok(Self { list, readings, turns: standing.turns().to_vec(), hash })
    }

    /// The turns from the T-pose to the standing body.
    pub fn turns(&self) -> &[Turn] {
        &self.turns
    }

    /// What a measure is read from.
    pub fn reading(&self, id: MeasureId) -> &Reading {
        &self.readings[id.index()]
    }

    /// Every vertex that some measure depends on, ascending.
    pub fn vertices(&self) -> Vec<u32> {
        let all = self.readings.iter().flat_map(|r| r.points()).flat_map(|p| p.terms().iter().map(|t| t.0));
        let mut vertices: Vec<u32> = all.collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }

    /// The definition of a measure.
    pub fn get(&self, id: MeasureId) -> &Definition {
        &self.list[id.index()]
    }

    /// All of them, in order.
    pub fn iter(&self) -> impl Iterator<Item = (MeasureId, &Definition)> {
        MeasureId::all().zip(&self.list)
    }

    /// SHA-256 of the JSON and of the turns of the standing body, in hexadecimal; a model file records the one that it was trained with.
    pub fn hash(&self) -> &str {
        &self.hash
    }
}

/// Parses the definitions of these measures, in this order, over a surface of `vertex_count` vertices.
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
