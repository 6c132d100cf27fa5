//! Posed surfaces, into the caller's buffers.

use anthronet::Error;
use anthronet::pose::Local;
use anthronet::skin::{SkinJob, StridedMut, SurfaceMut};
use bytemuck::cast_slice_mut;
use glam::{Quat, Vec3};

use crate::Result;
use crate::bridge::ffi;
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
        method: ffi::SkinMethod,
        pose: &[ffi::Transform],
        positions: &mut [f32],
        normals: &mut [f32],
    ) -> Result<()> {
        self.0.skin(method.meaning()?, &locals(pose), surface(positions, normals))
    }
}

pub(crate) fn skin_many(jobs: &mut [ffi::SkinJob<'_>]) -> Result<()> {
    let mut inputs = Vec::with_capacity(jobs.len());
    for job in jobs.iter() {
        let offsets: Vec<Vec3> =
            vectors(job.offsets, "offsets")?.iter().map(|offset| Vec3::from_array(*offset)).collect();
        inputs.push((job.method.meaning()?, locals(job.pose), offsets));
    }
    let work = jobs.iter_mut().zip(&inputs).map(|(job, (method, pose, offsets))| SkinJob {
        skinner: &job.skinner.0,
        method: *method,
        model_from_joints: pose,
        offsets: (!offsets.is_empty()).then_some(offsets.as_slice()),
        out: surface(job.positions, job.normals),
    });
    anthronet::skin::skin_many(work.collect())
}

/// Numbers in threes.
pub(crate) fn vectors<'a>(numbers: &'a [f32], what: &'static str) -> Result<&'a [[f32; 3]]> {
    match numbers.as_chunks() {
        (vectors, []) => Ok(vectors),
        _ => Err(Error::invalid(what, format!("expected three numbers each, got {} numbers", numbers.len()))),
    }
}

fn surface<'a>(positions: &'a mut [f32], normals: &'a mut [f32]) -> SurfaceMut<'a> {
    let packed =
        |numbers| StridedMut { bytes: cast_slice_mut(numbers), offset: 0, stride: size_of::<[f32; 3]>() };
    SurfaceMut::Separate {
        positions: packed(positions),
        normals: if normals.is_empty() { None } else { Some(packed(normals)) },
    }
}

fn locals(pose: &[ffi::Transform]) -> Vec<Local> {
    let local = |joint: &ffi::Transform| Local {
        rotation: Quat::from_array(joint.rotation),
        translation: Vec3::from_array(joint.translation),
    };
    pose.iter().map(local).collect()
}

impl From<Local> for ffi::Transform {
    fn from(local: Local) -> Self {
        Self { rotation: local.rotation.to_array(), translation: local.translation.to_array() }
    }
}
