//! Skinning: the surfaces of many characters posed in one call, into the caller's buffers.

use std::ffi::c_void;
use std::ops::Range;

use anthronet::math::RigidTransform;
use anthronet::skin::{SkinJob, SkinMethod, Skinner, StridedMut, SurfaceMut, skin_many};
use glam::Vec3;

use crate::context::anthronet_context;
use crate::mesh::anthronet_mesh;
use crate::options::{Descriptor, described_list, skin_method};
use crate::pointer::{Out, at, at_most, buffer, exactly, free, read, slice};
use crate::skeleton::anthronet_transform;
use crate::status::{ANTHRONET_ERROR_POINTER, Fault, Outcome, anthronet_error, anthronet_status, guard};

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
    /// vertex buffers are laid out, it points at the first normal, less than the one stride of both from the first
    /// position.
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

/// Poses the surfaces of `count` jobs, on all cores. Nothing is written unless all jobs are in order. From its first byte
/// to its last, what a job writes must not overlap what another writes nor what any of them reads. `context` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_skin(
    context: *mut anthronet_context,
    jobs: *const anthronet_skin_job,
    count: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let described = described_list(jobs, count, "jobs")?;
        let mut extents = Vec::new();
        if let Some(first) = described.first() {
            let bytes = u64::from(count) * u64::from(first.struct_size);
            extents.push(Extent::new(0, jobs, bytes, false, "jobs")?);
        }
        let mut own = anthronet_context::default();
        let anthronet_context { joints, skin, .. } = anthronet_context::of(context, &mut own)?;
        joints.clear();
        let mut work = Vec::new();
        for (i, job) in described.iter().enumerate() {
            let prepared = CheckedJob::of(job, joints)?;
            prepared.extents(i, &mut extents)?;
            work.push(prepared);
        }
        apart(extents)?;
        let jobs = work.iter().map(|prepared| prepared.job(joints)).collect::<Outcome<_>>()?;
        Ok(skin_many(jobs, skin)?)
    })
}

/// A job of which everything is checked that can be before its buffers are touched.
struct CheckedJob<'a> {
    asked: &'a anthronet_skin_job,
    skinner: &'a Skinner,
    method: SkinMethod,
    /// Its place among the joints of the call.
    pose: Range<usize>,
    offsets: &'a [Vec3],
    positions: Rows,
    normals: Option<Rows>,
}

impl<'a> CheckedJob<'a> {
    /// Appends the pose of the job to `poses`.
    fn of(job: &'a anthronet_skin_job, poses: &mut Vec<RigidTransform>) -> Outcome<Self> {
        let skinner = &read(job.skinner, "skinner")?.0;
        let count = skinner.vertex_count();
        exactly("joint_count", skinner.joint_count(), job.joint_count.into())?;
        if job.offset_count != 0 {
            exactly("offset_count", count, job.offset_count.into())?;
        }
        let joints = slice(job.joints, job.joint_count.into(), "joints")?;
        let start = poses.len();
        poses.extend(joints.iter().map(RigidTransform::from));
        let rows = |first, bytes, stride, what| Rows::new(first, bytes, stride, count, what);
        Ok(Self {
            asked: job,
            skinner,
            method: skin_method(job.method)?,
            pose: start..poses.len(),
            offsets: slice(job.offsets.cast(), job.offset_count.into(), "offsets")?,
            positions: rows(job.positions, job.position_bytes, job.position_stride, "positions")?,
            normals: match job.normals.is_null() {
                true => None,
                false => Some(rows(job.normals, job.normal_bytes, job.normal_stride, "normals")?),
            },
        })
    }

    /// What the job reads and writes; one that spans both buffers where they lie in each other.
    fn extents(&self, job: usize, extents: &mut Vec<Extent>) -> Outcome {
        let asked = self.asked;
        let read = |first, count: u32, width, what| {
            Extent::new(job, first, u64::from(count) * width as u64, false, what)
        };
        let transform = size_of::<anthronet_transform>();
        extents.push(read(asked.joints.cast::<u8>(), asked.joint_count, transform, "joints")?);
        extents.push(read(asked.offsets.cast::<u8>(), asked.offset_count, WIDTH, "offsets")?);
        let positions = self.positions.extent(job, "positions")?;
        let Some(normals) = &self.normals else {
            extents.push(positions);
            return Ok(());
        };
        let normals = normals.extent(job, "normals")?;
        if self.normals_between().is_some() {
            let (start, end) = (positions.start.min(normals.start), positions.end.max(normals.end));
            extents.push(Extent { start, end, ..positions });
        } else {
            extents.extend([positions, normals]);
        }
        Ok(())
    }

    /// The rows of the normals where they lie between those of the positions, as in vertex buffers.
    fn normals_between(&self) -> Option<&Rows> {
        let (positions, normals) = (&self.positions, self.normals.as_ref()?);
        let near = positions.first.addr().abs_diff(normals.first.addr()) < positions.stride;
        (near && positions.stride == normals.stride && positions.bytes > WIDTH as u64).then_some(normals)
    }

    /// `poses` holds those of all jobs.
    fn job<'b>(&'b self, poses: &'b [RigidTransform]) -> Outcome<SkinJob<'b>> {
        let strided = |rows: &Rows, what| {
            let bytes = buffer(rows.first, rows.bytes, what)?.into();
            Ok::<_, Fault>(StridedMut { bytes, offset: 0, stride: rows.stride })
        };
        let out = match (self.normals_between(), &self.normals) {
            (Some(normals), _) => {
                let (one, other) = (self.positions.first, normals.first);
                let first = if one.addr() < other.addr() { one } else { other };
                let apart = one.addr().abs_diff(other.addr());
                SurfaceMut::Interleaved {
                    bytes: buffer(first, self.positions.bytes + apart as u64, "positions")?.into(),
                    stride: normals.stride,
                    position_offset: one.addr() - first.addr(),
                    normal_offset: other.addr() - first.addr(),
                }
            }
            (None, normals) => SurfaceMut::Separate {
                positions: strided(&self.positions, "positions")?,
                normals: normals.as_ref().map(|rows| strided(rows, "normals")).transpose()?,
            },
        };
        Ok(SkinJob {
            skinner: self.skinner,
            method: self.method,
            model_from_joints: &poses[self.pose.clone()],
            offsets: (!self.offsets.is_empty()).then_some(self.offsets),
            out,
        })
    }
}

/// Bytes of three floats.
const WIDTH: usize = 12;

/// Three floats per vertex in a buffer of the caller's that is large enough.
struct Rows {
    first: *mut c_void,
    /// From the first row's first to the last row's last, no more than the vertices need.
    bytes: u64,
    stride: usize,
}

impl Rows {
    fn new(first: *mut c_void, bytes: u64, stride: u64, count: usize, what: &str) -> Outcome<Self> {
        if first.is_null() {
            return Err(Fault::null(what));
        }
        at_most(what, "bytes", isize::MAX as u64, bytes)?;
        let stride = if stride == 0 { WIDTH as u64 } else { stride };
        let rows = (count as u64).checked_sub(1);
        let needed = rows.map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(WIDTH as u64));
        match needed.filter(|needed| *needed <= bytes && stride >= WIDTH as u64) {
            Some(needed) => Ok(Self { first, bytes: needed, stride: stride as usize }),
            None => {
                let message =
                    format!("expected {count} rows of {WIDTH} bytes, {stride} bytes apart, in {bytes} bytes");
                Err(Fault::size(what, message))
            }
        }
    }

    fn extent(&self, job: usize, what: &'static str) -> Outcome<Extent> {
        Extent::new(job, self.first.cast_const(), self.bytes, true, what)
    }
}

/// Bytes of the caller's memory that a call reads or writes.
struct Extent {
    start: u64,
    end: u64,
    written: bool,
    job: usize,
    what: &'static str,
}

impl Extent {
    fn new<T>(job: usize, first: *const T, bytes: u64, written: bool, what: &'static str) -> Outcome<Self> {
        let start = first.addr() as u64;
        let end = start.checked_add(bytes);
        let end = end.ok_or_else(|| Fault::beyond_memory(what, bytes))?;
        Ok(Self { start, end, written, job, what })
    }
}

/// Refuses a call of which anything that is written overlaps something else.
fn apart(mut extents: Vec<Extent>) -> Outcome {
    extents.retain(|extent| extent.start < extent.end);
    extents.sort_by_key(|extent| extent.start);
    // Of those before: where the farthest ends, and where the farthest that is written does.
    let (mut farthest, mut written): (Option<&Extent>, Option<&Extent>) = (None, None);
    for extent in &extents {
        let before = if extent.written { farthest } else { written };
        if let Some(other) = before.filter(|other| extent.start < other.end) {
            let Extent { job, what, .. } = extent;
            let message = format!(
                "{what} of job {job}: expected a buffer apart from all others, got one that overlaps the {} of job {}",
                other.what, other.job
            );
            return Err(Fault::new(ANTHRONET_ERROR_POINTER, message));
        }
        let reaches = |other: Option<&Extent>| other.is_none_or(|other| other.end < extent.end);
        if reaches(farthest) {
            farthest = Some(extent);
        }
        if extent.written && reaches(written) {
            written = Some(extent);
        }
    }
    Ok(())
}
