//! Checkpoints: everything that a resumed training needs to continue as if it had never been interrupted.
//!
//! A safetensors file with the network's variables, running statistics and Adam's moments, and the state of the
//! run as JSON in its metadata. It is written beside the old one and renamed, so that a complete one always exists.

use std::collections::{BTreeMap, HashMap};
use std::io::Write as _;
use std::path::Path;

use anthronet::network::config::GeneratorConfig;
use candle_core::{Device, Tensor};
use safetensors::tensor::{Dtype, SafeTensors, TensorView, serialize};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::generator::network::Network;
use crate::generator::ops::values;
use crate::generator::{Metrics, ShapeStatistics, TrainingOptions, TrainingSet};
use crate::training::{Adam, Moments};
use crate::{Error, Result};

/// Format of the file.
const VERSION: u32 = 1;

/// What must be equal for a run to be resumed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Identity {
    version: u32,
    config: GeneratorConfig,
    seed: u64,
    epochs: usize,
    batch: usize,
    learning_rate: f64,
    warmup: f64,
    freeze_norm: f64,
    /// SHA-256 of the training set and the statistics.
    data: String,
}

impl Identity {
    pub(crate) fn of(
        training: &TrainingSet,
        statistics: &ShapeStatistics,
        config: &GeneratorConfig,
        options: &TrainingOptions,
    ) -> Result<Self> {
        let mut hash = Sha256::new();
        hash.update(bytemuck::cast_slice(&training.coefficients));
        hash.update(bytemuck::cast_slice(&training.measures));
        hash.update(&training.sex);
        hash.update((statistics.vertex_count as u64).to_le_bytes());
        if let Some(form) = &statistics.laplacian {
            hash.update(bytemuck::cast_slice(&form.matrix));
            hash.update(bytemuck::cast_slice(&form.vector));
        }
        Ok(Self {
            version: VERSION,
            config: config.clone(),
            seed: options.seed,
            epochs: options.epochs,
            batch: options.batch,
            learning_rate: options.learning_rate,
            warmup: options.warmup,
            freeze_norm: options.freeze_norm,
            data: hash.finalize().iter().map(|b| format!("{b:02x}")).collect(),
        })
    }
}

/// The metadata of the file.
#[derive(Serialize, Deserialize)]
struct State {
    identity: Identity,
    epoch: usize,
    steps: u32,
    history: Vec<Metrics>,
}

/// The state of a run between two epochs.
#[derive(Debug)]
pub(crate) struct Checkpoint {
    pub(crate) epoch: usize,
    pub(crate) history: Vec<Metrics>,
    steps: u32,
    tensors: BTreeMap<String, Vec<f32>>,
}

impl Checkpoint {
    pub(crate) fn of(network: &Network, adam: &Adam, epoch: usize, history: &[Metrics]) -> Result<Self> {
        let mut tensors = BTreeMap::new();
        for ((name, variable), moments) in network.variables().into_iter().zip(adam.moments()) {
            tensors.insert(format!("adam.first.{name}"), moments.first);
            tensors.insert(format!("adam.second.{name}"), moments.second);
            tensors.insert(name, values(variable)?);
        }
        for block in network.blocks() {
            tensors.insert(format!("{}.running_mean", block.name), block.running_mean.clone());
            tensors.insert(format!("{}.running_variance", block.name), block.running_variance.clone());
        }
        Ok(Self { epoch, history: history.to_vec(), steps: adam.steps(), tensors })
    }

    /// Writes the file whole or not at all.
    pub(crate) fn write(&self, path: &Path, identity: &Identity) -> Result<()> {
        let state = State {
            identity: identity.clone(),
            epoch: self.epoch,
            steps: self.steps,
            history: self.history.clone(),
        };
        let json = serde_json::to_string(&state).map_err(|e| Error::Invalid(format!("checkpoint: {e}")))?;
        let views: std::result::Result<Vec<_>, _> = self
            .tensors
            .iter()
            .map(|(n, v)| TensorView::new(Dtype::F32, vec![v.len()], bytemuck::cast_slice(v)).map(|t| (n, t)))
            .collect();
        let bytes = views
            .and_then(|views| serialize(views, Some(HashMap::from([("state".to_owned(), json)]))))
            .map_err(|e| Error::Invalid(format!("checkpoint: {e}")))?;
        let folder = path.parent().unwrap_or(Path::new("."));
        let mut file = tempfile::NamedTempFile::new_in(folder).map_err(Error::io(folder))?;
        file.write_all(&bytes).map_err(Error::io(path))?;
        file.persist(path).map_err(|e| Error::io(path)(e.error))?;
        Ok(())
    }

    /// Reads a file of the given run.
    pub(crate) fn read(path: &Path, identity: &Identity) -> Result<Self> {
        let bytes = std::fs::read(path).map_err(Error::io(path))?;
        let bad = |message: String| Error::Invalid(format!("checkpoint {}: {message}", path.display()));
        let (_, header) = SafeTensors::read_metadata(&bytes).map_err(|e| bad(e.to_string()))?;
        let state = header.metadata().as_ref().and_then(|m| m.get("state"));
        let state = state.ok_or_else(|| bad("expected a `state` in its metadata".into()))?;
        let state: State = serde_json::from_str(state).map_err(|e| bad(e.to_string()))?;
        if &state.identity != identity {
            return Err(bad(
                "it belongs to a run with other data, configuration or options; remove it".into()
            ));
        }
        let file = SafeTensors::deserialize(&bytes).map_err(|e| bad(e.to_string()))?;
        let mut tensors = BTreeMap::new();
        for (name, view) in file.iter() {
            if view.dtype() != Dtype::F32 {
                return Err(bad(format!("tensor `{name}`: expected f32, got {:?}", view.dtype())));
            }
            tensors.insert(name.to_owned(), bytemuck::pod_collect_to_vec(view.data()));
        }
        Ok(Self { epoch: state.epoch, history: state.history, steps: state.steps, tensors })
    }

    /// Restores the network to the saved state and returns its optimiser.
    pub(crate) fn restore(mut self, network: &mut Network) -> Result<Adam> {
        let mut take = |name: String, count: usize| match self.tensors.remove(&name) {
            Some(values) if values.len() == count => Ok(values),
            other => {
                let got = other.map_or(0, |v| v.len());
                Err(Error::Invalid(format!("checkpoint tensor `{name}`: expected {count} values, got {got}")))
            }
        };
        let mut moments = Vec::new();
        for (name, variable) in network.variables() {
            let count = variable.elem_count();
            moments.push(Moments {
                first: take(format!("adam.first.{name}"), count)?,
                second: take(format!("adam.second.{name}"), count)?,
            });
            variable.set(&Tensor::from_vec(take(name, count)?, variable.shape(), &Device::Cpu)?)?;
        }
        for block in network.blocks_mut() {
            let count = block.running_mean.len();
            block.running_mean = take(format!("{}.running_mean", block.name), count)?;
            block.running_variance = take(format!("{}.running_variance", block.name), count)?;
        }
        Ok(Adam::resume(self.steps, moments))
    }
}
