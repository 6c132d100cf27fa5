//! What is drawn: the parts of one person, in metres, +Y up, +Z forward, feet on y = 0.

use glam::Vec3;

use crate::failure::{Failure, Result};

/// What a part is made of; decides its colours and how it shines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Material {
    Skin,
    Eye,
    Teeth,
    Tongue,
    Lashes,
}

impl Material {
    /// The material that a mesh or material name of a file stands for; what is not known is skin.
    pub(crate) fn from_name(name: &str) -> Self {
        let name = name.to_ascii_lowercase();
        let has = |word: &str| name.contains(word);
        if has("lash") {
            Self::Lashes
        } else if has("eye") && !has("brow") {
            Self::Eye
        } else if has("teeth") {
            Self::Teeth
        } else if has("tongue") {
            Self::Tongue
        } else {
            Self::Skin
        }
    }
}

/// One mesh of a figure.
pub(crate) struct Part {
    pub(crate) material: Material,
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// One person.
pub(crate) struct Figure {
    pub(crate) parts: Vec<Part>,
    /// Albedo of the skin, linear RGB.
    pub(crate) skin: Vec3,
}

impl Figure {
    /// Checks what the renderer relies on: something to draw, finite positions, indices in range.
    pub(crate) fn new(parts: Vec<Part>, skin: Vec3) -> Result<Self> {
        let parts: Vec<_> = parts.into_iter().filter(|part| !part.triangles.is_empty()).collect();
        if parts.is_empty() {
            return Err(Failure::failed("nothing to draw: the input has no triangles"));
        }
        for part in &parts {
            let name = part.material;
            if let Some(at) =
                part.positions.iter().position(|p| !p.is_finite() || p.abs().max_element() > 1e3)
            {
                let p = part.positions[at];
                return Err(Failure::failed(format!(
                    "{name:?} vertex {at}: expected finite metres, got ({}, {}, {})",
                    p.x, p.y, p.z
                )));
            }
            let count = part.positions.len();
            if let Some(bad) = part.triangles.iter().flatten().find(|i| **i as usize >= count) {
                return Err(Failure::failed(format!(
                    "{name:?}: triangle names vertex {bad}, there are {count}"
                )));
            }
        }
        Ok(Self { parts, skin: skin.clamp(Vec3::splat(0.01), Vec3::splat(0.95)) })
    }

    /// Smallest box around all parts.
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        bounds(self.parts.iter().flat_map(|part| part.positions.iter().copied()))
    }
}

/// Smallest box around points; (max, min) reversed infinities for none.
pub(crate) fn bounds(points: impl Iterator<Item = Vec3>) -> (Vec3, Vec3) {
    points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
}

/// A mesh whose equal positions are one vertex: texture seams in files split vertices, light and normals must not.
pub(crate) struct Welded {
    /// For each vertex of the part, its welded vertex.
    pub(crate) welded_from_vertex: Vec<u32>,
    pub(crate) positions: Vec<Vec3>,
    pub(crate) normals: Vec<Vec3>,
    /// Neighbours of welded vertex i are `neighbours[starts[i]..starts[i + 1]]`.
    starts: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Welded {
    pub(crate) fn new(part: &Part) -> Self {
        let key = |p: Vec3| [p.x, p.y, p.z].map(|v| (v + 0.0).to_bits());
        let mut order: Vec<u32> = (0..part.positions.len() as u32).collect();
        order.sort_unstable_by_key(|i| (key(part.positions[*i as usize]), *i));
        let mut welded_from_vertex = vec![0_u32; part.positions.len()];
        let mut positions: Vec<Vec3> = Vec::new();
        for i in order {
            let p = part.positions[i as usize];
            if positions.last().is_none_or(|last| key(*last) != key(p)) {
                positions.push(p);
            }
            welded_from_vertex[i as usize] = positions.len() as u32 - 1;
        }
        let triangles: Vec<[u32; 3]> =
            part.triangles.iter().map(|t| t.map(|i| welded_from_vertex[i as usize])).collect();
        let normals = normals(&positions, &triangles);
        let (starts, neighbours) = adjacency(positions.len(), &triangles);
        Self { welded_from_vertex, positions, normals, starts, neighbours }
    }

    /// Steps of [`Welded::diffuse`] that spread a value over about `reach` metres: each spreads it by 0.7 of the
    /// mean distance between neighbours, and n steps by the square root of n as much.
    pub(crate) fn diffusion_steps(&self, reach: f32) -> usize {
        let mut sum = 0.0;
        for (i, p) in self.positions.iter().enumerate() {
            let around = &self.neighbours[self.starts[i] as usize..self.starts[i + 1] as usize];
            sum += around.iter().map(|j| p.distance(self.positions[*j as usize])).sum::<f32>();
        }
        let step = 0.7 * sum / self.neighbours.len().max(1) as f32;
        let ratio = reach / step.max(1e-6);
        ((ratio * ratio + 0.5) as usize).clamp(1, 16)
    }

    /// One step of diffusion over the surface: each value moves half way to the mean of its neighbours.
    pub(crate) fn diffuse(&self, values: &[f32]) -> Vec<f32> {
        (0..values.len())
            .map(|i| {
                let around = &self.neighbours[self.starts[i] as usize..self.starts[i + 1] as usize];
                if around.is_empty() {
                    return values[i];
                }
                let sum: f32 = around.iter().map(|j| values[*j as usize]).sum();
                0.5 * values[i] + 0.5 * sum / around.len() as f32
            })
            .collect()
    }
}

/// Vertex normals: the mean of the face normals, weighted by the corner angle's chord so that a fan's triangulation
/// does not show.
fn normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; positions.len()];
    for t in triangles {
        let p = t.map(|i| positions[i as usize]);
        let face = (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
        for k in 0..3 {
            let a = (p[(k + 1) % 3] - p[k]).normalize_or_zero();
            let b = (p[(k + 2) % 3] - p[k]).normalize_or_zero();
            sums[t[k] as usize] += face * (a - b).length();
        }
    }
    sums.into_iter().map(|n| n.normalize_or(Vec3::Y)).collect()
}

fn adjacency(count: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<u32>) {
    let mut edges: Vec<(u32, u32)> = Vec::with_capacity(triangles.len() * 6);
    for [a, b, c] in triangles {
        for (i, j) in [(a, b), (b, c), (c, a)] {
            edges.extend([(*i, *j), (*j, *i)]);
        }
    }
    edges.sort_unstable();
    edges.dedup();
    let mut starts = vec![0_u32; count + 1];
    for (i, _) in &edges {
        starts[*i as usize + 1] += 1;
    }
    for i in 0..count {
        starts[i + 1] += starts[i];
    }
    (starts, edges.into_iter().map(|(_, j)| j).collect())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A sphere of quads split into triangles, with its seam vertices doubled as a texture would.
    pub(crate) fn sphere(centre: Vec3, radius: f32, rings: u32) -> Part {
        let sectors = rings * 2;
        let mut positions = Vec::new();
        for r in 0..=rings {
            let theta = std::f64::consts::PI * f64::from(r) / f64::from(rings);
            for s in 0..=sectors {
                let phi = std::f64::consts::TAU * f64::from(s % sectors) / f64::from(sectors);
                let (st, ct) = (libm::sin(theta), libm::cos(theta));
                let d = [st * libm::sin(phi), ct, st * libm::cos(phi)].map(|v| v as f32);
                positions.push(centre + radius * Vec3::from_array(d));
            }
        }
        let mut triangles = Vec::new();
        for r in 0..rings {
            for s in 0..sectors {
                let a = r * (sectors + 1) + s;
                let b = a + sectors + 1;
                triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
            }
        }
        Part { material: Material::Skin, positions, triangles }
    }

    #[test]
    fn welding_joins_the_seam_and_normals_point_outwards() {
        let part = sphere(Vec3::new(0.0, 1.0, 0.0), 0.5, 16);
        let welded = Welded::new(&part);
        // 15 inner rings of 32, and the poles, whose float noise may leave more than one copy each.
        assert!(welded.positions.len() < part.positions.len() - 15 + 1);
        for (p, n) in welded.positions.iter().zip(&welded.normals) {
            let outward = (*p - Vec3::new(0.0, 1.0, 0.0)).normalize_or_zero();
            assert!(n.dot(outward) > 0.99, "{p} {n}");
        }
    }

    #[test]
    fn bad_input_is_refused() {
        let mut part = sphere(Vec3::ZERO, 1.0, 4);
        part.triangles.push([0, 1, 99_999]);
        assert!(Figure::new(vec![part], Vec3::ONE).is_err());
        let mut part = sphere(Vec3::ZERO, 1.0, 4);
        part.positions[3].x = f32::NAN;
        assert!(Figure::new(vec![part], Vec3::ONE).is_err());
        assert!(Figure::new(vec![], Vec3::ONE).is_err());
    }

    #[test]
    fn names_give_materials() {
        assert_eq!(Material::from_name("Body"), Material::Skin);
        assert_eq!(Material::from_name("eyelashes"), Material::Lashes);
        assert_eq!(Material::from_name("eyes"), Material::Eye);
        assert_eq!(Material::from_name("teeth"), Material::Teeth);
    }
}
