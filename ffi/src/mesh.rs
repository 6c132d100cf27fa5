//! Meshes of a body, for drawing or for editing.

use std::ffi::c_void;

use anthronet::math::RigidTransform;
use anthronet::scene::{Layout, MeshBuffers, MorphTarget, Scene, SceneOptions, SkinTone};

use crate::body::anthronet_body;
use crate::options::{Descriptor, DescriptorOut, choice, described, flag, joint_names, lod, space};
use crate::pointer::{Out, anthronet_text, at, change, free, read, write_rows};
use crate::status::{ANTHRONET_ERROR_ENUM, Fault, Outcome, anthronet_error, anthronet_status, guard};

/// One texture coordinate per vertex (vertices at seams are doubled) and triangles only: for drawing.
pub const ANTHRONET_LAYOUT_RENDER: u32 = 0;
/// The model's own vertices and quads, texture coordinates per corner: for editing and measuring.
pub const ANTHRONET_LAYOUT_MODEL: u32 = 1;

/// float × 3 per vertex, metres.
pub const ANTHRONET_ATTRIBUTE_POSITIONS: u32 = 0;
/// float × 3 per vertex, unit length.
pub const ANTHRONET_ATTRIBUTE_NORMALS: u32 = 1;
/// float × 2 per vertex (render layout) or per texture coordinate (model layout); v grows downwards in glTF space and
/// upwards in the others.
pub const ANTHRONET_ATTRIBUTE_UVS: u32 = 2;
/// uint32 × 3 per triangle: vertices. In the model layout these are the faces that are not quads: none at levels 0 and 1.
pub const ANTHRONET_ATTRIBUTE_TRIANGLES: u32 = 3;
/// uint16 × influences per vertex: joints.
pub const ANTHRONET_ATTRIBUTE_JOINTS: u32 = 4;
/// float × influences per vertex: weights, descending, of sum 1.
pub const ANTHRONET_ATTRIBUTE_WEIGHTS: u32 = 5;
/// uint32 per vertex: which vertex of the model it is.
pub const ANTHRONET_ATTRIBUTE_SOURCES: u32 = 6;
/// uint32 × 4 per quad: vertices. Model layout only.
pub const ANTHRONET_ATTRIBUTE_QUADS: u32 = 7;
/// uint32 × 4 per quad: texture coordinates of its corners. Model layout only.
pub const ANTHRONET_ATTRIBUTE_QUAD_UVS: u32 = 8;
/// uint32 × 3 per triangle: texture coordinates of its corners. Model layout only.
pub const ANTHRONET_ATTRIBUTE_TRIANGLE_UVS: u32 = 9;

/// 32-bit floats.
pub const ANTHRONET_TYPE_F32: u32 = 0;
/// 32-bit unsigned integers.
pub const ANTHRONET_TYPE_U32: u32 = 1;
/// 16-bit unsigned integers.
pub const ANTHRONET_TYPE_U16: u32 = 2;

/// How a mesh is made of a body; all zeros are the defaults.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_mesh_options {
    /// Set by the caller: `sizeof(anthronet_mesh_options)`.
    pub struct_size: u32,
    /// Level of detail, 0 (finest) to 3.
    pub lod: u32,
    /// Influences per vertex, 4 or 8; 0 stands for 4.
    pub influences: u32,
    /// `ANTHRONET_SPACE_…` of all that is read from the mesh.
    pub space: u32,
    /// `ANTHRONET_LAYOUT_…`.
    pub layout: u32,
    /// 1 leaves out eyes, teeth, tongue and lashes.
    pub body_only: u32,
    /// Step of the Monk skin tone scale, 1 to 10; 0 for the default tone.
    pub skin_tone: u32,
}

// SAFETY: numbers alone, the size first.
unsafe impl Descriptor for anthronet_mesh_options {}

/// A part of a mesh: one surface with one material. The body is the first.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_mesh_part {
    /// Set by the caller: `sizeof(anthronet_mesh_part)`.
    pub struct_size: u32,
    /// Number of vertices.
    pub vertex_count: u32,
    /// Number of texture coordinates.
    pub uv_count: u32,
    /// Number of triangles.
    pub triangle_count: u32,
    /// Number of quads; 0 in the render layout.
    pub quad_count: u32,
    /// Influences per vertex.
    pub influences: u32,
    /// 1 if back faces are drawn too.
    pub double_sided: u32,
    /// Perceptual roughness of the material, 0 to 1.
    pub roughness: f32,
    /// Colour of the material: linear red, green, blue and alpha.
    pub base_color: [f32; 4],
    /// Its name, such as `Body`; valid as long as the mesh.
    pub name: anthronet_text,
}

// SAFETY: numbers and a text of NULL, the size first.
unsafe impl Descriptor for anthronet_mesh_part {}

/// An array of a mesh.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_view {
    /// The first number; packed rows follow. NULL for an empty array. Valid until the mesh is updated or freed.
    pub data: *const c_void,
    /// Number of rows.
    pub rows: u64,
    /// Numbers per row.
    pub columns: u32,
    /// `ANTHRONET_TYPE_…` of the numbers.
    pub number_type: u32,
}

/// The surfaces of a body in a space and layout.
pub struct anthronet_mesh {
    pub(crate) parts: Vec<MeshBuffers>,
    pub(crate) bind: Vec<RigidTransform>,
    /// By shape, then by part.
    pub(crate) blend_shapes: Vec<Vec<MorphTarget>>,
    pub(crate) options: anthronet_mesh_options,
}

/// Makes the meshes of a body; `options` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_mesh_new(
    body: *const anthronet_body,
    options: *const anthronet_mesh_options,
    out_mesh: *mut *mut anthronet_mesh,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_mesh, "out_mesh")?;
        out.give(anthronet_mesh::of(read(body, "body")?, described(options, "options")?)?);
        Ok(())
    })
}

/// Changes the mesh to that of another body, with the same options and without blend shapes. Earlier views become
/// invalid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_mesh_update(
    mesh: *mut anthronet_mesh,
    body: *const anthronet_body,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let (mesh, body) = (change(mesh, "mesh")?, read(body, "body")?);
        *mesh = anthronet_mesh::of(body, mesh.options)?;
        Ok(())
    })
}

/// Frees a mesh; NULL is nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_mesh_free(mesh: *mut anthronet_mesh) {
    free(mesh);
}

/// Number of parts: the body, then eyes and, at levels 0 and 1, teeth, tongue and lashes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_mesh_part_count(
    mesh: *const anthronet_mesh,
    out_count: *mut u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        Out::new(out_count, "out_count")?.write(read(mesh, "mesh")?.parts.len() as u32);
        Ok(())
    })
}

/// Describes a part.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_mesh_describe_part(
    mesh: *const anthronet_mesh,
    part: u32,
    out_part: *mut anthronet_mesh_part,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = DescriptorOut::new(out_part, "out_part")?;
        let part = at(&read(mesh, "mesh")?.parts, part, "part")?;
        out.write(&anthronet_mesh_part {
            struct_size: 0,
            vertex_count: part.positions.len() as u32,
            uv_count: part.uvs.len() as u32,
            triangle_count: part.triangles.len() as u32,
            quad_count: part.quads.len() as u32,
            influences: part.influences.per_vertex as u32,
            double_sided: part.material.double_sided.into(),
            roughness: part.material.roughness,
            base_color: part.material.base_color,
            name: anthronet_text::of(&part.name),
        });
        Ok(())
    })
}

/// Where an array of a part is, `attribute` one of `ANTHRONET_ATTRIBUTE_…`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_mesh_data(
    mesh: *const anthronet_mesh,
    part: u32,
    attribute: u32,
    out_view: *mut anthronet_view,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_view, "out_view")?;
        let array = array(at(&read(mesh, "mesh")?.parts, part, "part")?, attribute)?;
        out.write(array.view());
        Ok(())
    })
}

/// Copies an array of a part to a buffer of `buffer_bytes` bytes, `stride` bytes from row to row (0: packed). Bytes
/// between the rows stay as they are.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_mesh_read(
    mesh: *const anthronet_mesh,
    part: u32,
    attribute: u32,
    out_rows: *mut c_void,
    buffer_bytes: u64,
    stride: u64,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let array = array(at(&read(mesh, "mesh")?.parts, part, "part")?, attribute)?;
        write_rows(array.bytes, array.width(), out_rows, buffer_bytes, stride, "out_rows")
    })
}

pub(crate) struct Array<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) columns: usize,
    pub(crate) number_type: u32,
}

impl Array<'_> {
    /// Bytes of a row.
    pub(crate) fn width(&self) -> usize {
        self.columns * if self.number_type == ANTHRONET_TYPE_U16 { 2 } else { 4 }
    }

    pub(crate) fn view(&self) -> anthronet_view {
        let rows = self.bytes.len() / self.width();
        anthronet_view {
            data: if rows == 0 { std::ptr::null() } else { self.bytes.as_ptr().cast() },
            rows: rows as u64,
            columns: self.columns as u32,
            number_type: self.number_type,
        }
    }
}

/// An array of a part.
fn array(part: &MeshBuffers, attribute: u32) -> Outcome<Array<'_>> {
    use bytemuck::cast_slice as bytes;
    let per_vertex = part.influences.per_vertex;
    let (bytes, columns, number_type) = match attribute {
        ANTHRONET_ATTRIBUTE_POSITIONS => (bytes(&part.positions), 3, ANTHRONET_TYPE_F32),
        ANTHRONET_ATTRIBUTE_NORMALS => (bytes(&part.normals), 3, ANTHRONET_TYPE_F32),
        ANTHRONET_ATTRIBUTE_UVS => (bytes(&part.uvs), 2, ANTHRONET_TYPE_F32),
        ANTHRONET_ATTRIBUTE_TRIANGLES => (bytes(&part.triangles), 3, ANTHRONET_TYPE_U32),
        ANTHRONET_ATTRIBUTE_JOINTS => (bytes(&part.influences.joints), per_vertex, ANTHRONET_TYPE_U16),
        ANTHRONET_ATTRIBUTE_WEIGHTS => (bytes(&part.influences.weights), per_vertex, ANTHRONET_TYPE_F32),
        ANTHRONET_ATTRIBUTE_SOURCES => (bytes(&part.sources), 1, ANTHRONET_TYPE_U32),
        ANTHRONET_ATTRIBUTE_QUADS => (bytes(&part.quads), 4, ANTHRONET_TYPE_U32),
        ANTHRONET_ATTRIBUTE_QUAD_UVS => (bytes(&part.quad_uvs), 4, ANTHRONET_TYPE_U32),
        ANTHRONET_ATTRIBUTE_TRIANGLE_UVS => (bytes(&part.triangle_uvs), 3, ANTHRONET_TYPE_U32),
        _ => {
            let message =
                format!("attribute: expected 0 to {ANTHRONET_ATTRIBUTE_TRIANGLE_UVS}, got {attribute}");
            return Err(Fault::new(ANTHRONET_ERROR_ENUM, message));
        }
    };
    Ok(Array { bytes, columns, number_type })
}

/// The scene options that a caller's descriptor asks for.
pub(crate) fn scene_options(
    level: u32,
    influences: u32,
    names: u32,
    body_only: u32,
    skin_tone: u32,
) -> Outcome<SceneOptions> {
    let skin_tone = match skin_tone {
        0 => SkinTone::default(),
        step => u8::try_from(step).ok().and_then(SkinTone::monk).ok_or_else(|| {
            Fault::new(ANTHRONET_ERROR_ENUM, format!("skin_tone: expected 0 to 10, got {step}"))
        })?,
    };
    Ok(SceneOptions {
        lod: lod(level)?,
        influences: if influences == 0 { 4 } else { influences as usize },
        joint_names: joint_names(names)?,
        skin_tone,
        accessories: !flag(body_only, "body_only")?,
    })
}

impl anthronet_mesh {
    pub(crate) fn of(body: &anthronet_body, options: anthronet_mesh_options) -> Outcome<Self> {
        let space = space(options.space)?;
        let layout = choice(&[Layout::Render, Layout::Model], options.layout, "layout")?;
        let asked = scene_options(options.lod, options.influences, 0, options.body_only, options.skin_tone)?;
        Ok(Self {
            parts: Scene::from_body(&body.body, &asked)?.into_buffers(layout, space)?,
            bind: body
                .body
                .skeleton()
                .model_from_joints()
                .iter()
                .map(|joint| joint.model_from_joint_in(space))
                .collect(),
            blend_shapes: Vec::new(),
            options,
        })
    }
}
