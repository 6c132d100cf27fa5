//! Bodies: what a model makes of a request, and the report of it.

use anthronet::measure::Sex;
use anthronet::skeleton::humanoid::renamed;

use crate::Result;
use crate::bridge::ffi;
use crate::enums::{Meaning, at};
use crate::mesh::Mesh;
use crate::model::measure;
use crate::scene::Scene;

pub(crate) struct Body {
    pub(crate) body: anthronet::Body,
}

impl Body {
    pub(crate) fn new(body: anthronet::Body) -> Result<Box<Self>> {
        Ok(Box::new(Self { body }))
    }

    pub(crate) fn summary(&self) -> ffi::BodySummary {
        let report = self.body.report();
        ffi::BodySummary {
            sex: match report.sex {
                Sex::Female => ffi::Sex::Female,
                Sex::Male => ffi::Sex::Male,
            },
            seed: report.seed,
            mass_kg: report.mass_kg,
            volume_m3: report.volume_m3,
            bmi: report.bmi,
            solve_residual: report.solve_residual,
            iterations: report.iterations as u32,
            converged: report.converged,
            joint_count: self.body.skeleton().len(),
        }
    }

    pub(crate) fn measures(&self) -> Vec<ffi::MeasureReport> {
        let measures = self.body.report().measures.iter().map(|measure| ffi::MeasureReport {
            name: measure.name.to_owned(),
            given: measure.given,
            asked: measure.asked.unwrap_or_default(),
            obtained: measure.obtained,
            residual: measure.residual.unwrap_or_default(),
            low90: measure.low90,
            high90: measure.high90,
            percentile: measure.percentile,
        });
        measures.collect()
    }

    pub(crate) fn measure(&self, name: &str) -> Result<f64> {
        Ok(self.body.measurements()[measure(name)?.index()])
    }

    pub(crate) fn warnings(&self) -> &[String] {
        &self.body.report().warnings
    }

    pub(crate) fn report(&self) -> String {
        self.body.report().to_json()
    }

    pub(crate) fn latent(&self) -> &[f64] {
        &self.body.report().z
    }

    pub(crate) fn joints(&self, space: ffi::Space) -> Result<Vec<ffi::Joint>> {
        let space = space.meaning()?;
        let skeleton = self.body.skeleton();
        let joints =
            skeleton.names().iter().zip(skeleton.bind_joints(space)).map(|(name, joint)| ffi::Joint {
                name: name.clone(),
                parent: joint.parent.map_or(-1, |parent| parent as i32),
                length: joint.bone_length.unwrap_or_default(),
                parent_from_joint: joint.parent_from_joint.into(),
                model_from_joint: joint.model_from_joint.to_cols_array(),
                joint_from_model: joint.joint_from_model.to_cols_array(),
            });
        Ok(joints.collect())
    }

    pub(crate) fn joint_name(&self, joint: usize, names: ffi::JointNames) -> Result<String> {
        Ok(renamed(at(self.body.skeleton().names(), joint, "joint")?, names.meaning()?).into_owned())
    }

    pub(crate) fn mesh(&self, options: &ffi::MeshOptions) -> Result<Box<Mesh>> {
        Mesh::new(self, options)
    }

    pub(crate) fn scene(&self, options: &ffi::SceneOptions) -> Result<Box<Scene>> {
        Scene::new(self, options)
    }

    pub(crate) fn save(&self, path: &str) -> Result<()> {
        anthronet::format::write_scene(
            &anthronet::scene::Scene::from_body(&self.body, &Default::default())?,
            path,
            &Default::default(),
        )
    }
}
