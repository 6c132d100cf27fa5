//! The identifiers of the 36 measures and of the two sexes, in the order that every array of the library uses.
//!
//! Twelve measures are central, twelve more exist on the left and on the right: the 24 rows of the paper's
//! table "statistics-anthro".

use serde::{Deserialize, Serialize};

/// Number of measures.
pub const MEASURE_COUNT: usize = 36;

/// One value per measure, in metres, in the order of [`MeasureId::all`].
pub type Measurements = [f64; MEASURE_COUNT];

const NAMES: [&str; MEASURE_COUNT] = [
    "waist_circumference",
    "chest_circumference",
    "hip_circumference",
    "height",
    "shoulder_width",
    "torso_height_back",
    "torso_height_front",
    "head_circumference",
    "neck_circumference",
    "head_height",
    "neck_length_midline",
    "neck_length_lateral",
    "hand_size_left",
    "arm_circumference_left",
    "arm_length_left",
    "forearm_circumference_left",
    "forearm_length_left",
    "thigh_circumference_left",
    "thigh_length_left",
    "calf_circumference_left",
    "calf_length_left",
    "foot_width_left",
    "heel_to_ball_length_left",
    "heel_to_toe_length_left",
    "hand_size_right",
    "arm_circumference_right",
    "arm_length_right",
    "forearm_circumference_right",
    "forearm_length_right",
    "thigh_circumference_right",
    "thigh_length_right",
    "calf_circumference_right",
    "calf_length_right",
    "foot_width_right",
    "heel_to_ball_length_right",
    "heel_to_toe_length_right",
];

/// One of the 36 measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MeasureId(u8);

impl MeasureId {
    /// The stature, `height`.
    pub const HEIGHT: Self = Self(3);
    /// `waist_circumference`.
    pub const WAIST: Self = Self(0);

    /// All measures, in order.
    pub fn all() -> impl DoubleEndedIterator<Item = Self> + ExactSizeIterator + Clone {
        (0..MEASURE_COUNT as u8).map(Self)
    }

    /// The measure at this place of the order, if there is one.
    pub fn from_index(index: usize) -> Option<Self> {
        (index < MEASURE_COUNT).then_some(Self(index as u8))
    }

    /// The measure with exactly this identifier, sides spelt out.
    pub fn from_name(name: &str) -> Option<Self> {
        NAMES.iter().position(|n| *n == name).map(|i| Self(i as u8))
    }

    /// Place in the order, `0..36`.
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// The identifier, such as `arm_length_left`.
    pub fn name(self) -> &'static str {
        NAMES[self.index()]
    }

    /// The same measure on the other side of the body; a central measure is its own mirror image.
    pub fn mirrored(self) -> Self {
        match self.0 {
            0..12 => self,
            12..24 => Self(self.0 + 12),
            _ => Self(self.0 - 12),
        }
    }
}

impl std::fmt::Display for MeasureId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

/// The measures that a user's name stands for: one, or both sides when the side is left out.
pub fn expand_name(name: &str) -> Option<Vec<MeasureId>> {
    if let Some(id) = MeasureId::from_name(name) {
        return Some(vec![id]);
    }
    let sides: Vec<_> =
        ["left", "right"].iter().filter_map(|side| MeasureId::from_name(&format!("{name}_{side}"))).collect();
    (sides.len() == 2).then_some(sides)
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
    /// Both, in the order of [`Sex::index`].
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
        }
        assert_eq!(MeasureId::from_index(MEASURE_COUNT), None);
        assert_eq!(MeasureId::HEIGHT.name(), "height");
        assert_eq!(MeasureId::WAIST.name(), "waist_circumference");
    }
}
