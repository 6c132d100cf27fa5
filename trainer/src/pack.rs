//! From the results of training to the parts of a model file.

use anthronet::condition::QUANTILE_COUNT;
use anthronet::measure::{Definitions, MEASURE_COUNT};
use anthronet::model::{Accessory, ModelParts, Provenance};
use anthronet::network::config::GeneratorConfig;
use glam::Vec3;
use half::f16;

use crate::assets::CAGE_VERTICES;
use crate::basis::{Basis, COMPONENTS};
use crate::corpus::{Corpus, DATA_VERSION, SEED};
use crate::dataset::{Bodies, Dataset};
use crate::generator::TrainedGenerator;
use crate::reduce::{SHARES, reduce};
use crate::survey::Survey;
use crate::{Error, Result};

/// Components stored as half floats; the rest are bytes.
const FINE: usize = 40;
/// Margin of a request beyond the training bodies, as a share of a measure's range.
const RANGE_SLACK: f64 = 0.25;

/// Packs a model, without its scores.
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
    let bodies = prior(&dataset.train)?;
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
        priors: [people(&bodies)?, bodies],
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

/// The components after the first [`FINE`] as bytes, and the scale of each.
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

/// The prior of ANSUR II's people.
fn people(bodies: &[Vec<f64>; 3]) -> Result<[Vec<f64>; 3]> {
    let statistics = crate::survey::committed()?;
    let statistics = statistics
        .get(Survey::Ansur2.name())
        .ok_or_else(|| Error::Invalid("no statistics of ANSUR II".into()))?;
    crate::population::prior(Survey::Ansur2, statistics, bodies)
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
            out[2].extend(
                (0..QUANTILE_COUNT).map(|q| f64::from(values[q * (values.len() - 1) / (QUANTILE_COUNT - 1)])),
            );
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

#[cfg(test)]
mod tests {
    use anthronet::random::Random;
    use faer::Mat;

    use super::*;

    /// Bodies whose measures are normal around 1 m for women and 2 m for men; the first two go together.
    fn bodies(count: usize) -> Bodies {
        let mut random = Random::new(2, 0);
        let mut bodies = Bodies::default();
        for i in 0..count {
            let sex = (i % 2) as u8;
            let first = random.normal();
            bodies.numbers.push(i as u64);
            bodies.sex.push(sex);
            bodies.measures.extend((0..MEASURE_COUNT).map(|m| {
                let deviation = if m < 2 { first } else { random.normal() };
                (1.0 + f64::from(sex) + 0.1 * deviation) as f32
            }));
        }
        bodies
    }

    #[test]
    fn a_prior_is_what_the_bodies_are() {
        let [means, covariances, quantiles] = prior(&bodies(4_000)).unwrap();
        assert_eq!(means.len(), 2 * MEASURE_COUNT);
        for (i, mean) in means.iter().enumerate() {
            // Six standard errors of 2000 draws with deviation 0.1 are 0.013.
            let expected = if i < MEASURE_COUNT { 1.0 } else { 2.0 };
            assert!((mean - expected).abs() < 0.013, "{i} {mean}");
        }
        let covariance = |i: usize, j: usize| covariances[i * MEASURE_COUNT + j];
        assert!((covariance(0, 1) - covariance(0, 0)).abs() < 1e-6 && covariance(0, 2).abs() < 1.5e-3);
        let all = 0..MEASURE_COUNT;
        assert!(all.clone().all(|i| all.clone().all(|j| covariance(i, j) == covariance(j, i))));
        assert!((covariance(5, 5) - 0.01).abs() < 2e-3);
        for of_measure in quantiles.chunks_exact(QUANTILE_COUNT) {
            assert!(of_measure.is_sorted());
            assert!((of_measure[50] - of_measure[16] - 0.1).abs() < 0.02, "one deviation below the median");
        }
        anthronet::condition::Prior::from_slices(&means, &covariances, &quantiles).map(drop).unwrap();
        assert!(prior(&bodies(100)).unwrap_err().to_string().contains("only 50 bodies"));
    }

    #[test]
    fn ranges_reach_a_quarter_beyond_the_bodies() {
        let mut bodies = bodies(2);
        for (i, m) in bodies.measures.iter_mut().enumerate() {
            *m = if i < MEASURE_COUNT { 1.0 } else { 2.0 };
        }
        assert!(ranges(&bodies).chunks_exact(2).all(|r| *r == [0.75, 2.25]));
    }

    #[test]
    fn bytes_are_within_half_a_step_of_what_they_stand_for() {
        let mut random = Random::new(7, 0);
        let rows = Mat::from_fn(9, COMPONENTS, |_, _| random.normal() as f32);
        let basis = Basis { mean: vec![0.0; 9], rows, std: vec![1.0; COMPONENTS] };
        let (packed, scales) = bytes(&basis, 6);
        assert_eq!((packed.len(), scales.len()), (6 * (COMPONENTS - FINE), COMPONENTS - FINE));
        for (k, (row, scale)) in packed.chunks_exact(6).zip(&scales).enumerate() {
            assert_eq!(row.iter().map(|b| b.unsigned_abs()).max(), Some(127));
            for (i, byte) in row.iter().enumerate() {
                let value = basis.rows[(i, FINE + k)];
                assert!((f32::from(*byte) * scale - value).abs() <= 0.5001 * scale, "{k} {i}");
            }
        }
    }
}
