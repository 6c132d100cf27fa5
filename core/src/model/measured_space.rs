//! Measures as a function of shape coefficients, with derivatives, for the exact solve.
//!
//! Only points that some measure depends on are kept: three rows of the shape space each, combined by the subdivision's
//! stencil. A solve spends its time on reading those rows. Therefore coordinates along an axis that does not affect a
//! measure are not computed; a slice, which has many vertices but cuts few edges, computes the height of most vertices only
//! to the precision that decides their side of the plane; and a measure's derivative follows its value at once, while the
//! rows are in the cache.

use glam::{DMat3, DVec3};
use multiversion::multiversion;

use super::shape_space::ShapeSpace;
use crate::condition::MeasuredShape;
use crate::measure::{Definition, Definitions, Gradient, Kind, MEASURE_COUNT, MeasureId, Measurements};
use crate::mesh::Subdivision;

/// The points of the shape space that measures depend on.
#[derive(Clone, Debug)]
pub struct MeasuredSpace {
    components: usize,
    measures: Vec<Measure>,
    /// The points of the mean body, metres.
    mean: Vec<DVec3>,
    /// Three rows of `components` per point, for x, y and z, metre per metre.
    rows: Vec<f32>,
}

/// A measure whose definition indexes the points of [`MeasuredSpace`] instead of vertices.
#[derive(Clone, Debug)]
struct Measure {
    definition: Definition,
    /// Point and axis of the coordinates that are always computed.
    coordinates: Vec<(u32, usize)>,
    /// For a slice across an axis.
    slice: Option<Slice>,
}

/// The vertices of a slice whose plane is perpendicular to an axis.
#[derive(Clone, Debug)]
struct Slice {
    axis: usize,
    vertices: Vec<SliceVertex>,
}

#[derive(Clone, Debug)]
struct SliceVertex {
    point: u32,
    /// Norm of the rest of its row along the axis, from each of [`STAGES`] on.
    tail_norms: [f64; STAGES.len()],
}

/// Vertices of the surface as sums of points of the cage, each of which is read once for all of them.
struct Stencils {
    /// The points of the cage.
    cage: Vec<usize>,
    /// Per vertex the end of its terms.
    ends: Vec<usize>,
    /// Places in `cage`, and weights.
    terms: Vec<(usize, f64)>,
}

impl Stencils {
    fn new(vertices: &[u32], subdivision: &Subdivision) -> Self {
        let mut place = vec![usize::MAX; subdivision.cage_len()];
        let (mut cage, mut ends, mut terms) = (Vec::new(), Vec::new(), Vec::new());
        for &vertex in vertices {
            for (i, weight) in subdivision.stencil(vertex as usize) {
                let place = &mut place[i as usize];
                if *place == usize::MAX {
                    *place = cage.len();
                    cage.push(i as usize);
                }
                terms.push((*place, f64::from(weight)));
            }
            ends.push(terms.len());
        }
        Self { cage, ends, terms }
    }

    /// The vertices, for these points of the cage.
    fn of(&self, of_cage: impl Fn(usize) -> DVec3) -> Vec<DVec3> {
        let cage: Vec<DVec3> = self.cage.iter().map(|i| of_cage(*i)).collect();
        let mut start = 0;
        let sums = self.ends.iter().map(|&end| {
            let terms = &self.terms[start..end];
            start = end;
            terms.iter().map(|&(i, weight)| cage[i] * weight).sum()
        });
        sums.collect()
    }
}

/// What a vertex is multiplied by: for most points of the T-pose a number.
#[derive(Clone, Copy, Debug)]
enum Factor {
    Number(f64),
    Matrix(DMat3),
}

impl Factor {
    fn new(matrix: DMat3) -> Self {
        let number = matrix.x_axis.x;
        let same = matrix == DMat3::from_diagonal(DVec3::splat(number));
        if same { Self::Number(number) } else { Self::Matrix(matrix) }
    }

    fn times(&self, x: DVec3) -> DVec3 {
        match self {
            Self::Number(number) => x * *number,
            Self::Matrix(matrix) => *matrix * x,
        }
    }
}

/// Numbers of components after which the bound on the rest of the sum may already decide a vertex's side of the plane.
const STAGES: [usize; 2] = [64, 128];

/// Added to that bound, metres: far above rounding.
const MARGIN: f64 = 1e-9;

impl MeasuredSpace {
    /// Collects the points that the definitions depend on.
    pub fn new(space: &ShapeSpace, subdivision: &Subdivision, definitions: &Definitions) -> Self {
        // Vertices of the surface over the cage, each once, and the points over these.
        let vertices = definitions.vertices();
        let stencils = Stencils::new(&vertices, subdivision);
        let mut points: Vec<Vec<(usize, Factor)>> = Vec::new();
        let mut measures: Vec<Measure> = MeasureId::all()
            .map(|id| {
                let reading = definitions.reading(id);
                let first = points.len() as u32;
                points.extend(reading.points().iter().map(|point| {
                    let terms = point.terms().iter();
                    terms.map(|(v, m)| (vertices.partition_point(|u| u < v), Factor::new(*m))).collect()
                }));
                let mut own = reading.definition().clone();
                for (point, _) in own.points.iter_mut().flat_map(|point| &mut point.0) {
                    *point += first;
                }
                for end in own.edges.iter_mut().flatten() {
                    *end += first;
                }
                let vertices = (first + own.points.len() as u32)..points.len() as u32;
                Measure::new(own, vertices.collect())
            })
            .collect();
        let place = |of_vertices: &[DVec3], terms: &[(usize, Factor)]| -> DVec3 {
            terms.iter().map(|(v, factor)| factor.times(of_vertices[*v])).sum()
        };

        let k = space.components();
        let mut rows = vec![0.0_f32; points.len() * 3 * k];
        for component in 0..k {
            let moved = stencils.of(|i| DVec3::from_array(space.component(component, i)));
            for (point, terms) in points.iter().enumerate() {
                let sum = place(&moved, terms);
                for axis in 0..3 {
                    rows[(3 * point + axis) * k + component] = sum[axis] as f32;
                }
            }
        }
        for slice in measures.iter_mut().filter_map(|m| m.slice.as_mut()) {
            for vertex in &mut slice.vertices {
                let row = &rows[(3 * vertex.point as usize + slice.axis) * k..][..k];
                vertex.tail_norms = STAGES.map(|stage| norm(row.iter().skip(stage).map(|x| f64::from(*x))));
            }
        }
        let at_mean = stencils.of(|i| space.mean_point(i).as_dvec3());
        let mean = points.iter().map(|terms| place(&at_mean, terms)).collect();
        Self { components: k, measures, mean, rows }
    }

    fn row(&self, point: u32, axis: usize) -> &[f32] {
        &self.rows[(3 * point as usize + axis) * self.components..][..self.components]
    }

    fn coordinate(&self, point: u32, axis: usize, c: &[f64]) -> f64 {
        self.mean[point as usize][axis] + dot(self.row(point, axis), c)
    }

    /// Writes the coordinates that a measure of this body depends on to `at`, and leaves all others as they are.
    fn update(&self, measure: &Measure, c: &[f64], at: &mut [DVec3]) {
        for &(point, axis) in &measure.coordinates {
            at[point as usize][axis] = self.coordinate(point, axis, c);
        }
        let Some(Slice { axis, vertices }) = &measure.slice else { return };
        let axis = *axis;
        let points = &measure.definition.points;
        let share = 1.0 / points.len() as f64;
        let level: f64 = points.iter().map(|p| p.position(|v| at[v as usize])[axis] * share).sum();
        let tail_norms_of_c = STAGES.map(|stage| norm(c.iter().skip(stage).copied()));
        for SliceVertex { point, tail_norms } in vertices {
            let row = self.row(*point, axis);
            // The rest of the sum is at most the product of the norms (Cauchy–Schwarz).
            let rough = STAGES.iter().zip(tail_norms).zip(&tail_norms_of_c).find_map(|((&stage, a), b)| {
                let height = self.mean[*point as usize][axis] + dot(row.get(..stage)?, c.get(..stage)?);
                ((height - level).abs() > a * b + MARGIN).then_some(height)
            });
            at[*point as usize][axis] = rough.unwrap_or_else(|| self.coordinate(*point, axis, c));
        }
        let mut cut: Vec<u32> = measure
            .definition
            .edges
            .iter()
            .filter(|e| (at[e[0] as usize][axis] < level) != (at[e[1] as usize][axis] < level))
            .flatten()
            .copied()
            .collect();
        cut.sort_unstable();
        cut.dedup();
        for point in cut {
            at[point as usize] = DVec3::from_array([0, 1, 2].map(|axis| self.coordinate(point, axis, c)));
        }
    }
}

impl Measure {
    /// `vertices` are the points at the ends of a slice's edges.
    fn new(definition: Definition, vertices: Vec<u32>) -> Self {
        // A tape along an axis does not depend on the coordinate along it; a slice across an axis and a length along one
        // depend on that coordinate alone, but for the vertices of cut edges.
        let along = |v: DVec3| [DVec3::X, DVec3::Y, DVec3::Z].iter().position(|axis| v.abs() == *axis);
        let normal = along(definition.normal);
        let affects = |axis: &usize| match definition.kind {
            Kind::Tape => normal != Some(*axis),
            Kind::Slice => normal.is_none_or(|normal| normal == *axis),
            Kind::Length | Kind::Extent => definition.axis.and_then(along).is_none_or(|along| along == *axis),
        };
        let points = definition.points.iter().flat_map(|p| p.0.iter().map(|term| term.0));
        let mut coordinates: Vec<(u32, usize)> =
            points.flat_map(|point| (0..3).filter(affects).map(move |axis| (point, axis))).collect();
        let slice = match normal.filter(|_| definition.kind == Kind::Slice) {
            Some(axis) => {
                let vertex = |point| SliceVertex { point, tail_norms: [0.0; STAGES.len()] };
                Some(Slice { axis, vertices: vertices.into_iter().map(vertex).collect() })
            }
            None => {
                coordinates.extend(vertices.iter().flat_map(|point| (0..3).map(move |axis| (*point, axis))));
                None
            }
        };
        Self { definition, coordinates, slice }
    }
}

impl MeasuredShape for MeasuredSpace {
    fn dim(&self) -> usize {
        self.components
    }

    fn measure(&self, c: &[f64], mut jacobian: Option<&mut [f64]>) -> Measurements {
        let mut at = vec![DVec3::ZERO; self.mean.len()];
        let mut out = [0.0; MEASURE_COUNT];
        let mut gradient = Gradient::new();
        for (i, (value, measure)) in out.iter_mut().zip(&self.measures).enumerate() {
            self.update(measure, c, &mut at);
            let Some(jacobian) = jacobian.as_deref_mut() else {
                *value = measure.definition.read(|v| at[v as usize]);
                continue;
            };
            gradient.clear();
            *value = measure.definition.read_with_gradient(|v| at[v as usize], &mut gradient);
            let row = &mut jacobian[i * self.components..][..self.components];
            row.fill(0.0);
            for &(point, g) in &gradient {
                let [x, y, z] = [0, 1, 2].map(|axis| self.row(point, axis));
                add(row, [x, y, z], g);
            }
        }
        out
    }
}

fn norm(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.map(|x| x * x).sum::<f64>().sqrt()
}

/// Adds a point's rows along x, y and z, each times its weight.
#[multiversion(targets("x86_64+avx2"))]
fn add(sums: &mut [f64], [x, y, z]: [&[f32]; 3], weights: DVec3) {
    for (((sum, &x), &y), &z) in sums.iter_mut().zip(x).zip(y).zip(z) {
        *sum += weights.x * f64::from(x) + weights.y * f64::from(y) + weights.z * f64::from(z);
    }
}

/// Dot product in eight lanes: fast without fused operations, and in the same order on every machine, however wide its
/// registers are.
#[multiversion(targets("x86_64+avx2"))]
fn dot(row: &[f32], c: &[f64]) -> f64 {
    let mut lanes = [0.0_f64; 8];
    let (rows, row_rest) = row.as_chunks::<8>();
    let (cs, c_rest) = c.as_chunks::<8>();
    for (r, c) in rows.iter().zip(cs) {
        for k in 0..8 {
            lanes[k] += f64::from(r[k]) * c[k];
        }
    }
    let mut sum =
        ((lanes[0] + lanes[4]) + (lanes[1] + lanes[5])) + ((lanes[2] + lanes[6]) + (lanes[3] + lanes[7]));
    for (r, c) in row_rest.iter().zip(c_rest) {
        sum += f64::from(*r) * c;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_have_the_same_bits_however_wide_the_registers_are() {
        let row: Vec<f32> = (0..301).map(|i| libm::sin(f64::from(i)) as f32).collect();
        let c: Vec<f64> = (0..301).map(|i| libm::cos(f64::from(i * i))).collect();
        let mut lanes = [0.0_f64; 8];
        for (i, (r, c)) in row[..296].iter().zip(&c).enumerate() {
            lanes[i % 8] += std::hint::black_box(f64::from(*r) * c);
        }
        let [a, b, d, e, f, g, h, i] = lanes;
        let mut sum = ((a + f) + (b + g)) + ((d + h) + (e + i));
        for (r, c) in row[296..].iter().zip(&c[296..]) {
            sum += f64::from(*r) * c;
        }
        assert_eq!(dot(&row, &c).to_bits(), sum.to_bits());

        let mut sums = c.clone();
        add(&mut sums, [&row, &row[1..], &row[2..]], DVec3::new(0.1, -0.7, 1.3));
        for (i, sum) in sums.iter().enumerate().take(299) {
            let [x, y, z] = [0, 1, 2].map(|k| std::hint::black_box(f64::from(row[i + k])));
            assert_eq!(sum.to_bits(), (c[i] + (0.1 * x + -0.7 * y + 1.3 * z)).to_bits(), "{i}");
        }
    }
}
