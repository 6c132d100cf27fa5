//! The measures there are: one table, a row per measure, from which names, order, sides, parts of the body and
//! standards follow.

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
    /// All of them, from the top down.
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

/// A measure, both sides together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Its name without the side.
    base: &'static str,
    /// Its names on the left and on the right; `None` for a measure of the middle.
    sides: Option<[&'static str; 2]>,
    part: BodyPart,
    /// The nearest measure of a published standard or survey: ISO 8559-1:2017 (garment sizing), ISO 7250-1:2017
    /// (technological design) and ANSUR II (Gordon et al. 2014). "Nearest" is not "same": ours are read in a T-pose
    /// and between vertices.
    standard: Option<&'static str>,
}

/// A row of a measure of the middle.
macro_rules! central {
    ($base:literal, $part:ident, $standard:expr) => {
        Row { base: $base, sides: None, part: BodyPart::$part, standard: $standard }
    };
}

/// A row of a measure that is taken on both sides.
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

/// The rows of the paper's table "statistics-anthro".
///
/// The order is that of every array of measures and of the model file: what is in the middle, then all of the left, then
/// all of the right. A row more changes the model file.
#[rustfmt::skip]
const ROWS: &[Row] = &[
    central!("waist_circumference", Trunk, Some("ISO 8559-1 waist girth; ANSUR II waistcircumference")),
    central!("chest_circumference", Trunk, Some("ISO 8559-1 bust/chest girth; ANSUR II chestcircumference")),
    central!("hip_circumference", Trunk, Some("ISO 8559-1 hip girth; ANSUR II buttockcircumference")),
    central!("height", Trunk, Some("ISO 7250-1 stature; ANSUR II stature")),
    central!("shoulder_width", Trunk, Some("ISO 7250-1 shoulder (biacromial) breadth; ANSUR II biacromialbreadth")),
    central!("torso_height_back", Trunk, Some("ISO 8559-1 back neck point to waist; ANSUR II waistbacklength")),
    central!("torso_height_front", Trunk, Some("ANSUR II waistfrontlengthsitting")),
    central!("head_circumference", Head, Some("ISO 8559-1 head girth; ANSUR II headcircumference")),
    central!("neck_circumference", Head, Some("ISO 8559-1 neck girth; ANSUR II neckcircumference")),
    central!("head_height", Head, Some("ISO 8559-1 head height")),
    central!("neck_length_midline", Head, None),
    central!("neck_length_lateral", Head, Some("ANSUR II earheight less neckheight, near")),
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
    /// Place of the same measure on the other side; its own in the middle.
    pub(super) mirrored: usize,
}

/// Number of measures that so many rows make, each side counted.
const fn count(rows: &[Row]) -> usize {
    let (mut count, mut r) = (0, 0);
    while r < rows.len() {
        count += if rows[r].sides.is_some() { 2 } else { 1 };
        r += 1;
    }
    count
}

/// The measures in order: the middle, the left, the right. `N` is their [`count`].
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
                let (at_left, at_right) = (next_sided, next_sided + per_side);
                let entry =
                    Entry { name: left, base, side: Some(Side::Left), part, standard, mirrored: at_right };
                entries[at_left] = entry;
                entries[at_right] =
                    Entry { name: right, side: Some(Side::Right), mirrored: at_left, ..entry };
                next_sided += 1;
            }
        }
        r += 1;
    }
    entries
}

/// Measures in order. There is one catalogue, [`CATALOGUE`]; tests make larger ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Catalogue(pub(super) &'static [Entry]);

impl Catalogue {
    /// Place of a measure that there is, for constants: a name that is none does not compile.
    pub(super) const fn place(self, name: &str) -> usize {
        let mut place = 0;
        while !same(self.0[place].name.as_bytes(), name.as_bytes()) {
            place += 1;
        }
        place
    }

    /// Names in order.
    pub(super) fn names(self) -> impl ExactSizeIterator<Item = &'static str> {
        self.0.iter().map(|entry| entry.name)
    }

    /// Place of the measure of exactly this name.
    pub(super) fn find(self, name: &str) -> Option<usize> {
        self.0.iter().position(|entry| entry.name == name)
    }

    /// Places of the measures that a user's name stands for: one, or both sides when the side is left out.
    pub(super) fn expand(self, name: &str) -> Option<Vec<usize>> {
        if let Some(place) = self.find(name) {
            return Some(vec![place]);
        }
        let sides: Vec<_> = (0..self.0.len()).filter(|&place| self.0[place].base == name).collect();
        (!sides.is_empty()).then_some(sides)
    }
}

/// Whether two texts are equal; `==` of texts is not for constants yet.
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
