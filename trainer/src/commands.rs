//! What `anthronet train` and `anthronet evaluate` do.

use std::path::{Path, PathBuf};

use anthronet::format::write_atomic;
use anthronet::measure::Definitions;
use anthronet::model::{Model, ModelParts};
use anthronet::network::config::GeneratorConfig;
use serde_json::json;

use crate::basis::{COMPONENTS, laplacian};
use crate::biases::fit;
use crate::corpus::{CACHE, Corpus, Split};
use crate::dataset::{Bodies, Dataset, first_of};
use crate::evaluation::{GeneratorScores, Statistics, generator};
use crate::generator::{ShapeStatistics, TrainingOptions, TrainingSet, train};
use crate::pack::pack;
use crate::progress::Bar;
use crate::{Error, Result};

/// Where the model is kept in the source tree.
const MODEL: &str = "model/anthronet.safetensors";
/// Bodies that scores are told on unless said otherwise.
const BODIES: usize = 1_000;
/// Weight γ of the Laplacian loss: enough to act, too little to shrink anybody.
const GAMMA: f64 = 1e-4;
const TRAINING_SEED: u64 = 1;

/// What of the training of the generator is asked for differently.
#[derive(Clone, Debug, Default)]
pub struct GeneratorOptions {
    /// Goes on from the last checkpoint.
    pub resume: bool,
    /// Passes over the bodies.
    pub epochs: Option<usize>,
    /// A folder for model and checkpoint; without it the model of the source tree is replaced and the checkpoint is
    /// kept in `target`.
    pub out: Option<PathBuf>,
    /// The paper's network without linear paths, for comparison.
    pub plain: bool,
    /// Fourier components f of a measure.
    pub fourier: Option<usize>,
    /// Deviation σ of their frequencies.
    pub sigma: Option<f64>,
}

impl GeneratorOptions {
    /// The network that these options ask for.
    fn config(&self) -> GeneratorConfig {
        let mut config = if self.plain { GeneratorConfig::paper() } else { GeneratorConfig::default() };
        config.coefficients = COMPONENTS;
        config.gamma = GAMMA;
        config.fourier.components = self.fourier.unwrap_or(config.fourier.components);
        config.fourier.sigma = self.sigma.unwrap_or(config.fourier.sigma);
        config
    }

    /// How they ask for it to be trained.
    fn training(&self) -> TrainingOptions {
        let defaults = TrainingOptions::default();
        TrainingOptions {
            seed: TRAINING_SEED,
            epochs: self.epochs.unwrap_or(defaults.epochs),
            resume: self.resume,
            // Without the skip the network starts far from people, the running statistics lag behind it, and a loss
            // through them grows without bound. The paper never freezes them.
            freeze_norm: if self.plain { 1.0 } else { defaults.freeze_norm },
            ..defaults
        }
    }
}

/// Trains the generator and writes the model file: data set, basis, network, scores.
///
/// # Errors
/// When the source of bodies cannot be had, a file cannot be written, or training diverges.
pub fn train_generator(options: &GeneratorOptions) -> Result<()> {
    let config = options.config();
    config.validate()?;
    let cache = PathBuf::from(CACHE);
    let (corpus, definitions, dataset) = data(&cache)?;
    let statistics = ShapeStatistics {
        vertex_count: crate::assets::CAGE_VERTICES,
        coefficient_std: dataset.basis.std.clone(),
        laplacian: Some(laplacian(&dataset.basis, corpus.cage())),
    };
    let out_dir = options.out.clone().unwrap_or_else(|| cache.join("generator"));
    std::fs::create_dir_all(&out_dir).map_err(Error::io(&out_dir))?;
    let training = TrainingOptions { out_dir, ..options.training() };
    let trained = train(
        &training_set(&dataset.train),
        &training_set(&dataset.validation),
        &statistics,
        &config,
        &training,
    )?;
    let mut parts = pack(&corpus, &definitions, &dataset, &trained, TRAINING_SEED)?;
    let path = match &options.out {
        Some(folder) => folder.join("anthronet.safetensors"),
        None => PathBuf::from(MODEL),
    };
    write_scored(&corpus, &mut parts, &path)
}

/// Scores the model of the source tree again and writes the scores into its file; its arrays stay as they are.
///
/// # Errors
/// When the source of bodies cannot be had, or the file is no model or cannot be written.
pub fn rescore() -> Result<()> {
    let path = Path::new(MODEL);
    let bytes = std::fs::read(path).map_err(Error::io(path))?;
    let mut parts = ModelParts::from_bytes(&bytes, MODEL)?;
    write_scored(&Corpus::open(Path::new(CACHE))?, &mut parts, path)
}

/// Scores a model on held-out bodies and writes it with its scores.
fn write_scored(corpus: &Corpus, parts: &mut ModelParts, path: &Path) -> Result<()> {
    // Of what the file will hold: its numbers are rounded.
    let model = Model::from_bytes(&parts.to_bytes()?)?;
    let scores = score(&model, corpus, Split::HeldOut, BODIES)?;
    eprintln!("{scores}");
    parts.provenance.scores = scores.told();
    let bytes = parts.to_bytes()?;
    write_atomic(path, &bytes)?;
    eprintln!("{}: {:.1} MB", path.display(), bytes.len() as f64 / 1e6);
    Ok(())
}

/// A table that [`evaluate`] makes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// Errors of the generator on the first `bodies` of `split`. Settings are chosen on the validation split, so that
    /// the held-out one stays unseen.
    Generator {
        /// Which bodies.
        split: Split,
        /// How many; `None` for 1000.
        bodies: Option<usize>,
    },
    /// The measures of all bodies beside the paper's.
    Statistics,
}

/// A table as text or JSON.
///
/// # Errors
/// When the source of bodies or the model cannot be had.
pub fn evaluate(table: Table, as_json: bool) -> Result<String> {
    let cache = Path::new(CACHE);
    let (json, text) = match table {
        Table::Generator { split, bodies } => {
            let model = Model::from_environment()?;
            let scores = score(&model, &Corpus::open(cache)?, split, bodies.unwrap_or(BODIES))?;
            (json!(scores), scores.to_string())
        }
        Table::Statistics => {
            let (_, _, dataset) = data(cache)?;
            let splits = [&dataset.train, &dataset.validation, &dataset.held_out];
            let statistics = Statistics::of(&splits, dataset.rejected);
            (json!(statistics), statistics.to_string())
        }
    };
    if !as_json {
        return Ok(text);
    }
    serde_json::to_string_pretty(&json).map_err(|e| Error::Invalid(e.to_string()))
}

/// Makes `model/measures.json` anew from the landmarks.
///
/// # Errors
/// When the source of bodies cannot be had or the landmarks do not fit it.
pub fn lay_measures(path: &Path) -> Result<()> {
    let corpus = Corpus::open(Path::new(CACHE))?;
    let mirror = &corpus.assets.mesh.mirror;
    let definitions = crate::landmarks::definitions(&corpus, &|v| mirror.get(&v).copied())?;
    let lines = definitions
        .iter()
        .map(|d| serde_json::to_string(d).map_err(|e| Error::Invalid(e.to_string())))
        .collect::<Result<Vec<_>>>()?;
    write_atomic(path, format!("[\n{}\n]\n", lines.join(",\n")).as_bytes())?;
    Ok(())
}

/// Fits the biases of the sliders anew and writes them; returns the statistics that they give.
///
/// # Errors
/// When the source of bodies cannot be had, or the file cannot be written.
pub fn fit_biases(path: &Path) -> Result<String> {
    let mut corpus = Corpus::open(Path::new(CACHE))?;
    let bar = Bar::new("mean measures", 1);
    let fitted = fit(&mut corpus, &Definitions::embedded()?, &|what, done, of| bar.set(what, done, of))?;
    bar.finish();
    write_atomic(path, fitted.to_json().as_bytes())?;
    Ok(fitted.statistics.to_string())
}

fn data(cache: &Path) -> Result<(Corpus, Definitions, Dataset)> {
    let corpus = Corpus::open(cache)?;
    let definitions = Definitions::embedded()?;
    let bar = Bar::new("bodies", 1);
    let dataset =
        Dataset::load_or_make(&corpus, &definitions, cache, &|what, done, of| bar.set(what, done, of))?;
    bar.finish();
    Ok((corpus, definitions, dataset))
}

fn score(model: &Model, corpus: &Corpus, split: Split, count: usize) -> Result<GeneratorScores> {
    let numbers = first_of(corpus, model.definitions(), split, count);
    let bar = Bar::new("scored bodies", numbers.len() as u64);
    let scores = generator(model, corpus, split, &numbers, &|| bar.inc());
    bar.finish();
    scores
}

fn training_set(bodies: &Bodies) -> TrainingSet {
    TrainingSet {
        count: bodies.len(),
        k: COMPONENTS,
        coefficients: bodies.coefficients.clone(),
        measures: bodies.measures.clone(),
        sex: bodies.sex.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_choose_the_network() {
        let default = GeneratorOptions::default().config();
        assert_eq!((default.fourier.components, default.skip, default.gamma), (0, true, GAMMA));
        let options =
            GeneratorOptions { plain: true, fourier: Some(4), sigma: Some(0.01), ..Default::default() };
        let config = options.config();
        assert_eq!((config.fourier.components, config.fourier.sigma, config.skip), (4, 0.01, false));
        assert_eq!(
            (options.training().freeze_norm, GeneratorOptions::default().training().freeze_norm),
            (1.0, 0.5)
        );
        let absurd = GeneratorOptions { sigma: Some(f64::NAN), ..Default::default() };
        assert!(train_generator(&absurd).unwrap_err().to_string().contains("fourier.sigma"));
    }
}
