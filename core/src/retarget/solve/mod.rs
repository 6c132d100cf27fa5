//! Pose transfer: a motion of a skeleton of any proportions and rest pose is transferred to a body of the rig.
//!
//! Bones of limbs take the directions of the source's bones in model space; the trunk takes its rotations. Everything that
//! depends on the two skeletons alone is computed once, in a [`Retargeter`], after which a frame costs one product of
//! quaternions per joint (see `reference.rs`).

mod bones;
mod direction;
mod drivers;
mod fingers;
mod hinge;
mod jump;
mod reference;
mod root;
#[cfg(test)]
mod tests;

use std::str::FromStr;
use std::sync::Arc;

pub(super) use direction::direction_error_from;
pub use direction::{BoneError, DirectionError, direction_error};
use hinge::{HingedLimb, MeanHingeAngle};
pub use jump::{Jump, worst_jump};
use reference::Reference;
use root::PelvisMotion;

use super::JointMap;
use crate::clip::{Clip, TranslationTrack};
use crate::math::{RigidTransform, Rotation};
use crate::pose::twist::{self, Twist};
use crate::skeleton::{Pose, SidedJoint, Skeleton};
use crate::{Error, Result, Side};

/// Which joint carries root motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RootMotion {
    /// The pelvis; the joint `Root` stays at the origin.
    #[default]
    Pelvis,
    /// `Root` moves along the floor with the pelvis, without rotating; the pelvis moves only up and down relative to it.
    Root,
}

/// Where finger poses come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FingerMode {
    /// From the source, for each hand of which it has at least four joints besides the thumb; otherwise as `Relaxed`.
    #[default]
    Source,
    /// A relaxed hand.
    Relaxed,
    /// The rest pose.
    Rest,
}

impl FingerMode {
    /// Every mode.
    pub const ALL: [Self; 3] = [Self::Source, Self::Relaxed, Self::Rest];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Source => "source",
            Self::Relaxed => "relaxed",
            Self::Rest => "rest",
        }
    }
}

impl FromStr for FingerMode {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|mode| mode.name() == text).ok_or_else(|| {
            let known = Self::ALL.map(Self::name).join(", ");
            Error::request("fingers", format!("expected one of {known}, got `{text}`"))
        })
    }
}

/// What feet keep of the source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FootMode {
    /// The sole: a foot that is flat in the source is flat, whatever the slope of the source's foot bone.
    #[default]
    Sole,
    /// The direction of the bone from ankle to ball.
    Bone,
}

/// How the height of the floor is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Floor {
    /// From the lowest feet of the clip: the body is lowered or lifted by one height for all frames until they stand on the
    /// floor.
    #[default]
    Fit,
    /// It is y = 0 of the source.
    Source,
}

/// How poses are transferred.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransferOptions {
    /// Which joint carries root motion; the pelvis by default.
    pub root: RootMotion,
    /// Where finger poses come from; by default from the source where it has fingers.
    pub fingers: FingerMode,
    /// What feet keep of the source; the sole by default.
    pub feet: FootMode,
    /// How the height of the floor is found; from the lowest feet by default.
    pub floor: Floor,
    /// Whether elbows and knees bend about their hinge axes, with the remaining roll moved to upper arm, hand, thigh and foot;
    /// on by default. Directions of bones do not change.
    pub hinges: bool,
    /// Scale of root motion and heights; `None` is the ratio of leg lengths.
    pub scale: Option<f32>,
}

impl Default for TransferOptions {
    fn default() -> Self {
        Self {
            root: RootMotion::default(),
            fingers: FingerMode::default(),
            feet: FootMode::default(),
            floor: Floor::default(),
            hinges: true,
            scale: None,
        }
    }
}

/// Both skeletons and their rest poses, `model_from_joint`.
struct Joints<'a> {
    source: &'a Skeleton,
    target: &'a Skeleton,
    source_rest: Vec<RigidTransform>,
    target_rest: Vec<RigidTransform>,
}

/// What determines the rotation of a joint of the target.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Driver {
    /// This constant `parent_from_joint`.
    Still(Rotation),
    /// `model_from_joint` of the source joint times this offset.
    Joint(usize, Rotation),
    /// Slerp between two of these; the number is from 0, the first, to 1.
    Between([(usize, Rotation); 2], f32),
}

/// Transfers clips of one skeleton to another. Created once per pair of skeletons; immutable.
#[derive(Clone, Debug)]
pub struct Retargeter {
    source: Skeleton,
    target: Arc<Skeleton>,
    drivers: Vec<Driver>,
    limbs: Vec<HingedLimb>,
    twists: Vec<Twist>,
    pelvis: PelvisMotion,
    options: TransferOptions,
}

impl Retargeter {
    /// For clips of `source`, whose joints `map` matches. `target` is the skeleton of a body, see
    /// [`Body::skeleton`](crate::Body::skeleton).
    ///
    /// # Errors
    /// [`Error::Invalid`] when the target lacks pelvis or thighs, `map` is of another source, or the scale is not positive.
    pub fn new(
        source: &Skeleton,
        target: Arc<Skeleton>,
        map: &JointMap,
        options: &TransferOptions,
    ) -> Result<Self> {
        Self::with_reference(source, source.model_from_joints(), target, map, options)
    }

    /// As [`new`](Self::new), with a pose of the source, `model_from_joint`, that is compared with the target's rest pose in
    /// place of the source's own.
    pub(super) fn with_reference(
        source: &Skeleton,
        source_rest: Vec<RigidTransform>,
        target: Arc<Skeleton>,
        map: &JointMap,
        options: &TransferOptions,
    ) -> Result<Self> {
        if let Some(scale) = options.scale.filter(|s| !(s.is_finite() && *s > 0.0)) {
            return Err(Error::invalid("retargeting", format!("expected a positive scale, got {scale}")));
        }
        if map.joints().any(|joint| joint >= source.len()) {
            return Err(Error::invalid(
                "retargeting",
                "the joint map is of another skeleton than the source",
            ));
        }
        let joints = Joints { source, target: &target, source_rest, target_rest: target.model_from_joints() };
        let reference = Reference::new(map, &joints);
        let pelvis = PelvisMotion::new(&reference, options.scale)
            .ok_or_else(|| Error::invalid("retargeting", "the target has no pelvis with thighs"))?;
        let mut limbs = Vec::new();
        for side in Side::ALL {
            limbs.extend(HingedLimb::of(&reference, [SidedJoint::Upperarm, SidedJoint::Lowerarm], side, 1.0));
            limbs.extend(HingedLimb::of(&reference, [SidedJoint::Thigh, SidedJoint::Calf], side, -1.0));
        }
        let drivers = drivers::drivers(&reference, options);
        let twists = twist::find(joints.target);
        Ok(Self { source: source.clone(), drivers, limbs, twists, pelvis, options: *options, target })
    }

    /// Scale of root motion and heights.
    pub fn scale(&self) -> f32 {
        self.pelvis.scale
    }

    /// The clip on the target's skeleton, with the same frames, rate and name.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the clip's skeleton is not the source, or when numbers overflow.
    pub fn retarget(&self, clip: &Clip) -> Result<Clip> {
        self.retarget_with(clip, |_, _| {})
    }

    /// As [`retarget`](Self::retarget), with a callback that may change every pose before the floor is found, for instance
    /// to clamp joints. `finish` gets the frame and the pose; changes of translations are ignored.
    ///
    /// # Errors
    /// As [`retarget`](Self::retarget).
    pub fn retarget_with(&self, clip: &Clip, mut finish: impl FnMut(usize, &mut Pose)) -> Result<Clip> {
        if **clip.skeleton() != self.source {
            let message = format!("`{}` moves another skeleton than the retargeter's source", clip.name());
            return Err(Error::invalid("clip", message));
        }
        let joints = Joints {
            source: &self.source,
            target: &self.target,
            source_rest: Vec::new(),
            target_rest: self.target.model_from_joints(),
        };
        let means = self.mean_hinge_angles(clip);
        let mut rotations = Vec::with_capacity(clip.frame_count() * self.target.len());
        let mut positions = Vec::with_capacity(clip.frame_count());
        let (mut pose, mut source, mut model, mut locals) = (Pose::default(), vec![], vec![], vec![]);
        let mut rolls = vec![None; self.twists.len()];
        let mut finished = self.target.rest_pose().clone();
        for frame in 0..clip.frame_count() {
            clip.model_into(frame, &mut pose, &mut source);
            self.model_rotations(&source, &mut model);
            if self.options.hinges {
                for (limb, mean) in self.limbs.iter().zip(&means) {
                    limb.bend_about_hinge(*mean, &mut model);
                }
            }
            let position = self.pelvis.position(&source, model[self.pelvis.joint]);
            self.locals(&mut model, &mut locals);
            for (local, rotation) in finished.locals.iter_mut().zip(&locals) {
                local.rotation = *rotation;
            }
            finish(frame, &mut finished);
            // Twist joints share the roll that the joint limits have left.
            locals.clear();
            locals.extend(finished.locals.iter().map(|local| local.rotation));
            twist::apply(&self.twists, &mut locals, &mut rolls);
            rotations.extend_from_slice(&locals);
            positions.push(position);
        }
        if self.options.floor == Floor::Fit {
            let above = self.pelvis.height_above_floor(&joints, &rotations, &positions);
            positions.iter_mut().for_each(|position| position.y -= above);
        }
        let tracks = self.pelvis.translations(&joints, self.options.root, positions).into_iter();
        let tracks = tracks.map(|(joint, values)| TranslationTrack { joint: joint as u32, values }).collect();
        let rest = self.target.clone();
        Clip::new(clip.name().to_owned(), rest, clip.frames_per_second(), rotations, tracks)
    }

    /// Rotations in model space of the joints that the source drives; the others keep those of the previous frame.
    fn model_rotations(&self, source: &[RigidTransform], model: &mut Vec<Rotation>) {
        model.resize(self.drivers.len(), Rotation::IDENTITY);
        for (rotation, driver) in model.iter_mut().zip(&self.drivers) {
            match *driver {
                Driver::Still(_) => {}
                Driver::Joint(joint, offset) => *rotation = source[joint].rotation * offset,
                Driver::Between([(a, from), (b, to)], t) => {
                    *rotation = (source[a].rotation * from).slerp(source[b].rotation * to, t);
                }
            }
        }
        for limb in &self.limbs {
            limb.aim(source, model);
        }
    }

    /// Rotations of `parent_from_joint` from those in model space, which are filled in for joints with constant rotations.
    fn locals(&self, model: &mut [Rotation], locals: &mut Vec<Rotation>) {
        locals.clear();
        for (joint, (driver, parent)) in self.drivers.iter().zip(self.target.parents()).enumerate() {
            let parent = parent.and_then(|p| model.get(p as usize)).copied().unwrap_or(Rotation::IDENTITY);
            locals.push(match *driver {
                Driver::Still(local) => {
                    model[joint] = parent * local;
                    local
                }
                _ => (parent.conjugate() * model[joint]).normalize(),
            });
        }
    }

    /// The mean over the clip of each limb's angle between bending and hinge, radians; empty without hinges.
    fn mean_hinge_angles(&self, clip: &Clip) -> Vec<f32> {
        let mut means = vec![MeanHingeAngle::default(); self.limbs.len()];
        if !self.options.hinges {
            return Vec::new();
        }
        let (mut pose, mut source, mut model) = (Pose::default(), vec![], vec![]);
        for frame in 0..clip.frame_count() {
            clip.model_into(frame, &mut pose, &mut source);
            self.model_rotations(&source, &mut model);
            for (mean, limb) in means.iter_mut().zip(&self.limbs) {
                mean.add(limb.hinge_angle(&model));
            }
        }
        means.into_iter().map(|mean| mean.angle(clip.frame_count())).collect()
    }
}
