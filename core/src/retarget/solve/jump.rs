//! Jumps of a retargeted clip from one frame to the next that its source does not have.

use glam::DQuat;
use serde::Serialize;

use super::super::JointMap;
use super::bones::LIMB_BONES;
use crate::clip::Clip;
use crate::math::RigidTransform;
use crate::skeleton::{Pose, SidedJoint, Skeleton};

/// The result of [`worst_jump`].
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Jump {
    /// How much farther a joint rotates in one frame than the source, degrees; 0 when none does.
    pub degrees: f64,
    /// The joint of the rig; `None` when there is no jump.
    pub joint: Option<String>,
    /// The frame before the jump.
    pub frame: usize,
}

/// The largest rotation of a joint of an arm or a leg in model space between two frames, beyond the largest one in the source
/// of the joints above and below it, within a frame of that time. Capture errors are in both clips and do not count. Only
/// frames that both clips have are compared.
pub fn worst_jump(source: &Clip, target: &Clip, map: &JointMap) -> Jump {
    let frames = source.frame_count().min(target.frame_count());
    let limbs = limbs(target.skeleton(), map);
    let theirs = steps(source, frames, limbs.iter().flat_map(|(_, sources)| sources.iter().copied()));
    let ours = steps(target, frames, limbs.iter().map(|(joint, _)| *joint));
    let mut worst = Jump::default();
    for (joint, sources) in limbs {
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

/// The joints of arms and legs, each with the source joints of itself, its ancestors and its descendants.
fn limbs(target: &Skeleton, map: &JointMap) -> Vec<(usize, Vec<usize>)> {
    let above =
        |joint: usize| std::iter::successors(Some(joint), |j| target.parents()[*j].map(|p| p as usize));
    let ours: Vec<_> = target.rig_joints().collect();
    let related = |joint: usize| {
        let relatives =
            (0..target.len()).filter(|j| above(joint).any(|a| a == *j) || above(*j).any(|a| a == joint));
        relatives.filter_map(|j| map.source_of(ours[j]?)).collect::<Vec<_>>()
    };
    let limbs = LIMB_BONES.iter().map(|(joint, _)| *joint).chain([SidedJoint::Ball]);
    let joints = limbs.flat_map(SidedJoint::both).filter_map(|joint| target.rig_joint(joint));
    joints.map(|j| (j, related(j))).filter(|(_, sources)| !sources.is_empty()).collect()
}

/// The rotation of these joints in model space from each frame to the next, degrees; 0 for the others.
fn steps(clip: &Clip, frames: usize, joints: impl Iterator<Item = usize>) -> Vec<Vec<f64>> {
    let mut wanted = vec![false; clip.skeleton().len()];
    joints.for_each(|joint| wanted[joint] = true);
    let (mut pose, mut before, mut after) = (Pose::default(), Vec::<RigidTransform>::new(), Vec::new());
    let mut steps = Vec::with_capacity(frames);
    for frame in 0..frames {
        std::mem::swap(&mut before, &mut after);
        clip.model_into(frame, &mut pose, &mut after);
        if frame > 0 {
            let angles = before.iter().zip(&after).zip(&wanted).map(|((a, b), wanted)| {
                if !wanted {
                    return 0.0;
                }
                let delta = DQuat::from(a.rotation.conjugate() * b.rotation);
                2.0 * libm::atan2(delta.xyz().length(), delta.w.abs()).to_degrees()
            });
            steps.push(angles.collect());
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
    fn only_jumps_that_the_source_lacks_count() {
        let rest = person();
        let source = motion(&rest, 12);
        let map = JointMap::find(&rest, &Overrides::new()).unwrap();
        assert!(worst_jump(&source, &source, &map).degrees < 1e-3);
        // One foot is off by 40° in frame 6 alone.
        let foot = rest.find("foot_l").unwrap();
        let with_error = |frame: usize, joint: usize| {
            let by = if frame == 6 && joint == foot { 40.0_f32 } else { 0.0 };
            source.rotations(frame)[joint] * Rotation::from_rotation_x(by.to_radians())
        };
        let rotations = (0..12).flat_map(|f| (0..rest.len()).map(move |j| (f, j)));
        let rotations = rotations.map(|(f, j)| with_error(f, j)).collect();
        let clip =
            Clip::new("c".into(), rest.clone(), 30.0, rotations, source.translations().to_vec()).unwrap();
        let jump = worst_jump(&source, &clip, &map);
        assert!(matches!(jump.joint.as_deref(), Some("foot_l" | "ball_l")), "{jump:?}");
        assert!((5..=6).contains(&jump.frame) && (20.0..41.0).contains(&jump.degrees), "{jump:?}");
        assert_eq!(worst_jump(&clip, &clip, &map), Jump::default(), "an error of the source itself");
    }
}
