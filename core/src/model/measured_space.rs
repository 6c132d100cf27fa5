//! Measures as a function of coefficients, with derivatives: what the exact solve turns.
//!
//! Only the places that some measure reads are kept: each is a row of the shape space pushed through the
//! subdivision's stencil. Reading those rows is what a solve spends its time on, so that as few as possible are read,
//! and those of a measure's derivative while they are still in the cache: along an axis that a measure does not see no
//! coordinate is computed, and a slice, which has many vertices but cuts few, looks at most of them only far enough to
//! know on which side of the plane they are.

use glam::DVec3;
use multiversion::multiversion;

use super::shape_space::ShapeSpace;
use crate::condition::MeasuredShape;
use crate::measure::{Definition, Definitions, Gradient, Kind, MEASURE_COUNT, Measurements, Point};
use crate::mesh::Subdivision;

/// The measured places of the shape space.
#[derive(Clone, Debug)]
pub struct MeasuredSpace {
    components: usize,
    measures: Vec<Measure>,
    mean: Vec<DVec3>,
    // Three rows of `components` per place.
    rows: Vec<f32>,
}

/// A measure over places instead of vertices.
#[derive(Clone, Debug)]
struct Measure {
    definition: Definition,
    // Place and axis of the coordinates that are always computed.
    coordinates: Vec<(u32, usize)>,
    slice: Option<Slice>,
}

/// The vertices of a slice whose plane is square to an axis.
#[derive(Clone, Debug)]
struct Slice {
    axis: usize,
    vertices: Vec<SliceVertex>,
}

#[derive(Clone, Debug)]
struct SliceVertex {
    place: u32,
    // Length of the row along the axis from each of `STAGES` on.
    rest: [f64; STAGES.len()],
}

/// Numbers of components after which a vertex of a slice may be far enough from the plane to be left there.
const STAGES: [usize; 2] = [64, 128];

/// Added to the distance that the other components can move such a vertex, metres: far above rounding.
const MARGIN: f64 = 1e-9;

impl MeasuredSpace {
    /// Collects the places that the definitions read.
    pub fn new(space: &ShapeSpace, subdivision: &Subdivision, definitions: &Definitions) -> Self {
        let mut places: Vec<Vec<(u32, f64)>> = Vec::new();
        let mut add = |terms: &[(u32, f64)]| {
            let mut over_cage = std::collections::BTreeMap::new();
            for &(vertex, weight) in terms {
                for (i, w) in subdivision.stencil(vertex as usize) {
                    *over_cage.entry(i).or_insert(0.0) += weight * f64::from(w);
                }
            }
            places.push(over_cage.into_iter().collect());
            (places.len() - 1) as u32
        };
        let mut measures: Vec<Measure> = definitions
            .iter()
            .map(|(_, definition)| {
                let mut own = definition.clone();
                own.points = definition.points.iter().map(|p| Point(vec![(add(&p.0), 1.0)])).collect();
                let mut of_vertex = std::collections::BTreeMap::new();
                for end in own.edges.iter_mut().flatten() {
                    *end = *of_vertex.entry(*end).or_insert_with_key(|v| add(&[(*v, 1.0)]));
                }
                Measure::new(own, of_vertex.into_values().collect())
            })
            .collect();

        let k = space.components();
        let mut rows = vec![0.0_f32; places.len() * 3 * k];
        for component in 0..k {
            for (place, terms) in places.iter().enumerate() {
                let mut sum = [0.0; 3];
                for &(point, w) in terms {
                    let b = space.component(component, point as usize);
                    for axis in 0..3 {
                        sum[axis] += w * b[axis];
                    }
                }
                for axis in 0..3 {
                    rows[(3 * place + axis) * k + component] = sum[axis] as f32;
                }
            }
        }
        for slice in measures.iter_mut().filter_map(|m| m.slice.as_mut()) {
            for vertex in &mut slice.vertices {
                let row = &rows[(3 * vertex.place as usize + slice.axis) * k..][..k];
                vertex.rest = STAGES.map(|stage| norm(row.iter().skip(stage).map(|x| f64::from(*x))));
            }
        }
        let mean = places
            .iter()
            .map(|terms| terms.iter().map(|&(p, w)| space.mean_point(p as usize).as_dvec3() * w).sum())
            .collect();
        Self { components: k, measures, mean, rows }
    }

    fn row(&self, place: u32, axis: usize) -> &[f32] {
        &self.rows[(3 * place as usize + axis) * self.components..][..self.components]
    }

    fn coordinate(&self, place: u32, axis: usize, c: &[f64]) -> f64 {
        self.mean[place as usize][axis] + dot(self.row(place, axis), c)
    }

    /// Computes where the places are that a measure of this body reads; coordinates that it does not see stay as they
    /// are.
    fn place(&self, measure: &Measure, c: &[f64], at: &mut [DVec3]) {
        for &(place, axis) in &measure.coordinates {
            at[place as usize][axis] = self.coordinate(place, axis, c);
        }
        let Some(Slice { axis, vertices }) = &measure.slice else { return };
        let axis = *axis;
        let points = &measure.definition.points;
        let share = 1.0 / points.len() as f64;
        let level: f64 = points.iter().map(|p| p.position(|v| at[v as usize])[axis] * share).sum();
        let rest = STAGES.map(|stage| norm(c.iter().skip(stage).copied()));
        for SliceVertex { place, rest: of_row } in vertices {
            let row = self.row(*place, axis);
            // What the other components add is at most the product of the lengths (Cauchy-Schwarz).
            let near = STAGES.iter().zip(of_row).zip(&rest).find_map(|((&stage, a), b)| {
                let height = self.mean[*place as usize][axis] + dot(row.get(..stage)?, c.get(..stage)?);
                ((height - level).abs() > a * b + MARGIN).then_some(height)
            });
            at[*place as usize][axis] = near.unwrap_or_else(|| self.coordinate(*place, axis, c));
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
        for place in cut {
            at[place as usize] = DVec3::from_array([0, 1, 2].map(|axis| self.coordinate(place, axis, c)));
        }
    }
}

impl Measure {
    /// `vertices` are the places of the ends of a slice's edges.
    fn new(definition: Definition, vertices: Vec<u32>) -> Self {
        // The axis that the direction lies along, if any: the others are then not seen, or it alone is.
        let along = |v: DVec3| [DVec3::X, DVec3::Y, DVec3::Z].iter().position(|axis| v.abs() == *axis);
        let normal = along(definition.normal);
        let seen = |axis: &usize| match definition.kind {
            Kind::Tape => normal != Some(*axis),
            Kind::Slice => normal.is_none_or(|normal| normal == *axis),
            Kind::Length => definition.axis.and_then(along).is_none_or(|along| along == *axis),
        };
        let points = definition.points.iter().flat_map(|p| p.0.iter().map(|term| term.0));
        let mut coordinates: Vec<(u32, usize)> =
            points.flat_map(|place| (0..3).filter(seen).map(move |axis| (place, axis))).collect();
        let slice = match normal.filter(|_| definition.kind == Kind::Slice) {
            Some(axis) => {
                let vertex = |place| SliceVertex { place, rest: [0.0; STAGES.len()] };
                Some(Slice { axis, vertices: vertices.into_iter().map(vertex).collect() })
            }
            None => {
                coordinates.extend(vertices.iter().flat_map(|place| (0..3).map(move |axis| (*place, axis))));
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
            self.place(measure, c, &mut at);
            let Some(jacobian) = jacobian.as_deref_mut() else {
                *value = measure.definition.read(|v| at[v as usize]);
                continue;
            };
            gradient.clear();
            *value = measure.definition.read_with_gradient(|v| at[v as usize], &mut gradient);
            let row = &mut jacobian[i * self.components..][..self.components];
            row.fill(0.0);
            for &(place, g) in &gradient {
                let [x, y, z] = [0, 1, 2].map(|axis| self.row(place, axis));
                add(row, [x, y, z], g);
            }
        }
        out
    }
}

fn norm(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.map(|x| x * x).sum::<f64>().sqrt()
}

/// Adds rows along x, y and z, each times its weight.
#[multiversion(targets("x86_64+avx2"))]
fn add(sums: &mut [f64], [x, y, z]: [&[f32]; 3], weights: DVec3) {
    for (((sum, &x), &y), &z) in sums.iter_mut().zip(x).zip(y).zip(z) {
        *sum += weights.x * f64::from(x) + weights.y * f64::from(y) + weights.z * f64::from(z);
    }
}

/// Sum of products in eight lanes: fast without fused operations, and in one order on every machine, however wide its
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
