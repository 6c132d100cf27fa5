//! Characters as files, on the disk or in memory.

use std::ffi::c_char;
use std::path::Path;

use anthronet::format::{Format, GltfOptions, WriteOptions, write_scene, write_scene_to_bytes};
use anthronet::pose::POSES;
use anthronet::scene::Scene;

use crate::body::anthronet_body;
use crate::bytes::anthronet_bytes;
use crate::clip::anthronet_clip;
use crate::mesh::scene_options;
use crate::options::{Descriptor, described, flag};
use crate::pointer::{Out, list, read, text};
use crate::status::{Outcome, anthronet_error, anthronet_status, guard};

/// How a body is written to a file; all zeros are the defaults.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct anthronet_export_options {
    /// Set by the caller: `sizeof(anthronet_export_options)`.
    pub struct_size: u32,
    /// Level of detail, 0 (finest) to 3.
    pub lod: u32,
    /// Influences per vertex, 4 or 8; 0 stands for 4.
    pub influences: u32,
    /// Names of the joints: `ANTHRONET_NAMES_…`.
    pub joint_names: u32,
    /// 1 leaves out eyes, teeth, tongue and lashes.
    pub body_only: u32,
    /// Step of the Monk skin tone scale, 1 to 10; 0 for the default tone.
    pub skin_tone: u32,
    /// 1 compresses .glb and .gltf (EXT_meshopt_compression).
    pub compress: u32,
    /// Number of `clips`.
    pub clip_count: u32,
    /// Clips of this body or one of the same rig that go into the file; NULL for none. Their names are unique.
    pub clips: *const *const anthronet_clip,
    /// Name of the pose in which the file stands, UTF-8: `t-pose`, `a-pose`, `standing` or `sitting`; NULL for the T-pose, the
    /// only one of a .vrm. Files with joints stay bound in the T-pose.
    pub pose: *const c_char,
    /// Bytes of `pose`.
    pub pose_length: u64,
}

// SAFETY: numbers and pointers that may be NULL, the size first.
unsafe impl Descriptor for anthronet_export_options {}

/// Writes a body to a file in the format of its extension: .glb, .gltf (and .bin beside it), .vrm, .usda, .usdc, .usdz
/// or .obj. The file is written completely or not at all. `options` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_export_path(
    body: *const anthronet_body,
    options: *const anthronet_export_options,
    path: *const c_char,
    path_length: u64,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let path = Path::new(text(path, path_length, "path")?);
        let (scene, options) = scene(body, options)?;
        Ok(write_scene(&scene, path, &options)?)
    })
}

/// Writes a body to memory in a format: `glb`, `vrm`, `usda`, `usdc`, `usdz` or `obj`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn anthronet_export_memory(
    body: *const anthronet_body,
    options: *const anthronet_export_options,
    format: *const c_char,
    format_length: u64,
    out_bytes: *mut *mut anthronet_bytes,
    error: *mut anthronet_error,
) -> anthronet_status {
    guard(error, || {
        let out = Out::new(out_bytes, "out_bytes")?;
        let format = Format::of_one_file(text(format, format_length, "format")?)?;
        let (scene, options) = scene(body, options)?;
        out.give(anthronet_bytes(write_scene_to_bytes(&scene, format, &options)?));
        Ok(())
    })
}

fn scene(
    body: *const anthronet_body,
    options: *const anthronet_export_options,
) -> Outcome<(Scene, WriteOptions)> {
    let body = read(body, "body")?;
    let asked = described(options, "options")?;
    let looks =
        scene_options(asked.lod, asked.influences, asked.joint_names, asked.body_only, asked.skin_tone)?;
    let gltf = GltfOptions { compress: flag(asked.compress, "compress")? };
    let mut scene = Scene::from_body(&body.body, &looks)?;
    if !asked.pose.is_null() {
        let name = text(asked.pose, asked.pose_length, "pose")?;
        scene.pose = (name != POSES[0]).then(|| scene.named_pose(name)).transpose()?;
    }
    for clip in list(asked.clips, asked.clip_count, "clips")? {
        scene.add_clip(read(*clip, "clip")?.0.clone());
    }
    Ok((scene, WriteOptions { gltf, ..WriteOptions::default() }))
}
