//! Blend shapes of meshes, from the surface of one body to that of another.

use std::ffi::{c_char, c_void};

use anthronet::scene::MorphTarget;

use crate::body::anthronet_body;
use crate::mesh::{
    ANTHRONET_ATTRIBUTE_NORMALS, ANTHRONET_ATTRIBUTE_POSITIONS, ANTHRONET_TYPE_F32, Array, anthronet_mesh,
    anthronet_view,
};
use crate::options::choice;
use crate::pointer::{Out, anthronet_text, at, change, read, text, write_rows};
use crate::status::{ANTHRONET_ERROR_INVALID, Fault, Outcome, anthronet_error, anthronet_status, guard};

/// Adds a blend shape from the mesh to the surface of another body: at weight 1 the mesh has that body's shape in the bind
/// pose. Joints stay where they are, so bodies should be of about the same stature.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_mesh_add_blend_shape(
    mesh: *mut anthronet_mesh,
    name: *const c_char,
    name_length: u64,
    body: *const anthronet_body,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let (mesh, body) = (change(mesh, "mesh")?, read(body, "body")?);
        let name = text(name, name_length, "name")?;
        if name.is_empty() || mesh.blend_shapes.iter().any(|parts| parts[0].name == name) {
            let message = format!("blend shape: the name `{name}` is empty or taken");
            return Err(Fault::new(ANTHRONET_ERROR_INVALID, message));
        }
        let other = anthronet_mesh::of(body, mesh.options)?;
        let shapes = mesh.parts.iter().zip(&other.parts).map(|(from, to)| Ok(from.blend_shape(name, to)?));
        mesh.blend_shapes.push(shapes.collect::<Outcome<_>>()?);
        Ok(())
    })
}

/// Number of blend shapes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_mesh_blend_shape_count(
    mesh: *const anthronet_mesh,
    out_count: *mut u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        Out::new(out_count, "out_count")?.write(read(mesh, "mesh")?.blend_shapes.len() as u32);
        Ok(())
    })
}

/// The name of a blend shape; valid until the mesh is updated or freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_mesh_blend_shape_name(
    mesh: *const anthronet_mesh,
    shape: u32,
    out_name: *mut anthronet_text,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_name, "out_name")?;
        let parts = at(&read(mesh, "mesh")?.blend_shapes, shape, "shape")?;
        out.write(anthronet_text::of(&at(parts, 0, "part")?.name));
        Ok(())
    })
}

/// Where the displacements of a part are: `attribute` is `ANTHRONET_ATTRIBUTE_POSITIONS` or `ANTHRONET_ATTRIBUTE_NORMALS`, three
/// floats per vertex, to be added to those of the mesh.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_mesh_blend_shape_data(
    mesh: *const anthronet_mesh,
    shape: u32,
    part: u32,
    attribute: u32,
    out_view: *mut anthronet_view,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_view, "out_view")?;
        let parts = at(&read(mesh, "mesh")?.blend_shapes, shape, "shape")?;
        out.write(array(at(parts, part, "part")?, attribute)?.view());
        Ok(())
    })
}

/// Copies the displacements of a part to a buffer, as `anthronet_mesh_read` does.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_mesh_read_blend_shape(
    mesh: *const anthronet_mesh,
    shape: u32,
    part: u32,
    attribute: u32,
    out_rows: *mut c_void,
    buffer_bytes: u64,
    stride: u64,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let parts = at(&read(mesh, "mesh")?.blend_shapes, shape, "shape")?;
        let array = array(at(parts, part, "part")?, attribute)?;
        write_rows(array.bytes, array.width(), out_rows, buffer_bytes, stride, "out_rows")
    })
}

fn array(shape: &MorphTarget, attribute: u32) -> Outcome<Array<'_>> {
    const KNOWN: [u32; 2] = [ANTHRONET_ATTRIBUTE_POSITIONS, ANTHRONET_ATTRIBUTE_NORMALS];
    let vectors = match choice(&KNOWN, attribute, "attribute")? {
        ANTHRONET_ATTRIBUTE_NORMALS => &shape.normals,
        _ => &shape.positions,
    };
    Ok(Array { bytes: bytemuck::cast_slice(vectors), columns: 3, number_type: ANTHRONET_TYPE_F32 })
}
