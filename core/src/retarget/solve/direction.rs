//! Angles between bones of a retargeted clip and of its source.

use serde::Serialize;

use super::super::JointMap;
use super::bones::{Bone, LIMB_BONES};
use crate::Side;
use crate::clip::Clip;
use crate::skeleton::{Pose, SidedJoint};

/// Angle between a bone of the source and of the target in model space, over the frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BoneError {
    /// The joint of the rig at which the bone begins.
    pub bone: String,
    /// Mean over the frames, degrees.
    pub mean: f64,
    /// Maximum over the frames, degrees.
    pub max: f64,
}

/// The result of [`direction_error`].
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DirectionError {
    /// Upper arms, forearms, thighs and calves.
    pub limbs: Vec<BoneError>,
    /// Hands and feet. The bone of a flat foot has different slopes in different skeletons; with
    /// [`FootMode::Sole`](super::FootMode::Sole) its error is that difference.
    pub ends: Vec<BoneError>,
}

impl DirectionError {
    /// Mean over [`limbs`](Self::limbs), degrees; 0 without any.
    pub fn mean(&self) -> f64 {
        self.limbs.iter().map(|bone| bone.mean).sum::<f64>() / self.limbs.len().max(1) as f64
    }

    /// Maximum over [`limbs`](Self::limbs) in any frame, degrees.
    pub fn max(&self) -> f64 {
        self.limbs.iter().map(|bone| bone.max).fold(0.0, f64::max)
    }
}

/// Compares the directions of bones in model space, in the frames that both clips have. Bones that a skeleton lacks are left
/// out.
pub fn direction_error(source: &Clip, target: &Clip, map: &JointMap) -> DirectionError {
    let mut result = DirectionError::default();
    let (mut pose, mut theirs, mut ours) = (Pose::default(), Vec::new(), Vec::new());
    let mut bones: Vec<(SidedJoint, Bone, BoneError)> = Vec::new();
    for side in Side::ALL {
        for (joint, _) in LIMB_BONES {
            if let Some(bone) = Bone::of(joint.on(side), map, source.skeleton(), target.skeleton()) {
                let name = joint.on(side).name().to_owned();
                bones.push((joint, bone, BoneError { bone: name, mean: 0.0, max: 0.0 }));
            }
        }
    }
    let frames = source.frame_count().min(target.frame_count());
    for frame in 0..frames {
        source.model_into(frame, &mut pose, &mut theirs);
        target.model_into(frame, &mut pose, &mut ours);
        for (_, bone, error) in &mut bones {
            let (a, b) = (bone.of_source(&theirs).as_dvec3(), bone.of_target(&ours).as_dvec3());
            let degrees = libm::atan2(a.cross(b).length(), a.dot(b)).to_degrees();
            error.mean += degrees / frames as f64;
            error.max = error.max.max(degrees);
        }
    }
    for (joint, _, error) in bones {
        let end = matches!(joint, SidedJoint::Hand | SidedJoint::Foot);
        if end { &mut result.ends } else { &mut result.limbs }.push(error);
    }
    result
}
