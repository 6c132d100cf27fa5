//! Measures as a function of coefficients, with derivatives: what the exact solve turns.
//!
//! Only the places that some measure reads are kept: each is a row of the shape space pushed through the
//! subdivision's stencil. A slice reads hundreds of vertices but is cut at few, so of the others only the height
//! over the plane is computed.

use glam::DVec3;

use super::shape_space::ShapeSpace;
use crate::condition::MeasuredShape;
use crate::measure::{Definition, Definitions, Gradient, Kind, MEASURE_COUNT, Measurements, Point};
use crate::mesh::Subdivision;

/// The measured places of the shape space.
#[derive(Clone, Debug)]
pub struct MeasuredSpace {
    components: usize,
    // Definitions over the places instead of vertices.
    definitions: Vec<Definition>,
    mean: Vec<DVec3>,
    // Three rows of `components` per place.
    rows: Vec<f32>,
    // Per definition, whether its places are computed only where it is cut.
    lazy: Vec<Option<Lazy>>,
    // Places that are always computed.
    eager: Vec<u32>,
}

/// A slice's places, of which the coordinate along its normal comes first.
#[derive(Clone, Debug)]
struct Lazy {
    axis: usize,
    places: Vec<u32>,
}

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
        let mut local = Vec::new();
        let mut lazy = Vec::new();
        let mut eager = Vec::new();
        for (_, definition) in definitions.iter() {
            let mut own = definition.clone();
            own.points = definition
                .points
                .iter()
                .map(|p| {
                    let place = add(&p.0);
                    eager.push(place);
                    Point(vec![(place, 1.0)])
                })
                .collect();
            let mut of_vertex = std::collections::BTreeMap::new();
            for end in own.edges.iter_mut().flatten() {
                *end = *of_vertex.entry(*end).or_insert_with_key(|v| add(&[(*v, 1.0)]));
            }
            let of_slice: Vec<u32> = of_vertex.into_values().collect();
            let along = [DVec3::X, DVec3::Y, DVec3::Z].iter().position(|axis| own.normal == *axis);
            match along.filter(|_| own.kind == Kind::Slice) {
                Some(axis) => lazy.push(Some(Lazy { axis, places: of_slice })),
                None => {
                    eager.extend(of_slice);
                    lazy.push(None);
                }
            }
            local.push(own);
        }

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
        let mean = places
            .iter()
            .map(|terms| terms.iter().map(|&(p, w)| space.mean_point(p as usize).as_dvec3() * w).sum())
            .collect();
        Self { components: k, definitions: local, mean, rows, lazy, eager }
    }

    fn row(&self, place: u32, axis: usize) -> &[f32] {
        &self.rows[(3 * place as usize + axis) * self.components..][..self.components]
    }

    fn coordinate(&self, place: u32, axis: usize, c: &[f64]) -> f64 {
        self.mean[place as usize][axis] + dot(self.row(place, axis), c)
    }

    /// Where every place is that the measures of this body read.
    fn places(&self, c: &[f64]) -> Vec<DVec3> {
        let mut at = vec![DVec3::ZERO; self.mean.len()];
        for &place in &self.eager {
            at[place as usize] = DVec3::from_array([0, 1, 2].map(|axis| self.coordinate(place, axis, c)));
        }
        for (definition, lazy) in self.definitions.iter().zip(&self.lazy) {
            let Some(Lazy { axis, places }) = lazy else { continue };
            for &place in places {
                at[place as usize][*axis] = self.coordinate(place, *axis, c);
            }
            let share = 1.0 / definition.points.len() as f64;
            let level: f64 =
                definition.points.iter().map(|p| p.place(|v| at[v as usize])[*axis] * share).sum();
            let mut cut: Vec<u32> = definition
                .edges
                .iter()
                .filter(|e| (at[e[0] as usize][*axis] < level) != (at[e[1] as usize][*axis] < level))
                .flatten()
                .copied()
                .collect();
            cut.sort_unstable();
            cut.dedup();
            for place in cut {
                for other in (0..3).filter(|other| other != axis) {
                    at[place as usize][other] = self.coordinate(place, other, c);
                }
            }
        }
        at
    }
}

impl MeasuredShape for MeasuredSpace {
    fn dim(&self) -> usize {
        self.components
    }

    fn measure(&self, c: &[f64], jacobian: Option<&mut [f64]>) -> Measurements {
        let at = self.places(c);
        let mut out = [0.0; MEASURE_COUNT];
        let Some(jacobian) = jacobian else {
            for (value, definition) in out.iter_mut().zip(&self.definitions) {
                *value = definition.read(|v| at[v as usize]);
            }
            return out;
        };
        jacobian.fill(0.0);
        let mut gradient = Gradient::new();
        for ((value, definition), row) in
            out.iter_mut().zip(&self.definitions).zip(jacobian.chunks_exact_mut(self.components))
        {
            gradient.clear();
            *value = definition.read_with_gradient(|v| at[v as usize], &mut gradient);
            for &(place, g) in &gradient {
                let [x, y, z] = [0, 1, 2].map(|axis| self.row(place, axis));
                for (((sum, &x), &y), &z) in row.iter_mut().zip(x).zip(y).zip(z) {
                    *sum += g.x * f64::from(x) + g.y * f64::from(y) + g.z * f64::from(z);
                }
            }
        }
        out
    }
}

/// Sum of products in eight lanes: fast without fused operations, and in one order on every machine.
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
