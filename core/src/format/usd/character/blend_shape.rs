//! Reads BlendShapes as morph targets. In-between shapes are ignored.

use glam::{DAffine3, DMat3, DVec3};
use openusd::sdf::{Path, Value};

use super::title;
use crate::error::{Fault, UsdError, Within};
use crate::format::limits::MAX_ELEMENTS;
use crate::format::usd::Result;
use crate::format::usd::document::layer::Layer;
use crate::format::usd::document::values;
use crate::scene::titles::Titles;
use crate::scene::{MorphTarget, SceneMesh};

/// Maximum number of points over all targets of a mesh: a few bytes must not allocate all memory.
const MAX_TARGET_VERTICES: usize = 8 * MAX_ELEMENTS;
/// Deviation from length 1 up to which a normal counts as a unit vector.
const UNIT_TOLERANCE: f64 = 1e-6;

/// Adds the morph targets of a mesh, whose normals are in our space; returns the tokens that identify their weights.
pub(super) fn read(
    layer: &Layer,
    prim: &Path,
    mesh: &mut SceneMesh,
    file_normals: &[[f64; 3]],
    ours_from_mesh: &DAffine3,
) -> Result<Vec<String>> {
    let tokens = layer.tokens(prim, "skel:blendShapes")?.unwrap_or_default();
    let targets = layer.targets(prim, "skel:blendShapeTargets")?;
    if tokens.len() != targets.len() {
        let expected = format!("{}, one per token", tokens.len());
        return Err(Fault::unexpected(expected, targets.len()).into())
            .within(format_args!("{prim}.skel:blendShapeTargets"));
    }
    let count = mesh.positions.len();
    if tokens.len().checked_mul(count).is_none_or(|vertices| vertices > MAX_TARGET_VERTICES) {
        let most = format!("{MAX_TARGET_VERTICES} points in all blend shapes");
        let found = format!("{} shapes of {count}", tokens.len());
        return Err(Fault::too_many(most, found).into()).within(prim);
    }
    let mut names = Titles::default();
    let normal_matrix = ours_from_mesh.matrix3.inverse().transpose();
    for shape in &targets {
        let indices = indices(layer, shape, count)?;
        let rows = |name: &str| dense(layer, shape, name, indices.as_deref(), count);
        let offsets = rows("offsets")?.ok_or_else(|| UsdError::from(Fault::missing("value")));
        let offsets = offsets.within(format_args!("{shape}.offsets"))?;
        let normals = match rows("normalOffsets")? {
            Some(normals) if mesh.normals.len() == count => turned(&normals, file_normals, normal_matrix),
            _ => Vec::new(),
        };
        let ours = |offset: &DVec3| (ours_from_mesh.matrix3 * *offset).as_vec3().to_array();
        mesh.morph_targets.push(MorphTarget {
            name: names.unique(&title(layer, shape)?),
            positions: offsets.iter().map(ours).collect(),
            normals,
        });
    }
    Ok(tokens)
}

/// Normal offsets, transformed and scaled like the base normals, which are normalised after the transform.
fn turned(offsets: &[DVec3], normals: &[[f64; 3]], normal_matrix: DMat3) -> Vec<[f32; 3]> {
    let turn = |(offset, normal): (&DVec3, &[f64; 3])| {
        let length = (normal_matrix * DVec3::from_array(*normal)).length();
        let share = if (length - 1.0).abs() < UNIT_TOLERANCE { 1.0 } else { length.max(1e-12).recip() };
        (normal_matrix * *offset * share).as_vec3().to_array()
    };
    offsets.iter().zip(normals).map(turn).collect()
}

/// Indices of the points to which a shape's offsets apply; `None` for all points in order.
fn indices(layer: &Layer, shape: &Path, count: usize) -> Result<Option<Vec<usize>>> {
    let numbers = match layer.default(shape, "pointIndices")? {
        Some(Value::IntVec(numbers)) => numbers,
        Some(_) => {
            return Err(Fault::unexpected("integers", "another type").into())
                .within(format_args!("{shape}.pointIndices"));
        }
        None => return Ok(None),
    };
    if numbers.is_empty() {
        return Ok(None);
    }
    let place = |number: &i32| usize::try_from(*number).ok().filter(|place| *place < count);
    let places: Option<Vec<usize>> = numbers.iter().map(place).collect();
    let fault = || UsdError::from(Fault::unexpected(format_args!("places among {count} points"), "others"));
    places.map(Some).ok_or_else(fault).within(format_args!("{shape}.pointIndices"))
}

/// An offset attribute with a row for every point; `None` where the shape has none.
fn dense(
    layer: &Layer,
    shape: &Path,
    name: &str,
    indices: Option<&[usize]>,
    count: usize,
) -> Result<Option<Vec<DVec3>>> {
    let Some(value) = layer.default(shape, name)? else { return Ok(None) };
    let rows = values::rows::<3>(&value);
    if rows.as_ref().is_some_and(Vec::is_empty) && name == "normalOffsets" {
        return Ok(None);
    }
    spread(rows, indices, count).map(Some).within(format_args!("{shape}.{name}"))
}

/// A row for each of `count` points, from the rows for the points in `indices`; zero for the others.
fn spread(rows: Option<Vec<[f64; 3]>>, indices: Option<&[usize]>, count: usize) -> Result<Vec<DVec3>> {
    let rows = rows.ok_or_else(|| Fault::unexpected("vectors", "another type"))?;
    let expected = indices.map_or(count, <[usize]>::len);
    if rows.len() != expected {
        return Err(Fault::unexpected(format_args!("{expected} vectors"), rows.len()).into());
    }
    let mut dense = vec![DVec3::ZERO; count];
    for (i, row) in rows.iter().enumerate() {
        let row = DVec3::from_array(*row);
        if !row.is_finite() {
            return Err(Fault::not_finite(format_args!("vector {i}"), row).into());
        }
        dense[indices.map_or(i, |indices| indices[i])] = row;
    }
    Ok(dense)
}
