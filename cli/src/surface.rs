//! From a file's body at any level of detail to the surface that measures are defined on.
//!
//! Level 0 is that surface. Level 1 is its first vertices, the cage's vertices after one Catmull-Clark step: that step
//! is undone exactly, then taken again. Levels 2 and 3 are some of those vertices: the body of the model's shape space
//! nearest to them is fitted, which for bodies of this model is the body itself.

use anthronet::mesh::{Lod, Subdivision};
use anthronet::model::Model;
use glam::{DVec3, Vec3};

use crate::failure::{Failure, Result};

/// Vertices of level 0 from those of any level, metres, in model order.
pub(crate) fn level0(model: &Model, points: &[Vec3]) -> Result<Vec<DVec3>> {
    let character = model.character();
    let points: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
    let Some(lod) = Lod::ALL.into_iter().find(|lod| character.vertex_count(*lod) == points.len()) else {
        let known: Vec<_> = Lod::ALL.iter().map(|lod| character.vertex_count(*lod).to_string()).collect();
        let known = known.join(", ");
        return Err(Failure::failed(format!(
            "expected a body of {known} vertices in the model's order, the first mesh has {}",
            points.len()
        )));
    };
    let subdivision = character.subdivision();
    let cage = match lod {
        Lod::Lod0 => return Ok(points),
        Lod::Lod1 => undo_subdivision(subdivision, &points)?,
        Lod::Lod2 | Lod::Lod3 => {
            let vertices = character.reduced(lod).map(|mesh| mesh.vertices.as_slice()).unwrap_or_default();
            fit(model, vertices, &points)?
        }
    };
    Ok(subdivision.refine_f64(&cage)?)
}

/// The cage whose Catmull-Clark vertex points are these. The step's matrix has eigenvalues between 0 and 1, so that
/// Richardson's iteration converges.
fn undo_subdivision(subdivision: &Subdivision, points: &[DVec3]) -> Result<Vec<DVec3>> {
    /// Far below what a file's single precision resolves.
    const TOLERANCE: f64 = 1e-11;
    const STEP: f64 = 1.5;
    let mut cage = points.to_vec();
    for _ in 0..20_000 {
        let mut worst = 0.0_f64;
        let residuals: Vec<DVec3> = (0..points.len())
            .map(|v| {
                let moved: DVec3 = subdivision.stencil(v).map(|(i, w)| cage[i as usize] * f64::from(w)).sum();
                points[v] - moved
            })
            .collect();
        for (vertex, residual) in cage.iter_mut().zip(residuals) {
            worst = worst.max(residual.abs().max_element());
            *vertex += residual * STEP;
        }
        if worst < TOLERANCE {
            return Ok(cage);
        }
    }
    Err(Failure::failed("the body's vertices are not those of a level of detail of this model"))
}

/// The cage of the model's body nearest to some level-1 vertices, up to a shift: files stand on the ground.
fn fit(model: &Model, vertices: &[u32], points: &[DVec3]) -> Result<Vec<DVec3>> {
    let (space, subdivision) = (model.shape_space(), model.character().subdivision());
    let count = space.components();
    // Unknowns: coefficients in standard deviations, then the shift along y in metres.
    let unknowns = count + 1;
    let mut rows = Vec::with_capacity(points.len() * 3);
    let mut right = Vec::with_capacity(points.len() * 3);
    for (vertex, point) in vertices.iter().zip(points) {
        let mut mean = DVec3::ZERO;
        let mut row = vec![[0.0; 3]; unknowns];
        for (cage, weight) in subdivision.stencil(*vertex as usize) {
            let weight = f64::from(weight);
            mean += space.mean_point(cage as usize).as_dvec3() * weight;
            for (k, (entry, deviation)) in row.iter_mut().zip(space.deviations()).enumerate() {
                let component = space.component(k, cage as usize);
                for axis in 0..3 {
                    entry[axis] += weight * deviation * component[axis];
                }
            }
        }
        row[count] = [0.0, 1.0, 0.0];
        let gap = (*point - mean).to_array();
        for axis in 0..3 {
            rows.push(row.iter().map(|entry| entry[axis]).collect::<Vec<f64>>());
            right.push(gap[axis]);
        }
    }
    let solution = least_squares(&rows, &right, unknowns)
        .ok_or_else(|| Failure::failed("the body's vertices do not determine a body of this model"))?;
    let coefficients: Vec<f64> =
        solution.iter().zip(space.deviations()).map(|(u, deviation)| u * deviation).collect();
    let cage = model.character().cage().vertex_count;
    Ok(space.body(&coefficients).iter().take(cage).map(|p| p.as_dvec3()).collect())
}

/// Smallest `|A x - b|² + (10 µm)² |x|²` by Cholesky, refined once. `None` for numbers that are not finite.
fn least_squares(rows: &[Vec<f64>], right: &[f64], n: usize) -> Option<Vec<f64>> {
    const RIDGE: f64 = 1e-10;
    let mut normal = vec![0.0; n * n];
    for row in rows {
        for i in 0..n {
            if row[i] != 0.0 {
                for j in 0..=i {
                    normal[i * n + j] += row[i] * row[j];
                }
            }
        }
    }
    for i in 0..n {
        normal[i * n + i] += RIDGE;
    }
    // Lower triangle in place.
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| normal[i * n + k] * normal[j * n + k]).sum();
            let value = normal[i * n + j] - sum;
            normal[i * n + j] = if i == j { value.sqrt() } else { value / normal[j * n + j] };
        }
        if !(normal[i * n + i] > 0.0 && normal[i * n + i].is_finite()) {
            return None;
        }
    }
    let mut x = vec![0.0; n];
    for _ in 0..3 {
        let mut step = vec![0.0; n];
        for (row, b) in rows.iter().zip(right) {
            let gap = b - row.iter().zip(&x).map(|(a, x)| a * x).sum::<f64>();
            for (s, a) in step.iter_mut().zip(row) {
                *s += a * gap;
            }
        }
        for (s, x) in step.iter_mut().zip(&x) {
            *s -= RIDGE * x;
        }
        for i in 0..n {
            let sum: f64 = (0..i).map(|k| normal[i * n + k] * step[k]).sum();
            step[i] = (step[i] - sum) / normal[i * n + i];
        }
        for i in (0..n).rev() {
            let sum: f64 = (i + 1..n).map(|k| normal[k * n + i] * step[k]).sum();
            step[i] = (step[i] - sum) / normal[i * n + i];
        }
        x.iter_mut().zip(&step).for_each(|(x, s)| *x += s);
    }
    x.iter().all(|v| v.is_finite()).then_some(x)
}

#[cfg(test)]
mod tests {
    use anthronet::condition::Request;
    use anthronet::mesh::Topology;

    use super::*;

    #[test]
    fn subdivision_is_undone() {
        // A torus of 6 by 5 quads.
        let at = |i: u32, j: u32| (i % 6) * 5 + j % 5;
        let quads: Vec<[u32; 4]> = (0..30)
            .map(|k| (k / 5, k % 5))
            .map(|(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
            .collect();
        let quad_uvs = vec![[0; 4]; 30];
        let torus = Topology { vertex_count: 30, quads, uvs: vec![[0.0; 2]], quad_uvs };
        let subdivision = Subdivision::new(&torus).unwrap();
        let cage: Vec<DVec3> = (0..30_u32)
            .map(|v| DVec3::new(f64::from(v * 7 % 11), f64::from(v * 5 % 13), f64::from(v * 3 % 17)))
            .collect();
        let refined = subdivision.refine_f64(&cage).unwrap();
        let back = undo_subdivision(&subdivision, &refined[..30]).unwrap();
        for (a, b) in back.iter().zip(&cage) {
            assert!(a.distance(*b) < 1e-9, "{a} for {b}");
        }
    }

    #[test]
    fn least_squares_finds_an_exact_solution() {
        let truth = [0.5, -2.0, 3.0];
        let rows: Vec<Vec<f64>> = (0..9_u32)
            .map(|i| (0..3_u32).map(|k| f64::from((i * 7 + k * 5 + i * k * 3) % 11) - 4.0).collect())
            .collect();
        let right: Vec<f64> = rows.iter().map(|r| r.iter().zip(&truth).map(|(a, x)| a * x).sum()).collect();
        let x = least_squares(&rows, &right, 3).unwrap();
        assert!(x.iter().zip(&truth).all(|(a, b)| (a - b).abs() < 1e-9), "{x:?}");
        assert!(least_squares(&[vec![f64::NAN; 3]], &[1.0], 3).is_none());
    }

    #[test]
    fn a_count_that_is_no_level_is_refused() {
        // Without a built-in model there is nothing to compare with.
        if let Ok(model) = Model::embedded() {
            assert!(level0(&model, &[Vec3::ZERO; 5]).is_err());
            let person = model.generate(&Request::default()).unwrap();
            let character = model.character();
            for lod in Lod::ALL {
                let points: Vec<Vec3> = match character.reduced(lod) {
                    Some(mesh) => mesh.vertices.iter().map(|v| person.vertices()[*v as usize]).collect(),
                    None => person.vertices()[..character.vertex_count(lod)].to_vec(),
                };
                let surface = level0(&model, &points).unwrap();
                let at = |v: u32| surface[v as usize];
                let measures = model.definitions().read_all(at);
                for (got, exact) in measures.iter().zip(person.measurements()) {
                    // A twentieth of a millimetre: single precision of the points, and of the fit's coefficients.
                    assert!((got - exact).abs() < 5e-5, "{lod:?}: {got} for {exact}");
                }
            }
        }
    }
}
