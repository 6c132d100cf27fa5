//! Evaluation of measures on a body, with the derivative with respect to every vertex.

use glam::{DVec2, DVec3};

use super::catalogue::MEASURE_COUNT;
use super::definition::{Definition, Definitions, Kind, Point, Stance};
use super::hull::hull_perimeter;
use super::names::{MeasureId, Measurements};
use super::standing::{Placed, Standing};
use crate::Result;

/// Sparse derivative of a measure with respect to vertex positions, metre per metre; the entries of a vertex that comes
/// more than once add up.
pub type Gradient = Vec<(u32, DVec3)>;

impl Point {
    /// The point's position on a body; `at` gives the positions of vertices, in the same unit and space.
    pub fn position(&self, at: impl Fn(u32) -> DVec3) -> DVec3 {
        self.0.iter().map(|&(v, w)| at(v) * w).sum()
    }

    fn add_gradient(&self, direction: DVec3, gradient: &mut Gradient) {
        gradient.extend(self.0.iter().map(|&(v, w)| (v, direction * w)));
    }
}

impl Definitions {
    /// Evaluates all measures of a body, metres, in the order of [`MeasureId`]. `at` gives the position of a vertex of LOD 0 in
    /// the T-pose, metres, model space.
    pub fn read_all(&self, at: impl Fn(u32) -> DVec3 + Copy) -> Measurements {
        let mut out = [0.0; MEASURE_COUNT];
        for (value, id) in out.iter_mut().zip(MeasureId::all()) {
            *value = self.reading(id).read(at);
        }
        out
    }

    /// Evaluates one measure, metres; `at` as for [`Definitions::read_all`].
    pub fn read(&self, id: MeasureId, at: impl Fn(u32) -> DVec3 + Copy) -> f64 {
        self.reading(id).read(at)
    }
}

/// A definition over points of the body in the measure's stance instead of vertices of the T-pose.
#[derive(Clone, Debug)]
pub struct Reading {
    definition: Definition,
    points: Vec<Placed>,
}

impl Reading {
    /// Places the points of a definition.
    ///
    /// # Errors
    /// [`Error::Invalid`](crate::Error::Invalid) for a bone that does not turn.
    pub fn new(definition: &Definition, standing: &Standing<'_>) -> Result<Self> {
        let mut points = Vec::new();
        for (i, point) in definition.points.iter().enumerate() {
            points.push(match (definition.stance, definition.bones.get(i).and_then(Option::as_deref)) {
                (Stance::TPose, _) => Placed::unmoved(point),
                (Stance::Standing, None) => standing.place(point),
                (Stance::Standing, Some(bone)) => standing.place_on_bone(point, bone)?,
            });
        }
        let mut own = definition.clone();
        own.points = (0..points.len() as u32).map(|p| Point(vec![(p, 1.0)])).collect();
        let mut point_of_vertex = std::collections::BTreeMap::new();
        for end in own.edges.iter_mut().flatten() {
            *end = *point_of_vertex.entry(*end).or_insert_with_key(|&v| {
                let point = Point(vec![(v, 1.0)]);
                points.push(match definition.stance {
                    Stance::TPose => Placed::unmoved(&point),
                    Stance::Standing => standing.place(&point),
                });
                points.len() as u32 - 1
            });
        }
        Ok(Self { definition: own, points })
    }

    /// The definition; what it calls vertices are the places in [`points`](Self::points).
    pub fn definition(&self) -> &Definition {
        &self.definition
    }

    /// The points: first those of the definition, then the ends of a slice's edges.
    pub fn points(&self) -> &[Placed] {
        &self.points
    }

    /// Positions of the points in the measure's stance; `at` as for [`Definitions::read_all`].
    pub fn positions(&self, at: impl Fn(u32) -> DVec3 + Copy) -> Vec<DVec3> {
        self.points.iter().map(|p| p.position(at)).collect()
    }

    /// Evaluates the measure, metres; `at` as for [`Definitions::read_all`].
    pub fn read(&self, at: impl Fn(u32) -> DVec3 + Copy) -> f64 {
        let positions = self.positions(at);
        self.definition.read(|p| positions[p as usize])
    }
}

impl Definition {
    /// Evaluates the measure, metres; `at` gives the positions, in the measure's stance, of what the definition names.
    pub fn read(&self, at: impl Fn(u32) -> DVec3 + Copy) -> f64 {
        self.evaluate(at, None)
    }

    /// As [`Definition::read`]; appends the derivative to `gradient`.
    pub fn read_with_gradient(&self, at: impl Fn(u32) -> DVec3 + Copy, gradient: &mut Gradient) -> f64 {
        self.evaluate(at, Some(gradient))
    }

    fn evaluate(&self, at: impl Fn(u32) -> DVec3 + Copy, gradient: Option<&mut Gradient>) -> f64 {
        match self.kind {
            Kind::Tape => self.tape(at, gradient),
            Kind::Slice => self.slice(at, gradient),
            Kind::Length => self.length(at, gradient),
            Kind::Extent => self.extent(at, gradient),
        }
    }

    fn extent(&self, at: impl Fn(u32) -> DVec3 + Copy, gradient: Option<&mut Gradient>) -> f64 {
        let axis = self.axis.unwrap_or(DVec3::ZERO);
        let along = self.points.iter().map(|p| p.position(at).dot(axis));
        // The first of equal ones.
        let mut ends = [(0, f64::INFINITY), (0, f64::NEG_INFINITY)];
        for (i, value) in along.enumerate() {
            if value < ends[0].1 {
                ends[0] = (i, value);
            }
            if value > ends[1].1 {
                ends[1] = (i, value);
            }
        }
        let [(low, least), (high, most)] = ends;
        if let Some(gradient) = gradient {
            self.points[high].add_gradient(axis, gradient);
            self.points[low].add_gradient(-axis, gradient);
        }
        most - least
    }

    fn length(&self, at: impl Fn(u32) -> DVec3 + Copy, gradient: Option<&mut Gradient>) -> f64 {
        let [from, to] = [&self.points[0], &self.points[1]];
        let between = to.position(at) - from.position(at);
        let (value, direction) = match self.axis {
            Some(axis) => {
                let along = between.dot(axis);
                (along.abs(), axis * along.signum())
            }
            None => (between.length(), between.normalize_or_zero()),
        };
        if let Some(gradient) = gradient {
            to.add_gradient(direction, gradient);
            from.add_gradient(-direction, gradient);
        }
        value
    }

    fn tape(&self, at: impl Fn(u32) -> DVec3 + Copy, gradient: Option<&mut Gradient>) -> f64 {
        let (e1, e2) = self.normal.any_orthonormal_pair();
        let flat: Vec<DVec2> = self
            .points
            .iter()
            .map(|p| {
                let x = p.position(at);
                DVec2::new(x.dot(e1), x.dot(e2))
            })
            .collect();
        let (perimeter, corners) = hull_perimeter(&flat);
        if let Some(gradient) = gradient {
            for (corner, g) in corners {
                self.points[corner].add_gradient(e1 * g.x + e2 * g.y, gradient);
            }
        }
        perimeter
    }

    fn slice(&self, at: impl Fn(u32) -> DVec3 + Copy, gradient: Option<&mut Gradient>) -> f64 {
        let n = self.normal;
        let (e1, e2) = n.any_orthonormal_pair();
        let share = 1.0 / self.points.len() as f64;
        let level: f64 = self.points.iter().map(|p| p.position(at).dot(n)).sum::<f64>() * share;
        // Cut edges [a, b] with the parameter t of the cut, at a + t (b − a).
        let mut cuts: Vec<([u32; 2], f64)> = Vec::new();
        let mut flat = Vec::new();
        for &[a, b] in &self.edges {
            let (xa, xb) = (at(a), at(b));
            let (ha, hb) = (xa.dot(n) - level, xb.dot(n) - level);
            // Half open: a vertex exactly on the plane counts as above, so that the cut through it is not lost.
            if (ha < 0.0) != (hb < 0.0) {
                let t = ha / (ha - hb);
                let x = xa + (xb - xa) * t;
                cuts.push(([a, b], t));
                flat.push(DVec2::new(x.dot(e1), x.dot(e2)));
            }
        }
        let (perimeter, corners) = hull_perimeter(&flat);
        if let Some(gradient) = gradient {
            let mut level_derivative = 0.0;
            for (corner, g) in corners {
                let ([a, b], t) = cuts[corner];
                let direction = e1 * g.x + e2 * g.y;
                let along = at(b) - at(a);
                // The cut moves along its edge by 1 / (along · n) per unit that the plane moves along n.
                let slide = direction.dot(along) / along.dot(n);
                let end_derivative = direction - n * slide;
                gradient.push((a, end_derivative * (1.0 - t)));
                gradient.push((b, end_derivative * t));
                level_derivative += slide;
            }
            for point in &self.points {
                point.add_gradient(n * (level_derivative * share), gradient);
            }
        }
        perimeter
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A barrel of uneven rings of points, with hollows for tapes and slices to span.
    fn barrel() -> (Vec<DVec3>, Vec<[u32; 2]>) {
        let (rings, around) = (6, 16);
        let mut points = Vec::new();
        for r in 0..rings {
            for k in 0..around {
                let angle = f64::from(k) / f64::from(around) * std::f64::consts::TAU;
                let radius = 1.0 + 0.2 * libm::sin(3.0 * angle + f64::from(r)) + 0.05 * f64::from(r);
                let y = f64::from(r) * 0.3 + 0.07 * libm::cos(5.0 * angle);
                points.push(DVec3::new(radius * libm::cos(angle), y, radius * libm::sin(angle)));
            }
        }
        let mut edges = Vec::new();
        for r in 0..rings - 1 {
            for k in 0..around {
                let (a, b) = (r * around + k, r * around + (k + 1) % around);
                edges.push([a as u32, (a + around) as u32]);
                edges.push([a as u32, (b + around) as u32]);
            }
        }
        (points, edges)
    }

    fn definitions() -> (Vec<DVec3>, Vec<Definition>) {
        let (points, edges) = barrel();
        let one = |v: u32| Point(vec![(v, 1.0)]);
        let base = Definition {
            name: "test".into(),
            kind: Kind::Tape,
            stance: Stance::TPose,
            bones: Vec::new(),
            points: (32..48).map(|v| Point(vec![(v, 0.25), (v + 16, 0.75)])).collect(),
            normal: DVec3::new(0.1, 1.0, -0.2).normalize_or_zero(),
            axis: None,
            edges: Vec::new(),
        };
        let slice = Definition { kind: Kind::Slice, points: vec![one(35), one(50)], edges, ..base.clone() };
        let length = Definition {
            kind: Kind::Length,
            points: vec![one(3), one(77)],
            normal: DVec3::ZERO,
            ..base.clone()
        };
        let along = Definition { axis: Some(DVec3::Y), ..length.clone() };
        let extent = Definition {
            kind: Kind::Extent,
            points: base.points.clone(),
            axis: Some(DVec3::new(0.6, 0.0, 0.8)),
            ..length.clone()
        };
        (points, vec![base, slice, length, along, extent])
    }

    #[test]
    fn gradients_match_finite_differences() {
        let (points, definitions) = definitions();
        for definition in definitions {
            let mut sparse = Gradient::new();
            definition.read_with_gradient(|v| points[v as usize], &mut sparse);
            let mut dense = vec![DVec3::ZERO; points.len()];
            for (v, g) in sparse {
                dense[v as usize] += g;
            }
            let step = 1e-6;
            for v in 0..points.len() {
                for axis in 0..3 {
                    let mut moved = points.clone();
                    moved[v][axis] += step;
                    let high = definition.read(|v| moved[v as usize]);
                    moved[v][axis] -= 2.0 * step;
                    let low = definition.read(|v| moved[v as usize]);
                    let numeric = (high - low) / (2.0 * step);
                    // Tolerance: second derivative of order 1/edge times the step, plus rounding over the step.
                    assert!(
                        (numeric - dense[v][axis]).abs() < 2e-6,
                        "{:?} vertex {v} axis {axis}: {numeric} {}",
                        definition.kind,
                        dense[v][axis]
                    );
                }
            }
        }
    }

    #[test]
    fn an_empty_cut_reads_zero() {
        let (points, definitions) = definitions();
        let high = |v: u32| if v == 35 || v == 50 { DVec3::Y * 100.0 } else { points[v as usize] };
        // Landmarks far above everything else; only edges at the landmarks themselves are cut.
        assert!(definitions[1].read(high) >= 0.0);
    }
}
