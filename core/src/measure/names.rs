//! Identifiers of the measures and of the two sexes.

use serde::{Deserialize, Serialize};

use super::catalogue::{BodyPart, CATALOGUE, Entry, MEASURE_COUNT};
use crate::Side;

/// One value per measure, in metres, in the order of [`MeasureId::all`].
pub type Measurements = [f64; MEASURE_COUNT];

/// One of the measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MeasureId(u8);

impl MeasureId {
    /// The stature, `height`.
    pub const HEIGHT: Self = Self(CATALOGUE.index_of("height") as u8);
    /// `waist_circumference`.
    pub const WAIST: Self = Self(CATALOGUE.index_of("waist_circumference") as u8);

    /// All measures, in order: central, left, right.
    pub fn all() -> impl DoubleEndedIterator<Item = Self> + ExactSizeIterator + Clone {
        (0..MEASURE_COUNT as u8).map(Self)
    }

    /// The measure of this index; `None` from [`MEASURE_COUNT`] on.
    pub fn from_index(index: usize) -> Option<Self> {
        (index < MEASURE_COUNT).then_some(Self(index as u8))
    }

    /// The measure of exactly this identifier, with its side.
    pub fn from_name(name: &str) -> Option<Self> {
        CATALOGUE.find(name).map(Self::at)
    }

    /// The measure on this side of a name without its side, such as `arm_length`.
    pub fn on_side(base: &str, side: Side) -> Option<Self> {
        Self::all().find(|id| id.base_name() == base && id.side() == Some(side))
    }

    /// Index in every array of measures, `0..MEASURE_COUNT`.
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// The identifier, such as `arm_length_left`.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// The identifier without its side, such as `arm_length`, which [`expand_name`] expands to both sides.
    pub fn base_name(self) -> &'static str {
        self.entry().base
    }

    /// The side of the body that it is taken on; `None` for a central measure.
    pub fn side(self) -> Option<Side> {
        self.entry().side
    }

    /// The part of the body that it is taken on.
    pub fn part(self) -> BodyPart {
        self.entry().part
    }

    /// The nearest measures of ISO 8559-1, ISO 7250-1, ANSUR II and NHANES, where they exist, separated by `; `.
    pub fn standard(self) -> Option<&'static str> {
        self.entry().standard
    }

    /// The same measure on the other side of the body; a central measure is its own mirror image.
    pub fn mirrored(self) -> Self {
        Self::at(self.entry().mirrored)
    }

    /// The measure of an index in the catalogue.
    fn at(index: usize) -> Self {
        Self(index as u8)
    }

    fn entry(self) -> &'static Entry {
        &CATALOGUE.0[self.index()]
    }
}

impl std::fmt::Display for MeasureId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// The measures that a user's name stands for: one, or both sides when the side is left out; `None` for an unknown name.
pub fn expand_name(name: &str) -> Option<Vec<MeasureId>> {
    Some(CATALOGUE.expand(name)?.into_iter().map(MeasureId::at).collect())
}

/// The sex that a body is conditioned on; the paper's binary identifier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sex {
    /// Female.
    Female,
    /// Male.
    Male,
}

impl Sex {
    /// Both sexes, in the order of [`Sex::index`].
    pub const ALL: [Self; 2] = [Self::Female, Self::Male];

    /// 0 for female, 1 for male.
    pub fn index(self) -> usize {
        self as usize
    }

    /// `female` or `male`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Female => "female",
            Self::Male => "male",
        }
    }
}

impl std::fmt::Display for Sex {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

impl std::str::FromStr for Sex {
    type Err = crate::Error;

    fn from_str(s: &str) -> crate::Result<Self> {
        match s.to_ascii_lowercase().as_str() {
            "female" | "f" => Ok(Self::Female),
            "male" | "m" => Ok(Self::Male),
            _ => Err(crate::Error::request("sex", format!("expected `female` or `male`, got `{s}`"))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_without_its_side_means_both() {
        let both = expand_name("arm_length").unwrap();
        assert_eq!(
            both.iter().map(|m| m.name()).collect::<Vec<_>>(),
            ["arm_length_left", "arm_length_right"]
        );
        assert_eq!(both[0].mirrored(), both[1]);
        assert_eq!(expand_name("height").unwrap().len(), 1);
        assert_eq!(expand_name("hat_size"), None);
    }

    #[test]
    fn names_are_unique_and_indices_round_trip() {
        for (i, id) in MeasureId::all().enumerate() {
            assert_eq!(MeasureId::from_name(id.name()), Some(id));
            assert_eq!(MeasureId::from_index(i), Some(id));
            assert_eq!(id.mirrored().mirrored(), id);
            assert_eq!(id.side().map(Side::mirrored), id.mirrored().side());
            assert_eq!(Side::split_measure_name(id.name()), (id.base_name(), id.side()));
        }
        assert_eq!(MeasureId::from_index(MEASURE_COUNT), None);
        assert_eq!(MeasureId::HEIGHT.name(), "height");
        assert_eq!(MeasureId::WAIST.name(), "waist_circumference");
    }
}
