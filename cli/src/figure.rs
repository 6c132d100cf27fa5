//! Characters as the renderer takes them.

use std::path::Path;

use anthronet::format::{read_meshes, read_scene};
use anthronet::scene::{Scene, SceneMaterial, SceneMesh, SceneSkinner, SkinTone};
use glam::Vec3;

use crate::failure::{Failure, Result};
use crate::render::{Figure, Material, Part};

/// The figure of a scene in its bind pose: materials by name, quads split into triangles.
pub(crate) fn from_scene(scene: &Scene) -> Result<Figure> {
    from_meshes(&scene.meshes, &scene.materials, Vec3::ZERO)
}

/// The figure of meshes with these materials, moved by `shift`, metres.
pub(crate) fn from_meshes(meshes: &[SceneMesh], materials: &[SceneMaterial], shift: Vec3) -> Result<Figure> {
    let material = |mesh: &SceneMesh| materials.get(mesh.material as usize);
    let kind = |mesh: &SceneMesh| {
        let by_material = material(mesh).map_or(Material::Skin, |m| Material::from_name(&m.name));
        if by_material == Material::Skin { Material::from_name(&mesh.name) } else { by_material }
    };
    let parts = meshes
        .iter()
        .map(|mesh| {
            let quads = mesh.quads.positions.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
            Part {
                material: kind(mesh),
                positions: mesh.positions.iter().map(|p| Vec3::from_array(*p) + shift).collect(),
                triangles: quads.chain(mesh.triangles.positions.iter().copied()).collect(),
            }
        })
        .collect();
    let skin = meshes.iter().find(|mesh| kind(mesh) == Material::Skin).and_then(material);
    // A file without colours reads as white, which is no skin.
    let skin = skin.map(|m| m.base_color).filter(|c| *c != [1.0; 4]);
    let [r, g, b, _] = skin.unwrap_or_else(|| SkinTone::default().base_color());
    Figure::new(parts, Vec3::new(r, g, b))
}

/// The figure of a character file, in the pose in which the file stands, moved so that its lowest point stands on the ground.
pub(crate) fn from_file(path: &Path) -> Result<Figure> {
    let mut scene = read_meshes(path)?;
    if scene.extras.pointer("/anthronet/posed") == Some(&true.into()) {
        let whole = read_scene(path)?;
        if let Some(pose) = &whole.pose {
            scene.meshes = SceneSkinner::new(&whole)?.pose(pose)?;
        }
    }
    let lowest =
        scene.meshes.iter().flat_map(|mesh| &mesh.positions).fold(f32::INFINITY, |low, p| low.min(p[1]));
    let is_skin = |name: &str| Material::from_name(name) == Material::Skin;
    let skin = scene.meshes.iter().find(|mesh| is_skin(&mesh.name));
    let skin = skin.and_then(|mesh| scene.materials.get(mesh.material as usize)).map(|m| m.base_color);
    // A file without colours reads as white, which is no skin.
    let [r, g, b, _] = skin.filter(|c| *c != [1.0; 4]).unwrap_or_else(|| SkinTone::default().base_color());
    let parts = scene
        .meshes
        .iter()
        .map(|mesh| Part {
            material: Material::from_name(&mesh.name),
            positions: mesh.positions.iter().map(|p| Vec3::from(*p) - Vec3::Y * lowest).collect(),
            triangles: mesh.triangulated().iter().map(|t| t.map(|corner| corner.0)).collect(),
        })
        .collect();
    Figure::new(parts, Vec3::new(r, g, b)).map_err(|failure| Failure::in_file(path, failure))
}
