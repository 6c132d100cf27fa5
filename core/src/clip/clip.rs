//! A clip: the motion of a skeleton, sampled at a fixed rate.

use std::sync::Arc;

use glam::Vec3;

use crate::math::{RigidTransform, Rotation, unit};
use crate::skeleton::{Pose, Skeleton};
use crate::{Error, Result};

/// Most frames of a clip.
pub const MAX_FRAMES: usize = 1 << 20;
/// Most rotations of a clip, frames × joints, so that a damaged file cannot exhaust memory.
pub const MAX_ROTATIONS: usize = 1 << 28;

/// The translation of one joint in every frame.
#[derive(Clone, Debug, PartialEq)]
pub struct TranslationTrack {
    /// Index of the joint.
    pub joint: u32,
    /// One per frame: translation of `parent_from_joint`, metres.
    pub values: Vec<Vec3>,
}

/// A motion of a skeleton, sampled at a fixed rate. Metres, seconds, +Y up.
#[derive(Clone, Debug, PartialEq)]
pub struct Clip {
    name: String,
    rest: Arc<Skeleton>,
    frames_per_second: f64,
    frame_count: usize,
    rotations: Vec<Rotation>,
    translations: Vec<TranslationTrack>,
}

impl Clip {
    /// From tracks: `rotations` are those of `parent_from_joint`, frame by frame, one per joint (frames × joints);
    /// `translations` are tracks of the joints that move relative to their parents, mostly the root; other joints keep their
    /// rest translation. Rotations are normalised, and each takes the sign nearer to that of the previous frame.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the clip, the joint and the frame when there are no frames or too many, the sizes do not
    /// match, a joint has two tracks, a number is not finite, a rotation is zero, or the rate is not in 0.1..=1000 frames a
    /// second.
    pub fn new(
        name: String,
        rest: Arc<Skeleton>,
        frames_per_second: f64,
        mut rotations: Vec<Rotation>,
        mut translations: Vec<TranslationTrack>,
    ) -> Result<Self> {
        let fail = |message: String| Err(Error::invalid("clip", format!("`{name}`: {message}")));
        let joints = rest.len();
        if !(0.1..=1000.0).contains(&frames_per_second) {
            return fail(format!("expected 0.1 to 1000 frames a second, got {frames_per_second}"));
        }
        let frame_count = rotations.len() / joints;
        if frame_count == 0 || frame_count > MAX_FRAMES || rotations.len() > MAX_ROTATIONS {
            return fail(format!("expected 1 to {MAX_FRAMES} frames, got {frame_count} of {joints} joints"));
        }
        if frame_count * joints != rotations.len() {
            return fail(format!("{} rotations for {joints} joints", rotations.len()));
        }
        for i in 0..rotations.len() {
            let rotation = rotations[i];
            if !rotation.is_finite() || rotation.length_squared() < 1e-12 {
                let (frame, joint) = (i / joints, &rest.names()[i % joints]);
                return fail(format!("frame {frame}, joint `{joint}`: rotation {rotation} is none"));
            }
            let rotation = unit(rotation);
            let before = if i < joints { Rotation::IDENTITY } else { rotations[i - joints] };
            rotations[i] = if rotation.dot(before) < 0.0 { -rotation } else { rotation };
        }
        translations.sort_by_key(|track| track.joint);
        for (i, track) in translations.iter().enumerate() {
            let Some(joint) = rest.names().get(track.joint as usize) else {
                return fail(format!("a translation of joint {} of {joints}", track.joint));
            };
            if i > 0 && translations[i - 1].joint == track.joint {
                return fail(format!("joint `{joint}` has two translations"));
            }
            if track.values.len() != frame_count {
                let got = track.values.len();
                return fail(format!("joint `{joint}`: expected {frame_count} translations, got {got}"));
            }
            if let Some(frame) = track.values.iter().position(|v| !v.is_finite()) {
                return fail(format!("frame {frame}, joint `{joint}`: translation is not finite"));
            }
        }
        Ok(Self { name, rest, frames_per_second, frame_count, rotations, translations })
    }

    /// From poses: `locals` are `parent_from_joint`, frame by frame, one per joint (frames × joints). Joints that leave their
    /// rest translation get a translation track.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn from_poses(
        name: String,
        rest: Arc<Skeleton>,
        frames_per_second: f64,
        locals: &[RigidTransform],
    ) -> Result<Self> {
        let joints = rest.len();
        let moving = |joint: &usize| {
            let at_rest = rest.rest_pose().locals[*joint].translation;
            locals.iter().skip(*joint).step_by(joints).any(|local| local.translation != at_rest)
        };
        let track = |joint: usize| TranslationTrack {
            joint: joint as u32,
            values: locals.iter().skip(joint).step_by(joints).map(|local| local.translation).collect(),
        };
        let translations = (0..joints).filter(moving).map(track).collect();
        let rotations = locals.iter().map(|local| local.rotation).collect();
        Self::new(name, rest, frames_per_second, rotations, translations)
    }

    /// Its name, as in files.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The same clip under another name.
    pub fn with_name(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// The skeleton that moves, with its rest pose.
    pub fn skeleton(&self) -> &Arc<Skeleton> {
        &self.rest
    }

    /// Frames per second.
    pub fn frames_per_second(&self) -> f64 {
        self.frames_per_second
    }

    /// Number of frames.
    pub fn frame_count(&self) -> usize {
        self.frame_count
    }

    /// Time from the first to the last frame, seconds.
    pub fn duration(&self) -> f64 {
        (self.frame_count - 1) as f64 / self.frames_per_second
    }

    /// Rotations of `parent_from_joint` in a frame, one per joint; empty beyond the last frame.
    pub fn rotations(&self, frame: usize) -> &[Rotation] {
        let joints = self.rest.len();
        self.rotations.get(frame * joints..(frame + 1) * joints).unwrap_or(&[])
    }

    /// Tracks of the joints that move relative to their parents, in the order of the joints.
    pub fn translations(&self) -> &[TranslationTrack] {
        &self.translations
    }

    /// Writes the pose of a frame to `pose`; beyond the last frame, that of the last.
    pub fn pose_into(&self, frame: usize, pose: &mut Pose) {
        let frame = frame.min(self.frame_count - 1);
        pose.locals.clear();
        let rest = &self.rest.rest_pose().locals;
        let rotations = self.rotations(frame);
        pose.locals.extend(
            rest.iter()
                .zip(rotations)
                .map(|(r, q)| RigidTransform { rotation: *q, translation: r.translation }),
        );
        for track in &self.translations {
            pose.locals[track.joint as usize].translation = track.values[frame];
        }
    }

    /// The pose of a frame; beyond the last frame, that of the last.
    pub fn pose(&self, frame: usize) -> Pose {
        let mut pose = Pose::default();
        self.pose_into(frame, &mut pose);
        pose
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rest() -> Arc<Skeleton> {
        let names = ["hips", "leg"].map(String::from).to_vec();
        let step = RigidTransform { rotation: Rotation::IDENTITY, translation: Vec3::NEG_Y };
        Arc::new(Skeleton::new(names, vec![None, Some(0)], vec![step; 2], vec![None; 2]).unwrap())
    }

    #[test]
    fn a_pose_has_the_rotations_of_its_frame_and_translations_of_the_tracks() {
        let rotated = Rotation::from_rotation_x(1.0);
        let track = TranslationTrack { joint: 0, values: vec![Vec3::ZERO, Vec3::X] };
        let clip = Clip::new(
            "walk".into(),
            rest(),
            30.0,
            vec![Rotation::IDENTITY, rotated, rotated, -rotated],
            vec![track],
        )
        .unwrap();
        assert_eq!((clip.frame_count(), clip.duration()), (2, 1.0 / 30.0));
        let pose = clip.pose(1);
        assert_eq!((pose.locals[0].translation, pose.locals[1].translation), (Vec3::X, Vec3::NEG_Y));
        assert!(pose.locals[1].rotation.dot(clip.pose(0).locals[1].rotation) > 0.99, "continuous sign");
        assert_eq!(clip.pose(9), pose);
    }

    #[test]
    fn poses_become_rotations_and_tracks_of_moving_joints() {
        let rotated = Rotation::from_rotation_x(1.0);
        let frame = |at: Vec3| {
            let hips = RigidTransform { rotation: rotated, translation: at };
            [hips, RigidTransform { rotation: Rotation::IDENTITY, translation: Vec3::NEG_Y }]
        };
        let poses = [frame(Vec3::NEG_Y), frame(Vec3::X)].concat();
        let clip = Clip::from_poses("step".into(), rest(), 30.0, &poses).unwrap();
        assert_eq!(clip.translations().iter().map(|t| t.joint).collect::<Vec<_>>(), [0]);
        assert_eq!([clip.pose(0).locals, clip.pose(1).locals].concat(), poses);
        assert!(Clip::from_poses("step".into(), rest(), 30.0, &poses[..3]).is_err());
    }

    #[test]
    fn names_what_is_wrong() {
        let q = Rotation::IDENTITY;
        let track = |joint, n| TranslationTrack { joint, values: vec![Vec3::ZERO; n] };
        let nan = Rotation::from_xyzw(f32::NAN, 0.0, 0.0, 1.0);
        let cases = [
            ("frames a second, got 0", 0.0, vec![q; 2], vec![]),
            ("got 0 of 2 joints", 30.0, vec![], vec![]),
            ("3 rotations for 2 joints", 30.0, vec![q; 3], vec![]),
            ("frame 1, joint `leg`", 30.0, vec![q, q, q, nan], vec![]),
            ("joint 2 of 2", 30.0, vec![q; 2], vec![track(2, 1)]),
            ("`leg` has two translations", 30.0, vec![q; 2], vec![track(1, 1), track(1, 1)]),
            ("expected 1 translations, got 2", 30.0, vec![q; 2], vec![track(1, 2)]),
        ];
        for (expected, rate, rotations, tracks) in cases {
            let error = Clip::new("c".into(), rest(), rate, rotations, tracks).unwrap_err().to_string();
            assert!(error.contains(expected) && error.contains("`c`"), "{error}");
        }
    }
}
