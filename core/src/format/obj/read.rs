//! Wavefront OBJ: polygons, one mesh per `o` or `g` section that has faces.
//!
//! A mesh has the vertices declared in its section and those used by its faces, in file order, so that files written by
//! this library keep the model's order. Statements about colours, smoothing, curves and lines are ignored.

use std::{collections::BTreeMap, path::Path};

use glam::Vec3;
use serde_json::{Value, json};

use super::write::{COUNTS, POSED};
use crate::Error;
use crate::error::{Fault, ObjError};
use crate::format::limits::MAX_ELEMENTS;
use crate::scene::POSED_SURFACE;
use crate::scene::titles::Titles;
use crate::scene::{Corners, Scene, SceneMaterial, SceneMesh};
use crate::text;

/// Reads an `.obj`; `path` is for messages. All meshes share one white material.
///
/// # Errors
/// [`Error::File`] with the line for an invalid or non-finite number, an index out of range or too few corners, and
/// without a line for a truncated file of our own or a file without vertices.
pub(super) fn read(bytes: &[u8], path: &Path) -> crate::Result<Scene> {
    let text = text::decode(bytes).map_err(|fault| Error::file(path, ObjError::Whole(fault)))?;
    let mut reader = Reader::default();
    for (i, line) in text.split(|byte| *byte == b'\n').enumerate() {
        reader.line(line).map_err(|fault| Error::file(path, ObjError::Line { line: i + 1, fault }))?;
    }
    reader.finish().map_err(|fault| Error::file(path, ObjError::Whole(fault)))
}

type Result<T> = std::result::Result<T, Fault>;

/// A corner: index into `positions` and, optionally, into `normals`.
type Corner = (u32, Option<u32>);

#[derive(Default)]
struct Section {
    name: String,
    first_vertex: usize,
    end_vertex: usize,
    triangles: Vec<[Corner; 3]>,
}

#[derive(Default)]
struct Reader {
    positions: Vec<Vec3>,
    uvs: usize,
    normals: Vec<Vec3>,
    faces: usize,
    triangles: usize,
    sections: Vec<Section>,
    /// Numbers of vertices and faces stated in the header of our own files.
    announced: Option<(usize, usize)>,
    /// Whether the header of our own files says that the surface is posed.
    posed: bool,
}

impl Reader {
    fn line(&mut self, line: &[u8]) -> Result<()> {
        let Ok(line) = std::str::from_utf8(line) else {
            // Only names and comments may be in another encoding.
            return match line.first() {
                Some(b'#' | b'o' | b'g' | b'u' | b'm') => self.statement(&String::from_utf8_lossy(line)),
                _ => Err(Fault::unexpected("text in UTF-8", "other bytes")),
            };
        };
        self.statement(line)
    }

    fn statement(&mut self, line: &str) -> Result<()> {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword {
            "v" => {
                let position = vector(rest)?;
                self.positions.push(position);
                self.section().end_vertex += 1;
            }
            "vn" => self.normals.push(vector(rest)?.normalize_or_zero()),
            "vt" => self.uvs += 1,
            "f" => self.face(rest)?,
            "o" | "g" => self.sections.push(Section {
                name: rest.trim().to_owned(),
                first_vertex: self.positions.len(),
                end_vertex: self.positions.len(),
                triangles: Vec::new(),
            }),
            _ => {
                if let Some(counts) = line.strip_prefix(COUNTS) {
                    let mut counts = counts.split_ascii_whitespace().map(str::parse);
                    let (Some(Ok(vertices)), Some(Ok(faces))) = (counts.next(), counts.next()) else {
                        return Err(Fault::unexpected("two counts", "something else"));
                    };
                    self.announced = Some((vertices, faces));
                } else if line == POSED {
                    self.posed = true;
                } else if !keyword.starts_with('#')
                    && !keyword.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')
                {
                    return Err(Fault::unexpected(
                        "a statement",
                        format_args!("`{}`", keyword.escape_debug()),
                    ));
                }
            }
        }
        Ok(())
    }

    fn section(&mut self) -> &mut Section {
        if self.sections.is_empty() {
            self.sections.push(Section::default());
        }
        let last = self.sections.len() - 1;
        &mut self.sections[last]
    }

    fn face(&mut self, rest: &str) -> Result<()> {
        let corners =
            rest.split_ascii_whitespace().map(|text| self.corner(text)).collect::<Result<Vec<_>>>()?;
        let (Some((first, fan)), 3..) = (corners.split_first(), corners.len()) else {
            return Err(Fault::unexpected("a face of at least 3 corners", corners.len()));
        };
        self.faces += 1;
        self.triangles += fan.len() - 1;
        if self.triangles > MAX_ELEMENTS {
            return Err(Fault::too_many(format_args!("{MAX_ELEMENTS} triangles"), "more"));
        }
        self.section().triangles.extend(fan.windows(2).map(|pair| [*first, pair[0], pair[1]]));
        Ok(())
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, text: &str) -> Result<Corner> {
        let mut parts = text.split('/');
        let position = place(parts.next().unwrap_or_default(), self.positions.len(), "vertex")?;
        if let Some(uv) = parts.next().filter(|uv| !uv.is_empty()) {
            place(uv, self.uvs, "texture coordinate")?;
        }
        let normal = parts.next().filter(|n| !n.is_empty()).map(|n| place(n, self.normals.len(), "normal"));
        Ok((position, normal.transpose()?))
    }

    fn finish(self) -> Result<Scene> {
        if let Some((vertices, faces)) = self.announced
            && (vertices, faces) != (self.positions.len(), self.faces)
        {
            return Err(Fault::truncated(
                format_args!("{vertices} vertices and {faces} faces"),
                format_args!("{} and {}", self.positions.len(), self.faces),
            ));
        }
        if self.positions.is_empty() {
            return Err(Fault::missing("vertices"));
        }
        // A file of points only becomes one mesh without faces.
        let any_faces = self.sections.iter().any(|s| !s.triangles.is_empty());
        let sections = self.sections.iter().filter(|s| !any_faces || !s.triangles.is_empty());
        let sections = sections.filter(|s| any_faces || s.end_vertex > s.first_vertex);
        let mut names = Titles::default();
        let meshes =
            sections.map(|section| SceneMesh { name: names.unique(&section.name), ..self.mesh(section) });
        let materials = vec![SceneMaterial::dielectric("Material", [1.0; 4], 0.5)];
        let extras = if self.posed { json!({"anthronet": {"posed": POSED_SURFACE}}) } else { Value::Null };
        Ok(Scene { meshes: meshes.collect(), materials, extras, ..Scene::default() })
    }

    fn mesh(&self, section: &Section) -> SceneMesh {
        // Vertices from outside the section, in file order, mapped to their index in the mesh.
        let own = section.first_vertex as u32..section.end_vertex as u32;
        let corners = || section.triangles.iter().flatten();
        let mut places: BTreeMap<u32, u32> =
            corners().map(|c| c.0).filter(|p| !own.contains(p)).map(|p| (p, 0)).collect();
        let before = places.range(..own.start).count() as u32;
        for (rank, (vertex, place)) in (0u32..).zip(places.iter_mut()) {
            *place = if *vertex < own.start { rank } else { rank + own.len() as u32 };
        }
        let place = |vertex: u32| {
            places.get(&vertex).copied().unwrap_or_else(|| before + vertex.saturating_sub(own.start))
        };
        let foreign = |range| places.range::<u32, _>(range).map(|(vertex, _)| *vertex);
        let vertices = foreign(0..own.start).chain(own.clone()).chain(foreign(own.end..u32::MAX));
        let positions: Vec<_> =
            vertices.map(|vertex| self.positions.get(vertex as usize).copied().unwrap_or_default()).collect();

        // A vertex gets the normal of its first corner; the mesh has normals only if all corners have one.
        let mut normals = Vec::new();
        if !section.triangles.is_empty() && corners().all(|corner| corner.1.is_some()) {
            normals = vec![None; positions.len()];
            for (vertex, normal) in corners() {
                let normal = normal.and_then(|n| self.normals.get(n as usize)).copied();
                if let Some(slot) = normals.get_mut(place(*vertex) as usize) {
                    *slot = slot.or(normal);
                }
            }
        }
        let triangles = section.triangles.iter().map(|t| t.map(|corner| place(corner.0))).collect();
        SceneMesh {
            positions: positions.iter().map(Vec3::to_array).collect(),
            normals: normals.into_iter().map(|normal| normal.unwrap_or_default().to_array()).collect(),
            triangles: Corners { positions: triangles, uvs: Vec::new() },
            ..SceneMesh::default()
        }
    }
}

/// The first three numbers of a statement.
fn vector(rest: &str) -> Result<Vec3> {
    let mut parts = rest.split_ascii_whitespace();
    let mut vector = Vec3::ZERO;
    for axis in ["x", "y", "z"] {
        let text = parts.next().ok_or_else(|| Fault::missing(axis))?;
        let fault = |_| Fault::unexpected(format_args!("a number for {axis}"), format_args!("`{text}`"));
        let value = text.parse::<f32>().map_err(fault)?;
        if !value.is_finite() {
            return Err(Fault::not_finite(axis, format_args!("`{text}`")));
        }
        vector = match axis {
            "x" => vector.with_x(value),
            "y" => vector.with_y(value),
            _ => vector.with_z(value),
        };
    }
    Ok(vector)
}

/// An OBJ index: counted from 1, or backwards from −1.
fn place(text: &str, len: usize, what: &str) -> Result<u32> {
    let index: i64 = text
        .parse()
        .map_err(|_| Fault::unexpected(format_args!("the number of a {what}"), format_args!("`{text}`")))?;
    let place = if index < 0 { len as i64 + index } else { index - 1 };
    u32::try_from(place).ok().filter(|p| (*p as usize) < len).ok_or_else(|| Fault::Dangling {
        what: what.to_owned(),
        index,
        count: len,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::obj::to_obj;
    use crate::testing::scene::arm;

    fn read(text: &str) -> crate::Result<Scene> {
        super::read(text.as_bytes(), Path::new("a.obj"))
    }

    #[test]
    fn reads_back_what_was_written() {
        let scene = arm(4);
        let read = super::read(&to_obj(&scene).unwrap(), Path::new("a.obj")).unwrap();
        assert_eq!(read.meshes.len(), 2);
        for (read, written) in read.meshes.iter().zip(&scene.meshes) {
            assert_eq!(read.name, written.name);
            assert_eq!(read.positions, written.positions);
            let triangles: Vec<_> = written.triangulated().iter().map(|t| t.map(|c| c.0)).collect();
            assert_eq!(read.triangles.positions, triangles);
            let far = |a: &[f32; 3], b: &[f32; 3]| Vec3::from(*a).distance(Vec3::from(*b)) >= 1e-6;
            assert!(!read.normals.iter().zip(&written.normals).any(|(a, b)| far(a, b)));
        }
        assert_eq!(read.meshes[0].normals.len(), 15);
    }

    #[test]
    fn sections_may_share_vertices_that_come_first() {
        let scene = read(
            "mtllib x.mtl\r\no All\r\nv 0 0 0 1\r\nv 1 0 0\r\nv 2 0 0\r\nv 3 0 0\r\nv 4 0 0\r\ng b\r\nusemtl y\r\n\
             f 5 2 -2\r\ng a\r\ns 1\r\nv 5 0 0\r\nf 1 2 3 -1\r\n",
        )
        .unwrap();
        let [b, a] = &scene.meshes[..] else { panic!("{scene:?}") };
        let x = |mesh: &SceneMesh| mesh.positions.iter().map(|p| p[0]).collect::<Vec<_>>();
        assert_eq!((x(b), &b.triangles.positions[..]), (vec![1.0, 3.0, 4.0], &[[2, 0, 1]][..]));
        assert_eq!(
            (x(a), &a.triangles.positions[..]),
            (vec![0.0, 1.0, 2.0, 5.0], &[[0, 1, 2], [0, 2, 3]][..])
        );
    }

    #[test]
    fn text_is_read_in_any_encoding() {
        let text = "o All\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
        let plain = read(text).unwrap();
        let utf16: Vec<u8> = format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_be_bytes).collect();
        for bytes in [format!("\u{feff}{text}").into_bytes(), text.replace('\n', "\r").into_bytes(), utf16] {
            let scene = super::read(&bytes, Path::new("a.obj")).unwrap();
            assert_eq!(scene.meshes[0].name, plain.meshes[0].name);
            assert_eq!(scene.meshes[0].positions, plain.meshes[0].positions);
            assert_eq!(scene.meshes[0].triangles.positions, plain.meshes[0].triangles.positions);
        }
    }

    #[test]
    fn points_alone_are_a_mesh() {
        let scene = read("v 1 2 3\nv 4 5 6").unwrap();
        assert_eq!(scene.meshes[0].positions, [[1., 2., 3.], [4., 5., 6.]]);
    }

    #[test]
    fn says_what_is_wrong_and_in_which_line() {
        for (text, expected) in [
            ("", "a.obj: has no vertices"),
            ("# v 1 2 3", "a.obj: has no vertices"),
            ("v 1 2", "line 1: has no z"),
            ("v 1 2 3\nv 1 nan 3", "line 2: y: `nan` is not finite"),
            ("v 1 1e99 3", "line 1: y: `1e99` is not finite"),
            ("v 1 x 3", "expected a number for y, got `x`"),
            ("v 1 2 3\nf 1 1 2", "line 2: vertex 2 does not exist, there are 1"),
            ("v 1 2 3\nf 1 1 0", "vertex 0 does not exist"),
            ("v 1 2 3\nf 1 1 -2", "vertex -2 does not exist"),
            ("v 1 2 3\nf 1 1", "line 2: expected a face of at least 3 corners, got 2"),
            ("v 1 2 3\nf 1/1 1/1 1/1", "texture coordinate 1 does not exist, there are 0"),
            ("v 1 2 3\nf 1//9 1//9 1//9", "normal 9 does not exist"),
            ("v 1 2 3\nf 1 1 99999999999999999999", "expected the number of a vertex"),
            ("v 1 2 3\n\u{1}\u{2}", "line 2: expected a statement"),
        ] {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(expected), "`{expected}` in `{message}`");
        }
        let message = super::read(b"v 1 2 3\n\xff\xfe", Path::new("a.obj")).unwrap_err().to_string();
        assert!(message.contains("line 2: expected text"), "{message}");
    }

    #[test]
    fn a_file_of_ours_that_lost_its_end_is_told() {
        let bytes = to_obj(&arm(4)).unwrap();
        let last_face = bytes.len() - b"f 16 17 18\n".len();
        let message = super::read(&bytes[..last_face], Path::new("a.obj")).unwrap_err().to_string();
        assert!(message.contains("expected 18 vertices and 11 faces, got 18 and 10"), "{message}");
    }
}
