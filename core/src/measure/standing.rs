//! The standing body: the T-pose with shoulders and arms let down and legs brought together, as surveys measure people.
//!
//! Each turn is a rotation by a fixed angle about an axis along z, through a centre that is a weighted mean of vertices.
//! Skin follows by linear blend skinning, bony landmarks ride on one bone. All of it is linear in the vertices, so that a
//! point of the standing body is a sum of vertices of the T-pose, each times a matrix, and measures of the standing body
//! have exact derivatives.

use std::collections::BTreeMap;

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

use super::definition::{Point, SURFACE_VERTICES};
use crate::{Error, Result};

/// What errors are about.
const WHAT: &str = "standing body";

/// A turn of a joint with everything below it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Turn {
    /// Name of the joint.
    pub joint: String,
    /// The point that it turns about, in the T-pose.
    pub centre: Point,
    /// Angle about +z, degrees: counter-clockwise as seen from in front of the body.
    pub degrees: f64,
}

/// A point that depends linearly on vertices: their sum, each times a matrix.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed(Vec<(u32, DMat3)>);

impl Placed {
    /// The vertices of the T-pose and their matrices.
    pub fn terms(&self) -> &[(u32, DMat3)] {
        &self.0
    }

    /// Its position; `at` gives the positions of vertices in the T-pose.
    pub fn position(&self, at: impl Fn(u32) -> DVec3) -> DVec3 {
        self.0.iter().map(|(v, matrix)| *matrix * at(*v)).sum()
    }

    /// A point of the T-pose.
    pub(super) fn unmoved(point: &Point) -> Self {
        Self(point.0.iter().map(|&(v, w)| (v, DMat3::from_diagonal(DVec3::splat(w)))).collect())
    }
}

/// Joint tree and skin weights of LOD 0, as far as [`Standing`] needs them.
#[derive(Clone, Copy)]
pub struct Skin<'a> {
    /// Names of the joints.
    pub joints: &'a [String],
    /// Parent of each joint, which comes before it.
    pub parents: &'a [Option<u32>],
    /// Joints and weights of a vertex; the weights sum to one.
    pub weights: &'a dyn Fn(u32) -> Vec<(u16, f32)>,
}

/// The turns from the T-pose to the standing body, and the skin that follows them.
pub struct Standing<'a> {
    turns: Vec<Turn>,
    /// Rotation of each turn.
    rotations: Vec<DMat3>,
    /// The turn that carries each one.
    carriers: Vec<Option<usize>>,
    /// The turn that carries each joint.
    turn_of_joint: Vec<Option<usize>>,
    skin: Skin<'a>,
}

impl<'a> Standing<'a> {
    /// The turns of this version of the library, `model/standing.json`, for a body with this skin.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the skin lacks a joint that turns.
    pub fn embedded(skin: Skin<'a>) -> Result<Self> {
        Self::new(&Self::embedded_turns()?, skin, SURFACE_VERTICES)
    }

    /// The turns of this version of the library.
    ///
    /// # Errors
    /// None for the file that the library is built with; a test reads it.
    pub fn embedded_turns() -> Result<Vec<Turn>> {
        serde_json::from_str(include_str!("../../../model/standing.json"))
            .map_err(|e| Error::invalid(WHAT, e.to_string()))
    }

    /// From turns, in any order, over a surface of `vertex_count` vertices.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a joint that the skin lacks, and for a centre that is no point of the surface.
    pub fn new(turns: &[Turn], skin: Skin<'a>, vertex_count: usize) -> Result<Self> {
        let mut turn_of_joint: Vec<Option<usize>> = Vec::with_capacity(skin.joints.len());
        let mut carriers = vec![None; turns.len()];
        let mut found = vec![false; turns.len()];
        for (name, parent) in skin.joints.iter().zip(skin.parents) {
            let inherited = parent.and_then(|p| turn_of_joint.get(p as usize).copied().flatten());
            let own = turns.iter().position(|turn| turn.joint == *name);
            if let Some(own) = own {
                carriers[own] = inherited;
                found[own] = true;
            }
            turn_of_joint.push(own.or(inherited));
        }
        for (i, turn) in turns.iter().enumerate() {
            let invalid = |message: String| Error::invalid(WHAT, format!("{}: {message}", turn.joint));
            turn.centre.validate(vertex_count).map_err(invalid)?;
            if !turn.degrees.is_finite() {
                return Err(invalid(format!("expected an angle, got {}", turn.degrees)));
            }
            if !found[i] {
                return Err(invalid("the skeleton has no such joint".into()));
            }
        }
        Ok(Self {
            rotations: turns.iter().map(|t| rotation_about_z(t.degrees)).collect(),
            turns: turns.to_vec(),
            carriers,
            turn_of_joint,
            skin,
        })
    }

    /// The turns.
    pub fn turns(&self) -> &[Turn] {
        &self.turns
    }

    /// Where a point of the skin stands.
    pub fn place(&self, point: &Point) -> Placed {
        let mut terms = BTreeMap::new();
        for &(vertex, weight) in &point.0 {
            let mut left = 1.0;
            for (turn, share) in self.shares(vertex) {
                left -= share;
                self.add_carried(
                    turn,
                    vertex,
                    DMat3::from_diagonal(DVec3::splat(weight * share)),
                    &mut terms,
                );
            }
            add(&mut terms, vertex, DMat3::from_diagonal(DVec3::splat(weight * left)));
        }
        Placed(terms.into_iter().collect())
    }

    /// Where a bony landmark stands that is carried by a joint: by the turn of this name.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a joint that does not turn.
    pub fn place_on_bone(&self, point: &Point, joint: &str) -> Result<Placed> {
        let turn = self.turns.iter().position(|turn| turn.joint == joint);
        let turn = turn.ok_or_else(|| Error::invalid(WHAT, format!("{joint} is no joint that turns")))?;
        let mut terms = BTreeMap::new();
        for &(vertex, weight) in &point.0 {
            self.add_carried(turn, vertex, DMat3::from_diagonal(DVec3::splat(weight)), &mut terms);
        }
        Ok(Placed(terms.into_iter().collect()))
    }

    /// The turns that a vertex follows, with weights; what is left of 1 stays.
    fn shares(&self, vertex: u32) -> BTreeMap<usize, f64> {
        let mut shares = BTreeMap::new();
        for (joint, weight) in (self.skin.weights)(vertex) {
            if let Some(turn) = self.turn_of_joint.get(usize::from(joint)).copied().flatten() {
                *shares.entry(turn).or_insert(0.0) += f64::from(weight);
            }
        }
        shares
    }

    /// Adds `matrix` times the vertex as this turn carries it: R (x − c) + c, then the turns that carry it.
    fn add_carried(&self, turn: usize, vertex: u32, matrix: DMat3, terms: &mut BTreeMap<u32, DMat3>) {
        // From the outermost turn inwards, the matrix that is applied last comes first.
        let mut chain = vec![turn];
        while let Some(carrier) = chain.last().and_then(|t| self.carriers[*t]) {
            chain.push(carrier);
        }
        let mut matrix = matrix;
        for &turn in chain.iter().rev() {
            let rotated = matrix * self.rotations[turn];
            for &(centre, weight) in &self.turns[turn].centre.0 {
                add(terms, centre, (matrix - rotated) * weight);
            }
            matrix = rotated;
        }
        add(terms, vertex, matrix);
    }
}

fn add(terms: &mut BTreeMap<u32, DMat3>, vertex: u32, matrix: DMat3) {
    *terms.entry(vertex).or_insert(DMat3::ZERO) += matrix;
}

fn rotation_about_z(degrees: f64) -> DMat3 {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    DMat3::from_cols(DVec3::new(cos, sin, 0.0), DVec3::new(-sin, cos, 0.0), DVec3::Z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn skin<'a>(joints: &'a [String], weights: &'a dyn Fn(u32) -> Vec<(u16, f32)>) -> Skin<'a> {
        Skin { joints, parents: &[None, Some(0), Some(1)], weights }
    }

    #[test]
    fn skin_and_bones_follow_as_in_skinning() {
        let surface: Vec<DVec3> = (0..30_u32)
            .map(|v| DVec3::new(f64::from(v * 7 % 11), f64::from(v * 5 % 13), f64::from(v * 3 % 17)))
            .collect();
        let joints = ["root", "arm", "hand"].map(str::to_owned);
        let weights = |v: u32| match v % 3 {
            0 => vec![(0, 1.0)],
            1 => vec![(0, 0.25), (1, 0.75)],
            _ => vec![(0, 0.125), (1, 0.375), (2, 0.5)],
        };
        let turn = |joint: &str, vertex, degrees| Turn {
            joint: joint.into(),
            centre: Point(vec![(vertex, 0.5), (vertex + 1, 0.5)]),
            degrees,
        };
        let turns = [turn("arm", 4, -78.0), turn("hand", 9, 31.0)];
        let standing = Standing::new(&turns, skin(&joints, &weights), 30).unwrap();
        let at = |v: u32| surface[v as usize];
        // Rigid motions by hand: a turn about its centre, the hand's carried by the arm's.
        let turned = |turn: &Turn, x: DVec3| {
            let c = turn.centre.position(at);
            let (sin, cos) = libm::sincos(turn.degrees.to_radians());
            let d = x - c;
            c + DVec3::new(cos * d.x - sin * d.y, sin * d.x + cos * d.y, d.z)
        };
        let arm = |x: DVec3| turned(&turns[0], x);
        let hand = |x: DVec3| arm(turned(&turns[1], x));
        for (v, &x) in (0..).zip(&surface) {
            let moved = weights(v).into_iter().map(|(joint, weight)| {
                let to = [x, arm(x), hand(x)][usize::from(joint)];
                to * f64::from(weight)
            });
            let point = Point(vec![(v, 1.0)]);
            let expected: DVec3 = moved.sum();
            assert!(standing.place(&point).position(at).distance(expected) < 1e-9, "{v}");
            let on_bone = standing.place_on_bone(&point, "hand").unwrap();
            assert!(on_bone.position(at).distance(hand(x)) < 1e-9, "{v}");
        }
        let two = Point(vec![(3, 0.25), (20, 0.75)]);
        let each = |v| standing.place(&Point(vec![(v, 1.0)])).position(at);
        assert!(standing.place(&two).position(at).distance(each(3) * 0.25 + each(20) * 0.75) < 1e-9);
    }

    #[test]
    fn turns_that_do_not_fit_are_refused() {
        let joints = ["root", "arm", "hand"].map(str::to_owned);
        let none = |_| Vec::new();
        let turn = |joint: &str, vertex, degrees| Turn {
            joint: joint.into(),
            centre: Point(vec![(vertex, 1.0)]),
            degrees,
        };
        for (bad, message) in [
            (turn("leg", 0, 5.0), "leg: the skeleton has no such joint"),
            (turn("arm", 30, 5.0), "arm: vertex 30"),
            (turn("arm", 0, f64::NAN), "arm: expected an angle"),
        ] {
            let Err(error) = Standing::new(&[bad], skin(&joints, &none), 30) else { panic!("{message}") };
            assert!(error.to_string().contains(message), "{error}");
        }
        let standing = Standing::new(&[turn("arm", 0, 5.0)], skin(&joints, &none), 30).unwrap();
        let error = standing.place_on_bone(&Point(vec![(0, 1.0)]), "root").unwrap_err().to_string();
        assert!(error.contains("root is no joint that turns"), "{error}");
    }

    #[test]
    fn the_librarys_turns_are_symmetric() {
        let turns = Standing::embedded_turns().unwrap();
        let names: Vec<&str> = turns.iter().map(|turn| turn.joint.as_str()).collect();
        assert_eq!(names, ["clavicle_l", "upperarm_l", "thigh_l", "clavicle_r", "upperarm_r", "thigh_r"]);
        for i in 0..3 {
            assert_eq!(turns[i].degrees, -turns[i + 3].degrees);
        }
    }
}
