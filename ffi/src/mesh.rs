//! Meshes of a body, as graphics hardware or as editors want them.

use std::ffi::c_void;

use anthronet::export::{Corners, Scene, SceneMesh, SceneOptions, SkinTone, SplitMesh, flip_v};
use anthronet::pose::Local;
use anthronet::rig::Influences;
use anthronet::space::Space;
use glam::Vec3;

use crate::body::anthronet_body;
use crate::options::{Descriptor, DescriptorOut, described, flag, joint_names, lod, space};
use crate::pointer::{Out, anthronet_text, at, buffer, change, free, read, write_rows};
use crate::status::{
    ANTHRONET_ERROR_ENUM, ANTHRONET_ERROR_INVALID, Fault, Outcome, anthronet_error, anthronet_status, guard,
};

/// One texture coordinate per vertex (vertices at seams are doubled) and triangles alone: what is drawn.
pub const ANTHRONET_LAYOUT_RENDER: u32 = 0;
/// The model's own vertices and quads, texture coordinates by corner: what is edited and measured.
pub const ANTHRONET_LAYOUT_MODEL: u32 = 1;

/// float × 3 per vertex, metres.
pub const ANTHRONET_ATTRIBUTE_POSITIONS: u32 = 0;
/// float × 3 per vertex, unit length.
pub const ANTHRONET_ATTRIBUTE_NORMALS: u32 = 1;
/// float × 2 per vertex (render layout) or per texture coordinate (model layout); v grows downwards in glTF space and
/// upwards in the others, as their programs have it.
pub const ANTHRONET_ATTRIBUTE_UVS: u32 = 2;
/// uint32 × 3 per triangle: vertices. In the model layout these are the faces that are no quads: none at levels 0 and 1.
pub const ANTHRONET_ATTRIBUTE_TRIANGLES: u32 = 3;
/// uint16 × influences per vertex: joints.
pub const ANTHRONET_ATTRIBUTE_JOINTS: u32 = 4;
/// float × influences per vertex: weights, descending, of sum 1.
pub const ANTHRONET_ATTRIBUTE_WEIGHTS: u32 = 5;
/// uint32 per vertex: which vertex of the model it is.
pub const ANTHRONET_ATTRIBUTE_SOURCES: u32 = 6;
/// uint32 × 4 per quad: vertices. Model layout alone.
pub const ANTHRONET_ATTRIBUTE_QUADS: u32 = 7;
/// uint32 × 4 per quad: texture coordinates of its corners. Model layout alone.
pub const ANTHRONET_ATTRIBUTE_QUAD_UVS: u32 = 8;
/// uint32 × 3 per triangle: texture coordinates of its corners. Model layout alone.
pub const ANTHRONET_ATTRIBUTE_TRIANGLE_UVS: u32 = 9;

/// 32-bit floats.
pub const ANTHRONET_TYPE_F32: u32 = 0;
/// 32-bit unsigned integers.
pub const ANTHRONET_TYPE_U32: u32 = 1;
/// 16-bit unsigned integers.
pub const ANTHRONET_TYPE_U16: u32 = 2;

/// What of a body becomes a mesh; all zeros ask for the defaults.
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
    /// The first number; packed rows follow. NULL of an empty array. Valid until the mesh is updated or freed.
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
    pub(crate) parts: Vec<Part>,
    pub(crate) bind: Vec<Local>,
    options: anthronet_mesh_options,
}

pub(crate) struct Part {
    name: String,
    base_color: [f32; 4],
    roughness: f32,
    double_sided: bool,
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    triangles: Vec<[u32; 3]>,
    triangle_uvs: Vec<[u32; 3]>,
    quads: Vec<[u32; 4]>,
    quad_uvs: Vec<[u32; 4]>,
    sources: Vec<u32>,
    pub(crate) influences: Influences,
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

/// Makes the mesh that of another body, with the options that it was made with. Views of before are invalid.
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

/// What a part is.
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
            double_sided: part.double_sided.into(),
            roughness: part.roughness,
            base_color: part.base_color,
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
        let array = at(&read(mesh, "mesh")?.parts, part, "part")?.array(attribute)?;
        let rows = array.bytes.len() / array.width();
        out.write(anthronet_view {
            data: if rows == 0 { std::ptr::null() } else { array.bytes.as_ptr().cast() },
            rows: rows as u64,
            columns: array.columns as u32,
            number_type: array.number_type,
        });
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
        let array = at(&read(mesh, "mesh")?.parts, part, "part")?.array(attribute)?;
        let out = buffer(out_rows, buffer_bytes, "out_rows")?;
        write_rows(array.bytes, array.width(), out, stride, "out_rows")
    })
}

struct Array<'a> {
    bytes: &'a [u8],
    columns: usize,
    number_type: u32,
}

impl Array<'_> {
    /// Bytes of a row.
    fn width(&self) -> usize {
        self.columns * if self.number_type == ANTHRONET_TYPE_U16 { 2 } else { 4 }
    }
}

impl Part {
    fn array(&self, attribute: u32) -> Outcome<Array<'_>> {
        use bytemuck::cast_slice as bytes;
        let per_vertex = self.influences.per_vertex;
        let (bytes, columns, number_type) = match attribute {
            ANTHRONET_ATTRIBUTE_POSITIONS => (bytes(&self.positions), 3, ANTHRONET_TYPE_F32),
            ANTHRONET_ATTRIBUTE_NORMALS => (bytes(&self.normals), 3, ANTHRONET_TYPE_F32),
            ANTHRONET_ATTRIBUTE_UVS => (bytes(&self.uvs), 2, ANTHRONET_TYPE_F32),
            ANTHRONET_ATTRIBUTE_TRIANGLES => (bytes(&self.triangles), 3, ANTHRONET_TYPE_U32),
            ANTHRONET_ATTRIBUTE_JOINTS => (bytes(&self.influences.joints), per_vertex, ANTHRONET_TYPE_U16),
            ANTHRONET_ATTRIBUTE_WEIGHTS => (bytes(&self.influences.weights), per_vertex, ANTHRONET_TYPE_F32),
            ANTHRONET_ATTRIBUTE_SOURCES => (bytes(&self.sources), 1, ANTHRONET_TYPE_U32),
            ANTHRONET_ATTRIBUTE_QUADS => (bytes(&self.quads), 4, ANTHRONET_TYPE_U32),
            ANTHRONET_ATTRIBUTE_QUAD_UVS => (bytes(&self.quad_uvs), 4, ANTHRONET_TYPE_U32),
            ANTHRONET_ATTRIBUTE_TRIANGLE_UVS => (bytes(&self.triangle_uvs), 3, ANTHRONET_TYPE_U32),
            _ => {
                let message =
                    format!("attribute: expected 0 to {ANTHRONET_ATTRIBUTE_TRIANGLE_UVS}, got {attribute}");
                return Err(Fault::new(ANTHRONET_ERROR_ENUM, message));
            }
        };
        Ok(Array { bytes, columns, number_type })
    }
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
    fn of(body: &anthronet_body, options: anthronet_mesh_options) -> Outcome<Self> {
        let space = space(options.space)?;
        let split = match options.layout {
            ANTHRONET_LAYOUT_RENDER => true,
            ANTHRONET_LAYOUT_MODEL => false,
            other => {
                return Err(Fault::new(
                    ANTHRONET_ERROR_ENUM,
                    format!("layout: expected 0 to 1, got {other}"),
                ));
            }
        };
        let asked = scene_options(options.lod, options.influences, 0, options.body_only, options.skin_tone)?;
        let mut scene = Scene::from_body(&body.body, &asked)?;
        let meshes = std::mem::take(&mut scene.meshes);
        let parts = meshes.into_iter().map(|mesh| Part::of(mesh, &scene, split, space));
        Ok(Self {
            parts: parts.collect::<Outcome<_>>()?,
            bind: body.rest.model_from_joints().iter().map(|joint| joint.in_space(space)).collect(),
            options,
        })
    }
}

impl Part {
    fn of(mesh: SceneMesh, scene: &Scene, split: bool, space: Space) -> Outcome<Self> {
        let material = scene.materials.get(mesh.material as usize).ok_or_else(|| {
            Fault::new(ANTHRONET_ERROR_INVALID, format!("mesh `{}` has no material", mesh.name))
        })?;
        let influences_per_vertex = mesh.influences_per_vertex;
        let v_up = space != Space::YUp;
        let mut part = if split {
            let split = SplitMesh::new(&mesh);
            let source = || split.source.iter().map(|v| *v as usize);
            let rows = || source().map(|v| v * influences_per_vertex..(v + 1) * influences_per_vertex);
            Self {
                positions: source().map(|v| mesh.positions[v]).collect(),
                normals: source().map(|v| mesh.normals[v]).collect(),
                uvs: split.uvs(&mesh),
                triangle_uvs: Vec::new(),
                quads: Vec::new(),
                quad_uvs: Vec::new(),
                influences: Influences {
                    per_vertex: influences_per_vertex,
                    joints: rows().flat_map(|r| mesh.joint_indices[r].iter().copied()).collect(),
                    weights: rows().flat_map(|r| mesh.joint_weights[r].iter().copied()).collect(),
                },
                triangles: split.triangles,
                sources: split.source,
                name: mesh.name,
                base_color: material.base_color,
                roughness: material.roughness,
                double_sided: material.double_sided,
            }
        } else {
            let Corners { positions: quads, uvs: quad_uvs } = mesh.quads;
            let Corners { positions: triangles, uvs: triangle_uvs } = mesh.triangles;
            Self {
                sources: (0..mesh.positions.len() as u32).collect(),
                positions: mesh.positions,
                normals: mesh.normals,
                uvs: mesh.uvs,
                triangles,
                triangle_uvs,
                quads,
                quad_uvs,
                influences: Influences {
                    per_vertex: influences_per_vertex,
                    joints: mesh.joint_indices,
                    weights: mesh.joint_weights,
                },
                name: mesh.name,
                base_color: material.base_color,
                roughness: material.roughness,
                double_sided: material.double_sided,
            }
        };
        if space != Space::YUp {
            for vector in part.positions.iter_mut().chain(&mut part.normals) {
                *vector = space.from_ours(Vec3::from_array(*vector)).to_array();
            }
        }
        if v_up {
            part.uvs.iter_mut().for_each(|uv| *uv = flip_v(*uv));
        }
        if space.flips_winding() {
            part.triangles.iter_mut().chain(&mut part.triangle_uvs).for_each(|face| face.swap(1, 2));
            part.quads.iter_mut().chain(&mut part.quad_uvs).for_each(|face| face.swap(1, 3));
        }
        Ok(part)
    }
}
