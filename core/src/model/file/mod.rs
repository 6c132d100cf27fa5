//! The model file: a safetensors file with everything that training produced.
//!
//! Format version 3. [`ModelParts::to_bytes`] names the arrays. The metadata entry `anthronet` is JSON: names and parents of
//! the joints, names of the accessories, the networks' configuration, hashes of the topology and of the measure definitions,
//! provenance, and a checksum: the SHA-256 of the whole file with the checksum's own 64 digits as zeros, which detects a
//! change anywhere in the file. Sizes in the file are checked against each other before they are used.

mod arrays;

use arrays::{Arrays, Reader};
use glam::Vec3;
use half::f16;
use safetensors::tensor::{Dtype, SafeTensors};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::character::{Accessory, Character, ReducedMesh};
use super::shape_space::ShapeSpace;
use crate::condition::{MeasureRange, Population, Prior, Priors};
use crate::measure::MEASURE_COUNT;
use crate::mesh::Topology;
use crate::network::Tensors;
use crate::network::config::GeneratorConfig;
use crate::skeleton::{JointTree, SkinWeights};
use crate::{Error, Result};

/// Version of the file's layout; a file of another version is refused.
pub const FORMAT_VERSION: u32 = 3;

/// How the model was trained, and its scores; for information only, shown by `info`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Version of the data set.
    pub data_version: u32,
    /// Seed of the data set.
    pub data_seed: u64,
    /// Bodies that the networks were trained on.
    pub training_bodies: usize,
    /// Seed of the training.
    pub training_seed: u64,
    /// Scores on held-out bodies, by name, with the unit in the name.
    pub scores: std::collections::BTreeMap<String, f64>,
}

/// Everything in a model file, as plain arrays.
#[derive(Clone, Debug, Default)]
pub struct ModelParts {
    /// The body's cage.
    pub cage: Topology,
    /// LODs 2 and 3.
    pub reduced: [ReducedMesh; 2],
    /// Eyes, teeth, tongue, lashes; their points follow the cage's.
    pub accessories: Vec<Accessory>,
    /// Points of the mean body, three coordinates each, metres; those of the cage, then of the accessories.
    pub mean: Vec<f32>,
    /// First components, `(components, coordinates)`, as half floats, metre per metre.
    pub fine: Vec<f16>,
    /// Remaining components, `(components, coordinates)`, as bytes to be multiplied by `scales`.
    pub coarse: Vec<i8>,
    /// Scale of each remaining component, metre per metre.
    pub scales: Vec<f32>,
    /// Standard deviation of each coefficient over people, metres.
    pub deviations: Vec<f64>,
    /// Joint names, parents first.
    pub joint_names: Vec<String>,
    /// Joint parents; only the first joint has none.
    pub joint_parents: Vec<Option<u32>>,
    /// Heads, then tails of the joints of the mean body, `(2, joints, 3)`, metres.
    pub joint_mean: Vec<f32>,
    /// Derivatives of those with respect to the coefficients, `(2 * joints * 3, components)`, metre per metre.
    pub joint_rows: Vec<f32>,
    /// Skin weights of cage and accessories, the arguments of [`SkinWeights::new`]: offsets of the rows, joints, weights.
    pub skin: (Vec<u32>, Vec<u16>, Vec<f32>),
    /// Per population in the order of [`Population::ALL`], and per sex, female first: means `(2, M)` in m, covariances
    /// `(2, M, M)` in m², quantiles `(2, M, 101)` in m; M is [`MEASURE_COUNT`].
    pub priors: [[Vec<f64>; 3]; 2],
    /// Per measure the smallest and largest value that a request may give, `(M, 2)`, metres.
    pub ranges: Vec<f64>,
    /// Mean and standard deviation that measures are standardised with, one each per measure, metres.
    pub standardisation: [Vec<f64>; 2],
    /// Weights of decoder and encoder.
    pub networks: Tensors,
    /// Their configuration.
    pub config: GeneratorConfig,
    /// SHA-256, in hexadecimal, of the measure definitions that the model was trained with.
    pub definitions_hash: String,
    /// How the model was trained.
    pub provenance: Provenance,
}

#[derive(Serialize, Deserialize)]
struct Metadata {
    format_version: u32,
    topology_hash: String,
    definitions_hash: String,
    joints: Vec<(String, Option<u32>)>,
    accessories: Vec<String>,
    config: GeneratorConfig,
    provenance: Provenance,
    sha256: String,
}

impl Metadata {
    /// The metadata in a file's header, of this format's version.
    fn read(bytes: &[u8], origin: &str) -> Result<Self> {
        let fail = |message: String| model_error(origin, message);
        let (_, header) = SafeTensors::read_metadata(bytes)
            .map_err(|e| fail(format!("not a whole safetensors file: {e}")))?;
        let text = header.metadata().as_ref().and_then(|m| m.get(METADATA_KEY)).ok_or_else(|| {
            fail("expected metadata `anthronet`, got none: not a model of AnthroNet".into())
        })?;
        let json: serde_json::Value =
            serde_json::from_str(text).map_err(|e| fail(format!("metadata: {e}")))?;
        if json["format_version"] != FORMAT_VERSION {
            return Err(fail(format!(
                "expected format version {FORMAT_VERSION}, got {}",
                json["format_version"]
            )));
        }
        serde_json::from_value(json).map_err(|e| fail(format!("metadata: {e}")))
    }
}

/// Placeholder for the checksum while it is computed.
const NO_CHECKSUM: [u8; 64] = [b'0'; 64];

const METADATA_KEY: &str = "anthronet";

/// The arrays of a prior, in the order of [`ModelParts::priors`].
const PRIOR_ARRAYS: [&str; 3] = ["mean", "covariance", "quantiles"];

impl ModelParts {
    /// The file's bytes; the same parts give the same bytes.
    ///
    /// # Errors
    /// [`Error::Invalid`] when an array cannot be stored.
    pub fn to_bytes(&self) -> Result<Vec<u8>> {
        let mut arrays = Arrays::default();
        arrays.topology("cage", &self.cage);
        for (level, mesh) in ["lod2", "lod3"].iter().zip(&self.reduced) {
            arrays.add(&format!("{level}.vertices"), Dtype::U32, vec![mesh.vertices.len()], &mesh.vertices);
            arrays.add(
                &format!("{level}.triangles"),
                Dtype::U32,
                vec![mesh.triangles.len(), 3],
                &mesh.triangles,
            );
            arrays.add(
                &format!("{level}.triangle_uvs"),
                Dtype::U32,
                vec![mesh.triangle_uvs.len(), 3],
                &mesh.triangle_uvs,
            );
        }
        for accessory in &self.accessories {
            arrays.topology(&format!("accessory.{}", accessory.name), &accessory.topology);
        }
        let n = self.mean.len();
        arrays.add("shape.mean", Dtype::F32, vec![n], &self.mean);
        arrays.add("shape.fine", Dtype::F16, vec![self.fine.len() / n.max(1), n], &self.fine);
        arrays.add("shape.coarse", Dtype::I8, vec![self.scales.len(), n], &self.coarse);
        arrays.add("shape.scales", Dtype::F32, vec![self.scales.len()], &self.scales);
        arrays.add("shape.deviations", Dtype::F64, vec![self.deviations.len()], &self.deviations);
        arrays.add("joints.mean", Dtype::F32, vec![self.joint_mean.len()], &self.joint_mean);
        arrays.add(
            "joints.rows",
            Dtype::F32,
            vec![self.joint_mean.len(), self.deviations.len()],
            &self.joint_rows,
        );
        arrays.add("skin.offsets", Dtype::U32, vec![self.skin.0.len()], &self.skin.0);
        arrays.add("skin.joints", Dtype::U16, vec![self.skin.1.len()], &self.skin.1);
        arrays.add("skin.weights", Dtype::F32, vec![self.skin.2.len()], &self.skin.2);
        for (population, prior) in Population::ALL.iter().zip(&self.priors) {
            for (name, data) in PRIOR_ARRAYS.iter().zip(prior) {
                let name = format!("prior.{}.{name}", population.name());
                arrays.add(&name, Dtype::F64, vec![2, data.len() / 2], data);
            }
        }
        arrays.add("measures.ranges", Dtype::F64, vec![MEASURE_COUNT, 2], &self.ranges);
        for (name, data) in ["mean", "deviation"].iter().zip(&self.standardisation) {
            arrays.add(&format!("measures.{name}"), Dtype::F64, vec![data.len()], data);
        }
        for (name, tensor) in &self.networks {
            // Half floats suffice for errors that the solve corrects; the linear skip and biases carry most of a body and keep
            // single precision.
            if name.starts_with("skip") || name.ends_with("bias") {
                arrays.add(&format!("network.{name}"), Dtype::F32, tensor.shape.clone(), &tensor.data);
            } else {
                let halves: Vec<f16> = tensor.data.iter().map(|&x| f16::from_f32(x)).collect();
                arrays.add(&format!("network.{name}"), Dtype::F16, tensor.shape.clone(), &halves);
            }
        }
        let metadata = Metadata {
            format_version: FORMAT_VERSION,
            topology_hash: topology_hash(&self.cage),
            definitions_hash: self.definitions_hash.clone(),
            joints: self.joint_names.iter().cloned().zip(self.joint_parents.iter().copied()).collect(),
            accessories: self.accessories.iter().map(|a| a.name.clone()).collect(),
            config: self.config.clone(),
            provenance: self.provenance.clone(),
            sha256: String::from_utf8_lossy(&NO_CHECKSUM).into_owned(),
        };
        let mut bytes = arrays.serialize(&metadata)?;
        let checksum = hex(&Sha256::digest(&bytes));
        let header = header_end(&bytes);
        let place = find(&bytes[..header], &NO_CHECKSUM)
            .ok_or_else(|| Error::invalid("model file", "the checksum has no place in the header"))?;
        bytes[place..place + NO_CHECKSUM.len()].copy_from_slice(checksum.as_bytes());
        Ok(bytes)
    }

    /// Reads a file's bytes and verifies their checksum.
    ///
    /// # Errors
    /// [`Error::Model`] naming `origin` and what is wrong.
    pub fn from_bytes(bytes: &[u8], origin: &str) -> Result<Self> {
        Self::read(bytes, origin, true)
    }

    /// As [`from_bytes`](Self::from_bytes), but verifies the checksum only if `verify`.
    pub(super) fn read(bytes: &[u8], origin: &str, verify: bool) -> Result<Self> {
        let fail = |message: String| model_error(origin, message);
        let metadata = Metadata::read(bytes, origin)?;
        if verify {
            verify_checksum(bytes, &metadata.sha256, origin)?;
        }
        let file = SafeTensors::deserialize(bytes).map_err(|e| fail(e.to_string()))?;
        let reader = Reader { file: &file, origin };

        let cage = reader.topology("cage")?;
        if topology_hash(&cage) != metadata.topology_hash {
            return Err(fail("the topology does not match its hash: the file is damaged".into()));
        }
        let mut start = cage.vertex_count;
        let mut accessories = Vec::new();
        for name in metadata.accessories {
            let topology = reader.topology(&format!("accessory.{name}"))?;
            let vertices = topology.vertex_count;
            accessories.push(Accessory { name, start, topology });
            start += vertices;
        }
        // Before anything is allocated by these counts.
        let mean: Vec<f32> = reader.get("shape.mean", Dtype::F32)?;
        if mean.len() != 3 * start {
            return Err(fail(format!(
                "the topologies have {start} vertices, the mean body has {} coordinates",
                mean.len()
            )));
        }
        let mut networks = Tensors::new();
        for name in file.names() {
            if let Some(key) = name.strip_prefix("network.") {
                networks.insert(key.to_owned(), reader.network(name)?);
            }
        }
        let prior = |population: Population| -> Result<[Vec<f64>; 3]> {
            let [mean, covariance, quantiles] = PRIOR_ARRAYS
                .map(|name| reader.get(&format!("prior.{}.{name}", population.name()), Dtype::F64));
            Ok([mean?, covariance?, quantiles?])
        };
        let (joint_names, joint_parents) = metadata.joints.into_iter().unzip();
        Ok(Self {
            reduced: [reader.reduced("lod2")?, reader.reduced("lod3")?],
            cage,
            accessories,
            mean,
            fine: reader.get("shape.fine", Dtype::F16)?,
            coarse: reader.get("shape.coarse", Dtype::I8)?,
            scales: reader.get("shape.scales", Dtype::F32)?,
            deviations: reader.get("shape.deviations", Dtype::F64)?,
            joint_names,
            joint_parents,
            joint_mean: reader.get("joints.mean", Dtype::F32)?,
            joint_rows: reader.get("joints.rows", Dtype::F32)?,
            skin: (
                reader.get("skin.offsets", Dtype::U32)?,
                reader.get("skin.joints", Dtype::U16)?,
                reader.get("skin.weights", Dtype::F32)?,
            ),
            priors: [prior(Population::Ansur2)?, prior(Population::Synthetic)?],
            ranges: reader.get("measures.ranges", Dtype::F64)?,
            standardisation: [
                reader.get("measures.mean", Dtype::F64)?,
                reader.get("measures.deviation", Dtype::F64)?,
            ],
            networks,
            config: metadata.config,
            definitions_hash: metadata.definitions_hash,
            provenance: metadata.provenance,
        })
    }

    /// What all bodies share.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the parts do not fit together.
    pub fn character(&self) -> Result<Character> {
        let joint_tree = JointTree::new(self.joint_names.clone(), self.joint_parents.clone())?;
        if !joint_tree.has_one_root() {
            return Err(Error::invalid("skeleton", "expected every joint but the first to have a parent"));
        }
        let (offsets, joints, weights) = self.skin.clone();
        let weights = SkinWeights::new(offsets, joints, weights, joint_tree.len())?;
        let mean = self.mean.chunks_exact(3).map(Vec3::from_slice).collect();
        Character::new(
            self.cage.clone(),
            self.reduced.clone(),
            self.accessories.clone(),
            std::sync::Arc::new(joint_tree),
            weights,
            mean,
        )
    }

    /// The shape space.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the parts do not fit together.
    pub fn shape_space(&self) -> Result<ShapeSpace> {
        let fine = self.fine.iter().map(|x| x.to_f32()).collect();
        ShapeSpace::new(
            self.mean.clone(),
            fine,
            self.coarse.clone(),
            self.scales.clone(),
            self.deviations.clone(),
        )
    }

    /// The priors over measures of all populations.
    ///
    /// # Errors
    /// As [`Prior::from_slices`].
    pub fn priors(&self) -> Result<Priors> {
        let of =
            |[mean, covariance, quantiles]: &[Vec<f64>; 3]| Prior::from_slices(mean, covariance, quantiles);
        Ok(Priors::new([of(&self.priors[0])?, of(&self.priors[1])?]))
    }

    /// The range of values of each measure, metres.
    ///
    /// # Errors
    /// [`Error::Invalid`] when there are not [`MEASURE_COUNT`] pairs that ascend.
    pub fn measure_ranges(&self) -> Result<[MeasureRange; MEASURE_COUNT]> {
        let bad = || Error::invalid("measure ranges", format!("expected {MEASURE_COUNT} ascending pairs"));
        if self.ranges.len() != 2 * MEASURE_COUNT || !self.ranges.chunks_exact(2).all(|r| r[0] < r[1]) {
            return Err(bad());
        }
        Ok(std::array::from_fn(|i| MeasureRange { min: self.ranges[2 * i], max: self.ranges[2 * i + 1] }))
    }
}

/// SHA-256 of a cage's connectivity, in hexadecimal.
pub fn topology_hash(cage: &Topology) -> String {
    let mut hash = Sha256::new();
    hash.update((cage.vertex_count as u64).to_le_bytes());
    for v in cage.quads.iter().chain(&cage.quad_uvs).flatten() {
        hash.update(v.to_le_bytes());
    }
    hex(&hash.finalize())
}

fn hex(digest: &[u8]) -> String {
    digest.iter().map(|b| format!("{b:02x}")).collect()
}

/// Offset of the header's end; the header's length is in the first eight bytes.
fn header_end(bytes: &[u8]) -> usize {
    let length = bytes.first_chunk().map_or(0, |b| u64::from_le_bytes(*b));
    usize::try_from(length).map_or(bytes.len(), |n| n.saturating_add(8).min(bytes.len()))
}

/// Offset of the first occurrence of `what` in `within`.
fn find(within: &[u8], what: &[u8]) -> Option<usize> {
    within.windows(what.len()).position(|w| w == what)
}

/// Compares the checksum stored in a file with the one computed from its bytes.
fn verify_checksum(bytes: &[u8], stored: &str, origin: &str) -> Result<()> {
    let place = find(&bytes[..header_end(bytes)], stored.as_bytes())
        .filter(|_| stored.len() == NO_CHECKSUM.len())
        .ok_or_else(|| model_error(origin, "metadata: sha256: expected 64 hexadecimal digits".into()))?;
    let mut hash = Sha256::new();
    hash.update(&bytes[..place]);
    hash.update(NO_CHECKSUM);
    hash.update(&bytes[place + NO_CHECKSUM.len()..]);
    let computed = hex(&hash.finalize());
    if computed == stored {
        return Ok(());
    }
    Err(model_error(
        origin,
        format!("the SHA-256 of the file is {computed}, its header says {stored}: the file is damaged"),
    ))
}

fn model_error(origin: &str, message: String) -> Error {
    Error::Model { origin: origin.to_owned(), message }
}
