//! The generator: from a request to the shape coefficients of a body that has exactly the given measures.

use std::path::Path;
use std::sync::Arc;

use glam::Vec3;

use super::character::Character;
use super::file::{ModelParts, Provenance};
use super::measured_space::MeasuredSpace;
use super::shape_space::ShapeSpace;
use crate::condition::{
    Limits, MeasureRange, MeasuredShape, Population, Prepared, Prior, Priors, Request, SolveOptions,
    SolveOutcome, solve,
};
use crate::measure::{Definitions, Landmarks, MEASURE_COUNT, Measurements, Sex};
use crate::network::{Decoder, Encoder};
use crate::skeleton::BonePositions;
use crate::{Error, Result};

/// Environment variable that names a model file to use instead of the embedded one.
pub const MODEL_VARIABLE: &str = "ANTHRONET_MODEL";

/// Standard deviation, metres, whose square is added to the variance of every coefficient in the metric of the exact solve;
/// over the whole cage it amounts to 0.26 mm per vertex. People hardly vary along the last components: without it, feet
/// that differ by a millimetre more than people's do would change the whole body.
const ISOTROPIC_DEVIATION: f64 = 0.03;

/// A loaded model: immutable, shared between threads, cheap to clone.
#[derive(Clone)]
pub struct Model {
    shared: Arc<Shared>,
}

struct Shared {
    origin: String,
    character: Arc<Character>,
    definitions: Definitions,
    landmarks: Landmarks,
    space: ShapeSpace,
    measured: MeasuredSpace,
    joint_mean: Vec<f32>,
    joint_rows: Vec<f32>,
    priors: Priors,
    ranges: [MeasureRange; MEASURE_COUNT],
    standardisation: [Measurements; 2],
    decoder: Decoder,
    encoder: Option<Encoder>,
    variances: Vec<f64>,
    provenance: Provenance,
}

/// A solved request: coefficients and the intermediate results.
#[derive(Clone, Debug)]
pub struct Solved {
    /// The request as prepared for the network.
    pub prepared: Prepared,
    /// The coefficients from the decoder, before the exact solve, metres.
    pub decoded: Vec<f64>,
    /// The exact solve's result.
    pub outcome: SolveOutcome,
}

impl std::fmt::Debug for Model {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Model").field("origin", &self.shared.origin).finish_non_exhaustive()
    }
}

impl Model {
    /// The model named by the environment variable `ANTHRONET_MODEL`, or the embedded one.
    ///
    /// # Errors
    /// [`Error::Io`] or [`Error::Model`] naming the file.
    pub fn from_environment() -> Result<Self> {
        match std::env::var_os(MODEL_VARIABLE).filter(|path| !path.is_empty()) {
            Some(path) => Self::open(path),
            None => Self::embedded(),
        }
    }

    /// The model that the library is built with.
    ///
    /// # Errors
    /// None; a test opens it.
    pub fn embedded() -> Result<Self> {
        // Without verifying the checksum: these bytes are as intact as the program around them, and it would add a fifth to
        // the time of every start. A test verifies it.
        let bytes = include_bytes!("../../../model/anthronet.safetensors");
        let origin = "(embedded)";
        Self::from_parts(&ModelParts::read(bytes, origin, false)?, origin)
    }

    /// Opens a model file.
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be read, [`Error::Model`] when it is damaged or does not match this library.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let bytes = std::fs::read(path).map_err(|source| Error::Io {
            path: path.to_owned(),
            action: "read",
            source,
        })?;
        Self::read(&bytes, &path.display().to_string())
    }

    /// Reads a model from the bytes of a file.
    ///
    /// # Errors
    /// [`Error::Model`] when they are damaged or do not match this library.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        Self::read(bytes, "(memory)")
    }

    fn read(bytes: &[u8], origin: &str) -> Result<Self> {
        Self::from_parts(&ModelParts::from_bytes(bytes, origin)?, origin)
    }

    /// Builds a model from its parts; `origin` names it in errors.
    ///
    /// # Errors
    /// [`Error::Model`] when the parts contradict each other or do not match this library.
    pub fn from_parts(parts: &ModelParts, origin: &str) -> Result<Self> {
        let named = |e: Error| match e {
            Error::Model { message, origin: inner } => {
                Error::Model { origin: origin.to_owned(), message: format!("{inner}: {message}") }
            }
            other => Error::Model { origin: origin.to_owned(), message: other.to_string() },
        };
        let fail = |message: String| Error::Model { origin: origin.to_owned(), message };
        let character = parts.character().map_err(named)?;
        let definitions = character.definitions().map_err(named)?;
        let landmarks = Landmarks::embedded().map_err(named)?;
        if parts.definitions_hash != definitions.hash() {
            return Err(fail("made with other measure definitions than this library's".into()));
        }
        let space = parts.shape_space().map_err(named)?;
        if space.points() != character.point_count() {
            return Err(fail(format!(
                "the shape space has {} points, the character {}",
                space.points(),
                character.point_count()
            )));
        }
        let surface = character.subdivision().refined().vertex_count;
        if let Some(v) = definitions.vertices().into_iter().find(|v| *v as usize >= surface) {
            return Err(fail(format!("measures read vertex {v} of {surface}")));
        }
        let k = space.components();
        let joints = character.joint_tree().len();
        if parts.joint_mean.len() != 6 * joints || parts.joint_rows.len() != 6 * joints * k {
            return Err(fail(format!("joint arrays do not fit {joints} joints and {k} components")));
        }
        if !parts.joint_mean.iter().chain(&parts.joint_rows).all(|x| x.is_finite()) {
            return Err(fail("joint arrays are not finite".into()));
        }
        if parts.config.coefficients != k {
            return Err(fail(format!(
                "the network has {} outputs for {k} components",
                parts.config.coefficients
            )));
        }
        let standard = |i: usize| -> Result<Measurements> {
            let data = &parts.standardisation[i];
            let usable = data.iter().all(|x| x.is_finite() && (i == 0 || *x > 0.0));
            Measurements::try_from(data.as_slice())
                .ok()
                .filter(|_| usable)
                .ok_or_else(|| fail(format!("standardisation: expected {MEASURE_COUNT} usable numbers")))
        };
        let decoder = Decoder::from_tensors(&parts.config, &parts.networks).map_err(named)?;
        // The encoder is optional, but a part of one is an error.
        let encoder = Encoder::is_in(&parts.networks)
            .then(|| Encoder::from_tensors(&parts.config, &parts.networks).map_err(named))
            .transpose()?;
        let measured = MeasuredSpace::new(&space, character.subdivision(), &definitions);
        let variances =
            space.deviations().iter().map(|s| s * s + ISOTROPIC_DEVIATION * ISOTROPIC_DEVIATION).collect();
        Ok(Self {
            shared: Arc::new(Shared {
                origin: origin.to_owned(),
                character: Arc::new(character),
                definitions,
                landmarks,
                space,
                measured,
                joint_mean: parts.joint_mean.clone(),
                joint_rows: parts.joint_rows.clone(),
                priors: parts.priors().map_err(named)?,
                ranges: parts.measure_ranges().map_err(named)?,
                standardisation: [standard(0)?, standard(1)?],
                decoder,
                encoder,
                variances,
                provenance: parts.provenance.clone(),
            }),
        })
    }

    /// What all bodies share.
    pub fn character(&self) -> &Arc<Character> {
        &self.shared.character
    }

    /// Where each measure is taken.
    pub fn definitions(&self) -> &Definitions {
        &self.shared.definitions
    }

    /// Where each landmark lies.
    pub fn landmarks(&self) -> &Landmarks {
        &self.shared.landmarks
    }

    /// The shape space.
    pub fn shape_space(&self) -> &ShapeSpace {
        &self.shared.space
    }

    /// Measures as a function of coefficients.
    pub fn measured_space(&self) -> &MeasuredSpace {
        &self.shared.measured
    }

    /// The priors over measures of all populations.
    pub fn priors(&self) -> &Priors {
        &self.shared.priors
    }

    /// The priors over measures of both sexes of a population.
    pub fn prior(&self, population: Population) -> &Prior {
        self.shared.priors.of(population)
    }

    /// The values that a request may give, metres, in the order of [`MeasureId`](crate::measure::MeasureId).
    pub fn ranges(&self) -> &[MeasureRange; MEASURE_COUNT] {
        &self.shared.ranges
    }

    /// Length of the latent vector z.
    pub fn latent_size(&self) -> usize {
        self.shared.decoder.latent_len()
    }

    /// How the model was trained, and its scores.
    pub fn provenance(&self) -> &Provenance {
        &self.shared.provenance
    }

    /// The coefficients (metres) that the decoder gives for all measures (metres) and z, before any solve.
    pub fn decode(&self, measures: &Measurements, sex: Sex, z: &[f64]) -> Vec<f64> {
        self.shared.decoder.decode_f64(&self.standardised(measures), sex, z)
    }

    /// The encoder's mean of z for a body with these measures (metres) and coefficients (metres).
    ///
    /// # Errors
    /// [`Error::Invalid`] when the model has no encoder, or for another number of coefficients.
    pub fn encode(&self, measures: &Measurements, sex: Sex, coefficients: &[f64]) -> Result<Vec<f64>> {
        let encoder =
            self.shared.encoder.as_ref().ok_or_else(|| Error::invalid("encoder", "the model has none"))?;
        Ok(encoder.encode(&self.standardised(measures), sex, coefficients)?.0)
    }

    fn standardised(&self, measures: &Measurements) -> Measurements {
        let [mean, deviation] = &self.shared.standardisation;
        std::array::from_fn(|i| (measures[i] - mean[i]) / deviation[i])
    }

    /// Solves a request: checks, fills and projects its measures, decodes and does the exact solve.
    ///
    /// # Errors
    /// As [`Prepared::new`].
    pub fn solve(&self, request: &Request) -> Result<Solved> {
        let shared = &self.shared;
        let prepared =
            Prepared::new(request, &shared.priors, &shared.ranges, &Limits::default(), self.latent_size())?;
        let decoded = self.decode(&prepared.projected, prepared.sex, &prepared.z);
        let outcome = self.solve_from(&decoded, &prepared.given)?;
        Ok(Solved { prepared, decoded, outcome })
    }

    /// The body nearest to these coefficients (metres) that has the given measures (metres).
    ///
    /// # Errors
    /// As [`solve()`].
    pub fn solve_from(
        &self,
        coefficients: &[f64],
        given: &[Option<f64>; MEASURE_COUNT],
    ) -> Result<SolveOutcome> {
        let shared = &self.shared;
        solve(&shared.measured, coefficients, &shared.variances, given, &SolveOptions::default())
    }

    /// The measures of the body with these coefficients, metres.
    pub fn measures_of(&self, coefficients: &[f64]) -> Measurements {
        self.shared.measured.measure(coefficients, None)
    }

    /// Heads and tails of the bones of the body with these coefficients, metres, with the pelvis at the origin.
    pub fn joints_of(&self, coefficients: &[f64]) -> BonePositions {
        let k = self.shared.space.components();
        let at = |i: usize| {
            let row = &self.shared.joint_rows[i * k..(i + 1) * k];
            let sum: f64 = row.iter().zip(coefficients).map(|(r, c)| f64::from(*r) * c).sum();
            (f64::from(self.shared.joint_mean[i]) + sum) as f32
        };
        let position = |j: usize| Vec3::new(at(3 * j), at(3 * j + 1), at(3 * j + 2));
        let joints = self.shared.character.joint_tree().len();
        BonePositions {
            heads: (0..joints).map(position).collect(),
            tails: (joints..2 * joints).map(position).collect(),
        }
    }
}
