//! Skeletons of the SMPL family: public joint names and hierarchy, joint positions of our own.
//!
//! The body models' own joint positions are under licences that forbid use in products, and vary with the shape anyway.
//! These are round numbers for a person 1.70 m tall in a T-pose, from common proportions: legs about half of the stature,
//! arm span about the stature. Retargeting scales by leg length, so that only ratios matter.

use glam::Vec3;

use super::Result;
use crate::Side;
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::Skeleton;

/// A rest pose: +Y up, facing +Z, metres; joint rotations are the identity.
pub(super) struct BodyModel {
    pub(super) name: &'static str,
    pub(super) skeleton: Skeleton,
}

/// A joint: name, parent, position. The right joint of a pair repeats the left one's position; its x changes sign on use.
type Row = (&'static str, &'static str, [f32; 3]);

/// The first 22 joints of every model of the family, in its order.
const BODY: [Row; 22] = [
    ("pelvis", "", [0.0, 0.95, 0.0]),
    ("left_hip", "pelvis", [0.09, 0.88, 0.0]),
    ("right_hip", "pelvis", [0.09, 0.88, 0.0]),
    ("spine1", "pelvis", [0.0, 1.06, 0.0]),
    ("left_knee", "left_hip", [0.10, 0.48, 0.0]),
    ("right_knee", "right_hip", [0.10, 0.48, 0.0]),
    ("spine2", "spine1", [0.0, 1.18, 0.0]),
    ("left_ankle", "left_knee", [0.10, 0.08, -0.02]),
    ("right_ankle", "right_knee", [0.10, 0.08, -0.02]),
    ("spine3", "spine2", [0.0, 1.24, 0.0]),
    ("left_foot", "left_ankle", [0.11, 0.02, 0.10]),
    ("right_foot", "right_ankle", [0.11, 0.02, 0.10]),
    ("neck", "spine3", [0.0, 1.44, -0.02]),
    ("left_collar", "spine3", [0.06, 1.36, -0.01]),
    ("right_collar", "spine3", [0.06, 1.36, -0.01]),
    ("head", "neck", [0.0, 1.53, 0.0]),
    ("left_shoulder", "left_collar", [0.18, 1.40, -0.01]),
    ("right_shoulder", "right_collar", [0.18, 1.40, -0.01]),
    ("left_elbow", "left_shoulder", [0.45, 1.40, -0.01]),
    ("right_elbow", "right_shoulder", [0.45, 1.40, -0.01]),
    ("left_wrist", "left_elbow", [0.70, 1.40, -0.01]),
    ("right_wrist", "right_elbow", [0.70, 1.40, -0.01]),
];
/// The hands of SMPL.
const PALMS: [Row; 2] =
    [("left_hand", "left_wrist", [0.78, 1.40, -0.01]), ("right_hand", "right_wrist", [0.78, 1.40, -0.01])];
/// The joints of SMPL-X between body and hands.
const FACE: [Row; 3] = [
    ("jaw", "head", [0.0, 1.54, 0.03]),
    ("left_eye", "head", [0.03, 1.59, 0.08]),
    ("right_eye", "head", [0.03, 1.59, 0.08]),
];
/// Fingers of the left hand in the order of SMPL-H and SMPL-X: position of the first knuckle, and the lengths to the next
/// two joints and to the tip. The thumb points forwards and outwards, the others along the arm.
const FINGERS: [(&str, [f32; 3], [f32; 3]); 5] = [
    ("index", [0.79, 1.40, 0.02], [0.04, 0.025, 0.02]),
    ("middle", [0.80, 1.40, 0.0], [0.045, 0.03, 0.02]),
    ("pinky", [0.77, 1.40, -0.05], [0.03, 0.02, 0.02]),
    ("ring", [0.79, 1.40, -0.03], [0.04, 0.03, 0.02]),
    ("thumb", [0.72, 1.39, 0.02], [0.04, 0.03, 0.025]),
];

/// The joints of a body model beyond the first 22.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Joints {
    /// SMPL's hands, one joint each.
    pub(super) palms: bool,
    pub(super) jaw: bool,
    pub(super) eyes: bool,
    /// Fingers.
    pub(super) hands: bool,
}

/// The models that are known by their number of joints: body only, SMPL, SMPL-H, SMPL-X without and with eyes.
pub(super) const MODELS: [Joints; 5] = {
    let none = Joints { palms: false, jaw: false, eyes: false, hands: false };
    let hands = Joints { hands: true, ..none };
    let jaw = Joints { jaw: true, ..hands };
    [none, Joints { palms: true, ..none }, hands, jaw, Joints { eyes: true, ..jaw }]
};

impl Joints {
    pub(super) fn count(self) -> usize {
        let Self { palms, jaw, eyes, hands } = self;
        BODY.len()
            + 2 * usize::from(palms)
            + usize::from(jaw)
            + 2 * usize::from(eyes)
            + 30 * usize::from(hands)
    }
}

/// The body model with these joints.
pub(super) fn body_model(joints: Joints) -> Result<BodyModel> {
    let mut found = Building::default();
    found.extend(&BODY);
    let [jaw, eyes @ ..] = FACE;
    if joints.palms {
        found.extend(&PALMS);
    }
    if joints.jaw {
        found.extend(&[jaw]);
    }
    if joints.eyes {
        found.extend(&eyes);
    }
    if joints.hands {
        found.add_hands();
    }
    let name = match joints {
        Joints { jaw: true, .. } | Joints { eyes: true, .. } => "SMPL-X",
        Joints { hands: true, .. } => "SMPL-H",
        Joints { palms: true, .. } => "SMPL",
        _ => "AMASS (body)",
    };
    Ok(BodyModel { name, skeleton: found.skeleton()? })
}

#[derive(Default)]
struct Building {
    names: Vec<String>,
    parents: Vec<Option<u32>>,
    places: Vec<Vec3>,
    ends: Vec<Option<Vec3>>,
}

impl Building {
    fn add(&mut self, name: String, parent: &str, place: Vec3, end: Option<Vec3>) {
        self.parents.push(self.names.iter().position(|n| n == parent).map(|p| p as u32));
        self.names.push(name);
        self.places.push(place);
        self.ends.push(end);
    }

    fn extend(&mut self, rows: &[Row]) {
        for &(name, parent, [x, y, z]) in rows {
            let x = if name.starts_with("right_") { -x } else { x };
            let end = match name.trim_start_matches("left_").trim_start_matches("right_") {
                "head" => Some(Vec3::Y * 0.17),
                "foot" => Some(Vec3::Z * 0.08),
                "hand" => Some(Vec3::X * 0.1 * x.signum()),
                _ => None,
            };
            self.add(name.to_owned(), parent, Vec3::new(x, y, z), end);
        }
    }

    fn add_hands(&mut self) {
        for side in Side::ALL {
            let mirror = |v: Vec3| Vec3::new(v.x * side.sign(), v.y, v.z);
            let side = side.name();
            for (finger, knuckle, lengths) in FINGERS {
                let along = if finger == "thumb" { Vec3::new(0.6, 0.0, 0.8) } else { Vec3::X };
                let (mut place, mut parent) = (Vec3::from(knuckle), format!("{side}_wrist"));
                for (i, length) in lengths.into_iter().enumerate() {
                    let name = format!("{side}_{finger}{}", i + 1);
                    let end = (i == 2).then(|| mirror(along * length));
                    self.add(name.clone(), &parent, mirror(place), end);
                    place += along * length;
                    parent = name;
                }
            }
        }
    }

    fn skeleton(self) -> Result<Skeleton> {
        let step = |(place, parent): (&Vec3, &Option<u32>)| {
            let from = parent.map_or(Vec3::ZERO, |p| self.places[p as usize]);
            RigidTransform { rotation: Rotation::IDENTITY, translation: *place - from }
        };
        let rest = self.places.iter().zip(&self.parents).map(step).collect();
        Ok(Skeleton::new(self.names, self.parents, rest, self.ends).map_err(Box::new)?)
    }
}
