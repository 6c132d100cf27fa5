//! Skinning: the surfaces of many characters posed in one call, into the caller's buffers.

use std::ffi::c_void;

use anthronet::pose::Local;
use anthronet::skin::{SkinJob, Skinner, StridedMut, SurfaceMut, skin_many};
use glam::Vec3;

use crate::mesh::anthronet_mesh;
use crate::options::{Descriptor, described_list, skin_method};
use crate::pointer::{Out, at, buffer, free, read, slice};
use crate::skeleton::anthronet_transform;
use crate::status::{ANTHRONET_ERROR_SIZE, Fault, Outcome, anthronet_error, anthronet_status, guard};

/// A part of a mesh ready to be posed. Immutable; may be used by many threads and jobs at once.
pub struct anthronet_skinner(Skinner);

/// One surface to pose. Everything is in the space of the mesh that the skinner was made of.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_skin_job {
    /// Set by the caller: `sizeof(anthronet_skin_job)`; in a list of jobs alike in all.
    pub struct_size: u32,
    /// `ANTHRONET_SKIN_…`.
    pub method: u32,
    /// The surface.
    pub skinner: *const anthronet_skinner,
    /// The pose: every joint relative to the model, as `anthronet_clip_sample` fills it.
    pub joints: *const anthronet_transform,
    /// Number of joints.
    pub joint_count: u32,
    /// Number of `offsets`: 0, or one per vertex.
    pub offset_count: u32,
    /// Three floats per vertex, added to the bind positions before they are posed (correctives), metres; or NULL.
    pub offsets: *const f32,
    /// Where three floats per vertex are written, metres.
    pub positions: *mut c_void,
    /// Bytes of that buffer.
    pub position_bytes: u64,
    /// Bytes from position to position; 0 for packed.
    pub position_stride: u64,
    /// Where unit normals are written, three floats per vertex; NULL for nowhere. In the buffer of the positions, as
    /// vertex buffers are laid out, it points at the first normal, behind the first position by less than the stride.
    pub normals: *mut c_void,
    /// Bytes of that buffer.
    pub normal_bytes: u64,
    /// Bytes from normal to normal; 0 for packed.
    pub normal_stride: u64,
}

// SAFETY: numbers and pointers that may be NULL, the size first.
unsafe impl Descriptor for anthronet_skin_job {}

/// Makes a part of a mesh ready to be posed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_skinner_new(
    mesh: *const anthronet_mesh,
    part: u32,
    out_skinner: *mut *mut anthronet_skinner,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_skinner, "out_skinner")?;
        let mesh = read(mesh, "mesh")?;
        let part = at(&mesh.parts, part, "part")?;
        let vectors = |rows: &[[f32; 3]]| rows.iter().map(|v| Vec3::from_array(*v)).collect::<Vec<_>>();
        let (positions, normals) = (vectors(&part.positions), vectors(&part.normals));
        out.give(anthronet_skinner(Skinner::new(&positions, &normals, &part.influences, &mesh.bind)?));
        Ok(())
    })
}

/// Frees a skinner; NULL is nothing.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_skinner_free(skinner: *mut anthronet_skinner) {
    free(skinner);
}

/// Number of vertices that the skinner writes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_skinner_vertex_count(
    skinner: *const anthronet_skinner,
    out_count: *mut u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        Out::new(out_count, "out_count")?.write(read(skinner, "skinner")?.0.vertex_count() as u32);
        Ok(())
    })
}

/// Poses the surfaces of `count` jobs, on all cores. Nothing is written unless all jobs are in order. Buffers of
/// different jobs must not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_skin(
    jobs: *const anthronet_skin_job,
    count: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let jobs = described_list(jobs, count, "jobs")?;
        let inputs = jobs.iter().map(Inputs::of).collect::<Outcome<Vec<_>>>()?;
        let work =
            jobs.iter().zip(&inputs).map(|(job, inputs)| prepare(job, inputs)).collect::<Outcome<_>>()?;
        Ok(skin_many(work)?)
    })
}

/// What a job reads, in the library's own types.
struct Inputs {
    pose: Vec<Local>,
    offsets: Vec<Vec3>,
}

impl Inputs {
    fn of(job: &anthronet_skin_job) -> Outcome<Self> {
        let joints = slice(job.joints, job.joint_count.into(), "joints")?;
        let offsets: &[[f32; 3]] = slice(job.offsets.cast(), job.offset_count.into(), "offsets")?;
        Ok(Self {
            pose: joints.iter().map(Local::from).collect(),
            offsets: offsets.iter().map(|offset| Vec3::from_array(*offset)).collect(),
        })
    }
}

fn prepare<'a>(job: &anthronet_skin_job, inputs: &'a Inputs) -> Outcome<SkinJob<'a>> {
    Ok(SkinJob {
        skinner: &read(job.skinner, "skinner")?.0,
        method: skin_method(job.method)?,
        model_from_joints: &inputs.pose,
        offsets: (!inputs.offsets.is_empty()).then_some(&inputs.offsets),
        out: surface(job)?,
    })
}

/// The buffers of a job: one that holds both, or two that do not touch.
fn surface<'a>(job: &anthronet_skin_job) -> Outcome<SurfaceMut<'a>> {
    const WIDTH: u64 = 12;
    let stride = |stride: u64| if stride == 0 { WIDTH as usize } else { stride as usize };
    let (position_stride, normal_stride) = (stride(job.position_stride), stride(job.normal_stride));
    let strided = |data, bytes, stride, what| {
        Ok::<_, Fault>(StridedMut { bytes: buffer(data, bytes, what)?, offset: 0, stride })
    };
    if job.positions.is_null() {
        return Err(Fault::new(
            crate::status::ANTHRONET_ERROR_POINTER,
            "positions: expected a pointer, got NULL",
        ));
    }
    if job.normals.is_null() {
        let positions = strided(job.positions, job.position_bytes, position_stride, "positions")?;
        return Ok(SurfaceMut::Separate { positions, normals: None });
    }
    let (first, second) = (job.positions.addr() as u64, job.normals.addr() as u64);
    let apart = first.saturating_add(job.position_bytes) <= second
        || second.saturating_add(job.normal_bytes) <= first;
    if apart {
        return Ok(SurfaceMut::Separate {
            positions: strided(job.positions, job.position_bytes, position_stride, "positions")?,
            normals: Some(strided(job.normals, job.normal_bytes, normal_stride, "normals")?),
        });
    }
    let behind = second.checked_sub(first).filter(|behind| *behind < position_stride as u64);
    let Some(behind) = behind.filter(|_| position_stride == normal_stride) else {
        return Err(Fault::new(
            ANTHRONET_ERROR_SIZE,
            "normals: expected a buffer apart from the positions', or of the same stride and behind them by less",
        ));
    };
    let bytes = job.position_bytes.max(behind.saturating_add(job.normal_bytes));
    Ok(SurfaceMut::Interleaved {
        bytes: buffer(job.positions, bytes, "positions")?,
        stride: position_stride,
        position_offset: 0,
        normal_offset: behind as usize,
    })
}
