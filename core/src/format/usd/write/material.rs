//! Writes materials as UsdPreviewSurface.

use std::collections::HashMap;

use openusd::gf::Vec3f;
use openusd::sdf::{FieldKey, Value, Variability};

use super::SPECULAR;
use super::layer::Layer;
use super::names::Names;
use crate::Result;
use crate::scene::{AlphaMode, SceneMaterial};

/// The path of each material.
pub(super) fn paths(scope: &str, materials: &[SceneMaterial]) -> Vec<String> {
    let mut names = Names::default();
    materials.iter().map(|material| format!("{scope}/{}", names.unique(&material.name))).collect()
}

/// Writes the material to this path.
pub(super) fn write(layer: &mut Layer, path: &str, material: &SceneMaterial) -> Result<()> {
    layer.prim(path, &material.name, "Material")?;
    if material.specular != 1.0 {
        let specular = Value::Float(material.specular);
        let data = HashMap::from([(SPECULAR.to_owned(), specular)]);
        layer.set(path, FieldKey::CustomData, Value::Dictionary(data))?;
    }
    let surface = layer.declare(path, "outputs:surface", "token", Variability::Varying, None)?;
    let shader = format!("{path}/Surface");
    layer.connect(&surface, &format!("{shader}.outputs:surface"))?;

    layer.prim(&shader, "Surface", "Shader")?;
    layer.uniform(&shader, "info:id", "token", Value::token("UsdPreviewSurface"))?;
    let [red, green, blue, alpha] = material.base_color;
    let opacity = match material.alpha_mode {
        AlphaMode::Opaque => 1.0,
        AlphaMode::Blend => alpha,
    };
    for (name, type_name, value) in [
        ("diffuseColor", "color3f", Value::Vec3f(Vec3f::from([red, green, blue]))),
        ("opacity", "float", Value::Float(opacity)),
        ("roughness", "float", Value::Float(material.roughness)),
        ("metallic", "float", Value::Float(material.metallic)),
        ("ior", "float", Value::Float(material.ior)),
    ] {
        layer.attribute(&shader, &format!("inputs:{name}"), type_name, value)?;
    }
    layer.declare(&shader, "outputs:surface", "token", Variability::Varying, None).map(drop)
}
