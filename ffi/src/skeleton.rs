//! The joints of a body, their names in other programs, and where they rest.

use anthronet::skeleton::humanoid::{humanoid_bones, renamed};

use crate::body::anthronet_body;
use crate::options::{Descriptor, DescriptorOut, joint_names, space};
use crate::pointer::{Out, OutSlice, anthronet_text, at, exactly, read};
use crate::status::{anthronet_error, anthronet_status, guard};

/// Where a joint is, relative to its parent or to the model: a rotation, then a translation.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_transform {
    /// Unit quaternion x, y, z, w.
    pub rotation: [f32; 4],
    /// Metres.
    pub translation: [f32; 3],
}

/// A joint in the bind pose. Its +Y axis runs along its bone in every space. Matrices are column-major and multiply column vectors.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_joint {
    /// Place of the parent, before this joint's own; −1 of the root.
    pub parent: i32,
    /// From the joint along its +Y axis to where its bone ends, metres.
    pub length: f32,
    /// Relative to the parent.
    pub parent_from_joint: anthronet_transform,
    /// From the joint's space to the model's.
    pub model_from_joint: [f32; 16],
    /// The inverse bind matrix.
    pub joint_from_model: [f32; 16],
}

/// A joint that is a bone of the standard humanoid, with its name in every vocabulary. All texts stay valid.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_humanoid_bone {
    /// Set by the caller: `sizeof(anthronet_humanoid_bone)`.
    pub struct_size: u32,
    /// 1 if Unity and VRM 1.0 require it.
    pub required: u32,
    /// Name in the rig.
    pub native: anthronet_text,
    /// Member of Unity's `HumanBodyBones`.
    pub unity: anthronet_text,
    /// Name in Unity's `HumanTrait.BoneName`.
    pub unity_trait: anthronet_text,
    /// Name in files from Mixamo.
    pub mixamo: anthronet_text,
    /// Key in VRM 1.0's `humanBones`.
    pub vrm: anthronet_text,
    /// Name in Blender.
    pub blender: anthronet_text,
}

// SAFETY: numbers and texts of NULL, the size first.
unsafe impl Descriptor for anthronet_humanoid_bone {}

/// The joints of a body in the bind pose, parents first: fills `count` entries, as many as
/// `anthronet_body_summary.joint_count` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_body_joints(
    body: *const anthronet_body,
    in_space: u32,
    out_joints: *mut anthronet_joint,
    count: u32,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let space = space(in_space)?;
        let skeleton = read(body, "body")?.body.skeleton();
        exactly("count", skeleton.len(), count.into())?;
        let mut out = OutSlice::new(out_joints, count.into(), "out_joints")?;
        out.write(skeleton.bind_joints(space).map(|joint| anthronet_joint {
            parent: joint.parent.map_or(-1, |parent| parent as i32),
            length: joint.bone_length.unwrap_or_default(),
            parent_from_joint: joint.parent_from_joint.into(),
            model_from_joint: joint.model_from_joint.to_cols_array(),
            joint_from_model: joint.joint_from_model.to_cols_array(),
        }));
        Ok(())
    })
}

/// The name of a joint of a body in a vocabulary, `ANTHRONET_NAMES_…`; valid as long as the body.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_body_joint_name(
    body: *const anthronet_body,
    joint: u32,
    names: u32,
    out_name: *mut anthronet_text,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_name, "out_name")?;
        let names = joint_names(names)?;
        let native = at(read(body, "body")?.body.skeleton().names(), joint, "joint")?;
        out.write(anthronet_text::of(renamed_in_place(native, names)));
        Ok(())
    })
}

/// Number of humanoid bones: 55.
#[unsafe(no_mangle)]
pub extern "C" fn anthronet_humanoid_bone_count() -> u32 {
    humanoid_bones().len() as u32
}

/// A humanoid bone.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_humanoid_bone_at(
    index: u32,
    out_bone: *mut anthronet_humanoid_bone,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = DescriptorOut::new(out_bone, "out_bone")?;
        let bone = at(humanoid_bones(), index, "index")?;
        out.write(&anthronet_humanoid_bone {
            struct_size: 0,
            required: bone.required.into(),
            native: anthronet_text::of(&bone.native),
            unity: anthronet_text::of(&bone.unity),
            unity_trait: anthronet_text::of(&bone.unity_trait),
            mixamo: anthronet_text::of(&bone.mixamo),
            vrm: anthronet_text::of(&bone.vrm),
            blender: anthronet_text::of(&bone.blender),
        });
        Ok(())
    })
}

/// The name of a joint of the rig: borrowed from the table of names, or the joint's own.
fn renamed_in_place(native: &str, names: anthronet::skeleton::humanoid::JointNames) -> &str {
    match renamed(native, names) {
        std::borrow::Cow::Borrowed(name) => name,
        std::borrow::Cow::Owned(_) => native,
    }
}

impl From<anthronet::math::RigidTransform> for anthronet_transform {
    fn from(local: anthronet::math::RigidTransform) -> Self {
        Self { rotation: local.rotation.to_array(), translation: local.translation.to_array() }
    }
}

impl From<&anthronet_transform> for anthronet::math::RigidTransform {
    fn from(transform: &anthronet_transform) -> Self {
        Self {
            rotation: anthronet::math::Rotation::from_array(transform.rotation),
            translation: glam::Vec3::from_array(transform.translation),
        }
    }
}
