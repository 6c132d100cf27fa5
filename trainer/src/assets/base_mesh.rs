//! MakeHuman's `base.obj`: the body's cage, eyes, teeth, tongue and lashes with their texture coordinates.

use std::collections::{BTreeMap, HashMap};

use anthronet::mesh::Topology;
use glam::Vec3;

use super::{METRES_PER_UNIT, Wheel};
use crate::{Error, Result};

/// Vertices of the body's cage; they are the first of `base.obj`.
pub const CAGE_VERTICES: usize = 13_380;

/// The submeshes that move with the body, and the groups of `base.obj` they are made of.
pub const ACCESSORIES: [(&str, &[&str]); 4] = [
    ("eyes", &["helper-l-eye", "helper-r-eye"]),
    ("teeth", &["helper-upper-teeth", "helper-lower-teeth"]),
    ("tongue", &["helper-tongue"]),
    (
        "lashes",
        &["helper-l-eyelashes-1", "helper-l-eyelashes-2", "helper-r-eyelashes-1", "helper-r-eyelashes-2"],
    ),
];

/// One accessory: its own topology, over a contiguous range of points.
pub struct AccessoryRange {
    /// `eyes`, `teeth`, `tongue` or `lashes`.
    pub name: &'static str,
    /// First point.
    pub start: usize,
    /// Topology over the accessory's own vertices.
    pub topology: Topology,
}

/// The base mesh without its helpers.
pub struct BaseMesh {
    /// All vertices of `base.obj`, metres.
    pub raw_positions: Vec<Vec3>,
    /// The body's cage.
    pub cage: Topology,
    /// Eyes, teeth, tongue and lashes.
    pub accessories: Vec<AccessoryRange>,
    /// For each surface point (cage, then accessories) its vertex of `base.obj`.
    pub raw_of_surface: Vec<u32>,
    /// Vertices of `base.obj` by group, as `basemesh_vertex_groups.json` lists them.
    pub groups: BTreeMap<String, Vec<u32>>,
    /// For each vertex of `base.obj` its mirror image, where `hm08.mirror` has one.
    pub mirror: BTreeMap<u32, u32>,
}

type Faces = Vec<([u32; 4], [u32; 4])>;

impl BaseMesh {
    /// Reads mesh and groups.
    ///
    /// # Errors
    /// [`Error::Source`] naming the line.
    pub fn read(wheel: &mut Wheel) -> Result<Self> {
        let text = wheel.read_text("3dobjs/base.obj")?;
        let mut positions = Vec::new();
        let mut uvs = Vec::new();
        let mut faces: BTreeMap<String, Faces> = BTreeMap::new();
        let mut group = String::new();
        for (n, line) in text.lines().enumerate() {
            let fail = || Error::Source(format!("base.obj line {}: cannot read `{line}`", n + 1));
            let mut words = line.split_whitespace();
            match words.next() {
                Some("v") => {
                    let v = numbers::<3>(words).ok_or_else(fail)?;
                    positions.push(Vec3::from(v) * METRES_PER_UNIT);
                }
                Some("vt") => uvs.push(numbers::<2>(words).ok_or_else(fail)?),
                Some("g") => group = words.next().ok_or_else(fail)?.to_owned(),
                Some("f") => {
                    let face = quad(words, positions.len(), uvs.len()).ok_or_else(fail)?;
                    faces.entry(group.clone()).or_default().push(face);
                }
                _ => {}
            }
        }

        let mut raw_of_surface: Vec<u32> = (0..CAGE_VERTICES as u32).collect();
        let body = faces.remove("body").unwrap_or_default();
        let cage = compact(&body, &uvs, Some(CAGE_VERTICES)).0;
        let mut accessories = Vec::new();
        for (name, groups) in ACCESSORIES {
            let of_groups: Faces = groups.iter().flat_map(|g| faces.remove(*g).unwrap_or_default()).collect();
            if of_groups.is_empty() {
                return Err(Error::Source(format!("base.obj: groups {groups:?} have no faces")));
            }
            let (topology, raw) = compact(&of_groups, &uvs, None);
            accessories.push(AccessoryRange { name, start: raw_of_surface.len(), topology });
            raw_of_surface.extend(raw);
        }
        cage.validate()?;

        let ranges: BTreeMap<String, Vec<[u32; 2]>> =
            serde_json::from_str(&wheel.read_text("mesh_metadata/basemesh_vertex_groups.json")?)
                .map_err(|e| Error::Source(format!("basemesh_vertex_groups.json: {e}")))?;
        let groups = ranges
            .into_iter()
            .map(|(name, ranges)| (name, ranges.iter().flat_map(|&[a, b]| a..=b).collect()))
            .collect();
        let mirror = wheel
            .read_text("mesh_metadata/hm08.mirror")?
            .lines()
            .filter_map(|line| {
                let mut words = line.split_whitespace();
                Some((words.next()?.parse().ok()?, words.next()?.parse().ok()?))
            })
            .collect();
        Ok(Self { raw_positions: positions, cage, accessories, raw_of_surface, groups, mirror })
    }
}

fn numbers<const N: usize>(words: std::str::SplitWhitespace<'_>) -> Option<[f32; N]> {
    let mut out = [0.0; N];
    let mut words = words;
    for value in &mut out {
        *value = words.next()?.parse().ok()?;
    }
    Some(out)
}

fn quad(words: std::str::SplitWhitespace<'_>, vertices: usize, uvs: usize) -> Option<([u32; 4], [u32; 4])> {
    let mut face = ([0; 4], [0; 4]);
    let mut corners = 0;
    for word in words {
        let (v, t) = word.split_once('/')?;
        let (v, t): (usize, usize) = (v.parse().ok()?, t.split('/').next()?.parse().ok()?);
        if corners == 4 || v == 0 || v > vertices || t == 0 || t > uvs {
            return None;
        }
        face.0[corners] = (v - 1) as u32;
        face.1[corners] = (t - 1) as u32;
        corners += 1;
    }
    (corners == 4).then_some(face)
}

/// Topology over only the vertices (unless their number is given) and texture coordinates that the faces use.
fn compact(faces: &[([u32; 4], [u32; 4])], uvs: &[[f32; 2]], keep: Option<usize>) -> (Topology, Vec<u32>) {
    let vertices = match keep {
        Some(count) => (0..count as u32).collect(),
        None => sorted_unique(faces.iter().flat_map(|f| f.0)),
    };
    let used_uvs = sorted_unique(faces.iter().flat_map(|f| f.1));
    let number = |ids: &[u32]| -> HashMap<u32, u32> {
        ids.iter().enumerate().map(|(new, &old)| (old, new as u32)).collect()
    };
    let (new_vertex, new_uv) = (number(&vertices), number(&used_uvs));
    let topology = Topology {
        vertex_count: vertices.len(),
        quads: faces.iter().map(|f| f.0.map(|v| new_vertex.get(&v).copied().unwrap_or(u32::MAX))).collect(),
        uvs: used_uvs.iter().map(|&t| uvs[t as usize]).collect(),
        quad_uvs: faces.iter().map(|f| f.1.map(|t| new_uv[&t])).collect(),
    };
    (topology, vertices)
}

fn sorted_unique(ids: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut ids: Vec<u32> = ids.collect();
    ids.sort_unstable();
    ids.dedup();
    ids
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_an_obj_are_read_or_refused() {
        assert_eq!(numbers::<3>("1 -2.5 3e1 9".split_whitespace()), Some([1.0, -2.5, 30.0]));
        assert_eq!(numbers::<2>("1".split_whitespace()), None);
        assert_eq!(numbers::<2>("1 x".split_whitespace()), None);
        let face = |text: &str| quad(text.split_whitespace(), 4, 5);
        assert_eq!(face("1/5 2/1/7 3/2 4/3"), Some(([0, 1, 2, 3], [4, 0, 1, 2])));
        for bad in [
            "1/1 2/2 3/3",
            "1/1 2/2 3/3 4/4 4/5",
            "1 2 3 4",
            "0/1 2/2 3/3 4/4",
            "1/1 2/2 3/3 5/4",
            "1/6 2/2 3/3 4/4",
        ] {
            assert_eq!(face(bad), None, "{bad}");
        }
    }

    #[test]
    fn a_part_gets_numbers_of_its_own() {
        let faces = vec![([9, 3, 5, 7], [4, 2, 6, 8]), ([3, 9, 11, 5], [2, 4, 6, 6])];
        let uvs: Vec<[f32; 2]> = (0..9).map(|i| [i as f32, 0.0]).collect();
        let (part, vertices) = compact(&faces, &uvs, None);
        assert_eq!(vertices, [3, 5, 7, 9, 11]);
        assert_eq!(part.vertex_count, 5);
        assert_eq!(part.quads, [[3, 0, 1, 2], [0, 3, 4, 1]]);
        assert_eq!(part.uvs, [[2.0, 0.0], [4.0, 0.0], [6.0, 0.0], [8.0, 0.0]]);
        assert_eq!(part.quad_uvs, [[1, 0, 2, 3], [0, 1, 2, 2]]);
        part.validate().unwrap();
        // The cage keeps its numbers; a face beyond them is found by the check.
        let (cage, vertices) = compact(&faces, &uvs, Some(12));
        assert_eq!((vertices.len(), cage.quads[0]), (12, [9, 3, 5, 7]));
        assert!(compact(&faces, &uvs, Some(10)).0.validate().is_err());
    }
}
