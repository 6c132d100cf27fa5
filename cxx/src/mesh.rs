//! Meshes of a body, as graphics hardware or as editors want them.

use anthronet::math::RigidTransform;
use anthronet::scene::{MeshBuffers, Scene};
use bytemuck::cast_slice;
use glam::Vec3;

use crate::Result;
use crate::body::Body;
use crate::bridge::ffi;
use crate::enums::{Meaning, at};
use crate::scene::looks;
use crate::skin::Skinner;

pub(crate) struct Mesh {
    parts: Vec<MeshPart>,
    bind: Vec<RigidTransform>,
}

pub(crate) struct MeshPart(MeshBuffers);

impl Mesh {
    pub(crate) fn new(body: &Body, options: &ffi::MeshOptions) -> Result<Box<Self>> {
        let ffi::MeshOptions { lod, influences, space, layout, body_only, skin_tone } = *options;
        let (space, layout) = (space.meaning()?, layout.meaning()?);
        let looks = looks(lod, influences, ffi::JointNames::Native, body_only, skin_tone)?;
        let parts = Scene::from_body(&body.body, &looks)?.into_buffers(layout, space)?;
        Ok(Box::new(Self {
            parts: parts.into_iter().map(MeshPart).collect(),
            bind: body
                .body
                .skeleton()
                .model_from_joints()
                .iter()
                .map(|joint| joint.model_from_joint_in(space))
                .collect(),
        }))
    }

    pub(crate) fn part_count(&self) -> usize {
        self.parts.len()
    }

    pub(crate) fn part(&self, index: usize) -> Result<&MeshPart> {
        at(&self.parts, index, "part")
    }

    pub(crate) fn skinner(&self, part: usize) -> Result<Box<Skinner>> {
        let part = &self.part(part)?.0;
        let vectors = |rows: &[[f32; 3]]| rows.iter().map(|v| Vec3::from_array(*v)).collect::<Vec<_>>();
        let (positions, normals) = (vectors(&part.positions), vectors(&part.normals));
        let skinner = anthronet::skin::Skinner::new(&positions, &normals, &part.influences, &self.bind)?;
        Ok(Box::new(Skinner(skinner)))
    }
}

impl MeshPart {
    pub(crate) fn name(&self) -> &str {
        &self.0.name
    }

    pub(crate) fn material(&self) -> ffi::Material {
        let material = &self.0.material;
        ffi::Material {
            base_color: material.base_color,
            roughness: material.roughness,
            double_sided: material.double_sided,
        }
    }

    pub(crate) fn vertex_count(&self) -> usize {
        self.0.positions.len()
    }

    pub(crate) fn influences(&self) -> usize {
        self.0.influences.per_vertex
    }

    pub(crate) fn positions(&self) -> &[f32] {
        cast_slice(&self.0.positions)
    }

    pub(crate) fn normals(&self) -> &[f32] {
        cast_slice(&self.0.normals)
    }

    pub(crate) fn uvs(&self) -> &[f32] {
        cast_slice(&self.0.uvs)
    }

    pub(crate) fn triangles(&self) -> &[u32] {
        cast_slice(&self.0.triangles)
    }

    pub(crate) fn triangle_uvs(&self) -> &[u32] {
        cast_slice(&self.0.triangle_uvs)
    }

    pub(crate) fn quads(&self) -> &[u32] {
        cast_slice(&self.0.quads)
    }

    pub(crate) fn quad_uvs(&self) -> &[u32] {
        cast_slice(&self.0.quad_uvs)
    }

    pub(crate) fn sources(&self) -> &[u32] {
        &self.0.sources
    }

    pub(crate) fn joints(&self) -> &[u16] {
        &self.0.influences.joints
    }

    pub(crate) fn weights(&self) -> &[f32] {
        &self.0.influences.weights
    }

    pub(crate) fn blend_shape(&self, name: &str, other: &Self) -> Result<ffi::BlendShape> {
        let shape = self.0.blend_shape(name, &other.0)?;
        Ok(ffi::BlendShape {
            name: shape.name,
            positions: shape.positions.into_flattened(),
            normals: shape.normals.into_flattened(),
        })
    }
}
