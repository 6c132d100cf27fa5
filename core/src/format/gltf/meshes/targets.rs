//! Morph targets of a primitive (glTF 2.0, section 3.7.2.2). Tangents and default weights are ignored: in a scene at
//! rest all weights are 0.

use glam::{Mat3A, Vec3};
use gltf_json::mesh::Primitive;
use gltf_json::{Mesh, Value};

use crate::error::{Fault, Within};
use crate::format::gltf::Result;
use crate::format::gltf::document::Document;
use crate::scene::titles::Titles;
use crate::scene::{MorphTarget, SceneMesh};

/// Limit on the vertices of all targets of a document: a small file must not demand all memory.
const MAX_TARGET_VERTICES: usize = 1 << 25;

/// Reads the morph targets of one document.
pub(super) struct Targets<'a> {
    document: &'a Document,
    /// The remaining budget of target vertices.
    left: usize,
}

impl<'a> Targets<'a> {
    pub(super) fn of(document: &'a Document) -> Self {
        Self { document, left: MAX_TARGET_VERTICES }
    }

    /// The targets of a primitive whose surface has already been read.
    pub(super) fn read(
        &mut self,
        mesh: &Mesh,
        primitive: &Primitive,
        surface: &SceneMesh,
    ) -> Result<Vec<MorphTarget>> {
        let Some(targets) = primitive.targets.as_ref().filter(|targets| !targets.is_empty()) else {
            return Ok(Vec::new());
        };
        let count = surface.positions.len();
        let left = targets.len().checked_mul(count).and_then(|vertices| self.left.checked_sub(vertices));
        self.left = left.ok_or_else(|| {
            Fault::too_many(format_args!("{MAX_TARGET_VERTICES} vertices in all morph targets"), "more")
        })?;
        let (named, mut names) = (names(mesh), Titles::default());
        let mut read = Vec::with_capacity(targets.len());
        for (i, target) in targets.iter().enumerate() {
            let offsets = |index, what: &str| {
                self.document.offsets(index, count).within(format_args!("targets[{i}]: {what}"))
            };
            let positions = match target.positions {
                Some(index) => offsets(index, "POSITION")?,
                None => vec![[0.0; 3]; count],
            };
            let normals = match target.normals {
                Some(index) if !surface.normals.is_empty() => offsets(index, "NORMAL")?,
                _ => Vec::new(),
            };
            let name = named.get(i).cloned().filter(|name| !name.is_empty());
            let name = names.unique(&name.unwrap_or_else(|| format!("target{i}")));
            read.push(MorphTarget { name, positions, normals });
        }
        Ok(read)
    }
}

/// The names of the mesh's targets: not part of the standard, but a common convention.
fn names(mesh: &Mesh) -> Vec<String> {
    let extras = mesh.extras.as_ref().and_then(|e| gltf_json::deserialize::from_str::<Value>(e.get()).ok());
    let names = extras.as_ref().and_then(|e| e.get("targetNames")).and_then(Value::as_array);
    let text = |name: &Value| name.as_str().unwrap_or_default().to_owned();
    names.map(|names| names.iter().map(text).collect()).unwrap_or_default()
}

/// Transforms the offsets with the surface, whose normals must still be those of the file.
pub(super) fn place(mesh: &mut SceneMesh, matrix: Mat3A, normal_matrix: Mat3A) {
    for target in &mut mesh.morph_targets {
        for offset in &mut target.positions {
            *offset = (matrix * Vec3::from_array(*offset)).to_array();
        }
        for (offset, normal) in target.normals.iter_mut().zip(&mesh.normals) {
            let length = (normal_matrix * Vec3::from_array(*normal)).length();
            let share = if length > 0.0 { length.recip() } else { 0.0 };
            *offset = (normal_matrix * Vec3::from_array(*offset) * share).to_array();
        }
    }
}
