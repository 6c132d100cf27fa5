//! A synthetic population for tests: two factors (size, girth) plus independent residuals, both sexes, no model file.

use super::prior::{Prior, Priors, QUANTILE_COUNT, SexPrior};
use super::request::MeasureRange;
use crate::measure::{MEASURE_COUNT, MeasureId, Measurements};

/// By name without side: mean of women's measures, and the standard deviations due to size, girth and the residual, metres.
const TABLE: &[(&str, f64, f64, f64, f64)] = &[
    ("waist_circumference", 0.80, 0.02, 0.13, 0.020),
    ("chest_circumference", 1.00, 0.03, 0.10, 0.025),
    ("hip_circumference", 0.98, 0.03, 0.09, 0.020),
    ("height", 1.69, 0.09, 0.0, 0.020),
    ("shoulder_width", 0.29, 0.015, 0.01, 0.008),
    ("torso_height_back", 0.37, 0.02, 0.0, 0.010),
    ("torso_height_front", 0.32, 0.02, 0.0, 0.010),
    ("head_circumference", 0.54, 0.008, 0.002, 0.008),
    ("neck_circumference", 0.40, 0.01, 0.03, 0.010),
    ("head_height", 0.24, 0.006, 0.0, 0.006),
    ("neck_length_midline", 0.09, 0.004, 0.0, 0.006),
    ("neck_length_lateral", 0.11, 0.005, 0.0, 0.006),
    ("hand_size", 0.17, 0.009, 0.0, 0.003),
    ("arm_circumference", 0.28, 0.0, 0.04, 0.010),
    ("arm_length", 0.32, 0.02, 0.0, 0.008),
    ("forearm_circumference", 0.25, 0.0, 0.025, 0.008),
    ("forearm_length", 0.25, 0.015, 0.0, 0.006),
    ("thigh_circumference", 0.55, 0.01, 0.06, 0.012),
    ("thigh_length", 0.50, 0.035, 0.0, 0.012),
    ("calf_circumference", 0.35, 0.006, 0.03, 0.008),
    ("calf_length", 0.42, 0.03, 0.0, 0.010),
    ("foot_width", 0.095, 0.006, 0.002, 0.003),
    ("heel_to_ball_length", 0.18, 0.011, 0.0, 0.003),
    ("heel_to_toe_length", 0.25, 0.015, 0.0, 0.004),
];

fn entry(id: MeasureId) -> (usize, (&'static str, f64, f64, f64, f64)) {
    TABLE.iter().copied().enumerate().find(|(_, row)| row.0 == id.base_name()).unwrap()
}

/// The prior of one sex; `size` and `girth` shift the mean by that many deviations of the two factors.
pub(crate) fn sex_prior(size: f64, girth: f64) -> SexPrior {
    let n = MEASURE_COUNT;
    let mean: Measurements = std::array::from_fn(|i| {
        let (_, (_, mean, s, g, _)) = entry(MeasureId::from_index(i).unwrap());
        mean + size * s + girth * g
    });
    let mut covariance = vec![0.0; n * n];
    for a in MeasureId::all() {
        for b in MeasureId::all() {
            let ((ka, (_, _, sa, ga, ra)), (kb, (_, _, sb, gb, rb))) = (entry(a), entry(b));
            // Both sides share 99 % of the variance of the residual.
            let rest = if a == b { 1.0 } else { 0.99 * f64::from(u8::from(ka == kb)) };
            covariance[a.index() * n + b.index()] = sa * sb + ga * gb + rest * ra * rb;
        }
    }
    let mut quantiles = Vec::new();
    for i in 0..n {
        let deviation = covariance[i * n + i].sqrt();
        // Any ascending table serves; 50 % is the mean.
        quantiles.extend((0..QUANTILE_COUNT).map(|q| mean[i] + 3.0 * deviation * (q as f64 - 50.0) / 50.0));
    }
    SexPrior::new(&mean, &covariance, &quantiles).unwrap()
}

/// Women, and men larger by one and a half deviations of size.
pub(crate) fn prior() -> Prior {
    Prior::new(sex_prior(0.0, 0.0), sex_prior(1.5, 0.0))
}

/// The same as people's and as bodies' prior.
pub(crate) fn priors() -> Priors {
    Priors::new([prior(), prior()])
}

/// Ranges of ± six standard deviations in whole centimetres, none below one.
pub(crate) fn ranges() -> [MeasureRange; MEASURE_COUNT] {
    let prior = sex_prior(0.7, 0.0);
    std::array::from_fn(|i| {
        let (mean, spread) = (prior.mean()[i], 6.0 * prior.covariance()[i * (MEASURE_COUNT + 1)].sqrt());
        let centimetre = |v: f64| (100.0 * v).round() / 100.0;
        MeasureRange { min: centimetre(mean - spread).max(0.01), max: centimetre(mean + spread) }
    })
}
