//! What `anthronet train` and `anthronet evaluate` do.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};

use anthronet::export::write_atomic;
use anthronet::measure::Definitions;
use anthronet::model::Model;
use anthronet::model::config::GeneratorConfig;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;

use crate::basis::{COMPONENTS, laplacian};
use crate::corpus::{CACHE, Corpus, Split};
use crate::dataset::{Bodies, Dataset};
use crate::evaluation::{GeneratorScores, generator, statistics};
use crate::generator::{ShapeStatistics, TrainingOptions, TrainingSet, train};
use crate::pack::pack;
use crate::{Error, Result};

/// Where the model is kept in the source tree.
const MODEL: &str = "model/anthronet.safetensors";
/// Bodies that scores are told on unless said otherwise.
const BODIES: usize = 1_000;
/// Weight γ of the Laplacian loss: enough to act, too little to shrink anybody.
const GAMMA: f64 = 1e-4;
const TRAINING_SEED: u64 = 1;

/// Trains the generator and writes the model file: data set, basis, network, scores.
///
/// `out` is a folder for model and checkpoint; without it the model of the source tree is replaced and the
/// checkpoint is kept in `target`. `plain` trains the paper's network without linear paths, for comparison.
///
/// # Errors
/// When the source of bodies cannot be had, a file cannot be written, or training diverges.
pub fn train_generator(resume: bool, epochs: Option<usize>, out: Option<&Path>, plain: bool) -> Result<()> {
    let cache = PathBuf::from(CACHE);
    let (corpus, definitions, dataset) = data(&cache)?;
    let statistics = ShapeStatistics {
        vertex_count: crate::assets::CAGE_VERTICES,
        coefficient_std: dataset.basis.std.clone(),
        laplacian: Some(laplacian(&dataset.basis, &corpus)),
    };
    let config = if plain { GeneratorConfig::paper() } else { GeneratorConfig::default() };
    let config = GeneratorConfig { coefficients: COMPONENTS, gamma: GAMMA, ..config };
    let defaults = TrainingOptions::default();
    let out_dir = out.map_or_else(|| cache.join("generator"), Path::to_path_buf);
    std::fs::create_dir_all(&out_dir).map_err(Error::io(&out_dir))?;
    let options = TrainingOptions {
        out_dir,
        seed: TRAINING_SEED,
        epochs: epochs.unwrap_or(defaults.epochs),
        resume,
        ..defaults
    };
    let trained = train(
        &training_set(&dataset.train),
        &training_set(&dataset.validation),
        &statistics,
        &config,
        &options,
    )?;

    let mut parts = pack(&corpus, &definitions, &dataset, &trained, TRAINING_SEED)?;
    let scores = score(&Model::from_parts(&parts, "(trained)")?, &corpus, &dataset, Split::HeldOut, BODIES)?;
    eprintln!("{scores}");
    let told = [
        ("bodies", scores.bodies as f64),
        ("p2p_mm", scores.p2p_mm),
        ("p2p_z0_mm", scores.p2p_z0_mm),
        ("measures_mean_mm", scores.measures_mm.get("mean").copied().unwrap_or(f64::NAN)),
        ("after_solve_max_mm", scores.after_solve_max_mm),
    ];
    parts.provenance.scores = told.map(|(name, value)| (name.to_owned(), value)).into();
    let path = out.map_or_else(|| PathBuf::from(MODEL), |folder| folder.join("anthronet.safetensors"));
    let bytes = parts.to_bytes()?;
    write_atomic(&path, &bytes)?;
    eprintln!("{}: {:.1} MB", path.display(), bytes.len() as f64 / 1e6);
    Ok(())
}

/// The table `generator` or `statistics`, as text or JSON.
///
/// The generator is scored on the first `bodies` of `split`; settings are chosen on the validation split, so that the
/// held-out one stays unseen. The statistics are those of all splits.
///
/// # Errors
/// For an unknown table, or when the source of bodies or the model cannot be had.
pub fn evaluate(table: &str, split: Split, as_json: bool, bodies: Option<usize>) -> Result<String> {
    let (corpus, _, dataset) = data(Path::new(CACHE))?;
    let to_json = |value: serde_json::Value| {
        serde_json::to_string_pretty(&value).map_err(|e| Error::Invalid(e.to_string()))
    };
    match table {
        "generator" => {
            let model = Model::from_environment()?;
            let scores = score(&model, &corpus, &dataset, split, bodies.unwrap_or(BODIES))?;
            if as_json { to_json(json!(scores)) } else { Ok(scores.to_string()) }
        }
        "statistics" => {
            let splits = [&dataset.train, &dataset.validation, &dataset.held_out];
            let rows = statistics(&splits);
            let count: usize = splits.iter().map(|b| b.len()).sum();
            if as_json {
                return to_json(json!({"bodies": count, "rejected": dataset.rejected, "measures": rows}));
            }
            let mut text = format!(
                "{count} bodies ({} rejected); metres; ours, then the paper's\n{:28} {:>6} {:>6} {:>6} {:>6} | {:>6} {:>6} {:>6} {:>6}\n",
                dataset.rejected, "measure", "mean", "std", "min", "max", "mean", "std", "min", "max"
            );
            for row in rows {
                let [a, b, c, d] = row.ours;
                let [p, q, r, s] = row.paper;
                text += &format!(
                    "{:28} {a:6.3} {b:6.3} {c:6.3} {d:6.3} | {p:6.3} {q:6.3} {r:6.3} {s:6.3}\n",
                    row.name
                );
            }
            Ok(text)
        }
        other => Err(Error::Invalid(format!("table: expected `generator` or `statistics`, got `{other}`"))),
    }
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

fn data(cache: &Path) -> Result<(Corpus, Definitions, Dataset)> {
    let corpus = Corpus::open(cache)?;
    let definitions = Definitions::embedded()?;
    let bar = bar(1, "bodies");
    let dataset = Dataset::load_or_make(&corpus, &definitions, cache, &|what, done, of| {
        bar.set_message(what.to_owned());
        bar.set_length(of.max(1));
        bar.set_position(done);
    })?;
    bar.finish_and_clear();
    Ok((corpus, definitions, dataset))
}

fn score(
    model: &Model,
    corpus: &Corpus,
    dataset: &Dataset,
    split: Split,
    count: usize,
) -> Result<GeneratorScores> {
    let count = count.min(dataset.split(split).len());
    let bar = bar(count as u64, "scored bodies");
    let scores = generator(model, corpus, dataset, split, count, &|| bar.inc(1));
    bar.finish_and_clear();
    scores
}

fn bar(length: u64, message: &'static str) -> ProgressBar {
    let bar = ProgressBar::new(length).with_message(message);
    if !std::io::stderr().is_terminal() {
        bar.set_draw_target(ProgressDrawTarget::hidden());
    }
    if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}") {
        bar.set_style(style);
    }
    bar
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
