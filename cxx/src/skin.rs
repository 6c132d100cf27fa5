//! Posed surfaces, into the caller's buffers.

use anthronet::Error;
use anthronet::math::{RigidTransform, Rotation};
use anthronet::skin::{BytesMut, SkinJob, StridedMut, SurfaceMut};
use bytemuck::cast_slice_mut;
use glam::Vec3;

use crate::Result;
use crate::bridge::ffi;
use crate::context::Context;
use crate::enums::Meaning;

pub(crate) struct Skinner(pub(crate) anthronet::skin::Skinner);

impl Skinner {
    pub(crate) fn vertex_count(&self) -> usize {
        self.0.vertex_count()
    }

    pub(crate) fn joint_count(&self) -> usize {
        self.0.joint_count()
    }

    pub(crate) fn skin(
        &self,
        context: &mut Context,
        method: ffi::SkinMethod,
        pose: &[ffi::Transform],
        positions: &mut [f32],
        normals: &mut [f32],
    ) -> Result<()> {
        let job = Job { skinner: self, method, pose, offsets: &[] };
        job.into_surface(surface(positions, normals), context)
    }

    #[allow(clippy::too_many_arguments)]
    pub(crate) fn skin_interleaved(
        &self,
        context: &mut Context,
        method: ffi::SkinMethod,
        pose: &[ffi::Transform],
        offsets: &[f32],
        vertices: &mut [u8],
        stride: usize,
        position_offset: usize,
        normal_offset: usize,
    ) -> Result<()> {
        let bytes = vertices.into();
        let out = SurfaceMut::Interleaved { bytes, stride, position_offset, normal_offset };
        Job { skinner: self, method, pose, offsets }.into_surface(out, context)
    }
}

/// One surface to pose, wherever it goes.
struct Job<'a> {
    skinner: &'a Skinner,
    method: ffi::SkinMethod,
    pose: &'a [ffi::Transform],
    offsets: &'a [f32],
}

impl Job<'_> {
    fn into_surface(self, out: SurfaceMut<'_>, context: &mut Context) -> Result<()> {
        let (pose, offsets) = (locals(self.pose), shifts(self.offsets)?);
        let job = SkinJob {
            skinner: &self.skinner.0,
            method: self.method.meaning()?,
            model_from_joints: &pose,
            offsets: (!offsets.is_empty()).then_some(offsets.as_slice()),
            out,
        };
        anthronet::skin::skin_many(vec![job], &mut context.skin)
    }
}

pub(crate) fn skin_many(context: &mut Context, jobs: &mut [ffi::SkinJob<'_>]) -> Result<()> {
    apart(jobs)?;
    let mut inputs = Vec::with_capacity(jobs.len());
    for job in jobs.iter() {
        inputs.push((job.method.meaning()?, locals(job.pose), shifts(job.offsets)?));
    }
    let work = jobs.iter_mut().zip(&inputs).map(|(job, (method, pose, offsets))| SkinJob {
        skinner: &job.skinner.0,
        method: *method,
        model_from_joints: pose,
        offsets: (!offsets.is_empty()).then_some(offsets.as_slice()),
        out: surface(job.positions, job.normals),
    });
    anthronet::skin::skin_many(work.collect(), &mut context.skin)
}

/// Refuses buffers that overlap, which slices of C++ can.
fn apart(jobs: &[ffi::SkinJob<'_>]) -> Result<()> {
    let buffers = jobs.iter().enumerate().flat_map(|(i, job)| {
        [("positions", &*job.positions), ("normals", &*job.normals)]
            .map(|(what, buffer)| (buffer.as_ptr_range(), what, i))
    });
    let mut buffers: Vec<_> = buffers.filter(|(range, ..)| !range.is_empty()).collect();
    buffers.sort_by_key(|(range, ..)| range.start);
    for pair in buffers.windows(2) {
        let [(one, what, i), (other, other_what, j)] = pair else { continue };
        if other.start < one.end {
            let message = format!(
                "expected a buffer of its own, the {what} of job {i} overlap the {other_what} of {j}"
            );
            return Err(Error::invalid("skin job", message));
        }
    }
    Ok(())
}

fn shifts(offsets: &[f32]) -> Result<Vec<Vec3>> {
    Ok(vectors(offsets, "offsets")?.iter().map(|offset| Vec3::from_array(*offset)).collect())
}

/// Numbers in threes.
pub(crate) fn vectors<'a>(numbers: &'a [f32], what: &'static str) -> Result<&'a [[f32; 3]]> {
    match numbers.as_chunks() {
        (vectors, []) => Ok(vectors),
        _ => Err(Error::invalid(what, format!("expected three numbers each, got {} numbers", numbers.len()))),
    }
}

fn surface<'a>(positions: &'a mut [f32], normals: &'a mut [f32]) -> SurfaceMut<'a> {
    let packed = |numbers| StridedMut {
        bytes: BytesMut::Init(cast_slice_mut(numbers)),
        offset: 0,
        stride: size_of::<[f32; 3]>(),
    };
    SurfaceMut::Separate {
        positions: packed(positions),
        normals: if normals.is_empty() { None } else { Some(packed(normals)) },
    }
}

fn locals(pose: &[ffi::Transform]) -> Vec<RigidTransform> {
    let local = |joint: &ffi::Transform| RigidTransform {
        rotation: Rotation::from_array(joint.rotation),
        translation: Vec3::from_array(joint.translation),
    };
    pose.iter().map(local).collect()
}

impl From<RigidTransform> for ffi::Transform {
    fn from(local: RigidTransform) -> Self {
        Self { rotation: local.rotation.to_array(), translation: local.translation.to_array() }
    }
}
