//! The only file that calls the library: from the command line's words to its types and back.

pub(crate) mod motion;
pub(crate) mod motion_table;
mod soles;

use std::path::Path;

use anthronet::Error;
use anthronet::condition::{Fill, Request, refusal_json};
use anthronet::format::{Format, GltfOptions, Purpose, WriteOptions};
use anthronet::measure::{Mass, MeasureId, Sex};
use anthronet::mesh::Lod;
pub(crate) use anthronet::random::Random;
use anthronet::scene::{Scene, SceneMaterial, SceneMesh, SceneOptions, SkinTone};
use anthronet::skeleton::humanoid::JointNames;
use glam::Vec3;

use crate::failure::{Failure, Result};
use crate::generate::{FileChoice, JointNamesChoice};
use crate::measure::{Measured, NamedValue};
use crate::render::{Figure, Material, Part};
use crate::request::{FillChoice, RequestArguments, SexChoice, read_text};

/// What becomes an error about a damaged file is said there and not as a panic.
pub(crate) fn keep_caught_panics_quiet() {
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if !anthronet::format::panic_becomes_error() {
            before(info);
        }
    }));
}

/// The generator with its prior and definitions.
pub(crate) struct Model(anthronet::model::Model);

/// A generated body with its report.
pub(crate) struct Person(anthronet::Body);

/// What is printed about a person.
pub(crate) struct Summary {
    pub(crate) sex: &'static str,
    /// Metres.
    pub(crate) height: f64,
    pub(crate) mass_kg: f64,
    /// The given measure that the body misses by most, with how much; `None` when none was given.
    pub(crate) worst_residual_mm: Option<(&'static str, f64)>,
    pub(crate) warnings: Vec<String>,
}

/// Mean and standard deviation (metres) of two measures of one sex, and how they go together.
pub(crate) struct Usual {
    pub(crate) height: (f64, f64),
    pub(crate) waist: (f64, f64),
    pub(crate) correlation: f64,
}

impl Model {
    /// The model file that `ANTHRONET_MODEL` names, else the built-in one.
    pub(crate) fn open() -> Result<Self> {
        Ok(Self(anthronet::model::Model::from_environment()?))
    }

    /// Makes the person that a request asks for. A bad field is bad usage where `from` says that it was typed, else a
    /// failure that names the request's file.
    pub(crate) fn generate(&self, request: &Request, from: &RequestArguments) -> Result<Person> {
        self.0.generate(request).map(Person).map_err(|error| blame(error, from))
    }

    /// The person at `t`, 0 to 1, between two requests; the second comes from a file.
    pub(crate) fn interpolate(
        &self,
        first: (&Request, &RequestArguments),
        second: (&Request, &Path),
        t: f64,
    ) -> Result<Person> {
        self.0.interpolate(first.0, second.0, t).map(Person).map_err(|error| {
            // Whose fault it is shows when the first is made alone.
            match self.0.solve(first.0) {
                Ok(_) => Failure::in_file(second.1, &error),
                Err(own) => blame(own, first.1),
            }
        })
    }

    /// The JSON report of a request that is refused because nobody can have its measures; `None` for any other.
    pub(crate) fn refusal(&self, request: &Request) -> Option<String> {
        match self.0.solve(request) {
            Err(Error::Infeasible(why)) => Some(refusal_json(request, &why)),
            _ => None,
        }
    }

    /// Measures, joints, versions and scores, as documented for `info --json`.
    pub(crate) fn info(&self) -> serde_json::Value {
        self.0.info()
    }

    /// What is usual for a sex, from the prior.
    pub(crate) fn usual(&self, sex: SexChoice) -> Usual {
        let prior = self.0.prior().of(core_sex(sex));
        usual(prior.mean(), prior.covariance())
    }
}

impl Person {
    /// The report as JSON.
    pub(crate) fn report_json(&self) -> String {
        self.0.report().to_json()
    }

    /// The person as the renderer takes it.
    pub(crate) fn figure(&self, lod: u8, skin_tone: Option<&str>) -> Result<Figure> {
        let joint_names = JointNamesChoice::Native;
        figure_from_scene(&self.scene(&FileChoice { lod, influences: 4, joint_names, skin_tone })?)
    }

    /// Where a joint of the bind pose is, metres.
    pub(crate) fn joint(&self, name: &str) -> Option<Vec3> {
        let joint = self.0.skeleton().find(name).and_then(|j| self.0.joints().get(j));
        joint.map(|joint| joint.model_from_joint.translation.into())
    }

    /// The person as files take it.
    pub(crate) fn scene(&self, choice: &FileChoice<'_>) -> Result<Scene> {
        let options = SceneOptions {
            lod: Lod::try_from(choice.lod)?,
            influences: choice.influences,
            joint_names: core_joint_names(choice.joint_names),
            skin_tone: tone(choice.skin_tone)?,
            ..SceneOptions::default()
        };
        Ok(Scene::from_body(&self.0, &options)?)
    }

    /// What is printed.
    pub(crate) fn summary(&self) -> Summary {
        let report = self.0.report();
        let obtained = |name| report.measures.iter().find(|m| m.name == name).map_or(0.0, |m| m.obtained);
        Summary {
            sex: report.sex.name(),
            height: obtained("height"),
            mass_kg: report.mass_kg,
            worst_residual_mm: report
                .measures
                .iter()
                .filter_map(|m| m.residual.map(|r| (m.name, r.abs() * 1000.0)))
                .max_by(|a, b| a.1.total_cmp(&b.1)),
            warnings: report.warnings.clone(),
        }
    }
}

/// All measures of a file's body: its first mesh, at any level of detail.
pub(crate) fn measure_file(model: &Model, path: &Path) -> Result<Measured> {
    let measured = anthronet::format::measure_file(&model.0, path)?;
    let Mass { volume_m3, mass_kg, bmi } = measured.mass;
    let named = MeasureId::all().zip(measured.measurements);
    let named = named.map(|(id, value)| NamedValue { name: id.name(), value });
    Ok(Measured { measures: named.collect(), mass_kg, volume_m3, bmi })
}

/// A character file as the renderer takes it, moved so that its lowest point stands on the ground.
pub(crate) fn figure_from_file(path: &Path) -> Result<Figure> {
    let scene = anthronet::format::read_meshes(path)?;
    let lowest =
        scene.meshes.iter().flat_map(|mesh| &mesh.positions).fold(f32::INFINITY, |low, p| low.min(p[1]));
    let is_skin = |name: &str| Material::from_name(name) == Material::Skin;
    let skin = scene.meshes.iter().find(|mesh| is_skin(&mesh.name));
    let skin = skin.and_then(|mesh| scene.materials.get(mesh.material as usize)).map(|m| m.base_color);
    // A file without colours reads as white, which is no skin.
    let [r, g, b, _] = skin.filter(|c| *c != [1.0; 4]).unwrap_or_else(|| SkinTone::default().base_color());
    let parts = scene
        .meshes
        .iter()
        .map(|mesh| Part {
            material: Material::from_name(&mesh.name),
            positions: mesh.positions.iter().map(|p| Vec3::from(*p) - Vec3::Y * lowest).collect(),
            triangles: mesh.triangulated().iter().map(|t| t.map(|corner| corner.0)).collect(),
        })
        .collect();
    Figure::new(parts, Vec3::new(r, g, b))
        .map_err(|failure| Failure::failed(format!("{}: {failure}", path.display())))
}

/// Writes the scene; the path's ending chooses the format.
pub(crate) fn write_scene(scene: &Scene, path: &Path, compress: bool) -> Result<()> {
    let ending = crate::request::ending(path);
    if compress && !matches!(Format::of_ending(&ending), Some(Format::Glb | Format::Gltf)) {
        return Err(Failure::usage(format!("--compress: expected with .glb or .gltf, got .{ending}")));
    }
    let options = WriteOptions { gltf: GltfOptions { compress }, ..Default::default() };
    Ok(anthronet::format::write_scene(scene, path, &options)?)
}

/// Endings, without the dot, of files that a character is written to.
pub(crate) fn written_endings() -> Vec<&'static str> {
    Format::serving(Purpose::WriteScene).map(Format::ending).collect()
}

/// Those of them that hold motion.
pub(crate) fn moving_endings() -> Vec<&'static str> {
    Format::serving(Purpose::WriteScene).filter(|format| format.holds().clips).map(Format::ending).collect()
}

/// Endings, without the dot, of files whose surfaces are read.
pub(crate) fn surface_endings() -> Vec<&'static str> {
    Format::serving(Purpose::ReadMeshes).map(Format::ending).collect()
}

/// Writes text to a file, or with `-` to standard output.
pub(crate) fn write_or_print(path: &Path, text: &str) -> Result<()> {
    if path == Path::new("-") { crate::progress::print(text) } else { write(path, text.as_bytes()) }
}

/// Writes a file whole or not at all.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    Ok(anthronet::format::write_atomic(path, bytes)?)
}

/// Refuses options that no file can have, before any work is done.
pub(crate) fn check_choice(choice: &FileChoice<'_>) -> Result<()> {
    tone(choice.skin_tone).map(drop)
}

/// The request that the options describe: the file's, then what the command line says.
pub(crate) fn request(arguments: &RequestArguments) -> Result<Request> {
    let mut request = match &arguments.request {
        Some(path) => request_file(path)?,
        None => Request::default(),
    };
    if let Some(sex) = arguments.sex {
        request.sex = Some(core_sex(sex));
    }
    for (name, metres) in arguments.sorted_measures()? {
        request.set(name, metres).map_err(usage_if_request)?;
    }
    if let Some(seed) = arguments.seed {
        request.seed = seed;
    }
    if let Some(z) = &arguments.z {
        request.z = Some(z.clone());
    }
    if let Some(fill) = arguments.fill {
        request.fill = match fill {
            FillChoice::Mean => Fill::Mean,
            FillChoice::Sample => Fill::Sample,
        };
    }
    request.nearest |= arguments.nearest;
    Ok(request)
}

/// The request in a JSON file.
pub(crate) fn request_file(path: &Path) -> Result<Request> {
    Request::from_json(&read_text(path)?).map_err(|error| Failure::in_file(path, &error))
}

/// What is wrong with a request, and with which exit code: a field that was typed is bad usage, the file's fields and
/// what nobody can have are failures.
fn blame(error: Error, from: &RequestArguments) -> Failure {
    let typed = match &error {
        Error::Request { field, .. } => from.request.is_none() || from.typed(field),
        _ => false,
    };
    match (&error, &from.request) {
        _ if typed => Failure::usage(error.to_string()),
        (Error::Request { .. } | Error::Infeasible(_), Some(file)) => Failure::in_file(file, &error),
        _ => error.into(),
    }
}

/// A wrong field is bad usage where the field was typed on the command line.
fn usage_if_request(error: Error) -> Failure {
    match error {
        Error::Request { .. } => Failure::usage(error.to_string()),
        other => other.into(),
    }
}

fn core_sex(sex: SexChoice) -> Sex {
    match sex {
        SexChoice::Female => Sex::Female,
        SexChoice::Male => Sex::Male,
    }
}

fn core_joint_names(names: JointNamesChoice) -> JointNames {
    match names {
        JointNamesChoice::Native => JointNames::Native,
        JointNamesChoice::Unity => JointNames::Unity,
        JointNamesChoice::Mixamo => JointNames::Mixamo,
        JointNamesChoice::Vrm => JointNames::Vrm,
        JointNamesChoice::Blender => JointNames::Blender,
    }
}

fn tone(text: Option<&str>) -> Result<SkinTone> {
    match text {
        Some(text) => text.parse().map_err(|error| match error {
            Error::Request { message, .. } => Failure::usage(format!("--skin-tone: {message}")),
            other => other.into(),
        }),
        None => Ok(SkinTone::default()),
    }
}

/// Mean, deviation and correlation of height and waist. `covariance` is (36, 36), row by row.
fn usual(mean: &[f64], covariance: &[f64]) -> Usual {
    let (h, w) = (MeasureId::HEIGHT.index(), MeasureId::WAIST.index());
    let cov = |a: usize, b: usize| covariance.get(a * mean.len() + b).copied().unwrap_or(0.0);
    let (sh, sw) = (cov(h, h).sqrt(), cov(w, w).sqrt());
    let at = |i: usize| mean.get(i).copied().unwrap_or(0.0);
    let correlation = cov(h, w) / (sh * sw).max(1e-12);
    Usual { height: (at(h), sh), waist: (at(w), sw), correlation }
}

/// A neutral scene as the renderer takes it: materials by name, quads split.
fn figure_from_scene(scene: &Scene) -> Result<Figure> {
    let material = |mesh: &SceneMesh| scene.materials.get(mesh.material as usize);
    let kind = |mesh: &SceneMesh| {
        let by_material = material(mesh).map_or(Material::Skin, |m| Material::from_name(&m.name));
        if by_material == Material::Skin { Material::from_name(&mesh.name) } else { by_material }
    };
    let parts = scene
        .meshes
        .iter()
        .map(|mesh| {
            let quads = mesh.quads.positions.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
            Part {
                material: kind(mesh),
                positions: mesh.positions.iter().map(|p| Vec3::from_array(*p)).collect(),
                triangles: quads.chain(mesh.triangles.positions.iter().copied()).collect(),
            }
        })
        .collect();
    let skin = scene.meshes.iter().find(|mesh| kind(mesh) == Material::Skin).and_then(material);
    let [r, g, b, _] =
        skin.map_or_else(|| SkinTone::default().base_color(), |m: &SceneMaterial| m.base_color);
    Figure::new(parts, Vec3::new(r, g, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_reads_the_covariance() {
        let mut covariance = vec![0.0; 36 * 36];
        let mut mean = vec![0.0; 36];
        let (h, w) = (3, 0);
        (mean[h], mean[w]) = (1.7, 0.8);
        covariance[h * 36 + h] = 0.01;
        covariance[w * 36 + w] = 0.04;
        covariance[h * 36 + w] = 0.01;
        let usual = usual(&mean, &covariance);
        assert_eq!((usual.height.0, usual.waist.0), (1.7, 0.8));
        assert!((usual.height.1 - 0.1).abs() < 1e-12 && (usual.waist.1 - 0.2).abs() < 1e-12);
        assert!((usual.correlation - 0.5).abs() < 1e-12);
    }

    #[test]
    fn options_go_before_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("r.json");
        std::fs::write(
            &file,
            r#"{"sex": "male", "measures": {"height": 1.8, "arm_length": 0.33}, "seed": 3}"#,
        )
        .unwrap();
        let arguments = RequestArguments {
            request: Some(file),
            sex: Some(SexChoice::Female),
            measures: vec![("height".into(), 1.7)],
            ..RequestArguments::default()
        };
        let request = request(&arguments).unwrap();
        assert_eq!(request.sex, Some(Sex::Female));
        assert_eq!(request.measures[3], Some(1.7));
        assert_eq!(request.seed, 3);
        assert_eq!(request.given().count(), 3);
    }
}
