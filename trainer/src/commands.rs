//! What `anthronet train` and `anthronet evaluate` do.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anthronet::format::write_atomic;
use anthronet::measure::{Definitions, Sex};
use anthronet::model::{Model, ModelParts};
use anthronet::network::config::GeneratorConfig;
use serde_json::json;

use crate::basis::{COMPONENTS, laplacian};
use crate::biases::fit;
use crate::corpus::{CACHE, Corpus, Split};
use crate::dataset::{Bodies, Dataset, first_of};
use crate::evaluation::{GeneratorScores, Statistics, generator};
use crate::generator::{ShapeStatistics, TrainingOptions, TrainingSet, train};
use crate::measures::Definer;
use crate::pack::pack;
use crate::people::{self, PeopleTable};
use crate::progress::Bar;
use crate::survey::{self, Rows, SexStatistics, Survey, SurveyStatistics};
use crate::{Error, Result};

/// The model in the source tree.
const MODEL: &str = "model/anthronet.safetensors";
/// Default number of bodies to score on.
const BODIES: usize = 1_000;
/// Weight γ of the Laplacian loss: enough to smooth, too little to shrink bodies.
const GAMMA: f64 = 1e-4;
const TRAINING_SEED: u64 = 1;

/// Options of the training of the generator; `None` and `false` keep the defaults.
#[derive(Clone, Debug, Default)]
pub struct GeneratorOptions {
    /// Resume from the last checkpoint.
    pub resume: bool,
    /// Number of epochs.
    pub epochs: Option<usize>,
    /// Folder for model and checkpoint; without it the model of the source tree is replaced and the checkpoint is in
    /// `target`.
    pub out: Option<PathBuf>,
    /// The paper's network without linear paths, for comparison.
    pub plain: bool,
    /// Number f of Fourier components per measure.
    pub fourier: Option<usize>,
    /// Standard deviation σ of their frequencies, cycles per standard deviation of the measure.
    pub sigma: Option<f64>,
}

impl GeneratorOptions {
    /// The network's configuration.
    fn config(&self) -> GeneratorConfig {
        let mut config = if self.plain { GeneratorConfig::paper() } else { GeneratorConfig::default() };
        config.coefficients = COMPONENTS;
        config.gamma = GAMMA;
        config.fourier.components = self.fourier.unwrap_or(config.fourier.components);
        config.fourier.sigma = self.sigma.unwrap_or(config.fourier.sigma);
        config
    }

    /// The options of the training.
    fn training(&self) -> TrainingOptions {
        let defaults = TrainingOptions::default();
        TrainingOptions {
            seed: TRAINING_SEED,
            epochs: self.epochs.unwrap_or(defaults.epochs),
            resume: self.resume,
            // Without the skip the network starts far from its targets, the running statistics lag behind, and the loss
            // grows without bound once they are used. The paper never freezes them.
            freeze_norm: if self.plain { 1.0 } else { defaults.freeze_norm },
            ..defaults
        }
    }
}

/// Trains the generator and writes the model file: data set, basis, network, scores.
///
/// # Errors
/// When the source of bodies is not available, a file cannot be written, or training diverges.
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
/// When the source of bodies is not available, or the file is no model or cannot be written.
pub fn rescore() -> Result<()> {
    let path = Path::new(MODEL);
    let bytes = std::fs::read(path).map_err(Error::io(path))?;
    let mut parts = ModelParts::from_bytes(&bytes, MODEL)?;
    write_scored(&Corpus::open(Path::new(CACHE))?, &mut parts, path)
}

/// Scores a model on held-out bodies and writes it with its scores.
fn write_scored(corpus: &Corpus, parts: &mut ModelParts, path: &Path) -> Result<()> {
    // Score the model as the file stores it, with rounded numbers.
    let model = Model::from_bytes(&parts.to_bytes()?)?;
    let scores = score(&model, corpus, Split::HeldOut, BODIES)?;
    eprintln!("{scores}");
    parts.provenance.scores = scores.summary();
    let bytes = parts.to_bytes()?;
    write_atomic(path, &bytes)?;
    eprintln!("{}: {:.1} MB", path.display(), bytes.len() as f64 / 1e6);
    Ok(())
}

/// A table of [`evaluate`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Table {
    /// Errors of the generator on the first `bodies` of `split`. Hyperparameters are chosen on the validation split, so
    /// that the held-out one stays unseen.
    Generator {
        /// The split.
        split: Split,
        /// Number of bodies; `None` for 1000.
        bodies: Option<usize>,
    },
    /// Statistics of the measures of all bodies, beside the paper's and the people's of ANSUR II.
    Statistics,
    /// Bodies made from some of real people's measures, beside these people: the rows of a survey in a folder.
    People(PathBuf),
}

/// Computes a table, as text or JSON.
///
/// # Errors
/// When the source of bodies or the model is not available.
pub fn evaluate(table: &Table, as_json: bool) -> Result<String> {
    let cache = Path::new(CACHE);
    let (json, text) = match table {
        &Table::Generator { split, bodies } => {
            let model = Model::from_environment()?;
            let scores = score(&model, &Corpus::open(cache)?, split, bodies.unwrap_or(BODIES))?;
            (json!(scores), scores.to_string())
        }
        Table::Statistics => {
            let (_, _, dataset) = data(cache)?;
            let splits = [&dataset.train, &dataset.validation, &dataset.held_out];
            let surveys = survey::committed()?;
            let missing = || Error::Invalid("no statistics of ANSUR II".into());
            let people = surveys.get(Survey::Ansur2.name()).ok_or_else(missing)?;
            let statistics = Statistics::of(&splits, dataset.rejected, Survey::Ansur2, people)?;
            (json!(statistics), statistics.to_string())
        }
        Table::People(folder) => {
            let scores = score_people(folder)?;
            (json!(scores), scores.to_string())
        }
    };
    if !as_json {
        return Ok(text);
    }
    serde_json::to_string_pretty(&json).map_err(|e| Error::Invalid(e.to_string()))
}

/// Rewrites `model/landmarks.json`, `model/standing.json` and `model/measures.json`, which are defined on the mean body.
///
/// # Errors
/// When the source of bodies is not available or the definitions do not fit it.
pub fn define_measures(folder: &Path) -> Result<()> {
    let corpus = Corpus::open(Path::new(CACHE))?;
    let mirror = |v| corpus.assets.mesh.mirror.get(&v).copied();
    let landmarks = crate::landmarks::landmarks(&mirror)?;
    write_lines(&folder.join("landmarks.json"), &landmarks)?;
    write_lines(&folder.join("standing.json"), &crate::measures::turns(&landmarks)?)?;
    write_lines(&folder.join("measures.json"), &Definer::new(&corpus, &landmarks)?.measures()?)
}

/// Writes a JSON list, a line per element.
fn write_lines(path: &Path, list: &[impl serde::Serialize]) -> Result<()> {
    let lines = list
        .iter()
        .map(|element| serde_json::to_string(element).map_err(|e| Error::Invalid(e.to_string())))
        .collect::<Result<Vec<_>>>()?;
    write_atomic(path, format!("[\n{}\n]\n", lines.join(",\n")).as_bytes())?;
    Ok(())
}

/// Fits the biases of the sliders and writes them; returns the statistics of the bodies sampled with them.
///
/// # Errors
/// When the source of bodies is not available, or the file cannot be written.
pub fn fit_biases(path: &Path) -> Result<String> {
    let mut corpus = Corpus::open(Path::new(CACHE))?;
    let bar = Bar::new("mean measures", 1);
    let fitted = fit(&mut corpus, &|what, done, of| bar.set(what, done, of))?;
    bar.finish();
    write_atomic(path, fitted.to_json().as_bytes())?;
    Ok(fitted.to_string())
}

/// Computes the statistics of both surveys from their folders, each with `female.csv` and `male.csv`, and writes them.
///
/// # Errors
/// When a file cannot be read or written, or holds another survey.
pub fn compute_surveys(folders: [(Survey, &Path); 2], path: &Path) -> Result<()> {
    let mut of_surveys = BTreeMap::new();
    for (survey, folder) in folders {
        let [female, male] = Sex::ALL.map(|sex| SexStatistics::new(&survey.read(folder, sex)?));
        of_surveys.insert(survey.name().to_owned(), SurveyStatistics { female: female?, male: male? });
    }
    let json = serde_json::to_string(&of_surveys).map_err(|e| Error::Invalid(e.to_string()))?;
    // A line per column.
    let json = json.replace("{\"name\"", "\n{\"name\"") + "\n";
    write_atomic(path, json.as_bytes())?;
    Ok(())
}

fn score_people(folder: &Path) -> Result<PeopleTable> {
    let [female, male] = Sex::ALL.map(|sex| Rows::read(folder, sex));
    let people = [female?, male?];
    let survey = people[0].survey;
    if people[1].survey != survey {
        return Err(Error::Invalid(format!("{}: women and men are of two surveys", folder.display())));
    }
    let statistics = survey::committed()?;
    let missing = || Error::Invalid(format!("no statistics of {}", survey.title()));
    let statistics = statistics.get(survey.name()).ok_or_else(missing)?;
    let bar = Bar::new("people", people::bodies(&people) as u64);
    let of_sexes = Sex::ALL.map(|sex| statistics.of(sex));
    let table = people::table(&Model::from_environment()?, &people, of_sexes, &|| bar.inc());
    bar.finish();
    table
}

fn data(cache: &Path) -> Result<(Corpus, Definitions, Dataset)> {
    let corpus = Corpus::open(cache)?;
    let definitions = corpus.definitions()?;
    let bar = Bar::new("bodies", 1);
    let dataset =
        Dataset::load_or_make(&corpus, &definitions, cache, &|what, done, of| bar.set(what, done, of))?;
    bar.finish();
    Ok((corpus, definitions, dataset))
}

fn score(model: &Model, corpus: &Corpus, split: Split, count: usize) -> Result<GeneratorScores> {
    let numbers = first_of(corpus, model.definitions(), split, count)?;
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
