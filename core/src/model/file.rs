//! The model file: safetensors with everything that training decided.
//!
//! Format version 2. Arrays are named below in [`ModelParts::to_bytes`]; the metadata entry `anthronet` is JSON:
//! names and parents of the joints, accessories, the networks' configuration, hashes of the topology and of the
//! measure definitions, how the model was made and scored, and a checksum: the SHA-256 of the whole file with the
//! checksum's own 64 digits as zeros, so that a change anywhere in the file is found. Sizes in the file are checked
//! against each other and never trusted.

use glam::Vec3;
use half::f16;
use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::character::{Accessory, Character, ReducedMesh};
use super::shape_space::ShapeSpace;
use crate::condition::{MeasureRange, Prior};
use crate::measure::MEASURE_COUNT;
use crate::mesh::Topology;
use crate::network::config::GeneratorConfig;
use crate::network::{Tensor, Tensors};
use crate::skeleton::{JointTree, SkinWeights};
use crate::{Error, Result};

/// Version of the file's layout; a file of another version is refused.
pub const FORMAT_VERSION: u32 = 2;

/// How the model was made and how well it does; shown by `info`, trusted by nothing.
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
    /// Levels 2 and 3.
    pub reduced: [ReducedMesh; 2],
    /// Eyes, teeth, tongue, lashes; their points follow the cage's.
    pub accessories: Vec<Accessory>,
    /// Mean body, three numbers a point, metres.
    pub mean: Vec<f32>,
    /// First components, `(components, coordinates)`, as half floats; metre per metre, as all components.
    pub fine: Vec<f16>,
    /// Remaining components, `(components, coordinates)`, as bytes.
    pub coarse: Vec<i8>,
    /// What a byte is worth, per remaining component.
    pub scales: Vec<f32>,
    /// Deviation of each coefficient, metres.
    pub deviations: Vec<f64>,
    /// Joint names, parents first.
    pub joint_names: Vec<String>,
    /// Joint parents; only the first joint has none.
    pub joint_parents: Vec<Option<u32>>,
    /// Mean heads, then mean tails of the joints, `(2, joints, 3)`, metres.
    pub joint_mean: Vec<f32>,
    /// How the coefficients move them, `(2 * 3 * joints, components)`, metre per metre.
    pub joint_rows: Vec<f32>,
    /// Skin weights of cage and accessories as [`crate::skeleton::SkinWeights::new`] takes them: offsets of the rows, joints,
    /// weights.
    pub skin: (Vec<u32>, Vec<u16>, Vec<f32>),
    /// Per sex, female first: means `(2, M)` in m, covariances `(2, M, M)` in m², quantiles `(2, M, 101)` in m;
    /// M is [`MEASURE_COUNT`].
    pub prior: [Vec<f64>; 3],
    /// Per measure the smallest and largest value that a request may give, `(M, 2)`, metres.
    pub ranges: Vec<f64>,
    /// Mean and deviation that measures are standardised with, one per measure, metres.
    pub standardisation: [Vec<f64>; 2],
    /// Decoder and encoder.
    pub networks: Tensors,
    /// Their configuration.
    pub config: GeneratorConfig,
    /// SHA-256 of the measure definitions that the model was made with.
    pub definitions_hash: String,
    /// How the model was made.
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

/// What stands in the place of the checksum while it is taken.
const NO_CHECKSUM: [u8; 64] = [b'0'; 64];

const METADATA_KEY: &str = "anthronet";

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
        for (name, data) in ["mean", "covariance", "quantiles"].iter().zip(&self.prior) {
            arrays.add(&format!("prior.{name}"), Dtype::F64, vec![2, data.len() / 2], data);
        }
        arrays.add("measures.ranges", Dtype::F64, vec![MEASURE_COUNT, 2], &self.ranges);
        for (name, data) in ["mean", "deviation"].iter().zip(&self.standardisation) {
            arrays.add(&format!("measures.{name}"), Dtype::F64, vec![data.len()], data);
        }
        for (name, tensor) in &self.networks {
            // Half floats suffice for what the solve corrects; the linear paths carry whole bodies and stay exact.
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

    /// Reads a file's bytes and holds them against their checksum.
    ///
    /// # Errors
    /// [`Error::Model`] naming `origin` and what does not fit.
    pub fn from_bytes(bytes: &[u8], origin: &str) -> Result<Self> {
        Self::read(bytes, origin, true)
    }

    /// Reads bytes; without `verify` the checksum is not taken.
    pub(super) fn read(bytes: &[u8], origin: &str, verify: bool) -> Result<Self> {
        let fail = |message: String| Error::Model { origin: origin.to_owned(), message };
        let (_, header) = SafeTensors::read_metadata(bytes)
            .map_err(|e| fail(format!("not a whole safetensors file: {e}")))?;
        let text = header.metadata().as_ref().and_then(|m| m.get(METADATA_KEY)).ok_or_else(|| {
            fail("expected metadata `anthronet`, got none: not a model of AnthroNet".into())
        })?;
        let version: serde_json::Value =
            serde_json::from_str(text).map_err(|e| fail(format!("metadata: {e}")))?;
        if version["format_version"] != FORMAT_VERSION {
            return Err(fail(format!(
                "expected format version {FORMAT_VERSION}, got {}",
                version["format_version"]
            )));
        }
        let metadata: Metadata =
            serde_json::from_value(version).map_err(|e| fail(format!("metadata: {e}")))?;
        if verify && let Some(fault) = checksum_fault(bytes, &metadata.sha256) {
            return Err(fail(fault));
        }
        let file = SafeTensors::deserialize(bytes).map_err(|e| fail(e.to_string()))?;
        let reader = Reader { file: &file, origin };

        let cage = reader.topology("cage")?;
        if topology_hash(&cage) != metadata.topology_hash {
            return Err(fail("the topology does not match its hash: the file is damaged".into()));
        }
        let reduced = |level: &str| -> Result<ReducedMesh> {
            Ok(ReducedMesh {
                vertices: reader.get(&format!("{level}.vertices"), Dtype::U32)?,
                triangles: reader.get(&format!("{level}.triangles"), Dtype::U32)?,
                triangle_uvs: reader.get(&format!("{level}.triangle_uvs"), Dtype::U32)?,
            })
        };
        let mut start = cage.vertex_count;
        let mut accessories = Vec::new();
        for name in metadata.accessories {
            let topology = reader.topology(&format!("accessory.{name}"))?;
            let vertices = topology.vertex_count;
            accessories.push(Accessory { name, start, topology });
            start += vertices;
        }
        // Before anything as large as these counts is made from them.
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
        let (joint_names, joint_parents) = metadata.joints.into_iter().unzip();
        Ok(Self {
            reduced: [reduced("lod2")?, reduced("lod3")?],
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
            prior: [
                reader.get("prior.mean", Dtype::F64)?,
                reader.get("prior.covariance", Dtype::F64)?,
                reader.get("prior.quantiles", Dtype::F64)?,
            ],
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

    /// The constant half of every body.
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

    /// What is known of people before anything is measured.
    ///
    /// # Errors
    /// When a covariance is none.
    pub fn prior(&self) -> Result<Prior> {
        Prior::from_slices(&self.prior[0], &self.prior[1], &self.prior[2])
    }

    /// Accepted values per measure.
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

/// SHA-256 of a cage's connectivity, as hexadecimal digits.
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

/// Where the header ends: its length stands in the first eight bytes.
fn header_end(bytes: &[u8]) -> usize {
    let length = bytes.first_chunk().map_or(0, |b| u64::from_le_bytes(*b));
    usize::try_from(length).map_or(bytes.len(), |n| n.saturating_add(8).min(bytes.len()))
}

/// Where `what` first begins in `within`.
fn find(within: &[u8], what: &[u8]) -> Option<usize> {
    within.windows(what.len()).position(|w| w == what)
}

/// Where the checksum that a file carries is not the one that its bytes have, what is wrong.
fn checksum_fault(bytes: &[u8], carried: &str) -> Option<String> {
    let place = find(&bytes[..header_end(bytes)], carried.as_bytes());
    let Some(place) = place.filter(|_| carried.len() == NO_CHECKSUM.len()) else {
        return Some("metadata: sha256: expected 64 hexadecimal digits".to_owned());
    };
    let mut hash = Sha256::new();
    hash.update(&bytes[..place]);
    hash.update(NO_CHECKSUM);
    hash.update(&bytes[place + NO_CHECKSUM.len()..]);
    let taken = hex(&hash.finalize());
    (taken != carried).then(|| {
        format!("the SHA-256 of the file is {taken}, its header says {carried}: the file is damaged")
    })
}

#[derive(Default)]
struct Arrays(Vec<(String, Dtype, Vec<usize>, Vec<u8>)>);

impl Arrays {
    fn add<T: bytemuck::NoUninit>(&mut self, name: &str, dtype: Dtype, shape: Vec<usize>, data: &[T]) {
        self.0.push((name.to_owned(), dtype, shape, bytemuck::cast_slice(data).to_vec()));
    }

    fn topology(&mut self, name: &str, topology: &Topology) {
        let faces = topology.quads.len();
        self.add(&format!("{name}.vertex_count"), Dtype::U32, vec![1], &[topology.vertex_count as u32]);
        self.add(&format!("{name}.quads"), Dtype::U32, vec![faces, 4], &topology.quads);
        self.add(&format!("{name}.uvs"), Dtype::F32, vec![topology.uvs.len(), 2], &topology.uvs);
        self.add(&format!("{name}.quad_uvs"), Dtype::U32, vec![faces, 4], &topology.quad_uvs);
    }

    fn serialize(&self, metadata: &Metadata) -> Result<Vec<u8>> {
        let bad = |e: String| Error::invalid("model file", e);
        let views = self
            .0
            .iter()
            .map(|(name, dtype, shape, data)| {
                TensorView::new(*dtype, shape.clone(), data)
                    .map(|view| (name.clone(), view))
                    .map_err(|e| bad(format!("{name}: {e}")))
            })
            .collect::<Result<Vec<_>>>()?;
        let text = serde_json::to_string(metadata).map_err(|e| bad(e.to_string()))?;
        let extra = std::collections::HashMap::from([(METADATA_KEY.to_owned(), text)]);
        safetensors::serialize(views, Some(extra)).map_err(|e| bad(e.to_string()))
    }
}

struct Reader<'a> {
    file: &'a SafeTensors<'a>,
    origin: &'a str,
}

impl Reader<'_> {
    fn fail(&self, message: String) -> Error {
        Error::Model { origin: self.origin.to_owned(), message }
    }

    /// The array's content as a list of `T`, whose size must divide it.
    fn get<T: bytemuck::AnyBitPattern + bytemuck::NoUninit>(
        &self,
        name: &str,
        dtype: Dtype,
    ) -> Result<Vec<T>> {
        let view = self.file.tensor(name).map_err(|e| self.fail(format!("array `{name}`: {e}")))?;
        if view.dtype() != dtype || view.data().len() % size_of::<T>() != 0 {
            return Err(self.fail(format!(
                "array `{name}`: expected {dtype:?}, got {:?} of shape {:?}",
                view.dtype(),
                view.shape()
            )));
        }
        Ok(bytemuck::pod_collect_to_vec(view.data()))
    }

    fn topology(&self, name: &str) -> Result<Topology> {
        let count: Vec<u32> = self.get(&format!("{name}.vertex_count"), Dtype::U32)?;
        let topology = Topology {
            vertex_count: count.first().map_or(0, |n| *n as usize),
            quads: self.get(&format!("{name}.quads"), Dtype::U32)?,
            uvs: self.get(&format!("{name}.uvs"), Dtype::F32)?,
            quad_uvs: self.get(&format!("{name}.quad_uvs"), Dtype::U32)?,
        };
        topology.validate().map_err(|e| self.fail(e.to_string()))?;
        Ok(topology)
    }

    fn network(&self, name: &str) -> Result<Tensor> {
        let view = self.file.tensor(name).map_err(|e| self.fail(format!("array `{name}`: {e}")))?;
        let data = match view.dtype() {
            Dtype::F32 => self.get::<f32>(name, Dtype::F32)?,
            _ => self.get::<f16>(name, Dtype::F16)?.iter().map(|x| x.to_f32()).collect(),
        };
        Ok(Tensor { shape: view.shape().to_vec(), data })
    }
}
