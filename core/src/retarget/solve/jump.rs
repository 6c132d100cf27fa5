//! Jumps of a retargeted clip's limbs from one frame to the next that the source does not have.

use glam::DQuat;
use serde::Serialize;

use super::super::JointMap;
use super::bones::LIMBS;
use crate::clip::Clip;
use crate::math::RigidTransform;
use crate::skeleton::{Pose, SidedJoint, Skeleton};

/// What [`worst_jump`] finds.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Jump {
    /// How much farther a joint turns in one frame than the source does, degrees; 0 when none does.
    pub degrees: f64,
    /// The joint of ours.
    pub joint: Option<String>,
    /// The frame it jumps from.
    pub frame: usize,
}

/// The farthest that an arm's or a leg's joint turns in model space from one frame to the next, beyond what the source
/// turns any joint of that limb, or of those that it hangs on, within a frame of then. Faults of a capture are in
/// both clips and so no jump. Of clips of different lengths the frames that both have.
pub fn worst_jump(source: &Clip, target: &Clip, map: &JointMap) -> Jump {
    let frames = source.frame_count().min(target.frame_count());
    let (theirs, ours) = (steps(source, frames), steps(target, frames));
    let mut worst = Jump::default();
    for (joint, sources) in limbs(target.skeleton(), map) {
        for (frame, step) in ours.iter().enumerate() {
            let around = &theirs[frame.saturating_sub(1)..(frame + 2).min(theirs.len())];
            let allowed = around.iter().flat_map(|step| sources.iter().map(|s| step[*s])).fold(0.0, f64::max);
            if step[joint] - allowed > worst.degrees {
                let name = target.skeleton().names()[joint].clone();
                worst = Jump { degrees: step[joint] - allowed, joint: Some(name), frame };
            }
        }
    }
    worst
}

/// The joints of arms and legs, each with the source's joints above and below it.
fn limbs(target: &Skeleton, map: &JointMap) -> Vec<(usize, Vec<usize>)> {
    let above =
        |joint: usize| std::iter::successors(Some(joint), |j| target.parents()[*j].map(|p| p as usize));
    let ours: Vec<_> = target.rig_joints().collect();
    let related = |joint: usize| {
        let kin =
            (0..target.len()).filter(|j| above(joint).any(|a| a == *j) || above(*j).any(|a| a == joint));
        kin.filter_map(|j| map.source_of(ours[j]?)).collect::<Vec<_>>()
    };
    let limbs = LIMBS.iter().map(|(joint, _)| *joint).chain([SidedJoint::Ball]);
    let joints = limbs.flat_map(SidedJoint::both).filter_map(|joint| target.rig_joint(joint));
    joints.map(|j| (j, related(j))).filter(|(_, sources)| !sources.is_empty()).collect()
}

/// Degrees that every joint turns from each frame to the next, in model space.
fn steps(clip: &Clip, frames: usize) -> Vec<Vec<f64>> {
    let (mut pose, mut before, mut after) = (Pose::default(), Vec::<RigidTransform>::new(), Vec::new());
    let mut steps = Vec::with_capacity(frames);
    for frame in 0..frames {
        std::mem::swap(&mut before, &mut after);
        clip.model_into(frame, &mut pose, &mut after);
        if frame > 0 {
            let turns = before.iter().zip(&after).map(|(a, b)| {
                let turn = DQuat::from(a.rotation.conjugate() * b.rotation);
                2.0 * libm::atan2(turn.xyz().length(), turn.w.abs()).to_degrees()
            });
            steps.push(turns.collect());
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use crate::math::Rotation;

    use super::*;
    use crate::retarget::Overrides;
    use crate::testing::person::{motion, person};

    #[test]
    fn only_what_the_source_does_not_do_is_a_jump() {
        let rest = person();
        let source = motion(&rest, 12);
        let map = JointMap::find(&rest, &Overrides::new()).unwrap();
        assert!(worst_jump(&source, &source, &map).degrees < 1e-3);
        // A foot that is thrown by 40° in frame 6 alone.
        let foot = rest.find("foot_l").unwrap();
        let thrown = |frame: usize, joint: usize| {
            let by = if frame == 6 && joint == foot { 40.0_f32 } else { 0.0 };
            source.rotations(frame)[joint] * Rotation::from_rotation_x(by.to_radians())
        };
        let rotations = (0..12).flat_map(|f| (0..rest.len()).map(move |j| (f, j)));
        let rotations = rotations.map(|(f, j)| thrown(f, j)).collect();
        let clip =
            Clip::new("c".into(), rest.clone(), 30.0, rotations, source.translations().to_vec()).unwrap();
        let jump = worst_jump(&source, &clip, &map);
        assert!(matches!(jump.joint.as_deref(), Some("foot_l" | "ball_l")), "{jump:?}");
        assert!((5..=6).contains(&jump.frame) && (20.0..41.0).contains(&jump.degrees), "{jump:?}");
        assert_eq!(worst_jump(&clip, &clip, &map), Jump::default(), "the source's own fault");
    }
}
