//! Parsers of options that take one of a few values of the library, with the descriptions that the help lists.

use std::str::FromStr;

use anthronet::condition::{Fill, Population};
use anthronet::measure::Sex;
use anthronet::mesh::Lod;
use anthronet::retarget::FingerMode;
use anthronet::skeleton::humanoid::JointNames;
use anthronet::space::{Axis, Unit};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// Accepts only these names; the type parses them.
fn one_of<T>(names: impl IntoIterator<Item = PossibleValue>) -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err = anthronet::Error> + Clone + Send + Sync + 'static,
{
    PossibleValuesParser::new(names).try_map(|name| name.parse())
}

pub(crate) fn sex() -> impl TypedValueParser<Value = Sex> {
    one_of(Sex::ALL.map(|sex| PossibleValue::new(sex.name())))
}

pub(crate) fn fill() -> impl TypedValueParser<Value = Fill> {
    one_of(Fill::ALL.map(|fill| {
        PossibleValue::new(fill.name()).help(match fill {
            Fill::Mean => "The most likely values, given the others",
            Fill::Sample => "A random draw of plausible values, given the others; `--seed` selects it",
        })
    }))
}

pub(crate) fn population() -> impl TypedValueParser<Value = Population> {
    one_of(Population::ALL.map(|population| {
        PossibleValue::new(population.name()).help(match population {
            Population::Ansur2 => "Soldiers of the United States, 2010 to 2012 (ANSUR II)",
            Population::Synthetic => {
                "The bodies that the model was trained on: every build and stature alike"
            }
        })
    }))
}

pub(crate) fn joint_names() -> impl TypedValueParser<Value = JointNames> {
    one_of(JointNames::ALL.map(|names| {
        PossibleValue::new(names.name()).help(match names {
            JointNames::Native => "Names of the rig, such as upperarm_l",
            JointNames::Unity => "HumanBodyBones of Unity, such as LeftUpperArm",
            JointNames::Mixamo => "Names in files from Mixamo, such as mixamorig:LeftArm",
            JointNames::Vrm => "Humanoid bones of VRM 1.0, such as leftUpperArm",
            JointNames::Blender => "Names that Blender mirrors, such as upper_arm.L",
        })
    }))
}

pub(crate) fn fingers() -> impl TypedValueParser<Value = FingerMode> {
    one_of(FingerMode::ALL.map(|mode| {
        PossibleValue::new(mode.name()).help(match mode {
            FingerMode::Source => "From the motion if it animates fingers, else relaxed",
            FingerMode::Relaxed => "Slightly curled, as in hanging hands",
            FingerMode::Rest => "Straight, as in the rest pose",
        })
    }))
}

pub(crate) fn unit() -> impl TypedValueParser<Value = Unit> {
    let names = [("m", "Metres"), ("cm", "Centimetres"), ("mm", "Millimetres"), ("in", "Inches")];
    one_of(names.map(|(name, help)| PossibleValue::new(name).help(help)))
}

pub(crate) fn up_axis() -> impl TypedValueParser<Value = Axis> {
    one_of(Axis::ALL.map(|axis| PossibleValue::new(axis.name())))
}

pub(crate) fn lod() -> impl TypedValueParser<Value = Lod> {
    clap::value_parser!(u8).range(0..=3).try_map(Lod::try_from)
}

pub(crate) fn influences() -> impl TypedValueParser<Value = usize> {
    PossibleValuesParser::new(["4", "8"]).try_map(|number| number.parse())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parses every name that the help lists.
    fn all<T: Clone + Send + Sync + 'static>(parser: &impl TypedValueParser<Value = T>) -> Vec<T> {
        let command = clap::Command::new("test");
        let names = parser.possible_values().expect("a list of names");
        names
            .map(|name| parser.parse_ref(&command, None, name.get_name().as_ref()).expect("a value"))
            .collect()
    }

    #[test]
    fn every_listed_name_has_its_value() {
        assert_eq!(all(&sex()), Sex::ALL);
        assert_eq!(all(&fill()), Fill::ALL);
        assert_eq!(all(&joint_names()), JointNames::ALL);
        assert_eq!(all(&fingers()), FingerMode::ALL);
        assert_eq!(all(&unit()), [Unit::Metre, Unit::Centimetre, Unit::Millimetre, Unit::Inch]);
        assert_eq!(all(&up_axis()), Axis::ALL);
        assert_eq!(all(&influences()), [4, 8]);
    }

    #[test]
    fn names_that_are_not_listed_are_refused() {
        let command = clap::Command::new("test");
        for name in ["ft", "0.04", "CM", ""] {
            assert!(unit().parse_ref(&command, None, name.as_ref()).is_err(), "{name}");
        }
    }
}
