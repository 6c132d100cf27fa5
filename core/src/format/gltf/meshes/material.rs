//! Materials: metallic-roughness, with the index of refraction and the specular factor.

use gltf_json::{Material, material::AlphaMode as GltfAlphaMode, validation::Checked};

use crate::scene::titles::Titles;
use crate::scene::{AlphaMode, SceneMaterial};

/// Reads a material; its name gets a number if another already has it.
pub(super) fn read(material: &Material, names: &mut Titles) -> SceneMaterial {
    let pbr = &material.pbr_metallic_roughness;
    let extensions = material.extensions.as_ref();
    SceneMaterial {
        name: names.unique(material.name.as_deref().unwrap_or("Material")),
        base_color: pbr.base_color_factor.0,
        roughness: pbr.roughness_factor.0,
        metallic: pbr.metallic_factor.0,
        ior: extensions.and_then(|e| e.ior.as_ref()).map_or(1.5, |e| e.ior.0),
        specular: extensions.and_then(|e| e.specular.as_ref()).map_or(1.0, |e| e.specular_factor.0),
        alpha_mode: match material.alpha_mode {
            Checked::Valid(GltfAlphaMode::Blend) => AlphaMode::Blend,
            _ => AlphaMode::Opaque,
        },
        double_sided: material.double_sided,
    }
}
