//! Small clips for tests.

use std::sync::Arc;

use glam::Vec3;

use crate::clip::{Clip, TranslationTrack};
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::Skeleton;

/// A root that moves forward at 3 m/s and bobs, and a child that swings; 30 frames a second. `phase` shifts the swing.
pub(crate) fn swing(name: &str, phase: f32, frames: usize) -> Clip {
    let step = RigidTransform { rotation: Rotation::IDENTITY, translation: Vec3::ZERO };
    let names = ["root", "child"].map(String::from).to_vec();
    let rest = Skeleton::new(names, vec![None, Some(0)], vec![step; 2], vec![None; 2]).unwrap();
    let angle = |f: usize| libm::sinf(phase + 0.1 * f as f32);
    let rotations =
        (0..frames).flat_map(|f| [Rotation::IDENTITY, Rotation::from_rotation_x(angle(f))]).collect();
    let values =
        (0..frames).map(|f| Vec3::new(0.0, 0.1 * angle(f) - 0.1 * angle(0), 0.1 * f as f32)).collect();
    let tracks = vec![TranslationTrack { joint: 0, values }];
    Clip::new(name.into(), Arc::new(rest), 30.0, rotations, tracks).unwrap()
}
