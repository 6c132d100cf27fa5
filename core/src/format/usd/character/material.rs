//! Reads UsdPreviewSurface materials.

use openusd::sdf::{FieldKey, Path, Value};

use super::title;
use crate::format::usd::Result;
use crate::format::usd::document::layer::Layer;
use crate::format::usd::document::values;
use crate::format::usd::write::SPECULAR;
use crate::scene::titles::Titles;
use crate::scene::{AlphaMode, SceneMaterial};

/// The materials of the meshes read so far, one for each pair of material and sidedness.
#[derive(Default)]
pub(super) struct Materials {
    list: Vec<(Option<Path>, SceneMaterial)>,
    titles: Titles,
}

impl Materials {
    /// Index of the material to which this mesh is bound.
    pub(super) fn of(&mut self, layer: &Layer, mesh: &Path, double_sided: bool) -> Result<u32> {
        let mut bound = None;
        for prim in mesh.ancestors_below_root() {
            bound = layer.target(&prim, "material:binding")?;
            if bound.is_some() {
                break;
            }
        }
        let same = |(path, material): &(Option<Path>, SceneMaterial)| {
            *path == bound && material.double_sided == double_sided
        };
        if let Some(place) = self.list.iter().position(same) {
            return Ok(place as u32);
        }
        let mut material = match &bound {
            Some(path) => read(layer, path)?,
            None => SceneMaterial::dielectric("Grey", [0.18, 0.18, 0.18, 1.0], 0.5),
        };
        material.double_sided = double_sided;
        material.name = self.titles.unique(&material.name);
        self.list.push((bound, material));
        Ok((self.list.len() - 1) as u32)
    }

    pub(super) fn into_list(self) -> Vec<SceneMaterial> {
        self.list.into_iter().map(|(_, material)| material).collect()
    }
}

fn read(layer: &Layer, path: &Path) -> Result<SceneMaterial> {
    let shader = layer.source(path, "outputs:surface")?.map(|output| output.prim_path());
    let input = |name: &str, count: usize| -> Result<Option<Vec<f64>>> {
        let Some(shader) = &shader else { return Ok(None) };
        let value = layer.default(shader, &format!("inputs:{name}"))?;
        Ok(value.and_then(|value| values::numbers(&value)).filter(|numbers| numbers.len() == count))
    };
    let factor = |name: &str, default: f32| -> Result<f32> {
        let value = input(name, 1)?.and_then(|numbers| numbers.first().copied());
        Ok(value.filter(|v| v.is_finite()).map_or(default, |v| v.clamp(0.0, 1.0) as f32))
    };
    // Missing inputs have UsdPreviewSurface's defaults.
    let color = input("diffuseColor", 3)?.unwrap_or_else(|| vec![0.18; 3]);
    let channel =
        |i: usize| color.get(i).map_or(0.18, |v| if v.is_nan() { 0.18 } else { v.clamp(0.0, 1.0) as f32 });
    let opacity = factor("opacity", 1.0)?;
    let ior = input("ior", 1)?.and_then(|n| n.first().copied()).filter(|ior| ior.is_finite());
    let mut material = SceneMaterial::dielectric(
        title(layer, path)?,
        [channel(0), channel(1), channel(2), opacity],
        factor("roughness", 0.5)?,
    );
    material.metallic = factor("metallic", 0.0)?;
    material.ior = ior.map_or(1.5, |ior| ior.max(1.0) as f32);
    material.alpha_mode = if opacity < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque };
    if let Some(Value::Dictionary(data)) = layer.field(path, FieldKey::CustomData.as_str())?
        && let Some(specular) = data.get(SPECULAR).and_then(values::numbers)
    {
        material.specular = specular.first().map_or(1.0, |s| s.clamp(0.0, 1.0) as f32);
    }
    Ok(material)
}
