//! Sampling a clip at any time.

use super::Clip;
use crate::math::RigidTransform;
use crate::skeleton::Pose;

/// What a clip does outside its duration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// Holds the first and the last frame.
    #[default]
    Once,
    /// Repeats. The last frame is the first frame of the next cycle, as in clips from [`looped`](super::looped), so the
    /// period is the clip's duration.
    Loop,
    /// Repeats with root motion: as [`Wrap::Loop`], and each cycle moves the topmost joints with translations on by their
    /// displacement along the floor in one cycle. For clips that walk straight ahead.
    RootMotion,
}

/// Samples poses of a clip between its frames. Cheap to create and copy; sampling allocates nothing once the pose has its
/// size.
///
/// Rotations are interpolated by [`slerp`](crate::math::Rotation::slerp), translations linearly.
#[derive(Clone, Copy, Debug)]
pub struct Sampler<'a> {
    clip: &'a Clip,
    wrap: Wrap,
}

impl<'a> Sampler<'a> {
    /// A sampler of a clip.
    pub fn new(clip: &'a Clip, wrap: Wrap) -> Self {
        Self { clip, wrap }
    }

    /// Writes the pose at a time in seconds to `pose`. A time that is not finite counts as 0.
    pub fn sample_into(&self, seconds: f64, pose: &mut Pose) {
        let (frame, share, cycles) = self.locate(if seconds.is_finite() { seconds } else { 0.0 });
        self.clip.pose_into(frame, pose);
        if share > 0.0 {
            let next = self.clip.rotations(frame + 1);
            for (local, next) in pose.locals.iter_mut().zip(next) {
                local.rotation = local.rotation.slerp(*next, share);
            }
            for track in self.clip.translations() {
                let local = &mut pose.locals[track.joint as usize];
                local.translation = local.translation.lerp(track.values[frame + 1], share);
            }
        }
        if cycles != 0.0 {
            for track in self.clip.top_tracks() {
                let last = track.values[track.values.len() - 1];
                let step = (last - track.values[0]).with_y(0.0);
                pose.locals[track.joint as usize].translation += step * cycles;
            }
        }
    }

    /// The pose at a time in seconds.
    pub fn sample(&self, seconds: f64) -> Pose {
        let mut pose = Pose::default();
        self.sample_into(seconds, &mut pose);
        pose
    }

    /// The frame before a time, the fraction of the way to the next, and the cycles of root motion before it.
    fn locate(&self, seconds: f64) -> (usize, f32, f32) {
        let last = self.clip.frame_count() - 1;
        let duration = self.clip.duration();
        let mut at = seconds;
        let mut cycles = 0.0;
        if self.wrap != Wrap::Once && duration > 0.0 {
            let cycle = libm::floor(seconds / duration);
            at = seconds - cycle * duration;
            cycles = if self.wrap == Wrap::RootMotion { cycle as f32 } else { 0.0 };
        }
        let place = (at * self.clip.frames_per_second()).clamp(0.0, last as f64);
        // Times of frames, which binary numbers only approximate, give the frame itself.
        let nearest = libm::round(place);
        if libm::fabs(place - nearest) < 1e-6 {
            return (nearest as usize, 0.0, cycles);
        }
        let frame = (place as usize).min(last);
        (frame, (place - frame as f64) as f32, cycles)
    }
}

/// Interpolates two transforms `parent_from_joint`: `a` at 0, `b` at 1.
pub(super) fn mix(a: RigidTransform, b: RigidTransform, share: f32) -> RigidTransform {
    if share == 0.0 {
        return a;
    }
    RigidTransform {
        rotation: a.rotation.slerp(b.rotation, share),
        translation: a.translation.lerp(b.translation, share),
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec3;

    use super::*;
    use crate::clip::TranslationTrack;
    use crate::math::Rotation;
    use crate::skeleton::Skeleton;

    /// One joint that rotates from 0 to 1 radian about X and moves a metre forwards and up, in three frames at 10 a second.
    fn clip() -> Clip {
        let rest = Skeleton::new(vec!["root".into()], vec![None], vec![RigidTransform::IDENTITY], vec![None])
            .unwrap();
        let rotation = |angle| Rotation::from_rotation_x(angle);
        let values = vec![Vec3::ZERO, Vec3::new(0.0, 0.5, 0.5), Vec3::new(0.0, 1.0, 1.0)];
        let tracks = vec![TranslationTrack { joint: 0, values }];
        Clip::new("c".into(), Arc::new(rest), 10.0, vec![rotation(0.0), rotation(0.5), rotation(1.0)], tracks)
            .unwrap()
    }

    #[test]
    fn between_frames_rotation_and_translation_are_interpolated() {
        let clip = clip();
        let local = Sampler::new(&clip, Wrap::Once).sample(0.025).locals[0];
        assert!(local.rotation.angle_between(Rotation::from_rotation_x(0.125)) < 1e-3);
        assert!(local.translation.distance(Vec3::new(0.0, 0.125, 0.125)) < 1e-6);
    }

    #[test]
    fn outside_its_duration_a_clip_holds_repeats_or_travels() {
        let clip = clip();
        let at = |wrap, seconds| Sampler::new(&clip, wrap).sample(seconds).locals[0].translation;
        assert_eq!(at(Wrap::Once, -1.0), Vec3::ZERO);
        assert_eq!(at(Wrap::Once, 9.0), Vec3::new(0.0, 1.0, 1.0));
        assert_eq!(at(Wrap::Once, f64::NAN), Vec3::ZERO);
        assert!(at(Wrap::Loop, 0.45).distance(Vec3::new(0.0, 0.25, 0.25)) < 1e-5);
        assert!(at(Wrap::Loop, -0.15).distance(Vec3::new(0.0, 0.25, 0.25)) < 1e-5);
        assert!(at(Wrap::RootMotion, 0.45).distance(Vec3::new(0.0, 0.25, 2.25)) < 1e-5);
    }

    #[test]
    fn the_time_of_a_frame_gives_that_frame() {
        let clip = clip();
        for wrap in [Wrap::Once, Wrap::Loop] {
            assert_eq!(Sampler::new(&clip, wrap).sample(0.1), clip.pose(1));
        }
    }
}
