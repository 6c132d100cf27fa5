//! From what training decided to the parts of a model file.

use anthronet::measure::{Definitions, MEASURE_COUNT};
use anthronet::model::config::GeneratorConfig;
use anthronet::model::{Accessory, ModelParts, Provenance};
use glam::Vec3;
use half::f16;

use crate::assets::CAGE_VERTICES;
use crate::basis::{Basis, COMPONENTS};
use crate::corpus::{Corpus, DATA_VERSION, SEED};
use crate::dataset::{Bodies, Dataset};
use crate::generator::TrainedGenerator;
use crate::reduce::{SHARES, reduce};
use crate::{Error, Result};

/// Components stored as half floats; the rest are bytes.
const FINE: usize = 40;
/// Quantiles per measure: 0 %, 1 %, … 100 %.
const QUANTILES: usize = 101;
/// How far beyond the training bodies a request may go, as a share of a measure's range.
const RANGE_SLACK: f64 = 0.25;

/// Packs a model without networks' scores.
///
/// # Errors
/// When the levels of detail cannot be made.
pub fn pack(
    corpus: &Corpus,
    definitions: &Definitions,
    dataset: &Dataset,
    generator: &TrainedGenerator,
    seed: u64,
) -> Result<ModelParts> {
    let basis = &dataset.basis;
    let surface = 3 * corpus.surface_points();
    let mean_cage: Vec<Vec3> =
        basis.mean[..3 * CAGE_VERTICES].chunks_exact(3).map(Vec3::from_slice).collect();
    let smooth = corpus.subdivision.refine(&mean_cage)?;
    let (coarse, scales) = bytes(basis, surface);
    let joints = &corpus.assets.rig.joints;
    let config: GeneratorConfig = generator.config.clone();
    Ok(ModelParts {
        cage: corpus.cage().clone(),
        reduced: [
            reduce(corpus.cage(), &smooth[..CAGE_VERTICES], SHARES[0])?,
            reduce(corpus.cage(), &smooth[..CAGE_VERTICES], SHARES[1])?,
        ],
        accessories: corpus
            .assets
            .mesh
            .accessories
            .iter()
            .map(|a| Accessory { name: a.name.to_owned(), start: a.start, topology: a.topology.clone() })
            .collect(),
        mean: basis.mean[..surface].to_vec(),
        fine: (0..FINE)
            .flat_map(|k| (0..surface).map(move |i| (i, k)))
            .map(|ik| f16::from_f32(basis.rows[ik]))
            .collect(),
        coarse,
        scales,
        deviations: basis.std.clone(),
        joint_names: joints.iter().map(|j| j.name.clone()).collect(),
        joint_parents: joints.iter().map(|j| j.parent.map(|p| p as u32)).collect(),
        joint_mean: basis.mean[surface..].to_vec(),
        joint_rows: (surface..basis.mean.len())
            .flat_map(|i| (0..COMPONENTS).map(move |k| (i, k)))
            .map(|ik| basis.rows[ik])
            .collect(),
        skin: skin(corpus),
        prior: prior(&dataset.train)?,
        ranges: ranges(&dataset.train),
        standardisation: [generator.measure_mean.to_vec(), generator.measure_std.to_vec()],
        networks: generator.tensors.clone(),
        config,
        definitions_hash: definitions.hash().to_owned(),
        provenance: Provenance {
            data_version: DATA_VERSION,
            data_seed: SEED,
            training_bodies: dataset.train.len(),
            training_seed: seed,
            scores: Default::default(),
        },
    })
}

/// The components after the first [`FINE`] as bytes, and what a byte is worth in each.
fn bytes(basis: &Basis, surface: usize) -> (Vec<i8>, Vec<f32>) {
    let mut coarse = Vec::with_capacity((COMPONENTS - FINE) * surface);
    let mut scales = Vec::new();
    for k in FINE..COMPONENTS {
        let largest =
            (0..surface).map(|i| basis.rows[(i, k)].abs()).fold(0.0, f32::max).max(f32::MIN_POSITIVE);
        let scale = largest / 127.0;
        scales.push(scale);
        coarse.extend((0..surface).map(|i| (basis.rows[(i, k)] / scale).round() as i8));
    }
    (coarse, scales)
}

fn skin(corpus: &Corpus) -> (Vec<u32>, Vec<u16>, Vec<f32>) {
    let (mut offsets, mut joints, mut weights) = (vec![0], Vec::new(), Vec::new());
    for row in &corpus.assets.rig.weights {
        for &(joint, weight) in row {
            joints.push(joint);
            weights.push(weight);
        }
        offsets.push(joints.len() as u32);
    }
    (offsets, joints, weights)
}

/// Means, covariances and quantiles of the measures, female first.
fn prior(bodies: &Bodies) -> Result<[Vec<f64>; 3]> {
    let mut out = [Vec::new(), Vec::new(), Vec::new()];
    for sex in [0, 1] {
        let rows: Vec<&[f32]> =
            (0..bodies.len()).filter(|&i| bodies.sex[i] == sex).map(|i| bodies.measures(i)).collect();
        if rows.len() < 2 * MEASURE_COUNT {
            return Err(Error::Invalid(format!("prior: only {} bodies of sex {sex}", rows.len())));
        }
        let n = rows.len() as f64;
        let mean: Vec<f64> =
            (0..MEASURE_COUNT).map(|m| rows.iter().map(|r| f64::from(r[m])).sum::<f64>() / n).collect();
        let mut covariance = vec![0.0; MEASURE_COUNT * MEASURE_COUNT];
        for row in &rows {
            for i in 0..MEASURE_COUNT {
                let a = f64::from(row[i]) - mean[i];
                for j in 0..=i {
                    covariance[i * MEASURE_COUNT + j] += a * (f64::from(row[j]) - mean[j]) / (n - 1.0);
                }
            }
        }
        for i in 0..MEASURE_COUNT {
            for j in 0..i {
                covariance[j * MEASURE_COUNT + i] = covariance[i * MEASURE_COUNT + j];
            }
        }
        for m in 0..MEASURE_COUNT {
            let mut values: Vec<f32> = rows.iter().map(|r| r[m]).collect();
            values.sort_by(f32::total_cmp);
            out[2]
                .extend((0..QUANTILES).map(|q| f64::from(values[q * (values.len() - 1) / (QUANTILES - 1)])));
        }
        out[0].extend(mean);
        out[1].extend(covariance);
    }
    Ok(out)
}

/// The training bodies' ranges with some slack, in whole millimetres.
fn ranges(bodies: &Bodies) -> Vec<f64> {
    (0..MEASURE_COUNT)
        .flat_map(|m| {
            let values = (0..bodies.len()).map(|i| f64::from(bodies.measures(i)[m]));
            let (low, high) =
                values.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
            let slack = RANGE_SLACK * (high - low);
            let millimetres = |x: f64| (1000.0 * x).round() / 1000.0;
            [millimetres((low - slack).max(0.5 * low)), millimetres(high + slack)]
        })
        .collect()
}
