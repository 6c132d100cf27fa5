//! Measures the body in a file.

use std::path::Path;

use glam::Vec3;

use crate::error::Fault;
use crate::model::{MeasuredMesh, Model};
use crate::{Error, Result};

/// Measures the body in a file: its first mesh, at any level of detail, in any format that
/// [`read_meshes`](super::read_meshes) reads.
///
/// Another program may have written it in another unit or other axes than the format says: the body itself tells them, and
/// [`MeasuredMesh::warnings`] says how it was read.
///
/// # Errors
/// As [`read_meshes`](super::read_meshes); [`Error::File`] for a file without a mesh, an `.obj` of ours in a pose, or one whose first mesh is not a body in
/// the model's vertex order, is mirrored, or of a unit or axes that cannot be told.
pub fn measure_file(model: &Model, path: impl AsRef<Path>) -> Result<MeasuredMesh> {
    let path = path.as_ref();
    let scene = super::read_meshes(path)?;
    if scene.has_posed_surface() {
        let found = "a posed surface, of which measures would be wrong";
        return Err(Error::file(path, Fault::unexpected("a body in the T-pose", found)));
    }
    let mesh = scene.meshes.first().ok_or_else(|| Error::file(path, Fault::missing("mesh")))?;
    let vertices: Vec<Vec3> = mesh.positions.iter().copied().map(Vec3::from_array).collect();
    model.measure_foreign_mesh(&vertices).map_err(|error| Error::file(path, Box::new(error)))
}
