//! The catalogue of measures: one table, a row per measure, from which names, order, sides, parts of the body and
//! standards are derived.

use crate::Side;

/// The part of the body that a measure is taken on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BodyPart {
    /// Head and neck.
    Head,
    /// Torso, and the body as a whole.
    Trunk,
    /// Upper arm and forearm.
    Arm,
    /// Hand.
    Hand,
    /// Thigh and calf.
    Leg,
    /// Foot.
    Foot,
}

impl BodyPart {
    /// All parts, from head to foot.
    pub const ALL: [Self; 6] = [Self::Head, Self::Trunk, Self::Arm, Self::Hand, Self::Leg, Self::Foot];

    /// Its name in lower case, such as `trunk`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Head => "head",
            Self::Trunk => "trunk",
            Self::Arm => "arm",
            Self::Hand => "hand",
            Self::Leg => "leg",
            Self::Foot => "foot",
        }
    }
}

/// A measure; one row for both sides.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// The name without the side.
    base: &'static str,
    /// The names of the left and the right measure; `None` for a central one.
    sides: Option<[&'static str; 2]>,
    part: BodyPart,
    /// The nearest measure of a published standard or survey: ISO 8559-1:2017 (garment sizing), ISO 7250-1:2017
    /// (technological design), ANSUR II (Gordon et al. 2014) and NHANES (2017 to March 2020); `, near` where ours only resembles it.
    standard: Option<&'static str>,
}

/// A row for a central measure.
macro_rules! central {
    ($base:literal, $part:ident, $standard:expr) => {
        Row { base: $base, sides: None, part: BodyPart::$part, standard: $standard }
    };
}

/// A row for a measure that is taken on both sides.
macro_rules! sided {
    ($base:literal, $part:ident, $standard:expr) => {
        Row {
            base: $base,
            sides: Some([concat!($base, "_left"), concat!($base, "_right")]),
            part: BodyPart::$part,
            standard: $standard,
        }
    };
}

/// The measures of the paper's table "statistics-anthro".
///
/// Their order defines that of every array of measures, in the model file too: central ones, then all of the left, then
/// all of the right. Another row therefore needs a newly trained model.
#[rustfmt::skip]
const ROWS: &[Row] = &[
    central!("waist_circumference", Trunk, Some("ISO 8559-1 waist girth; ANSUR II waistcircumference")),
    central!("chest_circumference", Trunk, Some("ISO 8559-1 bust/chest girth; ANSUR II chestcircumference")),
    central!("hip_circumference", Trunk, Some("ISO 8559-1 hip girth; ANSUR II buttockcircumference; NHANES bmxhip")),
    central!("height", Trunk, Some("ISO 7250-1 stature; ANSUR II stature; NHANES bmxht")),
    central!("shoulder_width", Trunk, Some("ISO 7250-1 shoulder (biacromial) breadth; ANSUR II biacromialbreadth")),
    central!("torso_height_back", Trunk, Some("ISO 8559-1 back neck point to waist, near; ANSUR II waistbacklength, near")),
    central!("torso_height_front", Trunk, Some("ANSUR II waistfrontlengthsitting, near")),
    central!("head_circumference", Head, Some("ISO 8559-1 head girth; ANSUR II headcircumference")),
    central!("neck_circumference", Head, Some("ISO 8559-1 neck girth; ANSUR II neckcircumference")),
    central!("head_height", Head, Some("ISO 8559-1 head height")),
    central!("neck_length_midline", Head, None),
    central!("neck_length_lateral", Head, None),
    sided!("hand_size", Hand, Some("ISO 7250-1 hand length; ANSUR II handlength")),
    sided!("arm_circumference", Arm, Some("ISO 8559-1 upper-arm girth; ANSUR II bicepscircumferenceflexed")),
    sided!("arm_length", Arm, Some("ISO 8559-1 upper-arm length; ANSUR II acromionradialelength")),
    sided!("forearm_circumference", Arm, Some("ANSUR II forearmcircumferenceflexed")),
    sided!("forearm_length", Arm, Some("ANSUR II radialestylionlength")),
    sided!("thigh_circumference", Leg, Some("ISO 8559-1 thigh girth; ANSUR II thighcircumference")),
    sided!("thigh_length", Leg, None),
    sided!("calf_circumference", Leg, Some("ISO 8559-1 calf girth; ANSUR II calfcircumference")),
    sided!("calf_length", Leg, Some("ISO 7250-1 tibial height, near")),
    sided!("foot_width", Foot, Some("ISO 7250-1 foot breadth; ANSUR II footbreadthhorizontal")),
    sided!("heel_to_ball_length", Foot, Some("ANSUR II balloffootlength")),
    sided!("heel_to_toe_length", Foot, Some("ISO 7250-1 foot length; ANSUR II footlength")),
];

/// Number of measures.
pub const MEASURE_COUNT: usize = count(ROWS);

/// The library's measures.
pub(super) const CATALOGUE: Catalogue = Catalogue(&ENTRIES);
const ENTRIES: [Entry; MEASURE_COUNT] = entries(ROWS);

/// One measure on one side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) name: &'static str,
    pub(super) base: &'static str,
    pub(super) side: Option<Side>,
    pub(super) part: BodyPart,
    pub(super) standard: Option<&'static str>,
    /// Index of the same measure on the other side; of itself for a central one.
    pub(super) mirrored: usize,
}

/// Number of measures in these rows, with both sides counted.
const fn count(rows: &[Row]) -> usize {
    let (mut count, mut r) = (0, 0);
    while r < rows.len() {
        count += if rows[r].sides.is_some() { 2 } else { 1 };
        r += 1;
    }
    count
}

/// The measures in order: central, left, right. `N` is their [`count`].
const fn entries<const N: usize>(rows: &[Row]) -> [Entry; N] {
    let per_side = N - rows.len();
    let central = rows.len() - per_side;
    let mut entries =
        [Entry { name: "", base: "", side: None, part: BodyPart::Trunk, standard: None, mirrored: 0 }; N];
    let (mut next, mut next_sided, mut r) = (0, central, 0);
    while r < rows.len() {
        let Row { base, sides, part, standard } = rows[r];
        match sides {
            None => {
                entries[next] = Entry { name: base, base, side: None, part, standard, mirrored: next };
                next += 1;
            }
            Some([left, right]) => {
                let (left_index, right_index) = (next_sided, next_sided + per_side);
                let entry =
                    Entry { name: left, base, side: Some(Side::Left), part, standard, mirrored: right_index };
                entries[left_index] = entry;
                entries[right_index] =
                    Entry { name: right, side: Some(Side::Right), mirrored: left_index, ..entry };
                next_sided += 1;
            }
        }
        r += 1;
    }
    entries
}

/// Measures in order. The library has one catalogue, [`CATALOGUE`]; tests make a larger one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Catalogue(pub(super) &'static [Entry]);

impl Catalogue {
    /// Index of the measure of this name, for constants: in a constant an unknown name does not compile.
    pub(super) const fn index_of(self, name: &str) -> usize {
        let mut index = 0;
        while !same(self.0[index].name.as_bytes(), name.as_bytes()) {
            index += 1;
        }
        index
    }

    /// Names in order.
    pub(super) fn names(self) -> impl ExactSizeIterator<Item = &'static str> {
        self.0.iter().map(|entry| entry.name)
    }

    /// Index of the measure of exactly this name.
    pub(super) fn find(self, name: &str) -> Option<usize> {
        self.0.iter().position(|entry| entry.name == name)
    }

    /// Indices of the measures that a user's name stands for: one, or both sides when the side is left out.
    pub(super) fn expand(self, name: &str) -> Option<Vec<usize>> {
        if let Some(index) = self.find(name) {
            return Some(vec![index]);
        }
        let sides: Vec<_> = (0..self.0.len()).filter(|&index| self.0[index].base == name).collect();
        (!sides.is_empty()).then_some(sides)
    }
}

/// Whether two names are equal; `==` of slices is not `const` yet.
const fn same(a: &[u8], b: &[u8]) -> bool {
    let (mut same, mut i) = (a.len() == b.len(), 0);
    while same && i < a.len() {
        same = a[i] == b[i];
        i += 1;
    }
    same
}

#[cfg(test)]
mod tests;
