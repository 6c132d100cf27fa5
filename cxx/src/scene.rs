//! Characters with their clips, as files on the disk or in memory.

use anthronet::Error;
use anthronet::format::{Format, GltfOptions, WriteOptions, write_scene, write_scene_to_bytes};
use anthronet::scene::{SceneOptions, SkinTone};

use crate::Result;
use crate::body::Body;
use crate::bridge::ffi;
use crate::clip::Clip;
use crate::enums::{Meaning, lod};

pub(crate) struct Scene {
    scene: anthronet::scene::Scene,
    options: WriteOptions,
}

impl Scene {
    pub(crate) fn new(body: &Body, options: &ffi::SceneOptions) -> Result<Box<Self>> {
        let ffi::SceneOptions { lod, influences, joint_names, body_only, skin_tone, compress } = *options;
        let looks = looks(lod, influences, joint_names, body_only, skin_tone)?;
        Ok(Box::new(Self {
            scene: anthronet::scene::Scene::from_body(&body.body, &looks)?,
            options: WriteOptions { gltf: GltfOptions { compress }, ..WriteOptions::default() },
        }))
    }

    pub(crate) fn add_clip(&mut self, clip: &Clip) -> Result<&mut Self> {
        if self.scene.clips.iter().any(|other| other.name() == clip.name()) {
            let message = format!("`{}` is there already, expected unique names", clip.name());
            return Err(Error::invalid("clip", message));
        }
        self.scene.clips.push(clip.clip().clone());
        Ok(self)
    }

    pub(crate) fn save(&self, path: &str) -> Result<()> {
        write_scene(&self.scene, path, &self.options)
    }

    pub(crate) fn to_bytes(&self, format: &str) -> Result<Vec<u8>> {
        write_scene_to_bytes(&self.scene, Format::of_one_file(format)?, &self.options)
    }
}

/// The scene options that a caller's fields ask for.
pub(crate) fn looks(
    level: u32,
    influences: u32,
    joint_names: ffi::JointNames,
    body_only: bool,
    skin_tone: u32,
) -> Result<SceneOptions> {
    let skin_tone = match skin_tone {
        0 => SkinTone::default(),
        step => u8::try_from(step)
            .ok()
            .and_then(SkinTone::monk)
            .ok_or_else(|| Error::request("skin_tone", format!("expected 0 to 10, got {step}")))?,
    };
    Ok(SceneOptions {
        lod: lod(level)?,
        influences: if influences == 0 { 4 } else { influences as usize },
        joint_names: joint_names.meaning()?,
        skin_tone,
        accessories: !body_only,
    })
}
