//! Editing a clip: resampling, looping, removing root motion.

use std::sync::Arc;

use glam::Vec3;

use super::sample::{Sampler, Wrap, mix};
use super::{Clip, MAX_FRAMES, TranslationTrack};
use crate::math::smoothstep;
use crate::skeleton::{Pose, Skeleton};
use crate::{Error, Result};

impl Clip {
    /// The topmost translation tracks: of joints none of whose ancestors has one. They carry root motion.
    pub(super) fn top_tracks(&self) -> impl Iterator<Item = &TranslationTrack> {
        self.translations().iter().filter(|track| {
            let mut above = self.skeleton().parents()[track.joint as usize];
            while let Some(joint) = above {
                if self.translations().iter().any(|t| t.joint == joint) {
                    return false;
                }
                above = self.skeleton().parents()[joint as usize];
            }
            true
        })
    }
}

/// A clip from poses; joints that leave their rest translation get a track.
///
/// # Errors
/// As [`Clip::new`].
pub(super) fn clip_of_poses(
    name: &str,
    rest: &Arc<Skeleton>,
    frames_per_second: f64,
    poses: impl IntoIterator<Item = Pose>,
) -> Result<Clip> {
    let at_rest: Vec<Vec3> = rest.rest_pose().locals.iter().map(|l| l.translation).collect();
    let mut rotations = Vec::new();
    let mut tracks: Vec<Option<Vec<Vec3>>> = vec![None; rest.len()];
    for (frame, pose) in poses.into_iter().enumerate() {
        rotations.extend(pose.locals.iter().map(|l| l.rotation));
        for ((local, at_rest), track) in pose.locals.iter().zip(&at_rest).zip(&mut tracks) {
            if track.is_none() && local.translation != *at_rest {
                *track = Some(vec![*at_rest; frame]);
            }
            if let Some(values) = track {
                values.push(local.translation);
            }
        }
    }
    let tracks = tracks
        .into_iter()
        .enumerate()
        .filter_map(|(joint, values)| Some(TranslationTrack { joint: joint as u32, values: values? }))
        .collect();
    Clip::new(name.to_owned(), rest.clone(), frames_per_second, rotations, tracks)
}

/// The clip at another frame rate. The first frame is kept; the last is the last that lies within the clip.
///
/// # Errors
/// [`Error::Request`] when the rate is not in 0.1..=1000 or the clip would have more than [`MAX_FRAMES`].
pub fn resample(clip: &Clip, frames_per_second: f64) -> Result<Clip> {
    let field = "frames_per_second";
    if !(0.1..=1000.0).contains(&frames_per_second) {
        return Err(Error::request(field, format!("expected 0.1 to 1000, got {frames_per_second}")));
    }
    // A tolerance of a hundredth of a frame, as rates such as 29.97 are rounded.
    let frames = libm::floor(clip.duration() * frames_per_second + 0.01) as usize + 1;
    if frames > MAX_FRAMES {
        let message =
            format!("{frames_per_second} a second makes {frames} frames, expected up to {MAX_FRAMES}");
        return Err(Error::request(field, message));
    }
    let sampler = Sampler::new(clip, Wrap::Once);
    let poses = (0..frames).map(|frame| sampler.sample(frame as f64 / frames_per_second));
    clip_of_poses(clip.name(), clip.skeleton(), frames_per_second, poses)
}

/// Makes the clip loop: its first `seconds` are cut off and blended over its last `seconds`, so that the last pose equals
/// the first. The clip gets shorter by `seconds`. Root motion along the floor is kept; height and everything else match.
///
/// # Errors
/// [`Error::Request`] when `seconds` is not between 0 and half of the clip.
pub fn looped(clip: &Clip, seconds: f64) -> Result<Clip> {
    let half = 0.5 * clip.duration();
    if !(0.0..=half).contains(&seconds) {
        return Err(Error::request("loop", format!("expected a blend of 0 to {half} s, got {seconds}")));
    }
    let fade = libm::round(seconds * clip.frames_per_second()) as usize;
    let last = clip.frame_count() - 1;
    // Frames fade..=last remain. Over the last `fade` of them the clip blends into frames 0..=fade, moved by its travel.
    let fade = fade.min(last / 2);
    let travel = travel(clip, fade, last);
    let poses = (fade..=last).map(|frame| {
        let mut pose = clip.pose(frame);
        let into = frame + fade - last.min(frame + fade);
        let share = if fade > 0 { into as f32 / fade as f32 } else { f32::from(u8::from(frame == last)) };
        if share > 0.0 {
            let mut lead = clip.pose(if fade > 0 { into } else { 0 });
            for (joint, by) in &travel {
                lead.locals[*joint as usize].translation += *by;
            }
            let share = smoothstep(share);
            for (local, lead) in pose.locals.iter_mut().zip(&lead.locals) {
                *local = mix(*local, *lead, share);
            }
        }
        pose
    });
    clip_of_poses(clip.name(), clip.skeleton(), clip.frames_per_second(), poses)
}

/// Plays a looping clip `times` times. Its last pose equals its first but for root motion, which continues.
///
/// # Errors
/// As [`Clip::new`].
pub(crate) fn repeated(clip: &Clip, times: usize) -> Result<Clip> {
    let cycle = clip.frame_count() - 1;
    let travel = travel(clip, 0, cycle);
    let poses = (0..=times * cycle).map(|frame| {
        let round = (frame / cycle.max(1)).min(times.saturating_sub(1));
        let mut pose = clip.pose(frame - round * cycle);
        for (joint, by) in &travel {
            pose.locals[*joint as usize].translation += *by * round as f32;
        }
        pose
    });
    clip_of_poses(clip.name(), clip.skeleton(), clip.frames_per_second(), poses)
}

/// `count` frames of a clip from `start` on, moved along the floor back to where the whole clip starts.
///
/// # Errors
/// As [`Clip::new`].
pub(crate) fn cut(clip: &Clip, start: usize, count: usize) -> Result<Clip> {
    let travel = travel(clip, 0, start);
    let poses = (start..start + count).map(|frame| {
        let mut pose = clip.pose(frame);
        for (joint, by) in &travel {
            pose.locals[*joint as usize].translation -= *by;
        }
        pose
    });
    clip_of_poses(clip.name(), clip.skeleton(), clip.frames_per_second(), poses)
}

/// The clip with its last pose replaced by its first, at the last one's position on the floor.
///
/// # Errors
/// As [`Clip::new`].
pub(crate) fn closed(clip: &Clip) -> Result<Clip> {
    let last = clip.frame_count() - 1;
    let travel = travel(clip, 0, last);
    let poses = (0..=last).map(|frame| {
        let mut pose = clip.pose(if frame < last { frame } else { 0 });
        if frame == last {
            for (joint, by) in &travel {
                pose.locals[*joint as usize].translation += *by;
            }
        }
        pose
    });
    clip_of_poses(clip.name(), clip.skeleton(), clip.frames_per_second(), poses)
}

/// Root motion along the floor between two frames: joints and their displacements, metres.
fn travel(clip: &Clip, from: usize, to: usize) -> Vec<(u32, Vec3)> {
    clip.top_tracks().map(|t| (t.joint, (t.values[to] - t.values[from]).with_y(0.0))).collect()
}

/// The clip without root motion: the topmost joints with translations keep their first position on the floor; heights are
/// kept.
///
/// # Errors
/// As [`Clip::new`].
pub fn in_place(clip: &Clip) -> Result<Clip> {
    let mut tracks = clip.translations().to_vec();
    let top: Vec<u32> = clip.top_tracks().map(|t| t.joint).collect();
    for track in tracks.iter_mut().filter(|t| top.contains(&t.joint)) {
        let first = track.values[0];
        track.values.iter_mut().for_each(|v| *v = Vec3::new(first.x, v.y, first.z));
    }
    let rotations = (0..clip.frame_count()).flat_map(|f| clip.rotations(f).iter().copied()).collect();
    Clip::new(clip.name().to_owned(), clip.skeleton().clone(), clip.frames_per_second(), rotations, tracks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::clips::swing;

    #[test]
    fn resampling_and_back_keeps_the_rotations() {
        let clip = swing("a", 0.5, 31);
        let fine = resample(&clip, 120.0).unwrap();
        assert_eq!((fine.frame_count(), fine.frames_per_second()), (121, 120.0));
        let back = resample(&fine, 30.0).unwrap();
        assert_eq!(back.frame_count(), 31);
        for frame in 0..31 {
            for (a, b) in back.rotations(frame).iter().zip(clip.rotations(frame)) {
                assert!(a.dot(*b) > 1.0 - 1e-6);
            }
        }
        assert!(resample(&clip, f64::NAN).is_err());
        assert!(resample(&clip, 0.0).unwrap_err().to_string().contains("got 0"));
    }

    #[test]
    fn a_loop_ends_in_its_first_pose_and_still_travels() {
        let clip = swing("a", 0.5, 61);
        let closed = looped(&clip, 0.5).unwrap();
        assert_eq!(closed.frame_count(), 46);
        let (first, last) = (closed.pose(0), closed.pose(45));
        for (a, b) in first.locals.iter().zip(&last.locals) {
            assert!(a.rotation.dot(b.rotation) > 1.0 - 1e-6);
            assert!((a.translation.y - b.translation.y).abs() < 1e-5);
        }
        assert!(last.locals[0].translation.z - first.locals[0].translation.z > 1.0, "it still travels");
        let step = |f: usize| closed.rotations(f)[1].angle_between(closed.rotations(f - 1)[1]);
        // A cut would rotate by 0.7 rad in one frame; the swing itself rotates by 0.1.
        assert!((1..46).map(step).fold(0.0, f32::max) < 0.35, "without a jump");
        assert_eq!(looped(&clip, 0.0).unwrap().frame_count(), 61);
        assert!(looped(&clip, 9.0).is_err());
    }

    #[test]
    fn in_place_keeps_heights_and_rotations() {
        let clip = swing("a", 0.5, 61);
        let still = in_place(&clip).unwrap();
        for frame in 0..61 {
            let (a, b) = (still.pose(frame).locals[0].translation, clip.pose(frame).locals[0].translation);
            assert_eq!((a.x, a.z, a.y), (0.0, 0.0, b.y));
            assert_eq!(still.rotations(frame), clip.rotations(frame));
        }
    }
}
