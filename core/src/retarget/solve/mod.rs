//! Retargeting: a motion of one skeleton, of any proportions and rest pose, onto ours.
//!
//! Bones of limbs point in the world where the source's point; the trunk turns as the source's trunk turns. Everything
//! that depends on the two skeletons alone is computed once, in a [`Retargeter`], of which a frame is then a product of
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
mod twist;

use std::str::FromStr;
use std::sync::Arc;

pub use direction::{BoneError, DirectionError, direction_error};
use hinge::{Limb, MeanFold};
pub use jump::{Jump, worst_jump};
use reference::Reference;
use root::Root;
use twist::Twist;

use super::JointMap;
use crate::clip::{Clip, TranslationTrack};
use crate::math::{RigidTransform, Rotation};
use crate::skeleton::{Pose, SidedJoint, Skeleton};
use crate::{Error, Result, Side};

/// Who carries the way over the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RootMotion {
    /// The pelvis; our `Root` stays at the origin.
    #[default]
    Pelvis,
    /// `Root` moves over the ground below the pelvis, without turning; the pelvis only moves up and down in it.
    Root,
}

/// What fingers do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FingerMode {
    /// As the source's, on each hand of which it has at least four joints besides the thumb; else as `Relaxed`.
    #[default]
    Source,
    /// Hands at ease.
    Relaxed,
    /// As at rest.
    Rest,
}

impl FingerMode {
    /// Every mode.
    pub const ALL: [Self; 3] = [Self::Source, Self::Relaxed, Self::Rest];

    /// The word for it on the command line.
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
    /// The sole: a foot that stands flat in the source stands flat, whatever the slope its bone is drawn at.
    #[default]
    Sole,
    /// The direction of the bone from ankle to ball.
    Bone,
}

/// Where the floor is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Floor {
    /// Below the lowest foot of the clip: the body is lowered or lifted, as a whole and by one height for all frames,
    /// until it stands there.
    #[default]
    Fit,
    /// At y = 0 of the source.
    Source,
}

/// How to retarget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransferOptions {
    /// Who carries the way over the ground; the pelvis.
    pub root: RootMotion,
    /// What fingers do; the source's where it has any, else at ease.
    pub fingers: FingerMode,
    /// What feet keep; the sole.
    pub feet: FootMode,
    /// Where the floor is; below the lowest foot.
    pub floor: Floor,
    /// Whether elbows and knees fold about their hinges, with the roll that is left over given to upper arm, hand,
    /// thigh and foot; they do. Directions stay as they are.
    pub hinges: bool,
    /// Scale of the way over the ground and of heights; `None`, the ratio of the legs' lengths.
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

/// Both skeletons, and where their joints rest in model space.
struct Joints<'a> {
    source: &'a Skeleton,
    target: &'a Skeleton,
    source_rest: Vec<RigidTransform>,
    target_rest: Vec<RigidTransform>,
}

/// What moves a joint of the target.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Driver {
    /// `parent_from_joint` stays this.
    Still(Rotation),
    /// `model_from_joint` is the source joint's, and this after it.
    Joint(usize, Rotation),
    /// Between those of two source joints: `0` is the first.
    Between([(usize, Rotation); 2], f32),
}

/// Carries clips of one skeleton over to another. Made once per pair, shared freely.
#[derive(Clone, Debug)]
pub struct Retargeter {
    source: Skeleton,
    target: Arc<Skeleton>,
    drivers: Vec<Driver>,
    limbs: Vec<Limb>,
    twists: Vec<Twist>,
    root: Root,
    options: TransferOptions,
}

impl Retargeter {
    /// Prepares for clips of `source`, matched by `map`. `target` is a body of ours: see [`Body::skeleton`](crate::Body::skeleton).
    ///
    /// # Errors
    /// [`Error::Invalid`] when the target lacks pelvis or thighs, `map` is of another source, or the scale is not
    /// positive.
    pub fn new(
        source: &Skeleton,
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
        let joints = Joints {
            source,
            target: &target,
            source_rest: source.model_from_joints(),
            target_rest: target.model_from_joints(),
        };
        let reference = Reference::new(map, &joints);
        let root = Root::new(&reference, options.scale)
            .ok_or_else(|| Error::invalid("retargeting", "the target has no pelvis with thighs"))?;
        let mut limbs = Vec::new();
        for side in Side::ALL {
            limbs.extend(Limb::of(&reference, [SidedJoint::Upperarm, SidedJoint::Lowerarm], side, 1.0));
            limbs.extend(Limb::of(&reference, [SidedJoint::Thigh, SidedJoint::Calf], side, -1.0));
        }
        let drivers = drivers::drivers(&reference, options);
        let twists = twist::find(&joints);
        Ok(Self { source: source.clone(), drivers, limbs, twists, root, options: *options, target })
    }

    /// What the way over the ground and heights are scaled by.
    pub fn scale(&self) -> f32 {
        self.root.scale
    }

    /// The clip on the target's skeleton: as many frames, the same rate and name.
    ///
    /// # Errors
    /// [`Error::Invalid`] when the clip's skeleton is not the source, or its numbers are too large to work with.
    pub fn retarget(&self, clip: &Clip) -> Result<Clip> {
        self.retarget_with(clip, |_, _| {})
    }

    /// As [`retarget`](Self::retarget), with a word in every frame's pose before the floor is found: joint limits, say.
    /// `finish` gets the frame and the pose, whose rotations it may change.
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
        let means = self.mean_folds(clip);
        let mut rotations = Vec::with_capacity(clip.frame_count() * self.target.len());
        let mut places = Vec::with_capacity(clip.frame_count());
        let (mut pose, mut source, mut model, mut locals) = (Pose::default(), vec![], vec![], vec![]);
        let mut rolls = vec![None; self.twists.len()];
        let mut finished = self.target.rest_pose().clone();
        for frame in 0..clip.frame_count() {
            clip.model_into(frame, &mut pose, &mut source);
            self.model_rotations(&source, &mut model);
            if self.options.hinges {
                for (limb, mean) in self.limbs.iter().zip(&means) {
                    limb.fold_about_hinge(*mean, &mut model);
                }
            }
            let place = self.root.place(&source, model[self.root.pelvis]);
            self.locals(&mut model, &mut locals);
            for (local, rotation) in finished.locals.iter_mut().zip(&locals) {
                local.rotation = *rotation;
            }
            finish(frame, &mut finished);
            // The twist joints share what limits have left of the roll.
            locals.clear();
            locals.extend(finished.locals.iter().map(|local| local.rotation));
            twist::apply(&self.twists, &mut locals, &mut rolls);
            rotations.extend_from_slice(&locals);
            places.push(place);
        }
        if self.options.floor == Floor::Fit {
            let above = self.root.above_floor(&joints, &rotations, &places);
            places.iter_mut().for_each(|place| place.y -= above);
        }
        let tracks = self.root.split(&joints, self.options.root, places).into_iter();
        let tracks = tracks.map(|(joint, values)| TranslationTrack { joint: joint as u32, values }).collect();
        let rest = self.target.clone();
        Clip::new(clip.name().to_owned(), rest, clip.frames_per_second(), rotations, tracks)
    }

    /// Rotations in model space of the joints that the source drives; the others' are left over from before.
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

    /// `parent_from_joint` from rotations in model space, which joints that stay still get on the way.
    fn locals(&self, model: &mut [Rotation], locals: &mut Vec<Rotation>) {
        locals.clear();
        for (joint, (driver, parent)) in self.drivers.iter().zip(self.target.parents()).enumerate() {
            let above = parent.and_then(|p| model.get(p as usize)).copied().unwrap_or(Rotation::IDENTITY);
            locals.push(match *driver {
                Driver::Still(local) => {
                    model[joint] = above * local;
                    local
                }
                _ => (above.conjugate() * model[joint]).normalize(),
            });
        }
    }

    /// How far each limb folds beside its hinge in the mean of the clip.
    fn mean_folds(&self, clip: &Clip) -> Vec<f32> {
        let mut means = vec![MeanFold::default(); self.limbs.len()];
        if !self.options.hinges {
            return Vec::new();
        }
        let (mut pose, mut source, mut model) = (Pose::default(), vec![], vec![]);
        for frame in 0..clip.frame_count() {
            clip.model_into(frame, &mut pose, &mut source);
            self.model_rotations(&source, &mut model);
            for (mean, limb) in means.iter_mut().zip(&self.limbs) {
                mean.add(limb.fold(&model));
            }
        }
        means.into_iter().map(|mean| mean.angle(clip.frame_count())).collect()
    }
}
