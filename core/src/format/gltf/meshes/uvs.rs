//! Texture coordinates. A scene has no images, and one set of texture coordinates: that of the base colour.

use glam::{Affine2, Vec2};
use gltf_json::{
    extensions::texture::TextureTransform,
    mesh::{Primitive, Semantic},
};

use super::{attribute, other_count};
use crate::error::{Fault, Within};
use crate::format::gltf::Result;
use crate::format::gltf::document::Document;

/// The texture coordinates at which the primitive's base colour texture is read, one per vertex; the first set where it has no
/// such texture. Empty when the primitive has none.
pub(super) fn read(document: &Document, primitive: &Primitive, vertices: usize) -> Result<Vec<[f32; 2]>> {
    let material = primitive.material.and_then(|material| document.root.get(material));
    let texture = material.and_then(|material| material.pbr_metallic_roughness.base_color_texture.as_ref());
    let transform = texture.and_then(|texture| texture.extensions.as_ref()?.texture_transform.as_ref());
    let set =
        transform.and_then(|transform| transform.tex_coord).or(texture.map(|texture| texture.tex_coord));
    let set = set.unwrap_or_default();
    let Some(accessor) = attribute(primitive, Semantic::TexCoords(set)) else { return Ok(Vec::new()) };
    let read = || {
        let mut uvs = document.numbers::<2>(accessor)?;
        if uvs.len() != vertices && !uvs.is_empty() {
            return Err(other_count(vertices, uvs.len()));
        }
        if let Some(transform) = transform {
            apply(transform, &mut uvs).within("KHR_texture_transform")?;
        }
        Ok(uvs)
    };
    read().within(format_args!("TEXCOORD_{set}"))
}

/// Applies KHR_texture_transform.
fn apply(transform: &TextureTransform, uvs: &mut [[f32; 2]]) -> Result<()> {
    // Counter-clockwise in an image, whose second coordinate points down. The matrix in the extension's text turns the other
    // way, its words and examples and all programs this one.
    let angle = -transform.rotation.0;
    let map =
        Affine2::from_scale_angle_translation(transform.scale.0.into(), angle, transform.offset.0.into());
    for (i, uv) in uvs.iter_mut().enumerate() {
        let moved = map.transform_point2(Vec2::from(*uv));
        if !moved.is_finite() {
            return Err(Fault::not_finite(format_args!("element {i}"), moved).into());
        }
        *uv = moved.to_array();
    }
    Ok(())
}
