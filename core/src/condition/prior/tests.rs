use proptest::prelude::*;

use super::super::test_prior::{prior, sex_prior};
use super::*;
use crate::condition::{FEASIBILITY_NOISE, PROJECTION_NOISE};

/// Solves A X = B for dense A by Gaussian elimination with pivoting: an oracle that shares nothing with Cholesky.
fn eliminate(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for c in 0..n {
        let p = (c..n).max_by(|i, j| a[*i][c].abs().total_cmp(&a[*j][c].abs())).unwrap();
        a.swap(c, p);
        b.swap(c, p);
        for r in 0..n {
            if r != c {
                let f = a[r][c] / a[c][c];
                let (pivot, target) = (a[c].clone(), &mut a[r]);
                for (t, v) in target.iter_mut().zip(&pivot) {
                    *t -= f * v;
                }
                b[r] -= f * b[c];
            }
        }
    }
    (0..n).map(|i| b[i] / a[i][i]).collect()
}

fn given_of(mask: &[bool], values: &Measurements) -> GivenMeasures {
    std::array::from_fn(|i| mask[i].then_some(values[i]))
}

fn quantiles_of(mean: &[f64]) -> Vec<f64> {
    mean.iter().flat_map(|m| (0..QUANTILE_COUNT).map(move |q| m + q as f64)).collect()
}

/// A prior from random factor loadings (rank `rank`) plus a diagonal of `ridge`: near-degenerate when both are small.
fn random_prior(seed: u64, rank: usize, ridge: f64) -> SexPrior {
    let mut random = Random::new(seed, 9);
    let n = MEASURE_COUNT;
    let loadings = random.normals(n * rank);
    let mean: Vec<_> = (0..n).map(|_| 0.5 + 0.1 * random.normal()).collect();
    let mut covariance = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..n {
            let dot: f64 = (0..rank).map(|k| loadings[i * rank + k] * loadings[j * rank + k]).sum();
            covariance[i * n + j] = 0.0025 * dot + if i == j { ridge } else { 0.0 };
        }
    }
    SexPrior::new(&mean, &covariance, &quantiles_of(&mean)).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn conditioning_is_the_textbook_formula(
        seed in 0..1000u64,
        rank in 1..40usize,
        exponent in -12..-3i32,
        mask in prop::collection::vec(any::<bool>(), MEASURE_COUNT),
        shift in prop::collection::vec(-0.2..0.2f64, MEASURE_COUNT),
    ) {
        let n = MEASURE_COUNT;
        let p = random_prior(seed, rank, 10f64.powi(exponent));
        let values: Measurements = std::array::from_fn(|i| p.mean()[i] + shift[i]);
        let given = given_of(&mask, &values);
        let conditional = p.condition(&given).unwrap();
        let rows: Vec<_> = (0..n).filter(|i| mask[*i]).collect();
        let noisy: Vec<Vec<f64>> = rows.iter().map(|i| rows.iter().map(|j| {
            p.covariance()[i * n + j] + if i == j { FILL_NOISE * FILL_NOISE } else { 0.0 }
        }).collect()).collect();
        let weights = eliminate(noisy.clone(), rows.iter().map(|i| shift[*i]).collect());
        let deviation = conditional.standard_deviation();
        for u in 0..n {
            if mask[u] {
                prop_assert_eq!(conditional.mean()[u], values[u]);
                prop_assert_eq!(deviation[u], 0.0);
                continue;
            }
            let cross: Vec<_> = rows.iter().map(|g| p.covariance()[u * n + g]).collect();
            let mean = p.mean()[u] + cross.iter().zip(&weights).map(|(s, w)| s * w).sum::<f64>();
            let explained = eliminate(noisy.clone(), cross.clone());
            let variance = p.covariance()[u * n + u] - cross.iter().zip(&explained).map(|(s, w)| s * w).sum::<f64>();
            // Condition number up to 1e6 times the size of the shifts; variances of order 0.1.
            prop_assert!((conditional.mean()[u] - mean).abs() < 1e-7, "{} {}", conditional.mean()[u], mean);
            prop_assert!((deviation[u].powi(2) - variance.max(0.0)).abs() < 1e-10);
        }
        let sample = conditional.sample(&mut Random::new(seed, 0));
        prop_assert!(sample.iter().all(|v| v.is_finite()));
    }

    #[test]
    fn projection_shrinks_and_leaves_the_mean(seed in 0..1000u64, rank in 1..40usize, shift in prop::collection::vec(-0.2..0.2f64, MEASURE_COUNT)) {
        let p = random_prior(seed, rank, 1e-6);
        let values: Measurements = std::array::from_fn(|i| p.mean()[i] + shift[i]);
        let distance = |v: &Measurements| p.distance_squared(&v.map(Some), PROJECTION_NOISE).unwrap();
        let projected = p.project(&values, PROJECTION_NOISE).unwrap();
        prop_assert!(distance(&projected) <= distance(&values) * (1.0 + 1e-9));
        let still = p.project(p.mean(), PROJECTION_NOISE).unwrap();
        prop_assert_eq!(&still, p.mean());
        // With next to no error every vector that the prior allows stays where it is.
        let exact = p.project(&projected, 1e-7).unwrap();
        prop_assert!(exact.iter().zip(&projected).all(|(a, b)| (a - b).abs() < 1e-4));
    }
}

#[test]
fn intervals_cover_nine_people_in_ten() {
    let p = sex_prior(0.0, 0.0);
    let nobody = p.condition(&[None; MEASURE_COUNT]).unwrap();
    let given_names = ["height", "waist_circumference", "arm_length_left"];
    let mask: Vec<_> = MeasureId::all().map(|id| given_names.contains(&id.name())).collect();
    let (mut inside, mut total) = (0, 0);
    for person in 0..2000 {
        let truth = nobody.sample(&mut Random::new(person, 5));
        let (low, high) = p.condition(&given_of(&mask, &truth)).unwrap().interval90();
        for i in (0..MEASURE_COUNT).filter(|i| !mask[*i]) {
            total += 1;
            inside += usize::from(low[i] <= truth[i] && truth[i] <= high[i]);
        }
    }
    let share = inside as f64 / f64::from(total);
    // Reading errors make intervals a little wide; correlated measures leave an error of about 0.4 %.
    assert!((0.89..0.925).contains(&share), "{share}");
}

#[test]
fn samples_have_the_conditional_moments() {
    let p = sex_prior(0.0, 0.0);
    let mut given = [None; MEASURE_COUNT];
    given[3] = Some(1.8);
    let conditional = p.condition(&given).unwrap();
    let draws: Vec<_> = (0..4000).map(|seed| conditional.sample(&mut Random::new(seed, 0))).collect();
    for i in 0..MEASURE_COUNT {
        let mean = draws.iter().map(|d| d[i]).sum::<f64>() / 4000.0;
        let variance = draws.iter().map(|d| (d[i] - mean).powi(2)).sum::<f64>() / 3999.0;
        let deviation = conditional.standard_deviation()[i];
        // Four standard errors.
        assert!((mean - conditional.mean()[i]).abs() <= 4.0 * deviation / 63.2 + 1e-12);
        assert!((variance.sqrt() - deviation).abs() <= 4.0 * deviation / 89.4 + 1e-12);
    }
    assert!(draws.iter().all(|d| d[3] == 1.8));
}

#[test]
fn taller_people_have_longer_arms_and_are_likelier_men() {
    let prior = prior();
    let mut given = [None; MEASURE_COUNT];
    assert_eq!(prior.sex_posterior(&given, FEASIBILITY_NOISE).unwrap(), [0.5, 0.5]);
    given[3] = Some(1.95);
    let posterior = prior.sex_posterior(&given, FEASIBILITY_NOISE).unwrap();
    assert!(posterior[1] > 0.9 && (posterior[0] + posterior[1] - 1.0).abs() < 1e-12);
    let arm = MeasureId::from_name("arm_length_left").unwrap().index();
    let women = prior.of(Sex::Female);
    assert!(women.condition(&given).unwrap().mean()[arm] > women.mean()[arm] + 0.03);
    // Far outside everything: still a probability.
    given[3] = Some(1e200);
    assert!(prior.sex_posterior(&given, FEASIBILITY_NOISE).unwrap().iter().all(|p| (0.0..=1.0).contains(p)));
}

#[test]
fn percentiles_are_linear_between_quantiles() {
    let mean = [0.0; MEASURE_COUNT];
    let n = MEASURE_COUNT;
    let identity: Vec<_> = (0..n * n).map(|i| f64::from(u8::from(i % (n + 1) == 0))).collect();
    let mut table = quantiles_of(&mean);
    table[10] = 9.0;
    let p = SexPrior::new(&mean, &identity, &table).unwrap();
    let id = MeasureId::from_index(0).unwrap();
    for (value, percentile) in [
        (-1.0, 0.0),
        (0.0, 0.0),
        (50.25, 50.25),
        (100.0, 100.0),
        (200.0, 100.0),
        (9.0, 10.0),
        (10.0, 10.5),
        (f64::NAN, 0.0),
    ] {
        assert_eq!(p.percentile(id, value), percentile, "{value}");
    }
}

#[test]
fn damaged_priors_are_refused() {
    let good = sex_prior(0.0, 0.0);
    let (mean, covariance) = (good.mean().to_vec(), good.covariance().to_vec());
    let table = quantiles_of(&mean);
    let refused = |m: &[f64], c: &[f64], q: &[f64], word: &str| {
        let message = SexPrior::new(m, c, q).unwrap_err().to_string();
        assert!(message.contains(word), "{message}");
    };
    refused(&mean[1..], &covariance, &table, &MEASURE_COUNT.to_string());
    refused(&mean, &covariance[1..], &table, "1296");
    refused(&mean, &covariance, &[], "3636");
    let with = |data: &[f64], i: usize, v: f64| {
        let mut copy = data.to_vec();
        copy[i] = v;
        copy
    };
    refused(&with(&mean, 3, f64::NAN), &covariance, &table, "finite");
    refused(&mean, &with(&covariance, 1, 5.0), &table, "symmetric");
    refused(&mean, &with(&covariance, 37, -1.0), &table, "positive definite");
    refused(&mean, &with(&covariance, 0, 1e-9), &table, "positive definite");
    refused(&mean, &covariance, &with(&table, 5, 1e9), "waist_circumference");
    assert!(
        Prior::from_slices(&mean, &covariance, &table)
            .unwrap_err()
            .to_string()
            .contains(&format!("2 x {MEASURE_COUNT}"))
    );
    let twice = |v: &[f64]| [v, v].concat();
    Prior::from_slices(&twice(&mean), &twice(&covariance), &twice(&table)).unwrap();
    assert!(good.condition(&[Some(f64::NAN); MEASURE_COUNT]).is_err());
    assert!(good.project(good.mean(), f64::NAN).is_err());
}
