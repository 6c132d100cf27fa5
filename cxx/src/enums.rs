//! Enumerations: from the caller's numbers to the library's types, values that none of them has refused.

use anthronet::clip::Wrap;
use anthronet::condition::Fill;
use anthronet::measure::Sex;
use anthronet::mesh::Lod;
use anthronet::retarget::FingerMode;
use anthronet::scene::Layout;
use anthronet::skeleton::humanoid::JointNames;
use anthronet::skin::SkinMethod;
use anthronet::space::{Axis, Space};
use anthronet::{Error, Result};

use crate::bridge::ffi;

/// What an enumeration of the bridge stands for.
pub(crate) trait Meaning {
    type Of;

    /// # Errors
    /// [`Error::Request`] for a number that the enumeration does not have.
    fn meaning(self) -> Result<Self::Of>;
}

macro_rules! meaning {
    ($name:ident as $of:ty, $what:literal: $($variant:ident => $value:expr),+) => {
        impl Meaning for ffi::$name {
            type Of = $of;

            fn meaning(self) -> Result<$of> {
                match self {
                    $(Self::$variant => Ok($value),)+
                    other => {
                        let expected = [$(stringify!($variant)),+].join(", ");
                        Err(Error::request($what, format!("expected one of {expected}, got number {}", other.repr)))
                    }
                }
            }
        }
    };
}

meaning!(Sex as Option<Sex>, "sex": Any => None, Female => Some(Sex::Female), Male => Some(Sex::Male));
meaning!(Fill as Fill, "fill": Mean => Fill::Mean, Sample => Fill::Sample);
meaning!(Space as Space, "space": Gltf => Space::Gltf, Blender => Space::Blender, Unity => Space::Unity);
meaning!(Layout as Layout, "layout": Render => Layout::Render, Model => Layout::Model);
meaning!(JointNames as JointNames, "joint_names":
    Native => JointNames::Native, Unity => JointNames::Unity, Mixamo => JointNames::Mixamo, Vrm => JointNames::Vrm,
    Blender => JointNames::Blender);
meaning!(SkinMethod as SkinMethod, "method":
    Linear => SkinMethod::Linear, DualQuaternion => SkinMethod::DualQuaternion,
    JointTranslation => SkinMethod::JointTranslation);
meaning!(Wrap as Wrap, "wrap": Once => Wrap::Once, Loop => Wrap::Loop, RootMotion => Wrap::RootMotion);
meaning!(Relative as bool, "relative": ToParent => false, ToModel => true);
meaning!(Fingers as FingerMode, "fingers":
    Source => FingerMode::Source, Relaxed => FingerMode::Relaxed, Rest => FingerMode::Rest);
meaning!(UpAxis as Option<Axis>, "up":
    Found => None, Y => Some(Axis::Y), Z => Some(Axis::Z), X => Some(Axis::X), NegativeX => Some(Axis::NegativeX),
    NegativeY => Some(Axis::NegativeY), NegativeZ => Some(Axis::NegativeZ));

/// A level of detail by its number.
pub(crate) fn lod(level: u32) -> Result<Lod> {
    Lod::ALL
        .get(level as usize)
        .copied()
        .ok_or_else(|| Error::request("lod", format!("expected 0, 1, 2 or 3, got {level}")))
}

/// The element at a place.
pub(crate) fn at<'a, T>(all: &'a [T], index: usize, what: &str) -> Result<&'a T> {
    all.get(index)
        .ok_or_else(|| Error::request(what, format!("expected less than {}, got {index}", all.len())))
}

/// A number that 0 stands in for where the default is asked for.
pub(crate) fn given(number: f64) -> Option<f64> {
    (number != 0.0).then_some(number)
}

/// A number that is one.
pub(crate) fn finite(what: &str, value: f64) -> Result<()> {
    if value.is_finite() {
        return Ok(());
    }
    Err(Error::request(what, format!("expected a finite number, got {value}")))
}
