//! The request: any subset of the measures, a sex, a seed or a latent vector; parsing, checks, writing.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use super::prior::{GivenMeasures, Population};
use super::text::{list, metres};
use crate::measure::{MEASURE_COUNT, MeasureId, Sex, expand_name};
use crate::random::Random;
use crate::{Error, Result, Side};

/// The stream of [`Random`] that a latent vector is drawn from.
const LATENT_STREAM: u64 = 1;

/// Largest absolute value of an entry of a given latent vector: entries are standard normal, and six deviations occur in
/// nobody.
pub const LATENT_LIMIT: f64 = 6.0;

/// How measures that a request leaves open are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Fill {
    /// With their likeliest values, conditioned on the given measures.
    #[default]
    Mean,
    /// With a draw from their distribution, conditioned on the given measures; the seed chooses it.
    Sample,
}

impl Fill {
    /// All variants.
    pub const ALL: [Self; 2] = [Self::Mean, Self::Sample];

    /// `mean` or `sample`, as in JSON and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mean => "mean",
            Self::Sample => "sample",
        }
    }
}

impl FromStr for Fill {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL
            .into_iter()
            .find(|fill| fill.name() == text)
            .ok_or_else(|| Error::request("fill", format!("expected mean or sample, got `{text}`")))
    }
}

/// The values that a measure may take, metres, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasureRange {
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
}

/// What a body is generated from.
///
/// The same request gives the same body. The default gives nothing: the likeliest woman.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// The sex; `None` to infer it from the given measures.
    pub sex: Option<Sex>,
    /// The given measures in metres, in the order of [`MeasureId`]; `None` where one is left open.
    pub measures: GivenMeasures,
    /// 0 for the likeliest person; any other number for a random one with the given measures.
    pub seed: u64,
    /// The latent vector, to be used instead of one drawn from the seed. Its entries are standard normal over people, and at
    /// most [`LATENT_LIMIT`] in absolute value.
    pub z: Option<Vec<f64>>,
    /// How open measures are filled.
    pub fill: Fill,
    /// Whose prior fills them, and judges what is unusual.
    pub population: Population,
    /// Whether to replace an infeasible request by the nearest feasible one, with a warning, instead of refusing it.
    pub nearest: bool,
}

/// The JSON format; names of measures are checked afterwards, so that errors can suggest the nearest one.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RequestFile {
    #[serde(default)]
    sex: Option<String>,
    #[serde(default)]
    measures: Pairs,
    #[serde(default)]
    seed: u64,
    #[serde(default)]
    z: Option<Vec<f64>>,
    #[serde(default)]
    fill: Fill,
    #[serde(default)]
    population: Population,
    #[serde(default)]
    nearest: bool,
}

/// A JSON object without duplicate keys, sorted by key: `arm_length` comes before `arm_length_left`, which overrides it.
#[derive(Default)]
struct Pairs(BTreeMap<String, Value>);

impl<'de> Deserialize<'de> for Pairs {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        struct PairsVisitor;
        impl<'de> Visitor<'de> for PairsVisitor {
            type Value = Pairs;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object of measures, such as {\"height\": 1.7}")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> std::result::Result<Pairs, A::Error> {
                let mut pairs = BTreeMap::new();
                while let Some((name, value)) = map.next_entry::<String, Value>()? {
                    if pairs.contains_key(&name) {
                        return Err(de::Error::custom(format!("measure `{name}` is given twice")));
                    }
                    pairs.insert(name, value);
                }
                Ok(Pairs(pairs))
            }
        }
        deserializer.deserialize_map(PairsVisitor)
    }
}

impl Default for Request {
    fn default() -> Self {
        Self {
            sex: None,
            measures: [None; MEASURE_COUNT],
            seed: 0,
            z: None,
            fill: Fill::Mean,
            population: Population::default(),
            nearest: false,
        }
    }
}

impl Request {
    /// Parses JSON such as `{"sex": "female", "measures": {"height": 1.70, "arm_length": 0.33}, "seed": 7}`.
    ///
    /// All fields are optional: `sex`, `measures`, `seed`, `z` (numbers), `fill` (`"mean"` or `"sample"`),
    /// `population` (`"ansur2"` or `"synthetic"`), `nearest`.
    /// A measure without its side sets both sides, and one with its side overrides that, in any order. `null` is the same
    /// as leaving a measure out.
    ///
    /// # Errors
    /// [`Error::Request`] naming the field, or line and column where the text is not such JSON. Values are checked by
    /// [`Request::check`] only.
    pub fn from_json(text: &str) -> Result<Self> {
        let text = crate::text::without_mark(text);
        // A derived deserializer also accepts an array of the fields in order.
        if !text.trim_start().starts_with('{') {
            let message =
                "expected a JSON object such as {\"sex\": \"female\", \"measures\": {\"height\": 1.7}}";
            return Err(Error::request("request", message));
        }
        let file: RequestFile =
            serde_json::from_str(text).map_err(|e| Error::request("request", e.to_string()))?;
        let mut request = Self {
            sex: file.sex.map(|s| s.parse()).transpose()?,
            seed: file.seed,
            z: file.z,
            fill: file.fill,
            population: file.population,
            nearest: file.nearest,
            ..Self::default()
        };
        for (name, value) in file.measures.0 {
            match value {
                Value::Null => {
                    known(&name)?;
                }
                Value::Number(number) if number.as_f64().is_some() => {
                    request.set(&name, number.as_f64().unwrap_or(f64::NAN))?;
                }
                other => {
                    known(&name)?;
                    return Err(Error::request(name, format!("expected a number of metres, got {other}")));
                }
            }
        }
        Ok(request)
    }

    /// Writes the JSON that [`Request::from_json`] reads; two sides of equal value become one name.
    ///
    /// Values that are not finite, which [`Request::check`] refuses, are written as `null`.
    pub fn to_json(&self) -> String {
        let measures: serde_json::Map<_, _> = groups(&self.measures)
            .into_iter()
            .map(|group| (group.name, self.measures[group.ids[0].index()].into()))
            .collect();
        let mut object = serde_json::Map::new();
        if let Some(sex) = self.sex {
            object.insert("sex".into(), sex.name().into());
        }
        object.insert("measures".into(), measures.into());
        object.insert("seed".into(), self.seed.into());
        if let Some(z) = &self.z {
            object.insert("z".into(), z.clone().into());
        }
        object.insert("fill".into(), self.fill.name().into());
        object.insert("population".into(), self.population.name().into());
        object.insert("nearest".into(), self.nearest.into());
        Value::from(object).to_string()
    }

    /// Sets a measure to a value in metres; a name without its side sets both sides.
    ///
    /// # Errors
    /// [`Error::Request`] for an unknown name, with the nearest ones. The value is checked by [`Request::check`] only.
    pub fn set(&mut self, name: &str, value: f64) -> Result<()> {
        for id in known(name)? {
            self.measures[id.index()] = Some(value);
        }
        Ok(())
    }

    /// [`Request::set`] for chains: `Request::default().with("height", 1.7)?.with("arm_length", 0.33)?`.
    ///
    /// # Errors
    /// As [`Request::set`].
    pub fn with(mut self, name: &str, value: f64) -> Result<Self> {
        self.set(name, value)?;
        Ok(self)
    }

    /// The given measures with their values in metres, in order.
    pub fn given(&self) -> impl Iterator<Item = (MeasureId, f64)> + '_ {
        MeasureId::all().zip(&self.measures).filter_map(|(id, value)| value.map(|v| (id, v)))
    }

    /// The latent vector: [`Request::z`] where given, whatever its length; else `size` entries drawn from the seed, or
    /// zeros for seed 0.
    pub fn latent(&self, size: usize) -> Vec<f64> {
        match (&self.z, self.seed) {
            (Some(z), _) => z.clone(),
            (None, 0) => vec![0.0; size],
            (None, seed) => Random::new(seed, LATENT_STREAM).normals(size),
        }
    }

    /// Checks that every value is finite and within its range, that there are no evident contradictions such as a waist
    /// larger than the stature, and that a latent vector has `latent_size` entries within [`LATENT_LIMIT`].
    ///
    /// # Errors
    /// [`Error::Request`] for the first field that is wrong, with what was expected, what was found, and a hint when the
    /// value fits in another unit.
    pub fn check(&self, ranges: &[MeasureRange; MEASURE_COUNT], latent_size: usize) -> Result<()> {
        for group in groups(&self.measures) {
            let id = group.ids[0];
            if let Some(value) = self.measures[id.index()] {
                check_value(&group.name, value, ranges[id.index()])?;
            }
        }
        check_contradictions(&self.measures)?;
        if let Some(z) = &self.z {
            if z.len() != latent_size {
                return Err(Error::request("z", format!("expected {latent_size} numbers, got {}", z.len())));
            }
            let range = -LATENT_LIMIT..=LATENT_LIMIT;
            if let Some((i, bad)) = z.iter().enumerate().find(|(_, v)| !range.contains(v)) {
                let expected = format!("expected numbers from -{LATENT_LIMIT} to {LATENT_LIMIT}");
                return Err(Error::request("z", format!("{expected}, got {bad} at place {i}")));
            }
        }
        Ok(())
    }
}

/// Measures of one name: one, or both sides.
pub(crate) struct Group {
    /// The name as in a request: without its side when both sides are in the group.
    pub(crate) name: String,
    /// One or two measures.
    pub(crate) ids: Vec<MeasureId>,
}

/// The given measures, with both sides in one group where their values are equal.
pub(crate) fn groups(measures: &GivenMeasures) -> Vec<Group> {
    group_by(measures, |left, right| left.to_bits() == right.to_bits())
}

/// The given measures, with both sides in one group where both are given and `same` of left and right holds.
pub(crate) fn group_by(measures: &GivenMeasures, same: impl Fn(f64, f64) -> bool) -> Vec<Group> {
    let mut result = Vec::new();
    for (id, value) in MeasureId::all().zip(measures) {
        let Some(value) = *value else { continue };
        let other = id.mirrored();
        let paired = other != id && measures[other.index()].is_some_and(|mirror| same(value, mirror));
        if !paired {
            result.push(Group { name: id.name().to_owned(), ids: vec![id] });
        } else if id < other {
            result.push(Group { name: id.base_name().to_owned(), ids: vec![id, other] });
        }
    }
    result
}

/// The measures of a name, or the error that suggests the nearest ones.
fn known(name: &str) -> Result<Vec<MeasureId>> {
    expand_name(name).ok_or_else(|| {
        let message = match name.to_ascii_lowercase().as_str() {
            "weight" | "mass" | "volume" | "bmi" => {
                "follows from the other measures and cannot be set; give circumferences instead".to_owned()
            }
            _ => format!("is not a measure: did you mean {}?", list(&nearest_names(name), "or")),
        };
        Error::request(name, message)
    })
}

/// Up to three known names that are most similar to the given one, best first.
fn nearest_names(name: &str) -> Vec<&'static str> {
    let wanted = name.trim().to_ascii_lowercase().replace([' ', '-'], "_");
    match wanted.as_str() {
        "stature" | "size" | "body_height" => return vec!["height"],
        "bust" | "bust_girth" => return vec!["chest_circumference"],
        _ => {}
    }
    let mut names: Vec<_> = MeasureId::all().flat_map(|id| [id.base_name(), id.name()]).collect();
    names.sort_unstable();
    names.dedup();
    // Names that contain every word of the wanted one (`waist`, `left_arm_length`) come before merely similar ones.
    let words: Vec<_> = wanted.split('_').filter(|w| !w.is_empty()).collect();
    let lacks = |candidate: &str| !candidate_has_words(candidate, &words);
    names.sort_by_cached_key(|candidate| {
        (lacks(candidate), crate::error::edit_distance(&wanted, candidate), *candidate)
    });
    names.truncate(3);
    if let Some(best) = names.first() {
        // Further suggestions only where they are about as good as the first.
        let (first_lacks, closest) = (lacks(best), crate::error::edit_distance(&wanted, best));
        names.retain(|n| lacks(n) == first_lacks && crate::error::edit_distance(&wanted, n) <= closest + 2);
    }
    names
}

fn candidate_has_words(candidate: &str, words: &[&str]) -> bool {
    !words.is_empty() && words.iter().all(|word| candidate.split('_').any(|part| part == *word))
}

fn check_value(name: &str, value: f64, range: MeasureRange) -> Result<()> {
    if value >= range.min && value <= range.max {
        return Ok(());
    }
    let millimetre = |v: f64| metres((v * 1000.0).round() / 1000.0);
    let span = format!("{}–{} m", millimetre(range.min), millimetre(range.max));
    let message = if !value.is_finite() {
        format!("expected {span}, got {value}")
    } else if value <= 0.0 {
        format!("expected {span}, got {} m: a measure is positive", metres(value))
    } else {
        let mut hints = Vec::new();
        for (unit, metre) in [("mm", 0.001), ("cm", 0.01), ("in", 0.0254), ("ft", 0.3048)] {
            let converted = value * metre;
            if converted >= range.min && converted <= range.max {
                hints.push(format!("{} m ({} {unit})", metres(converted), plain(value)));
            }
        }
        let hint =
            if hints.is_empty() { String::new() } else { format!(": did you mean {}?", list(&hints, "or")) };
        format!("{} m is outside {span}{hint}", metres(value))
    };
    Err(Error::request(name, message))
}

/// A number with at most four decimals and no trailing zeros.
fn plain(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Checks for contradictions that hold for bodies of any shape; [`Feasibility`](super::Feasibility) finds the subtler ones.
fn check_contradictions(measures: &GivenMeasures) -> Result<()> {
    let value = |id: MeasureId| measures[id.index()];
    let larger = |field: MeasureId, value: f64, than: MeasureId, limit: f64, why: &str| {
        Err(Error::request(
            field.name(),
            format!("{} m contradicts {than} {} m: {why}", metres(value), metres(limit)),
        ))
    };
    if let Some(height) = value(MeasureId::HEIGHT) {
        for (id, measure) in MeasureId::all().zip(measures) {
            let Some(measure) = *measure else { continue };
            // The largest chests of short people come close to their stature.
            let limit = if id.name() == "chest_circumference" { 1.15 * height } else { height };
            if id != MeasureId::HEIGHT && measure >= limit {
                let why = "it cannot be larger than the stature";
                return larger(id, measure, MeasureId::HEIGHT, height, why);
            }
        }
        for side in Side::ALL {
            let parts = ["thigh_length", "calf_length", "head_height"];
            let given: Vec<_> = parts
                .into_iter()
                .filter_map(|name| named(name, side))
                .filter_map(|id| Some((id, value(id)?)))
                .collect();
            let sum: f64 = given.iter().map(|(_, v)| v).sum();
            if let (Some((field, first)), true) = (given.first(), sum >= height) {
                let names: Vec<_> = given.iter().map(|(id, _)| id.name()).collect();
                let why = format!("{} are {} m together", list(&names, "and"), metres(sum));
                return larger(*field, *first, MeasureId::HEIGHT, height, &why);
            }
        }
    }
    for (small, large, side) in Side::ALL
        .into_iter()
        .flat_map(|side| SMALLER_OF_SIDES.map(|(small, large)| (small, large, side)))
        .chain([("neck_circumference", "chest_circumference", Side::Left)])
    {
        if let (Some(small), Some(large)) = (named(small, side), named(large, side))
            && let (Some(a), Some(b)) = (value(small), value(large))
            && a >= b
        {
            return larger(small, a, large, b, "it must be the smaller of the two");
        }
    }
    Ok(())
}

/// Per side: a measure and a larger one of every body, which is central or of the same side.
const SMALLER_OF_SIDES: [(&str, &str); 5] = [
    ("heel_to_ball_length", "heel_to_toe_length"),
    ("foot_width", "heel_to_toe_length"),
    ("thigh_circumference", "hip_circumference"),
    ("arm_circumference", "chest_circumference"),
    ("forearm_circumference", "chest_circumference"),
];

/// The measure of this name without side: central, or on this side.
fn named(base: &str, side: Side) -> Option<MeasureId> {
    MeasureId::from_name(base).or_else(|| MeasureId::on_side(base, side))
}

#[cfg(test)]
mod tests;
