//! Writes a clip as a SkelAnimation.

use openusd::gf::{Quatf, Vec3f, Vec3h, f16};
use openusd::sdf::{FieldKey, Value, Variability};

use super::layer::Layer;
use crate::Result;
use crate::clip::Clip;
use crate::math::RigidTransform;
use crate::skeleton::Pose;

/// Writes the clip to this path. `joints` is the skeleton's own joint list, `pace` the number of time codes per frame.
pub(super) fn write(layer: &mut Layer, path: &str, clip: &Clip, joints: &Value, pace: f64) -> Result<()> {
    layer.prim(path, clip.name(), "SkelAnimation")?;
    layer.uniform(path, "joints", "token[]", joints.clone())?;

    let samples = |value: &dyn Fn(&Pose) -> Value| {
        let mut pose = Pose::default();
        let sample = |frame: usize| {
            clip.pose_into(frame, &mut pose);
            (frame as f64 * pace, value(&pose))
        };
        Value::TimeSamples((0..clip.frame_count()).map(sample).collect())
    };
    // UsdSkel requires all three attributes, each with a value for every joint.
    let rotations = layer.declare(path, "rotations", "quatf[]", Variability::Varying, None)?;
    layer.set(&rotations, FieldKey::TimeSamples, samples(&rotations_of))?;
    if clip.translations().is_empty() {
        layer.attribute(path, "translations", "float3[]", translations_of(clip.skeleton().rest_pose()))?;
    } else {
        let translations = layer.declare(path, "translations", "float3[]", Variability::Varying, None)?;
        layer.set(&translations, FieldKey::TimeSamples, samples(&translations_of))?;
    }
    let one = Vec3h { x: f16::ONE, y: f16::ONE, z: f16::ONE };
    layer.attribute(path, "scales", "half3[]", Value::Vec3hVec(vec![one; clip.skeleton().len()]))?;
    Ok(())
}

fn rotations_of(pose: &Pose) -> Value {
    let rotation = |local: &RigidTransform| {
        let [x, y, z, w] = local.rotation.to_array();
        Quatf { w, x, y, z }
    };
    Value::QuatfVec(pose.locals.iter().map(rotation).collect())
}

fn translations_of(pose: &Pose) -> Value {
    Value::Vec3fVec(pose.locals.iter().map(|l| Vec3f::from(l.translation.to_array())).collect())
}
