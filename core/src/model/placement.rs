//! How a mesh of the model's topology lies in its file: unit, axes, handedness and order of vertices, found by comparison
//! with the mean body.
//!
//! The similarity that brings the mean body closest to the mesh tells all of it. Its scale tells the unit, as people are
//! about as tall as each other, its rotation the axes and its determinant a mirrored mesh. Where vertices are in another
//! order, neighbours are far apart.

use glam::{DMat3, DVec3, Vec3};

use super::generator::Model;
use crate::mesh::Lod;
use crate::space::Unit;
use crate::{Error, Result};

/// Statures of bodies in metres, metres. Wider than those of the model: a body in its own unit is measured as it is.
const IN_METRES: [f64; 2] = [0.5, 3.0];
/// Statures of bodies in other units, metres; the units' ranges do not overlap.
const IN_OTHERS: [f64; 2] = [1.2, 2.4];
/// The units that bodies come back in.
const OTHERS: [Unit; 5] = [Unit::Centimetre, Unit::Millimetre, Unit::Inch, Unit::Foot, Unit::Decimetre];
/// Largest angle between a body and the axes, radians: no body of the model fits a turn of more than a degree best.
const MAX_TILT: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// Neighbours that are as many times as far apart as in the mean body are none. Bodies of the model reach half of it.
const MAX_STRETCH: f64 = 8.0;
/// Shorter edges of the mean body, metres, count as so long, as eyelids and lips vary by more than their edges.
const SHORT_EDGE: f64 = 0.003;

/// The unit and axes of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placement {
    unit: Unit,
    /// From the file's axes to +Y up and +Z forward: a signed permutation without mirroring.
    model_from_file: DMat3,
}

impl Placement {
    /// Metres, +Y up, +Z forward.
    pub(crate) const OURS: Self = Self { unit: Unit::Metre, model_from_file: DMat3::IDENTITY };

    /// The vertices in metres and the model's axes.
    pub(crate) fn apply(&self, vertices: &[Vec3]) -> Vec<Vec3> {
        let turn = self.model_from_file * self.unit.metres();
        vertices.iter().map(|vertex| (turn * vertex.as_dvec3()).as_vec3()).collect()
    }
}

impl std::fmt::Display for Placement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Rows of the turn are the model's axes in the file.
        let [up, forward] = [1, 2].map(|row| axis_name(self.model_from_file.row(row)));
        write!(f, "a unit of {} m, axes {up} up and {forward} forward", self.unit.metres())
    }
}

impl Model {
    /// How a mesh lies; its vertices have the number of this level and are finite.
    ///
    /// # Errors
    /// [`Error::Invalid`] for vertices in another order or mirrored, and for a unit or axes that cannot be told.
    pub(crate) fn placement(&self, lod: Lod, vertices: &[Vec3]) -> Result<Placement> {
        let invalid = |message: String| Err(Error::invalid("body", message));
        let mean = self.mean_of_level(lod)?;
        let points: Vec<DVec3> = vertices.iter().map(|vertex| vertex.as_dvec3()).collect();
        let (mean_centred, points_centred) = (centred(&mean), centred(&points));
        let size = |points: &[DVec3]| points.iter().map(|p| p.length_squared()).sum::<f64>().sqrt();
        let scale = size(&points_centred) / size(&mean_centred);
        if !(scale > 1e-9 && scale.is_finite()) {
            return invalid("its vertices are in one place, expected a body".into());
        }
        if let Some(([a, b], stretch)) = self.torn_edge(lod, &mean, &points, scale) {
            return invalid(format!(
                "its vertices are not in the model's order: {a} and {b} are neighbours, but {stretch:.0} times as far \
                 apart as in the mean body"
            ));
        }
        let covariance: DMat3 = points_centred
            .iter()
            .zip(&mean_centred)
            .map(|(p, m)| outer(*p, *m))
            .fold(DMat3::ZERO, |a, b| a + b);
        let Some(turn) = nearest_orthogonal(covariance) else {
            return invalid("its vertices determine no body of this model".into());
        };
        if turn.determinant() < 0.0 {
            return invalid(
                "it is mirrored, or in left-handed axes: its left is on its right; mirror it back along one axis".into(),
            );
        }
        let (axes, tilt) = nearest_axes(turn);
        if tilt > MAX_TILT {
            return invalid(format!(
                "its axes are unknown: it is turned by {:.0}° from the nearest ones; expected +Y up and +Z forward",
                tilt.to_degrees()
            ));
        }
        let stature = scale * extent(&mean);
        let Some(unit) = unit_of(stature) else {
            return invalid(format!(
                "its unit is unknown: its stature is about {stature:.4}, which is no person's in m, cm, mm, in, ft or dm"
            ));
        };
        Ok(Placement { unit, model_from_file: axes.transpose() })
    }

    /// The mean body at a level of detail.
    fn mean_of_level(&self, lod: Lod) -> Result<Vec<DVec3>> {
        let (character, space) = (self.character(), self.shape_space());
        let subdivision = character.subdivision();
        let cage: Vec<DVec3> =
            (0..subdivision.cage_len()).map(|point| space.mean_point(point).as_dvec3()).collect();
        let refined = subdivision.refine_f64(&cage)?;
        Ok(match character.reduced(lod) {
            Some(mesh) => mesh.vertices.iter().map(|v| refined[*v as usize]).collect(),
            None => refined[..character.vertex_count(lod)].to_vec(),
        })
    }

    /// The edge that is longest in proportion to the mean body's, if it is none of a body, and the proportion.
    fn torn_edge(&self, lod: Lod, mean: &[DVec3], points: &[DVec3], scale: f64) -> Option<([usize; 2], f64)> {
        let character = self.character();
        let corners: Vec<&[u32]> = match (character.reduced(lod), lod) {
            (Some(mesh), _) => mesh.triangles.iter().map(|face| &face[..]).collect(),
            (None, Lod::Lod0) => {
                character.subdivision().refined().quads.iter().map(|face| &face[..]).collect()
            }
            (None, _) => character.cage().quads.iter().map(|face| &face[..]).collect(),
        };
        let edges = corners.iter().flat_map(|face| {
            let next = face.iter().cycle().skip(1);
            face.iter().zip(next).map(|(a, b)| [*a as usize, *b as usize])
        });
        let stretch = |[a, b]: [usize; 2]| {
            let expected = scale * mean[a].distance(mean[b]).max(SHORT_EDGE);
            points[a].distance(points[b]) / expected
        };
        let worst = edges.map(|edge| (edge, stretch(edge))).max_by(|a, b| a.1.total_cmp(&b.1));
        worst.filter(|(_, stretch)| *stretch > MAX_STRETCH)
    }
}

/// The unit in which a number is the stature of a person.
fn unit_of(stature: f64) -> Option<Unit> {
    let is = |unit: Unit, [low, high]: [f64; 2]| (low..=high).contains(&(stature * unit.metres()));
    if is(Unit::Metre, IN_METRES) {
        return Some(Unit::Metre);
    }
    OTHERS.into_iter().find(|unit| is(*unit, IN_OTHERS))
}

fn centred(points: &[DVec3]) -> Vec<DVec3> {
    let centre = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    points.iter().map(|point| *point - centre).collect()
}

/// Height of points.
fn extent(points: &[DVec3]) -> f64 {
    let heights = points.iter().map(|point| point.y);
    heights.clone().fold(f64::MIN, f64::max) - heights.fold(f64::MAX, f64::min)
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

/// The rotation, or rotation with mirroring, that is nearest to a matrix: its polar factor, by Newton's iteration, which
/// keeps the sign of the determinant. `None` for a singular matrix.
fn nearest_orthogonal(matrix: DMat3) -> Option<DMat3> {
    let mut turn = matrix * (1.0 / matrix.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt());
    for _ in 0..100 {
        let determinant = turn.determinant().abs();
        if determinant.is_nan() || determinant < 1e-12 {
            return None;
        }
        let next = (turn + turn.inverse().transpose()) * 0.5;
        let change = (next - turn).to_cols_array().iter().fold(0.0, |worst: f64, x| worst.max(x.abs()));
        turn = next;
        if change < 1e-12 {
            return Some(turn);
        }
    }
    None
}

/// The signed permutation without mirroring that is nearest to a rotation, and the angle between them, radians.
fn nearest_axes(turn: DMat3) -> (DMat3, f64) {
    let units = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
    let mut best = (DMat3::IDENTITY, f64::MIN);
    for x in units {
        for y in units.into_iter().filter(|y| x.dot(*y) == 0.0) {
            let axes = DMat3::from_cols(x, y, x.cross(y));
            let trace = (0..3).map(|column| axes.col(column).dot(turn.col(column))).sum::<f64>();
            if trace > best.1 {
                best = (axes, trace);
            }
        }
    }
    (best.0, libm::acos(((best.1 - 1.0) / 2.0).clamp(-1.0, 1.0)))
}

/// `+X` to `-Z`.
fn axis_name(axis: DVec3) -> String {
    let names = ["X", "Y", "Z"];
    let index = axis.abs().max_position();
    format!("{}{}", if axis[index] < 0.0 { '-' } else { '+' }, names[index])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_orthogonal_matrix_keeps_the_handedness() {
        let turn = DMat3::from_rotation_x(0.3) * DMat3::from_rotation_z(-2.0);
        let stretched = turn * DMat3::from_diagonal(DVec3::new(3.0, 1.0, 0.02));
        assert!(nearest_orthogonal(stretched).unwrap().abs_diff_eq(turn, 1e-9));
        let mirrored = turn * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        assert!(nearest_orthogonal(mirrored).unwrap().abs_diff_eq(mirrored, 1e-9));
        assert_eq!(nearest_orthogonal(DMat3::ZERO), None);
        assert_eq!(nearest_orthogonal(DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0))), None);
    }

    #[test]
    fn axes_are_named_and_the_angle_to_them_is_told() {
        let z_up = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y);
        let (axes, tilt) = nearest_axes(z_up * DMat3::from_rotation_y(0.2));
        assert_eq!(axes, z_up);
        assert!((tilt - 0.2).abs() < 1e-9, "{tilt}");
        let placement = Placement { unit: Unit::Centimetre, model_from_file: z_up.transpose() };
        assert_eq!(placement.to_string(), "a unit of 0.01 m, axes +Z up and -Y forward");
        let [up, forward] = [Vec3::new(0.0, 0.0, 170.0), Vec3::new(0.0, -100.0, 0.0)];
        assert_eq!(placement.apply(&[up, forward]), [Vec3::new(0.0, 1.7, 0.0), Vec3::Z]);
    }

    #[test]
    fn units_are_told_by_the_stature() {
        for (stature, unit) in [
            (1.7, Unit::Metre),
            (0.6, Unit::Metre),
            (170.0, Unit::Centimetre),
            (1_700.0, Unit::Millimetre),
            (66.9, Unit::Inch),
            (5.6, Unit::Foot),
            (17.0, Unit::Decimetre),
        ] {
            assert_eq!(unit_of(stature), Some(unit), "{stature}");
        }
        for stature in [0.017, 0.3, 3.2, 30.0, 100.0, 600.0, 1e5, f64::NAN] {
            assert_eq!(unit_of(stature), None, "{stature}");
        }
    }
}
