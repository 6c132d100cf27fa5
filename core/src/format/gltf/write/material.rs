//! Materials: metallic-roughness, with index of refraction and specular factor where they differ from the default.

use gltf_json::{
    Material,
    extensions::material::{IndexOfRefraction, Ior, Specular, SpecularFactor},
    material::{AlphaMode as GltfAlphaMode, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor},
    validation::Checked,
};

use crate::scene::{AlphaMode, SceneMaterial};

/// The default of KHR_materials_ior, which is not written.
const DEFAULT_IOR: f32 = 1.5;

pub(super) fn material(material: &SceneMaterial) -> Material {
    let ior =
        (material.ior != DEFAULT_IOR).then(|| Ior { ior: IndexOfRefraction(material.ior), ..Ior::default() });
    let specular = (material.specular != 1.0)
        .then(|| Specular { specular_factor: SpecularFactor(material.specular), ..Specular::default() });
    let extensions = (ior.is_some() || specular.is_some())
        .then(|| gltf_json::extensions::material::Material { ior, specular, ..Default::default() });
    Material {
        name: Some(material.name.clone()),
        alpha_mode: Checked::Valid(match material.alpha_mode {
            AlphaMode::Opaque => GltfAlphaMode::Opaque,
            AlphaMode::Blend => GltfAlphaMode::Blend,
        }),
        double_sided: material.double_sided,
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor(material.base_color),
            metallic_factor: StrengthFactor(material.metallic),
            roughness_factor: StrengthFactor(material.roughness),
            ..PbrMetallicRoughness::default()
        },
        extensions,
        ..Material::default()
    }
}

pub(super) fn extensions_used(materials: &[SceneMaterial]) -> Vec<String> {
    let ior = materials.iter().any(|m| m.ior != DEFAULT_IOR).then(|| "KHR_materials_ior".to_owned());
    let specular = materials.iter().any(|m| m.specular != 1.0).then(|| "KHR_materials_specular".to_owned());
    ior.into_iter().chain(specular).collect()
}
