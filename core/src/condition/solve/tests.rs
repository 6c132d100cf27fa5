use proptest::prelude::*;

use super::*;
use crate::random::Random;

/// Measures with curvature and with kinks: m_i = a·c + cᵀ diag(q) c + Σ max over four linear forms, as a tape's hull
/// switches corners. Coefficients have standard deviations that fall from 1 to 0.01.
struct Synthetic {
    k: usize,
    linear: Vec<f64>,
    quadratic: Vec<f64>,
    corners: Vec<f64>,
}

impl Synthetic {
    fn new(k: usize, seed: u64) -> Self {
        let mut random = Random::new(seed, 77);
        let mut part =
            |scale: f64, count: usize| random.normals(count).iter().map(|x| scale * x).collect::<Vec<_>>();
        let linear = part(0.03, MEASURE_COUNT * k);
        let quadratic = part(0.001, MEASURE_COUNT * k);
        let corners = part(0.01, MEASURE_COUNT * 4 * k);
        Self { k, linear, quadratic, corners }
    }

    fn variances(&self) -> Vec<f64> {
        (0..self.k).map(|i| 1.0 / (1.0 + i as f64).powi(2)).collect()
    }

    fn random_coefficients(&self, seed: u64) -> Vec<f64> {
        let x = Random::new(seed, 78).normals(self.k);
        x.iter().zip(self.variances()).map(|(x, v)| x * v.sqrt()).collect()
    }
}

impl MeasuredShape for Synthetic {
    fn dim(&self) -> usize {
        self.k
    }

    fn measure(&self, c: &[f64], mut jacobian: Option<&mut [f64]>) -> Measurements {
        let k = self.k;
        let dot = |a: &[f64]| a.iter().zip(c).map(|(x, y)| x * y).sum::<f64>();
        std::array::from_fn(|i| {
            let (a, q) = (&self.linear[i * k..][..k], &self.quadratic[i * k..][..k]);
            let corners = self.corners[i * 4 * k..][..4 * k].chunks_exact(k);
            let top = corners.max_by(|x, y| dot(x).total_cmp(&dot(y))).unwrap();
            if let Some(jacobian) = jacobian.as_deref_mut() {
                for j in 0..k {
                    jacobian[i * k + j] = a[j] + 2.0 * q[j] * c[j] + top[j];
                }
            }
            1.0 + dot(a) + q.iter().zip(c).map(|(q, c)| q * c * c).sum::<f64>() + dot(top)
        })
    }
}

#[test]
fn the_synthetic_derivatives_are_derivatives() {
    let shape = Synthetic::new(12, 1);
    let c = shape.random_coefficients(2);
    let mut jacobian = vec![0.0; MEASURE_COUNT * 12];
    shape.measure(&c, Some(&mut jacobian));
    for j in 0..12 {
        let at = |h: f64| {
            let mut moved = c.clone();
            moved[j] += h;
            shape.measure(&moved, None)
        };
        let (plus, minus) = (at(1e-6), at(-1e-6));
        for i in 0..MEASURE_COUNT {
            // Central differences of a piecewise quadratic are exact up to rounding, 1e-16 / 1e-6.
            assert!(((plus[i] - minus[i]) / 2e-6 - jacobian[i * 12 + j]).abs() < 1e-8);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Another body's measures, any subset of them: the solve reaches them from anywhere.
    #[test]
    fn any_subset_of_measures_is_met(seed in 0..10_000u64, density in 0.0..=1.0f64) {
        let shape = Synthetic::new(120, seed % 7);
        let truth = shape.measure(&shape.random_coefficients(seed), None);
        let mut random = Random::new(seed, 4);
        let given = truth.map(|v| (random.uniform() < density).then_some(v));
        let start = shape.random_coefficients(seed + 1);
        let outcome = solve(&shape, &start, &shape.variances(), &given, &SolveOptions::default()).unwrap();
        prop_assert!(outcome.converged, "{} after {}", outcome.residual_max, outcome.iterations);
        prop_assert!(outcome.residual_max <= 1e-7);
        let again = shape.measure(&outcome.coefficients, None);
        prop_assert_eq!(again, outcome.obtained);
        for (asked, obtained) in given.iter().zip(&again) {
            prop_assert!(asked.is_none_or(|a| (a - obtained).abs() <= 1e-7));
        }
    }
}

#[test]
fn the_move_is_the_shortest() {
    // One smooth row: the shortest move in the metric is along Σ J, by hand.
    struct Line;
    impl MeasuredShape for Line {
        fn dim(&self) -> usize {
            3
        }
        fn measure(&self, c: &[f64], jacobian: Option<&mut [f64]>) -> Measurements {
            let mut m = [0.0; MEASURE_COUNT];
            m[3] = 2.0 * c[0] + c[1] + 5.0 * c[2];
            if let Some(j) = jacobian {
                j.fill(0.0);
                j[9..12].copy_from_slice(&[2.0, 1.0, 5.0]);
            }
            m
        }
    }
    let mut given = [None; MEASURE_COUNT];
    given[3] = Some(9.0);
    // Σ Jᵀ = (2, 4, 0), J Σ Jᵀ = 8: multiplier 9 / 8.
    let outcome = solve(&Line, &[0.0; 3], &[1.0, 4.0, 0.0], &given, &SolveOptions::default()).unwrap();
    for (c, expected) in outcome.coefficients.iter().zip([2.25, 4.5, 0.0]) {
        assert!((c - expected).abs() < 1e-12);
    }
    assert_eq!(outcome.iterations, 1);
    assert!((outcome.move_distance - 81.0f64.sqrt() / 8.0f64.sqrt()).abs() < 1e-12);
    // A measure that nothing moves is left alone, and said to be off.
    given[5] = Some(0.5);
    let outcome = solve(&Line, &[0.0; 3], &[1.0, 4.0, 0.0], &given, &SolveOptions::default()).unwrap();
    assert!(!outcome.converged && (outcome.residual_max - 0.5).abs() < 1e-12);
    assert!((outcome.obtained[3] - 9.0).abs() < 1e-7);
}

#[test]
fn contradictions_end_in_a_compromise() {
    /// Two rows that read the same thing.
    struct Twice;
    impl MeasuredShape for Twice {
        fn dim(&self) -> usize {
            2
        }
        fn measure(&self, c: &[f64], jacobian: Option<&mut [f64]>) -> Measurements {
            let mut m = [0.0; MEASURE_COUNT];
            (m[0], m[1]) = (c[0], c[0] + 1e-9 * c[1]);
            if let Some(j) = jacobian {
                j.fill(0.0);
                (j[0], j[2], j[3]) = (1.0, 1.0, 1e-9);
            }
            m
        }
    }
    let mut given = [None; MEASURE_COUNT];
    (given[0], given[1]) = (Some(1.0), Some(2.0));
    let outcome = solve(&Twice, &[0.0; 2], &[1.0; 2], &given, &SolveOptions::default()).unwrap();
    assert!(!outcome.converged && (outcome.residual_max - 0.5).abs() < 0.02, "{outcome:?}");
}

#[test]
fn nothing_given_changes_nothing() {
    let shape = Synthetic::new(5, 0);
    let start = shape.random_coefficients(1);
    let outcome =
        solve(&shape, &start, &shape.variances(), &[None; MEASURE_COUNT], &SolveOptions::default()).unwrap();
    assert_eq!((outcome.coefficients, outcome.iterations, outcome.converged), (start, 0, true));
}

#[test]
fn the_same_input_gives_the_same_bits() {
    let shape = Synthetic::new(60, 3);
    let given = shape.measure(&shape.random_coefficients(1), None).map(Some);
    let run = || {
        solve(&shape, &shape.random_coefficients(2), &shape.variances(), &given, &SolveOptions::default())
            .unwrap()
    };
    assert_eq!(run().coefficients, run().coefficients);
}

#[test]
fn bad_input_is_an_error_and_bad_shapes_do_not_panic() {
    let shape = Synthetic::new(3, 0);
    let run = |start: &[f64], variances: &[f64], value: f64| {
        solve(&shape, start, variances, &[Some(value); MEASURE_COUNT], &SolveOptions::default()).map(|_| ())
    };
    assert!(run(&[0.0; 2], &[1.0; 3], 1.0).is_err());
    assert!(run(&[0.0; 3], &[1.0; 4], 1.0).is_err());
    assert!(run(&[0.0, f64::NAN, 0.0], &[1.0; 3], 1.0).is_err());
    assert!(run(&[0.0; 3], &[1.0, -1.0, 1.0], 1.0).is_err());
    assert!(run(&[0.0; 3], &[1.0; 3], f64::NAN).is_err());
    // More measures than coefficients, absurd values, no freedom at all.
    run(&[0.0; 3], &[1.0; 3], 1e300).unwrap();
    run(&[0.0; 3], &[0.0; 3], 1.0).unwrap();
    run(&[0.0; 3], &[1e-300, 1e300, 1.0], 1.5).unwrap();

    /// Not a number as soon as it moves.
    struct Broken;
    impl MeasuredShape for Broken {
        fn dim(&self) -> usize {
            1
        }
        fn measure(&self, c: &[f64], jacobian: Option<&mut [f64]>) -> Measurements {
            if let Some(j) = jacobian {
                j.fill(1.0);
            }
            [if c[0] == 0.0 { 1.0 } else { f64::NAN }; MEASURE_COUNT]
        }
    }
    let outcome =
        solve(&Broken, &[0.0], &[1.0], &[Some(2.0); MEASURE_COUNT], &SolveOptions::default()).unwrap();
    assert!(!outcome.converged && outcome.coefficients == [0.0]);
    assert!(solve(&Broken, &[1.0], &[1.0], &[Some(2.0); MEASURE_COUNT], &SolveOptions::default()).is_err());
}
