//! Whether the given measures can belong to one person, and if not, which of them conflict and which values are nearest.
//!
//! People's prior warns; what is refused is beyond the limit of that prior and of the trained bodies' too. The criterion is the
//! Mahalanobis distance of the given measures from a prior's mean, with [`FEASIBILITY_NOISE`] added
//! to the covariance. In that metric the point of the feasible ellipsoid nearest to the given measures lies on the line to
//! the mean, so it has a closed form.

use super::chi_squared;
use super::error::FEASIBILITY_NOISE;
use super::prior::{GivenMeasures, Population, SexPrior};
use super::request::{group_by, groups};
use super::text::{list, metres};
use crate::Result;
use crate::error::{Conflict, ConflictMeasure, Infeasible};
use crate::measure::{MEASURE_COUNT, MeasureId, Sex};

/// Largest conflicts, in names (both sides of a measure count as one), that an exhaustive search looks for; 24 names give
/// 12,950 sets. Larger conflicts are found by removing names one by one.
const FULL_SEARCH: usize = 4;

/// Number of conflicts that are resolved one by one; a request with more is then corrected as a whole.
const MAX_CONFLICTS: usize = 3;

/// Most names that a message lists in full; of more, it lists the three that change most.
const MAX_LISTED: usize = 6;

/// How often nearest values are moved towards the mean, each time by the factor [`SHRINK`] on their distance, before the
/// mean itself is taken; a sixtieth of the first distance is left by then.
const MAX_SHRINKS: usize = 39;
const SHRINK: f64 = 0.9;

/// Distance of nearest values as a share of the limit: inside it, so that they are still feasible when rounded to
/// millimetres.
const NEAREST_SCALE: f64 = 0.98;

/// Where a request becomes unusual, and where it is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Standard deviation of the noise of given measures, metres; [`FEASIBILITY_NOISE`].
    pub noise: f64,
    /// Share of people, under the Gaussian, beyond the distance that gives a warning.
    pub warn_tail: f64,
    /// Share of people, under the Gaussian, beyond the distance that, times `slack`, is the limit of feasibility.
    pub refuse_tail: f64,
    /// Factor on that distance: real bodies have heavier tails than the Gaussian.
    pub slack: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { noise: FEASIBILITY_NOISE, warn_tail: 1e-3, refuse_tail: 1e-6, slack: 1.6 }
    }
}

impl Limits {
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
    /// Whose distance warns.
    pub population: Population,
    /// Number of given measures.
    pub count: usize,
    /// Mahalanobis distance from that population's mean; 0 when nothing is given.
    pub distance: f64,
    /// Share of that population, under the Gaussian, that is as far from its mean.
    pub share_beyond: f64,
    /// The share below which a request is unusual.
    pub warn_tail: f64,
    /// The distance beyond which a request is refused, from the mean of every prior.
    pub refuse: f64,
    /// The conflicts; empty for a feasible request.
    pub conflicts: Vec<Conflict>,
    /// The given measures, with the nearest feasible values in the place of conflicting ones; always feasible.
    pub nearest: GivenMeasures,
}

impl Feasibility {
    /// Judges the given measures (metres) of a person of this sex, by priors of that sex: the first, of `population`, warns, and
    /// what is beyond the limit of all of them is infeasible.
    ///
    /// # Errors
    /// As [`SexPrior::project`], with `limits.noise`.
    pub fn assess(
        priors: [&SexPrior; 2],
        population: Population,
        sex: Sex,
        given: &GivenMeasures,
        limits: &Limits,
    ) -> Result<Self> {
        let count = given.iter().flatten().count();
        let distances = [
            priors[0].distance_squared(given, limits.noise)?.sqrt(),
            priors[1].distance_squared(given, limits.noise)?.sqrt(),
        ];
        let distance = distances[0];
        let mut result = Self {
            sex,
            population,
            count,
            distance,
            share_beyond: priors[0].share_beyond(given, limits.noise)?,
            warn_tail: limits.warn_tail,
            refuse: limits.refuse(count),
            conflicts: Vec::new(),
            nearest: *given,
        };
        // An overflow counts as infeasible.
        if distances.iter().all(|distance| distance.is_nan() || *distance > result.refuse) {
            let search = Search::new(priors, given, limits)?;
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

    /// A warning when the measures are feasible, but fewer people than [`warn_tail`](Self::warn_tail) have such.
    pub fn warning(&self) -> Option<String> {
        if !self.is_feasible() || self.share_beyond >= self.warn_tail {
            return None;
        }
        let share = self.share_beyond;
        let rarity = if share < 1e-9 {
            "fewer than 1 in 1,000,000,000".to_owned()
        } else {
            // Two significant digits: the tails are not known better.
            let one_in = 1.0 / share;
            let step = libm::pow(10.0, libm::floor(libm::log10(one_in)) - 1.0);
            format!("about 1 in {}", thousands((one_in / step).round() * step))
        };
        let (sex, members) = (self.sex, self.population.members());
        Some(format!(
            "the given measures are unusual together: {rarity} {sex} {members} is so far from their average"
        ))
    }

    /// The reason to refuse the request; without conflicts for a feasible one.
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
    priors: [&'a SexPrior; 2],
    limits: &'a Limits,
    /// Indices of measures, one entry per name: both sides together where both are given.
    names: Vec<Vec<usize>>,
    /// Limit of feasibility per number of measures, from 0 to all.
    refuse: Vec<f64>,
}

impl<'a> Search<'a> {
    fn new(priors: [&'a SexPrior; 2], given: &GivenMeasures, limits: &'a Limits) -> Result<Self> {
        let names = group_by(given, |_, _| true)
            .into_iter()
            .map(|group| group.ids.iter().map(|id| id.index()).collect())
            .collect();
        let refuse = (0..=MEASURE_COUNT).map(|n| limits.refuse(n)).collect();
        Ok(Self { priors, limits, names, refuse })
    }

    /// Replaces one conflict after another by its nearest values until all measures together are feasible; returns the
    /// conflicting sets of measures.
    fn resolve(&self, current: &mut GivenMeasures) -> Result<Vec<Vec<usize>>> {
        let mut sets = Vec::new();
        let everything: Vec<_> = self.names.iter().flatten().copied().collect();
        for _ in 0..MAX_CONFLICTS {
            if self.excess(&everything, current)? <= 1.0 {
                return Ok(sets);
            }
            let set = self.smallest_conflict(current)?;
            self.make_feasible(&set, current)?;
            sets.push(set);
        }
        if self.excess(&everything, current)? > 1.0 {
            self.make_feasible(&everything, current)?;
            sets.push(everything);
        }
        Ok(sets)
    }

    /// Distance of these measures as a share of the limit of feasibility; above 1 they conflict.
    fn excess(&self, set: &[usize], values: &GivenMeasures) -> Result<f64> {
        Ok(self.nearer(set, values)?.1)
    }

    /// The prior that these measures are nearer to, and the distance from it as a share of the limit.
    fn nearer(&self, set: &[usize], values: &GivenMeasures) -> Result<(&'a SexPrior, f64)> {
        let part = subset(values, set);
        let of = |prior: &'a SexPrior| -> Result<(&'a SexPrior, f64)> {
            let distance = prior.distance_squared(&part, self.limits.noise)?.sqrt();
            let excess = distance / self.refuse[set.len().min(MEASURE_COUNT)];
            Ok((prior, if excess.is_nan() { f64::INFINITY } else { excess }))
        };
        let [people, bodies] = self.priors.map(of);
        let (people, bodies) = (people?, bodies?);
        Ok(if bodies.1 < people.1 { bodies } else { people })
    }

    /// A conflicting set of the fewest names possible, the worst of that size; larger than [`FULL_SEARCH`], a minimal one.
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
        self.minimal_conflict(values)
    }

    /// A conflicting set that is feasible without any one of its names, found by greedy removal.
    fn minimal_conflict(&self, values: &GivenMeasures) -> Result<Vec<usize>> {
        let mut kept: Vec<usize> = (0..self.names.len()).collect();
        let flatten =
            |kept: &[usize]| kept.iter().flat_map(|i| self.names[*i].iter().copied()).collect::<Vec<_>>();
        loop {
            let mut best: Option<(f64, Vec<usize>)> = None;
            for removed in 0..kept.len() {
                let mut rest = kept.clone();
                rest.remove(removed);
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

    /// Moves these measures along the line to their mean until they are feasible, in whole millimetres; equal values of both
    /// sides stay equal.
    fn make_feasible(&self, set: &[usize], values: &mut GivenMeasures) -> Result<()> {
        let start = *values;
        let (prior, excess) = self.nearer(set, values)?;
        let mean = prior.mean();
        let mut scale = if excess.is_finite() { NEAREST_SCALE / excess.max(1.0) } else { 0.0 };
        for attempt in 0..=MAX_SHRINKS {
            if attempt == MAX_SHRINKS {
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
            // Rounding and averaging can exceed the margin when the limits are very tight.
            if self.excess(set, values)? <= 1.0 {
                return Ok(());
            }
            scale *= SHRINK;
        }
        for &i in set {
            values[i] = Some(mean[i]);
        }
        Ok(())
    }
}

/// The entries of `set` only.
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

/// A [`Conflict`] with its message. `beside`: the set conflicts only together with the nearest values of earlier conflicts.
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
    if count > MAX_LISTED {
        let share = |m: &(String, f64, f64)| (m.2 - m.1).abs() / m.1.abs().max(f64::MIN_POSITIVE);
        moves.sort_by(|a, b| share(b).total_cmp(&share(a)));
        moves.truncate(3);
    }
    let asked_text =
        list(&moves.iter().map(|m| format!("{} {} m", m.0, metres(m.1))).collect::<Vec<_>>(), "and");
    let nearest_text = list(&moves.iter().map(|m| format!("{} m", metres(m.2))).collect::<Vec<_>>(), "and");
    let message = if count > MAX_LISTED {
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
