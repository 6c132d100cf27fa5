//! Reads one mesh of a USD file in our space.

use glam::{DAffine3, DMat4, DVec3};
use openusd::sdf::{Path, Value};

use super::blend_shape;
use crate::error::{Fault, Located, UsdError, Within};
use crate::format::limits::MAX_ELEMENTS;
use crate::format::usd::Result;
use crate::format::usd::document::layer::Layer;
use crate::format::usd::document::skeleton::Skeleton;
use crate::format::usd::document::values;
use crate::format::usd::document::xform::Xforms;
use crate::scene::SceneMesh;
use crate::scene::flip_v;

/// The skeleton to which meshes are skinned.
pub(super) struct Skin<'a> {
    pub(super) skeleton: &'a Skeleton,
    /// From the skeleton's space to ours.
    pub(super) above: DAffine3,
}

/// A mesh as read, still without name and material.
pub(super) struct Read {
    pub(super) mesh: SceneMesh,
    pub(super) double_sided: bool,
    /// The tokens that identify the weights of its morph targets.
    pub(super) tokens: Vec<String>,
}

/// Reads the mesh at this path, in the bind pose where it is skinned.
pub(super) fn read(
    layer: &Layer,
    prim: &Path,
    skin: Option<&Skin>,
    ours_from_file: &DAffine3,
) -> Result<Read> {
    let vectors = |name: &str| -> Result<Option<Vec<[f64; 3]>>> {
        let Some(value) = layer.default(prim, name)? else { return Ok(None) };
        let rows = values::rows::<3>(&value).map(Some);
        rows.ok_or_else(|| fault(prim, name, Fault::unexpected("vectors", "another type")))
    };
    let points = vectors("points")?.ok_or_else(|| fault(prim, "points", Fault::missing("value")))?;
    if points.is_empty() || points.len() > MAX_ELEMENTS {
        let expected = format!("1 to {MAX_ELEMENTS} of them");
        return Err(fault(prim, "points", Fault::unexpected(expected, points.len())));
    }

    let mut mesh = SceneMesh::default();
    let influences = match skin {
        Some(skin) => influences(layer, prim, skin.skeleton, points.len())?,
        None => None,
    };
    let ours_from_mesh = match (skin, &influences) {
        (Some(skin), Some(_)) => skin.above * geometry_bind(layer, prim)?,
        _ => *ours_from_file * Xforms::read(layer, prim)?.at_start()?,
    };
    let normal_matrix = ours_from_mesh.matrix3.inverse().transpose();
    let single = |v: DVec3| v.as_vec3().to_array();
    mesh.positions =
        points.iter().map(|p| single(ours_from_mesh.transform_point3(DVec3::from_array(*p)))).collect();
    let normals = match vectors("primvars:normals")? {
        Some(normals) => normals,
        None => vectors("normals")?.unwrap_or_default(),
    };
    // Per-corner normals are dropped, as a mesh has one normal per vertex.
    if normals.len() == points.len() {
        let normal = |n: &[f64; 3]| (normal_matrix * DVec3::from_array(*n)).normalize_or(DVec3::Y);
        mesh.normals = normals.iter().map(|n| single(normal(n))).collect();
    }
    faces(layer, prim, &mut mesh)?;
    let tokens = blend_shape::read(layer, prim, &mut mesh, &normals, &ours_from_mesh)?;

    if let Some(skin) = skin {
        let rigid =
            || Influences { width: 1, joints: vec![0; points.len()], weights: vec![1.0; points.len()] };
        let count = skin.skeleton.joints.names.len();
        influences.unwrap_or_else(rigid).into_mesh(&mut mesh, count).within(prim)?;
    }
    let double_sided = layer.default(prim, "doubleSided")? == Some(Value::Bool(true));
    Ok(Read { mesh, double_sided, tokens })
}

/// The error for an attribute of a prim.
fn fault(prim: &Path, attribute: &str, fault: Fault) -> UsdError {
    UsdError::from(fault).within(format!("{prim}.{attribute}"))
}

fn integers(layer: &Layer, prim: &Path, name: &str) -> Result<Option<Vec<i32>>> {
    match layer.default(prim, name)? {
        Some(Value::IntVec(numbers)) => Ok(Some(numbers)),
        None => Ok(None),
        Some(_) => Err(fault(prim, name, Fault::unexpected("integers", "another type"))),
    }
}

/// Reads faces and texture coordinates.
fn faces(layer: &Layer, prim: &Path, mesh: &mut SceneMesh) -> Result<()> {
    let required =
        |name: &str| integers(layer, prim, name)?.ok_or_else(|| fault(prim, name, Fault::missing("value")));
    const CORNERS: &str = "faceVertexIndices";
    let (counts, corners) = (required("faceVertexCounts")?, required(CORNERS)?);
    let total = counts.iter().try_fold(0_usize, |sum, n| sum.checked_add(usize::try_from(*n).ok()?));
    if total != Some(corners.len()) || corners.len() > 4 * MAX_ELEMENTS {
        let expected = "as many corners as faceVertexCounts adds up to";
        return Err(fault(prim, CORNERS, Fault::unexpected(expected, corners.len())));
    }
    let vertices = mesh.positions.len();
    let index = |corner: &i32| usize::try_from(*corner).ok().filter(|v| *v < vertices).map(|v| v as u32);
    let corners: Vec<u32> = corners.iter().map(index).collect::<Option<_>>().ok_or_else(|| {
        fault(prim, CORNERS, Fault::unexpected(format_args!("places among {vertices} points"), "others"))
    })?;
    let uvs = texture_coordinates(layer, prim, &corners, mesh)?;
    let left_handed = layer.text_value(prim, "orientation")?.as_deref() == Some("leftHanded");

    let mut start = 0;
    for count in counts.iter().map(|count| *count as usize) {
        let mut around: Vec<usize> = (start..start + count).collect();
        start += count;
        if left_handed {
            around.reverse();
        }
        let uv = |at: usize| uvs.as_ref().map(|uvs| uvs[at]);
        if let [a, b, c, d] = around[..] {
            let quad = [a, b, c, d];
            mesh.quads.positions.push(quad.map(|at| corners[at]));
            mesh.quads.uvs.extend(uvs.as_ref().map(|uvs| quad.map(|at| uvs[at])));
            continue;
        }
        for at in 2..around.len() {
            let triangle = [around[0], around[at - 1], around[at]];
            mesh.triangles.positions.push(triangle.map(|at| corners[at]));
            mesh.triangles.uvs.extend(uv(0).map(|_| triangle.map(|at| uv(at).unwrap_or_default())));
        }
    }
    Ok(())
}

/// Reads the mesh's texture coordinates; returns the index of each corner's.
fn texture_coordinates(
    layer: &Layer,
    prim: &Path,
    corners: &[u32],
    mesh: &mut SceneMesh,
) -> Result<Option<Vec<u32>>> {
    let Some(value) = layer.default(prim, "primvars:st")? else { return Ok(None) };
    let st = values::rows::<2>(&value)
        .ok_or_else(|| fault(prim, "primvars:st", Fault::unexpected("pairs", "another type")))?;
    let indices: Vec<i32> = match integers(layer, prim, "primvars:st:indices")? {
        Some(indices) => indices,
        None => (0..st.len() as i32).collect(),
    };
    let per_corner = indices.len() == corners.len();
    if !per_corner && indices.len() != mesh.positions.len() {
        let expected = format!("{} values, one per corner", corners.len());
        return Err(fault(prim, "primvars:st", Fault::unexpected(expected, indices.len())));
    }
    let place = |(corner, vertex): (usize, &u32)| {
        let index = indices.get(if per_corner { corner } else { *vertex as usize })?;
        usize::try_from(*index).ok().filter(|i| *i < st.len()).map(|i| i as u32)
    };
    let places: Option<Vec<u32>> = corners.iter().enumerate().map(place).collect();
    let places = places.ok_or_else(|| {
        let expected = format!("places among {} values", st.len());
        fault(prim, "primvars:st:indices", Fault::unexpected(expected, "others"))
    })?;
    mesh.uvs = st.iter().map(|uv| flip_v(uv.map(|n| n as f32))).collect();
    Ok(Some(places))
}

fn geometry_bind(layer: &Layer, prim: &Path) -> Result<DAffine3> {
    const BIND: &str = "primvars:skel:geomBindTransform";
    let Some(value) = layer.default(prim, BIND)? else { return Ok(DAffine3::IDENTITY) };
    let rows = values::rows::<16>(&value).unwrap_or_default();
    let [matrix] = rows[..] else {
        return Err(fault(prim, BIND, Fault::unexpected("a matrix", "another type")));
    };
    Ok(DAffine3::from_mat4(DMat4::from_cols_array(&matrix)))
}

/// Joints and weights as in the file: `width` slots per vertex, joints in our order.
struct Influences {
    width: usize,
    joints: Vec<usize>,
    weights: Vec<f64>,
}

/// The mesh's own influences; `None` for a mesh without any. A binding to another skeleton is an error.
fn influences(
    layer: &Layer,
    prim: &Path,
    skeleton: &Skeleton,
    vertices: usize,
) -> Result<Option<Influences>> {
    const JOINTS: &str = "primvars:skel:jointIndices";
    const WEIGHTS: &str = "primvars:skel:jointWeights";
    let Some(slots) = integers(layer, prim, JOINTS)? else { return Ok(None) };
    // The binding is inherited from ancestors.
    for above in prim.ancestors_below_root() {
        if let Some(target) = layer.target(&above, "skel:skeleton")? {
            if target != skeleton.prim {
                let message = format!("is bound to {target}, and {} is read", skeleton.prim);
                return Err(Fault::inconsistent(message).into()).within(prim);
            }
            break;
        }
    }
    let weights = layer.default(prim, WEIGHTS)?.and_then(|value| values::numbers(&value)).unwrap_or_default();
    let count = slots.len();
    if count != weights.len() || count == 0 {
        let expected = format!("{count} weights, one per joint index");
        return Err(fault(prim, WEIGHTS, Fault::unexpected(expected, weights.len())));
    }
    let constant = layer.interpolation(prim, JOINTS)?.as_deref() == Some("constant");
    let width = if constant { count } else { count / vertices };
    if !constant && (width == 0 || width * vertices != count) {
        let expected = format!("as many for each of {vertices} points");
        return Err(fault(prim, JOINTS, Fault::unexpected(expected, format_args!("{count} in all"))));
    }
    // Indices refer to the mesh's own list of joints where it has one, else to the skeleton's.
    let paths = &skeleton.joints.paths;
    let listed: Vec<Option<usize>> = match layer.tokens(prim, "skel:joints")? {
        Some(own) => own.iter().map(|joint| paths.iter().position(|path| path == joint)).collect(),
        None => {
            let mut ours = vec![None; paths.len()];
            skeleton.joints.places.iter().enumerate().for_each(|(new, &old)| ours[old] = Some(new));
            ours
        }
    };
    let joint = |(slot, weight): (&i32, &f64)| {
        let joint = usize::try_from(*slot).ok().and_then(|slot| listed.get(slot).copied().flatten());
        // The index of an unused slot is irrelevant.
        joint.or((*weight == 0.0).then_some(0))
    };
    let joints: Option<Vec<usize>> = slots.iter().zip(&weights).map(joint).collect();
    let mut joints = joints.ok_or_else(|| {
        let expected = format!("places among {} joints", listed.len());
        fault(prim, JOINTS, Fault::unexpected(expected, "others"))
    })?;
    let mut weights = weights;
    if constant {
        if width * vertices > 8 * MAX_ELEMENTS {
            let most = format!("{} influences", 8 * MAX_ELEMENTS);
            let found = format!("{width} for each of {vertices} points");
            return Err(fault(prim, JOINTS, Fault::too_many(most, found)));
        }
        (joints, weights) = (joints.repeat(vertices), weights.repeat(vertices));
    }
    Ok(Some(Influences { width, joints, weights }))
}

impl Influences {
    /// Keeps the strongest four or eight influences of each vertex, sorted and normalised.
    fn into_mesh(self, mesh: &mut SceneMesh, joint_count: usize) -> Result<()> {
        let slots = if self.width <= 4 { 4 } else { 8 };
        mesh.influences_per_vertex = slots;
        let mut merged = vec![0.0; joint_count];
        for (vertex, (joints, weights)) in
            self.joints.chunks_exact(self.width).zip(self.weights.chunks_exact(self.width)).enumerate()
        {
            if let Some(weight) = weights.iter().find(|w| !w.is_finite() || **w < 0.0) {
                return Err(Fault::unexpected("weights of at least 0", weight).into())
                    .within(format_args!("vertex {vertex}"));
            }
            // A joint may occur twice.
            joints.iter().zip(weights).for_each(|(joint, weight)| merged[*joint] += weight);
            let mut used: Vec<(usize, f64)> = Vec::with_capacity(self.width);
            for joint in joints {
                let weight = std::mem::take(&mut merged[*joint]);
                if weight > 0.0 {
                    used.push((*joint, weight));
                }
            }
            used.sort_by(|a, b| b.1.total_cmp(&a.1));
            used.truncate(slots);
            let sum: f64 = used.iter().map(|slot| slot.1).sum();
            if sum <= 0.0 || sum.is_infinite() {
                return Err(Fault::unexpected("weights with a positive sum", sum).into())
                    .within(format_args!("vertex {vertex}"));
            }
            // Weights that sum to 1 up to rounding are kept exactly.
            let whole = if (sum - 1.0).abs() < 1e-6 { 1.0 } else { sum };
            used.resize(slots, (0, 0.0));
            mesh.joint_indices.extend(used.iter().map(|slot| slot.0 as u16));
            mesh.joint_weights.extend(used.iter().map(|slot| (slot.1 / whole) as f32));
        }
        Ok(())
    }
}
