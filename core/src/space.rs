//! Conversion of units, axes and handedness; no other module converts between spaces.
//!
//! Inside the library: metres, right-handed, +Y up, +Z forward, +X the character's left (glTF). Every other space is a
//! signed permutation of these axes, so vectors convert there and back exactly:
//!
//! | [`Space`] | up | forward | character's left | handedness | our (x, y, z) becomes |
//! |---|---|---|---|---|---|
//! | `Gltf` (ours, USD) | +Y | +Z | +X | right | (x, y, z) |
//! | `Blender` (AMASS) | +Z | −Y | +X | right | (x, −z, y) |
//! | `Unity` | +Y | +Z | −X | left | (−x, y, z) |
//!
//! The same as matrices C = `space_from_ours`. They act on column vectors, v′ = C v, so column j of C is our axis j in
//! the other space:
//!
//! ```text
//!                  x  y  z                   x  y  z     (ours)
//!              x │ 1  0  0 │            x │ −1  0  0 │
//! C(Blender) = y │ 0  0 −1 │ C(Unity) = y │  0  1  0 │
//!              z │ 0  1  0 │            z │  0  0  1 │
//!
//!         rotation, +90° about X     reflection in the plane x = 0
//! ```
//!
//! A transform M = `model_from_joint` becomes C M J⁻¹: C changes the axes of the model, on the left of M, and J those of
//! the joint, on its right. J is the identity in right-handed spaces, which leaves every joint's own frame as it is (+Y
//! stays along the bone), and C in Unity, as a reflection has to act on both sides for the result to remain a rotation.

use std::{f32::consts::FRAC_1_SQRT_2, fmt, str::FromStr};

use glam::{Mat3, Mat4, Vec3};
use serde::{Serialize, Serializer};

use crate::math::{RigidTransform, Rotation};
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
    /// Any other unit, as metres per unit; finite and positive.
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

    /// The unit with this many metres per unit: a named one where they agree to a relative 10⁻⁶; `None` unless `metres` is
    /// finite and positive.
    pub fn from_metres(metres: f64) -> Option<Self> {
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
        let number = || text.trim_end_matches('m').trim_end().parse().ok().and_then(Self::from_metres);
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

/// The up axis of a right-handed file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// +X up.
    X,
    /// +Y up, as in this library.
    Y,
    /// +Z up, as in Blender and AMASS.
    Z,
    /// −X up: +X points down.
    NegativeX,
    /// −Y up: +Y points down, as in the axes of a camera, whose +Z points away from it.
    NegativeY,
    /// −Z up: +Z points down.
    NegativeZ,
}

impl Axis {
    /// Every axis; those that point along +X, +Y and +Z come first.
    pub const ALL: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::NegativeX, Self::NegativeY, Self::NegativeZ];

    /// The rotation from the file's axes to ours: the smallest that takes this axis to +Y; a half turn about X for +Y down.
    ///
    /// Multiplied on the left of the root's transform it turns the whole skeleton; the joints' own frames stay as they
    /// are.
    pub fn ours_from_file(self) -> Rotation {
        match self {
            Self::X => Rotation::from_xyzw(0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2),
            Self::Y => Rotation::IDENTITY,
            Self::Z => Y_UP_FROM_Z_UP,
            Self::NegativeX => Rotation::from_xyzw(0.0, 0.0, -FRAC_1_SQRT_2, FRAC_1_SQRT_2),
            Self::NegativeY => Rotation::from_xyzw(1.0, 0.0, 0.0, 0.0),
            Self::NegativeZ => Y_UP_FROM_Z_UP.conjugate(),
        }
    }

    /// Converts a vector from the file's axes to ours, exactly.
    pub fn vector_to_ours(self, v: Vec3) -> Vec3 {
        match self {
            Self::X => Vec3::new(-v.y, v.x, v.z),
            Self::Y => v,
            Self::Z => Vec3::new(v.x, v.z, -v.y),
            Self::NegativeX => Vec3::new(v.y, -v.x, v.z),
            Self::NegativeY => Vec3::new(v.x, -v.y, -v.z),
            Self::NegativeZ => Vec3::new(v.x, -v.z, v.y),
        }
    }

    /// The direction up, in the file's axes.
    pub fn direction(self) -> Vec3 {
        match self {
            Self::X => Vec3::X,
            Self::Y => Vec3::Y,
            Self::Z => Vec3::Z,
            Self::NegativeX => Vec3::NEG_X,
            Self::NegativeY => Vec3::NEG_Y,
            Self::NegativeZ => Vec3::NEG_Z,
        }
    }

    /// Its name: `y`, or `-y` where +Y points down.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::NegativeX => "-x",
            Self::NegativeY => "-y",
            Self::NegativeZ => "-z",
        }
    }
}

/// −90° about X, the inverse of C(Blender) in the [module](self): takes +Z to +Y and −Y to +Z.
const Y_UP_FROM_Z_UP: Rotation = Rotation::from_xyzw(-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2);

/// A rotation R reflected in the plane x = 0: C R C with C = diag(−1, 1, 1).
fn mirrored(q: Rotation) -> Rotation {
    Rotation::from_xyzw(q.x, -q.y, -q.z, q.w)
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name().to_uppercase())
    }
}

impl Serialize for Axis {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl FromStr for Axis {
    type Err = Error;

    /// `x`, `y` or `z`, in either case and with a sign or none: `-y` where +Y points down.
    fn from_str(text: &str) -> Result<Self> {
        let name = text.strip_prefix('+').unwrap_or(text);
        Self::ALL.into_iter().find(|axis| axis.name().eq_ignore_ascii_case(name)).ok_or_else(|| {
            let known = Self::ALL.map(Self::name).join(", ");
            Error::request("up", format!("expected one of {known}, got `{text}`"))
        })
    }
}

/// Axes and handedness of a program or file; see the table in the [module](self). Lengths stay in metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Space {
    /// The library's own: right-handed, +Y up, characters face +Z.
    #[default]
    Gltf,
    /// Blender's and AMASS's: right-handed, +Z up, characters face −Y.
    Blender,
    /// Unity's: left-handed, +Y up, characters face +Z with their left at −X.
    Unity,
}

impl Space {
    /// Converts a point, direction or normal from our space to this one, exactly: C v.
    pub fn from_ours(self, v: Vec3) -> Vec3 {
        match self {
            Self::Gltf => v,
            Self::Blender => Vec3::new(v.x, -v.z, v.y),
            Self::Unity => Vec3::new(-v.x, v.y, v.z),
        }
    }

    /// Converts a point, direction or normal from this space to ours, exactly: Cᵀ v.
    pub fn to_ours(self, v: Vec3) -> Vec3 {
        match self {
            Self::Gltf => v,
            Self::Blender => Vec3::new(v.x, v.z, -v.y),
            Self::Unity => Vec3::new(-v.x, v.y, v.z),
        }
    }

    /// Converts a `model_from_joint` (metres) from our space to this one: C M J⁻¹ of the
    /// [module](self).
    pub fn model_from_joint(self, ours: RigidTransform) -> RigidTransform {
        let rotation = match self {
            Self::Gltf => ours.rotation,
            Self::Blender => Y_UP_FROM_Z_UP.conjugate() * ours.rotation,
            Self::Unity => mirrored(ours.rotation),
        };
        RigidTransform { rotation, translation: self.from_ours(ours.translation) }
    }

    /// The inverse of [`model_from_joint`](Self::model_from_joint): from this space to ours.
    pub fn model_from_joint_to_ours(self, theirs: RigidTransform) -> RigidTransform {
        let rotation = match self {
            Self::Gltf => theirs.rotation,
            Self::Blender => Y_UP_FROM_Z_UP * theirs.rotation,
            Self::Unity => mirrored(theirs.rotation),
        };
        RigidTransform { rotation, translation: self.to_ours(theirs.translation) }
    }

    /// Converts a `parent_from_joint` (metres) between our space and this one: J M J⁻¹, so
    /// unchanged in right-handed spaces and reflected in Unity's. Its own inverse.
    pub fn parent_from_joint(self, transform: RigidTransform) -> RigidTransform {
        match self {
            Self::Gltf | Self::Blender => transform,
            Self::Unity => RigidTransform {
                rotation: mirrored(transform.rotation),
                translation: self.from_ours(transform.translation),
            },
        }
    }

    /// [`model_from_joint`](Self::model_from_joint) for a matrix, exactly: C M J⁻¹.
    pub fn model_from_joint_matrix(self, model_from_joint: Mat4) -> Mat4 {
        Mat4::from_mat3(self.space_from_ours()) * model_from_joint * Mat4::from_mat3(self.joint_from_ours())
    }

    /// Converts a `joint_from_model` (an inverse bind matrix) from our space to this one, exactly: J M C⁻¹.
    pub fn joint_from_model_matrix(self, joint_from_model: Mat4) -> Mat4 {
        let ours_from_space = self.space_from_ours().transpose();
        Mat4::from_mat3(self.joint_from_ours()) * joint_from_model * Mat4::from_mat3(ours_from_space)
    }

    /// Whether faces have to reverse the order of their corners to keep their front outside: in a left-handed space.
    pub fn flips_winding(self) -> bool {
        self == Self::Unity
    }

    /// C of the [module](self), orthogonal.
    fn space_from_ours(self) -> Mat3 {
        Mat3::from_cols(self.from_ours(Vec3::X), self.from_ours(Vec3::Y), self.from_ours(Vec3::Z))
    }

    /// J of the [module](self): the change of a joint's own axes; its own inverse.
    fn joint_from_ours(self) -> Mat3 {
        if self.flips_winding() { self.space_from_ours() } else { Mat3::IDENTITY }
    }
}

impl RigidTransform {
    /// A joint's transform to the model, ours, in a space: see [`Space::model_from_joint`].
    pub fn model_from_joint_in(self, space: Space) -> Self {
        space.model_from_joint(self)
    }

    /// A joint's transform to its parent, ours, in a space; the model is the parent of a joint without one.
    pub fn parent_from_joint_in(self, space: Space, parent: Option<u32>) -> Self {
        match parent {
            None => space.model_from_joint(self),
            Some(_) => space.parent_from_joint(self),
        }
    }

    /// A joint's transform to its parent in a space, as ours.
    pub fn parent_from_joint_out_of(self, space: Space, parent: Option<u32>) -> Self {
        match parent {
            None => space.model_from_joint_to_ours(self),
            Some(_) => space.parent_from_joint(self),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPACES: [Space; 3] = [Space::Gltf, Space::Blender, Space::Unity];

    #[test]
    fn up_forward_and_left_of_every_space() {
        let (left, up, front) = (Vec3::X, Vec3::Y, Vec3::Z);
        let axes = |space: Space| [left, up, front].map(|v| space.from_ours(v));
        assert_eq!(axes(Space::Gltf), [Vec3::X, Vec3::Y, Vec3::Z]);
        assert_eq!(axes(Space::Blender), [Vec3::X, Vec3::Z, Vec3::NEG_Y]);
        assert_eq!(axes(Space::Unity), [Vec3::NEG_X, Vec3::Y, Vec3::Z]);
    }

    #[test]
    fn round_trips_are_exact_except_for_rotations() {
        let (v, q) = (Vec3::new(0.1, -2.0, 3.0), Rotation::from_xyzw(0.1, -0.3, 0.7, 0.64).normalize());
        for space in SPACES {
            assert_eq!(space.to_ours(space.from_ours(v)), v);
            let ours = RigidTransform { rotation: q, translation: v };
            assert_eq!(space.parent_from_joint(space.parent_from_joint(ours)), ours);
            let back = space.model_from_joint_to_ours(space.model_from_joint(ours));
            // Products with the quarter turn are rounded.
            assert!(back.translation == v && back.rotation.dot(q) > 1.0 - 1e-6, "{space:?}");
        }
    }

    #[test]
    fn points_of_a_joint_land_in_the_same_place() {
        let q = Rotation::from_axis_angle(Vec3::new(0.48, -0.6, 0.64), 1.1);
        let (translation, point) = (Vec3::new(4.0, 5.0, -6.0), Vec3::new(0.3, 1.7, -0.2));
        let ours = RigidTransform { rotation: q, translation };
        let matrix = Mat4::from(ours.to_affine());
        for space in SPACES {
            // Coordinates in the joint's own frame change only under the reflection.
            let in_joint = if space == Space::Unity { space.from_ours(point) } else { point };
            let expected = space.from_ours(q * point + translation);
            let there = space.model_from_joint(ours);
            // A few roundings of numbers near 8.
            assert!((there.rotation * in_joint + there.translation).distance(expected) < 4e-6, "{space:?}");
            let model_from_joint = space.model_from_joint_matrix(matrix);
            assert!(model_from_joint.transform_point3(in_joint).distance(expected) < 4e-6, "{space:?}");
            let joint_from_model = space.joint_from_model_matrix(matrix.inverse());
            assert!(joint_from_model.transform_point3(expected).distance(in_joint) < 4e-6, "{space:?}");
        }
    }

    #[test]
    fn bones_run_along_y_everywhere() {
        // An upper arm of the T-pose: its bone runs to the left.
        let q = Rotation::from_rotation_z(-std::f32::consts::FRAC_PI_2);
        for space in SPACES {
            let there = space.model_from_joint(RigidTransform { rotation: q, translation: Vec3::ZERO });
            assert!((there.rotation * Vec3::Y).distance(space.from_ours(Vec3::X)) < 1e-6, "{space:?}");
        }
    }

    #[test]
    fn every_axis_becomes_y_up() {
        for axis in Axis::ALL {
            assert_eq!(axis.vector_to_ours(axis.direction()), Vec3::Y, "{axis}");
            for v in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::new(1.0, 2.0, 3.0)] {
                assert!((axis.ours_from_file() * v).distance(axis.vector_to_ours(v)) < 1e-6, "{axis}");
            }
            assert_eq!(axis.to_string().parse::<Axis>().unwrap(), axis);
        }
        assert_eq!(Axis::Z.vector_to_ours(Vec3::Z), Vec3::Y);
        // Y down and Z away, as of a camera, in front of which a person faces it.
        assert_eq!(Axis::NegativeY.vector_to_ours(Vec3::NEG_Z), Vec3::Z);
        assert_eq!(Axis::Y.vector_to_ours(Vec3::Z), Vec3::Z);
    }

    #[test]
    fn units_are_written_and_read() {
        for unit in Unit::NAMED.into_iter().chain([Unit::Metres(0.04)]) {
            assert_eq!(unit.to_string().parse::<Unit>().unwrap(), unit);
            assert_eq!(Unit::from_metres(unit.metres()), Some(unit));
        }
        for wrong in ["", "miles", "-1", "NaN", "0", "inf"] {
            assert!(
                wrong.parse::<Unit>().unwrap_err().to_string().contains("expected one of m, dm"),
                "{wrong}"
            );
        }
        let axes = ["y", "Z", "-x", "+Y"].map(|a| a.parse::<Axis>().unwrap());
        assert_eq!(axes, [Axis::Y, Axis::Z, Axis::NegativeX, Axis::Y]);
        assert!(["w", "", "--y", "-"].iter().all(|wrong| wrong.parse::<Axis>().is_err()));
    }
}
