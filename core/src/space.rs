//! Units, axes and handedness: the only place that knows of any but the library's own.
//!
//! Inside the library: metres, right-handed, +Y up, +Z forward, +X the character's left (glTF). Every other space is a
//! signed permutation of these axes, so that conversions there and back are exact:
//!
//! | [`Space`] | up | forward | character's left | hand | from ours (x, y, z) |
//! |---|---|---|---|---|---|
//! | `Gltf` (ours, USD) | +Y | +Z | +X | right | (x, y, z) |
//! | `Blender` (AMASS) | +Z | −Y | +X | right | (x, −z, y) |
//! | `Unity` | +Y | +Z | −X | left | (−x, y, z) |

use std::{f32::consts::FRAC_1_SQRT_2, fmt, str::FromStr};

use glam::{Mat3, Mat4, Quat, Vec3};
use serde::{Serialize, Serializer};

use crate::{Error, Result};

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unit {
    /// 1 m.
    Metre,
    /// 0.1 m.
    Decimetre,
    /// 0.01 m.
    Centimetre,
    /// 0.001 m.
    Millimetre,
    /// 0.0254 m.
    Inch,
    /// 0.3048 m.
    Foot,
    /// 1 / 0.45 inch, 0.0564 m: what the skeletons of the CMU motion capture database are measured in (`:units
    /// length 0.45` in their ASF files), and the BVH files made of them.
    Acclaim,
    /// So many metres; positive.
    Metres(f64),
}

impl Unit {
    /// The units that have names.
    pub const NAMED: [Self; 7] = [
        Self::Metre,
        Self::Decimetre,
        Self::Centimetre,
        Self::Millimetre,
        Self::Inch,
        Self::Foot,
        Self::Acclaim,
    ];

    /// Metres per unit.
    pub fn metres(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Decimetre => 0.1,
            Self::Centimetre => 0.01,
            Self::Millimetre => 0.001,
            Self::Inch => 0.0254,
            Self::Foot => 0.3048,
            Self::Acclaim => 0.0254 / 0.45,
            Self::Metres(metres) => metres,
        }
    }

    /// The unit of so many metres: a named one within a millionth; `None` when it is not finite and positive.
    pub fn of_metres(metres: f64) -> Option<Self> {
        let named = Self::NAMED.into_iter().find(|unit| (metres / unit.metres() - 1.0).abs() < 1e-6);
        let valid = metres.is_finite() && metres > 0.0;
        named.or(valid.then_some(Self::Metres(metres)))
    }

    /// Its abbreviation; `None` where it has none.
    fn name(self) -> Option<&'static str> {
        match self {
            Self::Metre => Some("m"),
            Self::Decimetre => Some("dm"),
            Self::Centimetre => Some("cm"),
            Self::Millimetre => Some("mm"),
            Self::Inch => Some("in"),
            Self::Foot => Some("ft"),
            Self::Acclaim => Some("acclaim"),
            Self::Metres(_) => None,
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name() {
            Some(name) => f.write_str(name),
            None => write!(f, "{} m", self.metres()),
        }
    }
}

impl FromStr for Unit {
    type Err = Error;

    /// `m`, `dm`, `cm`, `mm`, `in`, `ft`, `acclaim`, or metres per unit as a number, such as `0.04`.
    fn from_str(text: &str) -> Result<Self> {
        let named = Self::NAMED.into_iter().find(|unit| unit.name() == Some(text));
        let number = || text.trim_end_matches('m').trim_end().parse().ok().and_then(Self::of_metres);
        named.or_else(number).ok_or_else(|| {
            let known = Self::NAMED.iter().filter_map(|u| u.name()).collect::<Vec<_>>().join(", ");
            Error::request("unit", format!("expected one of {known} or metres per unit, got `{text}`"))
        })
    }
}

impl Serialize for Unit {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// The axis that points up in a right-handed file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Axis {
    /// +Y up, as in this library.
    Y,
    /// +Z up, as in Blender and AMASS.
    Z,
}

impl Axis {
    /// The rotation that stands a file with this axis up on our floor: identity, or −90° about X.
    ///
    /// As the left factor of a root's transform it moves everything below; joint spaces stay as they are.
    pub fn ours_from_file(self) -> Quat {
        match self {
            Self::Y => Quat::IDENTITY,
            Self::Z => STAND_UP,
        }
    }

    /// A vector of the file in our axes, exactly.
    pub fn vector_to_ours(self, v: Vec3) -> Vec3 {
        self.space().to_ours(v)
    }

    /// The space with this axis up.
    pub fn space(self) -> Space {
        match self {
            Self::Y => Space::Gltf,
            Self::Z => Space::Blender,
        }
    }

    /// Its place among x, y, z.
    pub fn index(self) -> usize {
        match self {
            Self::Y => 1,
            Self::Z => 2,
        }
    }
}

/// −90° about X: what lies along +Z stands along +Y.
const STAND_UP: Quat = Quat::from_xyzw(-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2);

/// A rotation as seen in a mirror across X.
fn mirrored(q: Quat) -> Quat {
    Quat::from_xyzw(q.x, -q.y, -q.z, q.w)
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Y => "Y",
            Self::Z => "Z",
        })
    }
}

impl FromStr for Axis {
    type Err = Error;

    /// `y` or `z`, small or capital.
    fn from_str(text: &str) -> Result<Self> {
        match text {
            "y" | "Y" => Ok(Self::Y),
            "z" | "Z" => Ok(Self::Z),
            _ => Err(Error::request("up", format!("expected y or z, got `{text}`"))),
        }
    }
}

/// Axes and handedness of a program or file; see the table of the [module](self). Lengths stay metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Space {
    /// The library's own, glTF's and USD's.
    #[default]
    Gltf,
    /// Blender's and AMASS's: the front of a character looks along −Y.
    Blender,
    /// Unity's, left-handed.
    Unity,
}

impl Space {
    /// A point, direction or normal of ours in this space.
    pub fn from_ours(self, v: Vec3) -> Vec3 {
        match self {
            Self::Gltf => v,
            Self::Blender => Vec3::new(v.x, -v.z, v.y),
            Self::Unity => Vec3::new(-v.x, v.y, v.z),
        }
    }

    /// A point, direction or normal of this space in ours.
    pub fn to_ours(self, v: Vec3) -> Vec3 {
        match self {
            Self::Gltf => v,
            Self::Blender => Vec3::new(v.x, v.z, -v.y),
            Self::Unity => Vec3::new(-v.x, v.y, v.z),
        }
    }

    /// A joint's rotation and translation to the model, ours, in this space: the model's axes change, the joint's own stay,
    /// so that +Y runs along its bone everywhere; a mirror mirrors them too.
    pub fn model_from_joint(self, rotation: Quat, translation: Vec3) -> (Quat, Vec3) {
        let rotation = match self {
            Self::Gltf => rotation,
            Self::Blender => STAND_UP.conjugate() * rotation,
            Self::Unity => mirrored(rotation),
        };
        (rotation, self.from_ours(translation))
    }

    /// A joint's rotation and translation to the model, in this space, as ours.
    pub fn model_from_joint_to_ours(self, rotation: Quat, translation: Vec3) -> (Quat, Vec3) {
        let rotation = match self {
            Self::Gltf => rotation,
            Self::Blender => STAND_UP * rotation,
            Self::Unity => mirrored(rotation),
        };
        (rotation, self.to_ours(translation))
    }

    /// A joint's rotation and translation to another joint: the same in every right-handed space, mirrored in the other;
    /// from ours to this space and back alike.
    pub fn parent_from_joint(self, rotation: Quat, translation: Vec3) -> (Quat, Vec3) {
        match self {
            Self::Gltf | Self::Blender => (rotation, translation),
            Self::Unity => (mirrored(rotation), self.from_ours(translation)),
        }
    }

    /// [`model_from_joint`](Self::model_from_joint) as a matrix, exactly.
    pub fn model_from_joint_matrix(self, model_from_joint: Mat4) -> Mat4 {
        Mat4::from_mat3(self.change()) * model_from_joint * Mat4::from_mat3(self.joint_change())
    }

    /// The inverse of such a matrix, ours, in this space, exactly.
    pub fn joint_from_model_matrix(self, joint_from_model: Mat4) -> Mat4 {
        Mat4::from_mat3(self.joint_change()) * joint_from_model * Mat4::from_mat3(self.change().transpose())
    }

    /// Whether corners of triangles go round the other way, as they do in a left-handed space.
    pub fn flips_winding(self) -> bool {
        self == Self::Unity
    }

    fn change(self) -> Mat3 {
        Mat3::from_cols(self.from_ours(Vec3::X), self.from_ours(Vec3::Y), self.from_ours(Vec3::Z))
    }

    /// What becomes of a joint's own axes; its own inverse.
    fn joint_change(self) -> Mat3 {
        if self.flips_winding() { self.change() } else { Mat3::IDENTITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPACES: [Space; 3] = [Space::Gltf, Space::Blender, Space::Unity];

    #[test]
    fn a_character_stands_faces_and_holds_its_left_out_in_every_space() {
        let (left, up, front) = (Vec3::X, Vec3::Y, Vec3::Z);
        let seen = |space: Space| [left, up, front].map(|v| space.from_ours(v));
        assert_eq!(seen(Space::Gltf), [Vec3::X, Vec3::Y, Vec3::Z]);
        assert_eq!(seen(Space::Blender), [Vec3::X, Vec3::Z, Vec3::NEG_Y]);
        assert_eq!(seen(Space::Unity), [Vec3::NEG_X, Vec3::Y, Vec3::Z]);
    }

    #[test]
    fn there_and_back_is_exact_but_for_rotations() {
        let (v, q) = (Vec3::new(0.1, -2.0, 3.0), Quat::from_xyzw(0.1, -0.3, 0.7, 0.64).normalize());
        for space in SPACES {
            assert_eq!(space.to_ours(space.from_ours(v)), v);
            let (turn, step) = space.parent_from_joint(q, v);
            assert_eq!(space.parent_from_joint(turn, step), (q, v));
            let (turn, step) = space.model_from_joint(q, v);
            let (turn, step) = space.model_from_joint_to_ours(turn, step);
            // The products with a quarter turn round.
            assert!(step == v && turn.dot(q) > 1.0 - 1e-6, "{space:?}");
        }
    }

    #[test]
    fn what_hangs_on_a_joint_is_carried_along() {
        let q = Quat::from_axis_angle(Vec3::new(0.48, -0.6, 0.64), 1.1);
        let (step, point) = (Vec3::new(4.0, 5.0, -6.0), Vec3::new(0.3, 1.7, -0.2));
        let matrix = Mat4::from_rotation_translation(q, step);
        for space in SPACES {
            // The joint's own axes, and what hangs on it, change only in a mirror.
            let hanging = if space == Space::Unity { space.from_ours(point) } else { point };
            let expected = space.from_ours(q * point + step);
            let (turn, shift) = space.model_from_joint(q, step);
            // A few roundings of numbers near 8.
            assert!((turn * hanging + shift).distance(expected) < 4e-6, "{space:?}");
            let model_from_joint = space.model_from_joint_matrix(matrix);
            assert!(model_from_joint.transform_point3(hanging).distance(expected) < 4e-6, "{space:?}");
            let joint_from_model = space.joint_from_model_matrix(matrix.inverse());
            assert!(joint_from_model.transform_point3(expected).distance(hanging) < 4e-6, "{space:?}");
        }
    }

    #[test]
    fn bones_run_along_y_everywhere() {
        // An upper arm of the T-pose: its bone runs to the left.
        let q = Quat::from_rotation_z(-std::f32::consts::FRAC_PI_2);
        for space in SPACES {
            let (turn, _) = space.model_from_joint(q, Vec3::ZERO);
            assert!((turn * Vec3::Y).distance(space.from_ours(Vec3::X)) < 1e-6, "{space:?}");
        }
    }

    #[test]
    fn a_file_with_z_up_is_stood_up() {
        for v in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(1.0, 2.0, 3.0)] {
            assert!((Axis::Z.ours_from_file() * v).distance(Axis::Z.vector_to_ours(v)) < 1e-6);
        }
        assert_eq!(Axis::Z.vector_to_ours(Vec3::Z), Vec3::Y);
        assert_eq!(Axis::Y.vector_to_ours(Vec3::Z), Vec3::Z);
    }

    #[test]
    fn units_are_written_and_read() {
        for unit in Unit::NAMED.into_iter().chain([Unit::Metres(0.04)]) {
            assert_eq!(unit.to_string().parse::<Unit>().unwrap(), unit);
            assert_eq!(Unit::of_metres(unit.metres()), Some(unit));
        }
        for wrong in ["", "miles", "-1", "NaN", "0", "inf"] {
            assert!(
                wrong.parse::<Unit>().unwrap_err().to_string().contains("expected one of m, dm"),
                "{wrong}"
            );
        }
        assert_eq!(["y", "Z"].map(|a| a.parse::<Axis>().unwrap()), [Axis::Y, Axis::Z]);
        assert!("x".parse::<Axis>().is_err());
    }
}
