//! Whether the given measures can belong to one person, and if not, which of them quarrel and what would do instead.
//!
//! The ruler is the Mahalanobis distance of the given measures from the prior's mean, each believed up to
//! [`JUDGING_ERROR`]. In that metric the nearest point of the feasible ellipsoid lies on the line to the mean, so it has a closed
//! form.

use super::chi_squared;
use super::error::JUDGING_ERROR;
use super::prior::{GivenMeasures, SexPrior};
use super::request::{group_by, groups};
use super::text::{list, metres};
use crate::Result;
use crate::error::{Conflict, ConflictMeasure, Infeasible};
use crate::measure::{MEASURE_COUNT, MeasureId, Sex};

/// Largest number of names (both sides of a measure count as one) that the search for a conflict goes through in
/// full; 24 names give 12,950 sets. Larger conflicts are found by leaving names out one by one.
const FULL_SEARCH: usize = 4;

/// Number of conflicts that are told apart. A request with more is wrong all over and is best moved as a whole.
const ROUNDS: usize = 3;

/// Names that a message spells out; of more, it tells those that move most.
const SPELT_OUT: usize = 6;

/// How often nearest values are pulled towards the mean, each time to [`PULL`] of their distance, before the mean itself is
/// taken: by then a sixtieth of the first distance is left.
const PULLS: usize = 39;
const PULL: f64 = 0.9;

/// How far inside the limit a nearest value is put, so that it is still feasible when rounded to the millimetre.
const NEAREST_SCALE: f64 = 0.98;

/// Where a request becomes unusual, and where it is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Standard deviation, metres, of the error with which given measures are believed; [`JUDGING_ERROR`].
    pub error: f64,
    /// Share of people farther out than the distance that draws a warning.
    pub warn_tail: f64,
    /// Share of people farther out than the distance that, times `slack`, is refused.
    pub refuse_tail: f64,
    /// The factor on that distance: real bodies have heavier tails than the Gaussian.
    pub slack: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { error: JUDGING_ERROR, warn_tail: 1e-3, refuse_tail: 1e-6, slack: 1.6 }
    }
}

impl Limits {
    /// The Mahalanobis distance of `count` measures beyond which a warning is due.
    pub fn warn(&self, count: usize) -> f64 {
        chi_squared::upper_quantile(self.warn_tail, count).sqrt()
    }

    /// The Mahalanobis distance of `count` measures beyond which they are refused.
    pub fn refuse(&self, count: usize) -> f64 {
        self.slack * chi_squared::upper_quantile(self.refuse_tail, count).sqrt()
    }
}

/// How plausible the given measures are.
#[derive(Clone, Debug)]
pub struct Feasibility {
    /// The sex that was assumed.
    pub sex: Sex,
    /// Number of given measures.
    pub count: usize,
    /// Mahalanobis distance from the mean; 0 when nothing is given.
    pub distance: f64,
    /// The distance beyond which a request is unusual.
    pub warn: f64,
    /// The distance beyond which a request is refused.
    pub refuse: f64,
    /// What quarrels; empty for a feasible request.
    pub conflicts: Vec<Conflict>,
    /// The given measures where they are feasible, else with the nearest values of all conflicts taken over: feasible.
    pub nearest: GivenMeasures,
}

impl Feasibility {
    /// Judges the given measures.
    ///
    /// # Errors
    /// [`crate::Error::Request`] for a measure that is not finite, [`crate::Error::Invalid`] for an error of theirs that
    /// is not positive.
    pub fn assess(prior: &SexPrior, sex: Sex, given: &GivenMeasures, limits: &Limits) -> Result<Self> {
        let count = given.iter().flatten().count();
        let distance = prior.distance_squared(given, limits.error)?.sqrt();
        let mut result = Self {
            sex,
            count,
            distance,
            warn: limits.warn(count),
            refuse: limits.refuse(count),
            conflicts: Vec::new(),
            nearest: *given,
        };
        // A distance that overflows counts as too far.
        if distance.is_nan() || distance > result.refuse {
            let search = Search::new(prior, given, limits)?;
            let sets = search.resolve(&mut result.nearest)?;
            let mut covered = Vec::new();
            for set in &sets {
                let (known, fresh): (Vec<usize>, Vec<usize>) = set.iter().partition(|i| covered.contains(*i));
                if !fresh.is_empty() {
                    result.conflicts.push(describe(&fresh, !known.is_empty(), given, &result.nearest, sex));
                }
                covered.extend(fresh);
            }
        }
        Ok(result)
    }

    /// Whether one person can have all the given measures.
    pub fn is_feasible(&self) -> bool {
        self.conflicts.is_empty()
    }

    /// A warning when the measures are feasible but rarer together than the limit.
    pub fn warning(&self) -> Option<String> {
        if !self.is_feasible() || self.distance <= self.warn {
            return None;
        }
        let share = chi_squared::survival(self.distance * self.distance, self.count);
        let rarity = if share < 1e-9 {
            "fewer than 1 in 1,000,000,000".to_owned()
        } else {
            // Two digits: more would claim knowledge of tails that nobody has.
            let one_in = 1.0 / share;
            let step = libm::pow(10.0, libm::floor(libm::log10(one_in)) - 1.0);
            format!("about 1 in {}", thousands((one_in / step).round() * step))
        };
        let sex = self.sex;
        Some(format!(
            "the given measures are unusual together: {rarity} {sex} bodies is so far from the average"
        ))
    }

    /// Why the request is refused; without conflicts for a feasible one.
    pub fn infeasible(&self) -> Infeasible {
        Infeasible { conflicts: self.conflicts.clone() }
    }
}

/// 1234567 as `1,234,567`.
fn thousands(value: f64) -> String {
    let digits = format!("{value:.0}");
    let mut text = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(c);
    }
    text
}

/// The search for conflicts among one request's measures.
struct Search<'a> {
    prior: &'a SexPrior,
    limits: &'a Limits,
    /// Indices of measures, one entry per name: both sides together where both are given.
    names: Vec<Vec<usize>>,
    /// Refusing distance per number of measures, 0 to all.
    refuse: Vec<f64>,
}

impl<'a> Search<'a> {
    fn new(prior: &'a SexPrior, given: &GivenMeasures, limits: &'a Limits) -> Result<Self> {
        let names = group_by(given, |_, _| true)
            .into_iter()
            .map(|group| group.ids.iter().map(|id| id.index()).collect())
            .collect();
        let refuse = (0..=MEASURE_COUNT).map(|n| limits.refuse(n)).collect();
        Ok(Self { prior, limits, names, refuse })
    }

    /// Replaces conflict after conflict by its nearest values until the whole is feasible; returns the conflicting
    /// sets of measures.
    fn resolve(&self, current: &mut GivenMeasures) -> Result<Vec<Vec<usize>>> {
        let mut sets = Vec::new();
        let everything: Vec<_> = self.names.iter().flatten().copied().collect();
        for _ in 0..ROUNDS {
            if self.excess(&everything, current)? <= 1.0 {
                return Ok(sets);
            }
            let set = self.smallest_conflict(current)?;
            self.pull_inside(&set, current)?;
            sets.push(set);
        }
        if self.excess(&everything, current)? > 1.0 {
            self.pull_inside(&everything, current)?;
            sets.push(everything);
        }
        Ok(sets)
    }

    /// Distance of these measures as a share of what is refused; above 1 they conflict.
    fn excess(&self, set: &[usize], values: &GivenMeasures) -> Result<f64> {
        let part = subset(values, set);
        let distance = self.prior.distance_squared(&part, self.limits.error)?.sqrt();
        let excess = distance / self.refuse[set.len().min(MEASURE_COUNT)];
        Ok(if excess.is_nan() { f64::INFINITY } else { excess })
    }

    /// The smallest set of names that conflicts by itself, the worst of that size.
    fn smallest_conflict(&self, values: &GivenMeasures) -> Result<Vec<usize>> {
        for size in 1..=FULL_SEARCH.min(self.names.len()) {
            let mut worst: Option<(f64, Vec<usize>)> = None;
            let mut choice: Vec<usize> = (0..size).collect();
            loop {
                let set: Vec<_> = choice.iter().flat_map(|i| self.names[*i].iter().copied()).collect();
                let excess = self.excess(&set, values)?;
                if excess > 1.0 && worst.as_ref().is_none_or(|(most, _)| excess > *most) {
                    worst = Some((excess, set));
                }
                if !next_combination(&mut choice, self.names.len()) {
                    break;
                }
            }
            if let Some((_, set)) = worst {
                return Ok(set);
            }
        }
        self.leave_out(values)
    }

    /// A conflicting set that stops conflicting whichever name is left out, by leaving out greedily.
    fn leave_out(&self, values: &GivenMeasures) -> Result<Vec<usize>> {
        let mut kept: Vec<usize> = (0..self.names.len()).collect();
        let flatten =
            |kept: &[usize]| kept.iter().flat_map(|i| self.names[*i].iter().copied()).collect::<Vec<_>>();
        loop {
            let mut best: Option<(f64, Vec<usize>)> = None;
            for leave in 0..kept.len() {
                let mut rest = kept.clone();
                rest.remove(leave);
                let excess = self.excess(&flatten(&rest), values)?;
                if excess > 1.0 && best.as_ref().is_none_or(|(most, _)| excess > *most) {
                    best = Some((excess, rest));
                }
            }
            match best {
                Some((_, rest)) => kept = rest,
                None => return Ok(flatten(&kept)),
            }
        }
    }

    /// Moves these measures along the line to their mean until they are feasible, in whole millimetres; both sides of
    /// a measure that were equal stay equal.
    fn pull_inside(&self, set: &[usize], values: &mut GivenMeasures) -> Result<()> {
        let start = *values;
        let mean = self.prior.mean();
        let excess = self.excess(set, values)?;
        let mut scale = if excess.is_finite() { NEAREST_SCALE / excess.max(1.0) } else { 0.0 };
        for attempt in 0..=PULLS {
            if attempt == PULLS {
                scale = 0.0;
            }
            for &i in set {
                let asked = start[i].unwrap_or(mean[i]);
                let moved = if scale == 0.0 { mean[i] } else { mean[i] + scale * (asked - mean[i]) };
                values[i] = Some(moved);
            }
            for &i in set {
                if let Some(mirror) = MeasureId::from_index(i).map(|id| id.mirrored().index())
                    && mirror > i
                    && set.contains(&mirror)
                    && start[i] == start[mirror]
                {
                    let middle = 0.5 * (values[i].unwrap_or(mean[i]) + values[mirror].unwrap_or(mean[i]));
                    values[i] = Some(middle);
                    values[mirror] = Some(middle);
                }
            }
            for &i in set {
                values[i] = values[i].map(|v| (v * 1000.0).round() / 1000.0);
            }
            // Rounding and averaging can cost what the margin does not hold when the limits are very tight.
            if self.excess(set, values)? <= 1.0 {
                return Ok(());
            }
            scale *= PULL;
        }
        for &i in set {
            values[i] = Some(mean[i]);
        }
        Ok(())
    }
}

/// The entries of `set` alone.
fn subset(values: &GivenMeasures, set: &[usize]) -> GivenMeasures {
    let mut part = [None; MEASURE_COUNT];
    for &i in set {
        part[i] = values[i];
    }
    part
}

/// The next combination of `choice.len()` out of `n` in lexicographic order; false after the last.
fn next_combination(choice: &mut [usize], n: usize) -> bool {
    let size = choice.len();
    for place in (0..size).rev() {
        if choice[place] + (size - place) < n {
            choice[place] += 1;
            for later in place + 1..size {
                choice[later] = choice[later - 1] + 1;
            }
            return true;
        }
    }
    false
}

/// The conflict in words. `beside` says that the set conflicts only together with measures of earlier conflicts.
fn describe(
    set: &[usize],
    beside: bool,
    asked: &GivenMeasures,
    nearest: &GivenMeasures,
    sex: Sex,
) -> Conflict {
    let given = subset(asked, set);
    let measures = MeasureId::all()
        .filter_map(|id| {
            let (asked, nearest) = (given[id.index()]?, nearest[id.index()]?);
            Some(ConflictMeasure { name: id.name(), asked, nearest })
        })
        .collect();
    let mut moves: Vec<(String, f64, f64)> = groups(&given)
        .into_iter()
        .map(|group| {
            let value =
                |of: &GivenMeasures| group.ids.first().and_then(|id| of[id.index()]).unwrap_or(f64::NAN);
            (group.name, value(&given), value(nearest))
        })
        .collect();
    let count = moves.len();
    if count > SPELT_OUT {
        let share = |m: &(String, f64, f64)| (m.2 - m.1).abs() / m.1.abs().max(f64::MIN_POSITIVE);
        moves.sort_by(|a, b| share(b).total_cmp(&share(a)));
        moves.truncate(3);
    }
    let asked_text =
        list(&moves.iter().map(|m| format!("{} {} m", m.0, metres(m.1))).collect::<Vec<_>>(), "and");
    let nearest_text = list(&moves.iter().map(|m| format!("{} m", metres(m.2))).collect::<Vec<_>>(), "and");
    let message = if count > SPELT_OUT {
        format!(
            "{count} measures do not go together for a {sex}, most of all {asked_text}: nearest feasible are {nearest_text}"
        )
    } else {
        let verb = match (beside, count) {
            (true, 1) => "does not fit beside these",
            (true, _) => "do not fit beside these",
            (false, 1) => "is out of reach",
            (false, _) => "do not go together",
        };
        let is = if count == 1 { "is" } else { "are" };
        format!("{asked_text} {verb} for a {sex}: nearest feasible {is} {nearest_text}")
    };
    Conflict { measures, message }
}

#[cfg(test)]
mod tests;
