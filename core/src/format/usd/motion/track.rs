//! A time-sampled array attribute.

use glam::{DQuat, DVec4};
use openusd::sdf::{Path, Value};

use crate::error::{Fault, Within};
use crate::format::usd::Result;
use crate::format::usd::document::layer::Layer;
use crate::format::usd::document::values;

/// One row of `N` components per joint or blend shape.
type Rows<const N: usize> = Vec<[f64; N]>;

/// Samples of scalars (`N` = 1), vectors (`N` = 3) or quaternions w, x, y, z (`N` = 4), one per joint or blend shape.
pub(super) struct Track<const N: usize> {
    /// Sorted by time; a constant is one sample at time 0; empty without a value.
    samples: Vec<(f64, Rows<N>)>,
    animated: bool,
}

impl<const N: usize> Track<N> {
    /// Reads an attribute with a value for each of `count` joints or blend shapes, or with no value at all.
    pub(super) fn read(layer: &Layer, prim: &Path, attribute: &str, count: usize) -> Result<Self> {
        let rows = |value: &Value| {
            let rows = values::rows::<N>(value)
                .ok_or_else(|| Fault::unexpected("numbers, vectors or quaternions", "another type"))?;
            if rows.len() != count {
                let expected = format!("{count} values, one per joint");
                return Err(Fault::unexpected(expected, rows.len()).into());
            }
            if let Some(joint) = rows.iter().position(|row| !row.iter().all(|n| n.is_finite())) {
                let value = format!("value {joint}");
                return Err(Fault::not_finite(value, format_args!("{:?}", rows[joint])).into());
            }
            Result::Ok(rows)
        };
        let mut samples = Vec::new();
        for (time, value) in layer.samples(prim, attribute)? {
            let rows = rows(&value).within(format_args!("{prim}.{attribute} at time code {time}"))?;
            samples.push((time, rows));
        }
        let animated = !samples.is_empty();
        if let (false, Some(value)) = (animated, layer.default(prim, attribute)?) {
            // Some programs write an empty array instead of omitting the attribute.
            if values::numbers(&value).is_none_or(|n| !n.is_empty()) {
                samples.push((0.0, rows(&value).within(format_args!("{prim}.{attribute}"))?));
            }
        }
        Ok(Self { samples, animated })
    }

    /// A track without any value.
    pub(super) fn none() -> Self {
        Self { samples: Vec::new(), animated: false }
    }

    /// Whether there is any value.
    pub(super) fn has_values(&self) -> bool {
        !self.samples.is_empty()
    }

    /// Time codes of the samples; empty for a constant.
    pub(super) fn times(&self) -> Vec<f64> {
        if self.animated { self.samples.iter().map(|s| s.0).collect() } else { Vec::new() }
    }

    /// The values at a time code: linear between samples, quaternions along the shorter arc, as in USD. Empty without any
    /// value.
    pub(super) fn at(&self, time: f64) -> Rows<N> {
        let after = self.samples.partition_point(|sample| sample.0 <= time);
        let before = after.saturating_sub(1);
        let (Some(a), b) = (self.samples.get(before), self.samples.get(after)) else { return Vec::new() };
        let Some(b) = b else { return a.1.clone() };
        let share = (time - a.0) / (b.0 - a.0);
        // The time of a sample is hit only up to rounding.
        match share {
            ..1e-6 => a.1.clone(),
            0.999_999.. => b.1.clone(),
            _ => a.1.iter().zip(&b.1).map(|(a, b)| between(a, b, share)).collect(),
        }
    }
}

fn between<const N: usize>(a: &[f64; N], b: &[f64; N], share: f64) -> [f64; N] {
    let mut out: [f64; N] = std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share);
    if let (Ok(a), Ok(b)) = (<[f64; 4]>::try_from(a.as_slice()), <[f64; 4]>::try_from(b.as_slice())) {
        let [a, b] = [a, b].map(|q| DVec4::from_array(q).normalize_or(DVec4::X));
        // Slerp does not depend on the order of the components.
        let turned = DQuat::from_vec4(a).slerp(DQuat::from_vec4(b), share);
        out.copy_from_slice(&turned.to_array()[..N.min(4)]);
    }
    out
}

/// All times, sorted and without duplicates.
pub(super) fn merged(times: impl Iterator<Item = Vec<f64>>) -> Vec<f64> {
    let mut times: Vec<f64> = times.flatten().collect();
    times.sort_by(f64::total_cmp);
    // The key times of two attributes may differ by rounding.
    times.dedup_by(|later, earlier| *later - *earlier < 1e-6);
    times
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quaternions_take_the_shorter_arc() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let turned = between(&[1.0, 0.0, 0.0, 0.0], &[-half, -half, 0.0, 0.0], 0.5);
        let eighth = std::f64::consts::FRAC_PI_8;
        assert!((turned[0].abs() - libm::cos(eighth)).abs() < 1e-12, "{turned:?}");
        assert!((turned[0] * turned[1] - libm::cos(eighth) * libm::sin(eighth)).abs() < 1e-12);
    }

    #[test]
    fn values_between_before_and_after_samples() {
        let track =
            Track::<3> { samples: vec![(1.0, vec![[0.0; 3]]), (3.0, vec![[2.0, 4.0, 6.0]])], animated: true };
        assert_eq!(track.at(0.0), [[0.0; 3]]);
        assert_eq!(track.at(1.5), [[0.5, 1.0, 1.5]]);
        assert_eq!(track.at(3.0), track.at(9.0));
        assert_eq!(merged([vec![1.0, 2.0], vec![0.5, 1.0 + 1e-9]].into_iter()), [0.5, 1.0, 2.0]);
    }
}
