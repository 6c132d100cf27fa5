//! Models, and what is the same for all of them.

use anthronet::measure::MeasureId;
use anthronet::model::MeasuredMesh;
use anthronet::{Error, skeleton as rig};
use glam::Vec3;

use crate::Result;
use crate::body::Body;
use crate::bridge::ffi;
use crate::enums::{Meaning, lod};
use crate::request::Request;
use crate::skin::vectors;

pub(crate) struct Model(anthronet::model::Model);

impl Model {
    pub(crate) fn embedded() -> Result<Box<Self>> {
        Ok(Box::new(Self(anthronet::model::Model::embedded()?)))
    }

    pub(crate) fn from_environment() -> Result<Box<Self>> {
        Ok(Box::new(Self(anthronet::model::Model::from_environment()?)))
    }

    pub(crate) fn open(path: &str) -> Result<Box<Self>> {
        Ok(Box::new(Self(anthronet::model::Model::open(path)?)))
    }

    pub(crate) fn from_bytes(bytes: &[u8]) -> Result<Box<Self>> {
        Ok(Box::new(Self(anthronet::model::Model::from_bytes(bytes)?)))
    }

    pub(crate) fn info(&self) -> String {
        self.0.info().to_string()
    }

    pub(crate) fn latent_size(&self) -> usize {
        self.0.latent_size()
    }

    pub(crate) fn vertex_count(&self, level: u32) -> Result<usize> {
        Ok(self.0.character().vertex_count(lod(level)?))
    }

    pub(crate) fn measure_range(&self, name: &str) -> Result<ffi::MeasureRange> {
        let range = self.0.ranges()[measure(name)?.index()];
        Ok(ffi::MeasureRange { min: range.min, max: range.max })
    }

    pub(crate) fn generate(&self, request: &Request) -> Result<Box<Body>> {
        Body::new(self.0.generate(&request.0)?)
    }

    pub(crate) fn interpolate(&self, from: &Request, to: &Request, t: f64) -> Result<Box<Body>> {
        Body::new(self.0.interpolate(&from.0, &to.0, t)?)
    }

    pub(crate) fn measure_mesh(&self, positions: &[f32], space: ffi::Space) -> Result<ffi::Measured> {
        let space = space.meaning()?;
        let vertices: Vec<Vec3> =
            vectors(positions, "positions")?.iter().map(|v| space.to_ours(Vec3::from_array(*v))).collect();
        Ok(self.0.measure_mesh(&vertices)?.into())
    }

    pub(crate) fn measure_file(&self, path: &str) -> Result<ffi::Measured> {
        crate::panic::keep_caught_ones_quiet();
        Ok(anthronet::format::measure_file(&self.0, path)?.into())
    }
}

impl From<MeasuredMesh> for ffi::Measured {
    fn from(found: MeasuredMesh) -> Self {
        Self {
            lod: u8::from(found.lod).into(),
            mass_kg: found.mass.mass_kg,
            volume_m3: found.mass.volume_m3,
            bmi: found.mass.bmi,
            metres: found.measurements.to_vec(),
            warnings: found.warnings,
        }
    }
}

/// A measure by its name with its side.
pub(crate) fn measure(name: &str) -> Result<MeasureId> {
    let unknown = || Error::request(name, "is not a measure: expected one of measure_names(), with its side");
    MeasureId::from_name(name).ok_or_else(unknown)
}

pub(crate) fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

pub(crate) fn measure_names() -> Vec<String> {
    MeasureId::all().map(|id| id.name().to_owned()).collect()
}

pub(crate) fn humanoid_bones() -> Vec<ffi::HumanoidBone> {
    let bone = |bone: &rig::humanoid::HumanoidBone| ffi::HumanoidBone {
        native: bone.native.clone(),
        unity: bone.unity.clone(),
        unity_trait: bone.unity_trait.clone(),
        mixamo: bone.mixamo.clone(),
        vrm: bone.vrm.clone(),
        blender: bone.blender.clone(),
        required: bone.required,
    };
    rig::humanoid::humanoid_bones().iter().map(bone).collect()
}
