//! Motion: files as they were read, retargeted to bodies, and clips of a body's skeleton.

use std::path::Path;

use anthronet::Error;
use anthronet::clip;
use anthronet::clip::{BUILTIN, JointMask, Sampler};
use anthronet::format::{self, ReadOptions};
use anthronet::math::RigidTransform;
use anthronet::retarget::feet::FeetOptions;
use anthronet::retarget::{self, Overrides, RetargetOptions, RootMotion, TransferOptions};
use anthronet::skeleton::Pose;
use anthronet::space::Space;

use crate::Result;
use crate::body::Body;
use crate::bridge::ffi;
use crate::context::Context;
use crate::enums::{Meaning, at, finite, given};

pub(crate) struct Clip {
    clip: clip::Clip,
    report: String,
}

pub(crate) struct Motion(format::Motion);

pub(crate) fn builtin_clips() -> Vec<String> {
    BUILTIN.iter().map(|name| (*name).to_owned()).collect()
}

impl From<clip::Clip> for Box<Clip> {
    fn from(clip: clip::Clip) -> Self {
        Self::new(Clip { clip, report: String::new() })
    }
}

impl Clip {
    pub(crate) fn builtin(name: &str, body: &Body) -> Result<Box<Self>> {
        Ok(clip::builtin(name, body.body.skeleton())?.into())
    }

    pub(crate) fn clip(&self) -> &clip::Clip {
        &self.clip
    }

    pub(crate) fn name(&self) -> &str {
        self.clip.name()
    }

    pub(crate) fn renamed(&self, name: &str) -> Box<Self> {
        Box::new(Self { clip: self.clip.clone().with_name(name), report: self.report.clone() })
    }

    pub(crate) fn frame_count(&self) -> usize {
        self.clip.frame_count()
    }

    pub(crate) fn joint_count(&self) -> usize {
        self.clip.skeleton().len()
    }

    pub(crate) fn frames_per_second(&self) -> f64 {
        self.clip.frames_per_second()
    }

    pub(crate) fn duration(&self) -> f64 {
        self.clip.duration()
    }

    pub(crate) fn report(&self) -> &str {
        &self.report
    }

    pub(crate) fn sample(
        &self,
        context: &mut Context,
        seconds: f64,
        wrap: ffi::Wrap,
        relative: ffi::Relative,
        space: ffi::Space,
        joints: &mut [ffi::Transform],
    ) -> Result<()> {
        let (wrap, to_model, space) = (wrap.meaning()?, relative.meaning()?, space.meaning()?);
        finite("seconds", seconds)?;
        room(joints, self.joint_count())?;
        let Context { pose, model, .. } = context;
        Sampler::new(&self.clip, wrap).sample_into(seconds, pose);
        self.write(pose, model, to_model, space, joints);
        Ok(())
    }

    pub(crate) fn bake(
        &self,
        relative: ffi::Relative,
        space: ffi::Space,
        joints: &mut [ffi::Transform],
    ) -> Result<()> {
        let (to_model, space) = (relative.meaning()?, space.meaning()?);
        room(joints, self.frame_count() * self.joint_count())?;
        let (mut pose, mut model) = (Pose::default(), Vec::new());
        for (frame, joints) in joints.chunks_exact_mut(self.joint_count()).enumerate() {
            self.clip.pose_into(frame, &mut pose);
            self.write(&pose, &mut model, to_model, space, joints);
        }
        Ok(())
    }

    pub(crate) fn resample(&self, frames_per_second: f64) -> Result<Box<Self>> {
        Ok(clip::resample(&self.clip, frames_per_second)?.into())
    }

    pub(crate) fn in_place(&self) -> Result<Box<Self>> {
        Ok(clip::in_place(&self.clip)?.into())
    }

    pub(crate) fn looped(&self, seconds: f64) -> Result<Box<Self>> {
        Ok(clip::looped(&self.clip, seconds)?.into())
    }

    pub(crate) fn blend(&self, other: &Self, weight: f32) -> Result<Box<Self>> {
        finite("weight", weight.into())?;
        Ok(clip::blend(&self.clip, &other.clip, weight, None)?.into())
    }

    pub(crate) fn joint_mask(&self, joint: &str) -> Result<Vec<f32>> {
        let mask = JointMask::below(self.clip.skeleton(), &[joint])?;
        Ok((0..self.joint_count()).map(|joint| mask.weight(joint)).collect())
    }

    pub(crate) fn blend_masked(&self, other: &Self, weight: f32, mask: &[f32]) -> Result<Box<Self>> {
        finite("weight", weight.into())?;
        let mask = JointMask::of_weights(self.clip.skeleton(), mask)?;
        Ok(clip::blend(&self.clip, &other.clip, weight, Some(&mask))?.into())
    }

    pub(crate) fn additive(&self, layer: &Self, weight: f32, mask: &[f32]) -> Result<Box<Self>> {
        finite("weight", weight.into())?;
        let mask = match mask {
            [] => None,
            weights => Some(JointMask::of_weights(self.clip.skeleton(), weights)?),
        };
        let reference = layer.clip.pose(0);
        Ok(clip::additive(&self.clip, &layer.clip, &reference, weight, mask.as_ref())?.into())
    }

    pub(crate) fn crossfade(&self, next: &Self, seconds: f64) -> Result<Box<Self>> {
        Ok(clip::crossfade(&self.clip, &next.clip, seconds)?.into())
    }

    /// Writes a pose for the caller; `model` is room for its joints relative to the model.
    fn write(
        &self,
        pose: &Pose,
        model: &mut Vec<RigidTransform>,
        to_model: bool,
        space: Space,
        out: &mut [ffi::Transform],
    ) {
        let parents = self.clip.skeleton().parents();
        if to_model {
            anthronet::skeleton::model_from_joints(parents, &pose.locals, model);
            for (out, joint) in out.iter_mut().zip(model) {
                *out = joint.model_from_joint_in(space).into();
            }
        } else {
            for ((out, joint), parent) in out.iter_mut().zip(&pose.locals).zip(parents) {
                *out = joint.parent_from_joint_in(space, *parent).into();
            }
        }
    }
}

fn room(joints: &[ffi::Transform], expected: usize) -> Result<()> {
    if joints.len() == expected {
        return Ok(());
    }
    Err(Error::invalid("joints", format!("expected room for {expected} transforms, got {}", joints.len())))
}

impl Motion {
    pub(crate) fn open(path: &str, options: &ffi::MotionOptions) -> Result<Box<Self>> {
        crate::panic::keep_caught_ones_quiet();
        Ok(Box::new(Self(format::read_motion(path, &read_options(options)?)?)))
    }

    pub(crate) fn from_bytes(bytes: &[u8], name: &str, options: &ffi::MotionOptions) -> Result<Box<Self>> {
        crate::panic::keep_caught_ones_quiet();
        Ok(Box::new(Self(format::read_motion_from_bytes(bytes, name, &read_options(options)?)?)))
    }

    pub(crate) fn clip_count(&self) -> usize {
        self.0.clips.len()
    }

    pub(crate) fn clip_name(&self, clip: usize) -> Result<&str> {
        Ok(at(&self.0.clips, clip, "clip")?.name())
    }

    pub(crate) fn report(&self) -> Result<String> {
        json("motion report", &self.0.report)
    }

    pub(crate) fn retarget(
        &self,
        clip: usize,
        body: &Body,
        options: &ffi::RetargetOptions,
    ) -> Result<Box<Clip>> {
        let options = retarget_options(options)?;
        let source = at(&self.0.clips, clip, "clip")?;
        let (clip, report) = retarget::retarget_clip(source, body.body.skeleton(), &options)?;
        report.check(&options)?;
        let report = json("retarget report", &report)?;
        Ok(Box::new(Clip { clip, report }))
    }
}

fn read_options(asked: &ffi::MotionOptions) -> Result<ReadOptions> {
    let options = ReadOptions {
        unit: None,
        up: asked.up.meaning()?,
        person: asked.person.checked_sub(1).map(|person| person as usize),
        frames_per_second: given(asked.frames_per_second),
    };
    match given(asked.metres_per_unit) {
        None => Ok(options),
        Some(metres) => options.with_metres_per_unit(metres),
    }
}

fn retarget_options(asked: &ffi::RetargetOptions) -> Result<RetargetOptions> {
    let transfer = TransferOptions {
        fingers: asked.fingers.meaning()?,
        root: if asked.root_motion { RootMotion::Root } else { RootMotion::Pelvis },
        ..TransferOptions::default()
    };
    let mapping = match asked.mapping_json.as_str() {
        "" => Overrides::new(),
        json => retarget::read_overrides(json, Path::new("mapping_json"))?,
    };
    Ok(RetargetOptions {
        mapping,
        transfer,
        limits: !asked.no_limits,
        feet: (!asked.no_feet).then(FeetOptions::default),
        in_place: asked.in_place,
        looped: asked.looped,
        force: asked.force,
        frames_per_second: given(asked.frames_per_second),
    })
}

fn json(what: &'static str, value: &impl serde::Serialize) -> Result<String> {
    serde_json::to_string(value).map_err(|e| Error::invalid(what, e.to_string()))
}
