//! Synthetic bodies: coefficients with a decaying spectrum, mixed linearly and quadratically from random traits, and
//! measures that depend on some of them. For tests and for timing, without the real data.

use anthronet::measure::MEASURE_COUNT;
use anthronet::random::Random;

use super::TrainingSet;

/// Random traits per body.
const TRAITS: usize = 80;

/// A set of `count` bodies with `k` coefficients. The laws of the bodies are the same for every seed.
pub fn synthetic_set(count: usize, k: usize, seed: u64) -> TrainingSet {
    let mut laws = Random::new(99, 0);
    let mut draw = |n: usize, scale: f64| (0..n).map(|_| laws.normal() * scale).collect::<Vec<f64>>();
    let linear = draw(k * TRAITS, 1.0);
    let quadratic = draw(k * 40, 0.25);
    let pairs: Vec<(usize, usize)> = (0..40).map(|i| (i % 9, (i * 7 + 3) % TRAITS)).collect();
    let seen = draw(MEASURE_COUNT * 60, 1.0);
    let bent = draw(MEASURE_COUNT * 6, 0.15);
    let mut rng = Random::new(seed, 1);
    let mut set = TrainingSet { count, k, coefficients: Vec::new(), measures: Vec::new(), sex: Vec::new() };
    for _ in 0..count {
        let sex = u32::from(rng.uniform() < 0.5);
        // Few strong traits, many weak ones.
        let mut traits: Vec<f64> = (0..TRAITS).map(|i| rng.normal() / (1.0 + 0.25 * i as f64)).collect();
        traits[0] += f64::from(sex) - 0.5;
        for c in 0..k {
            let scale = 8.0 / (1.0 + c as f64).powf(1.3);
            let flat: f64 = traits.iter().zip(&linear[c * TRAITS..]).map(|(t, w)| t * w).sum();
            let bend: f64 =
                pairs.iter().zip(&quadratic[c * 40..]).map(|(&(a, b), w)| traits[a] * traits[b] * w).sum();
            set.coefficients.push((scale * (flat + bend)) as f32);
        }
        for m in 0..MEASURE_COUNT {
            let flat: f64 = traits.iter().zip(&seen[m * 60..(m + 1) * 60]).map(|(t, w)| t * w).sum();
            let bend: f64 = traits.iter().zip(&bent[m * 6..(m + 1) * 6]).map(|(t, w)| t * t * w).sum();
            set.measures.push((0.8 + 0.04 * (flat + bend)) as f32);
        }
        set.sex.push(sex as u8);
    }
    set
}
