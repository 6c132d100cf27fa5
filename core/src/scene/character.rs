//! The scene of a body: one level of detail, with accessories, skin weights and materials.

use std::sync::Arc;

use glam::Vec3;
use serde_json::json;

use super::scene::{AlphaMode, Corners, Scene, SceneMaterial, SceneMesh, flip_v};
use super::skin_tone::SkinTone;
use crate::mesh::{Lod, Topology};
use crate::skeleton::Influences;
use crate::skeleton::humanoid::{JointNames, renamed};
use crate::{Body, Error, Result};

/// Options of the scene of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneOptions {
    /// Level of detail.
    pub lod: Lod,
    /// Influences per vertex, 4 or 8. Some viewers support only 4.
    pub influences: usize,
    /// Naming convention of the joints.
    pub joint_names: JointNames,
    /// Colour of the skin.
    pub skin_tone: SkinTone,
    /// Whether to include eyes, teeth, tongue and lashes. LODs 2 and 3 have only the eyes, without which
    /// the openings between the lids would show.
    pub accessories: bool,
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self {
            lod: Lod::Lod0,
            influences: 4,
            joint_names: JointNames::Native,
            skin_tone: SkinTone::default(),
            accessories: true,
        }
    }
}

/// Accessory, name of its mesh and material, base colour (linear) and roughness.
const ACCESSORY_MATERIALS: [(&str, &str, [f32; 4], f32); 4] = [
    ("eyes", "Eyes", [0.80, 0.78, 0.75, 1.0], 0.2),
    ("teeth", "Teeth", [0.72, 0.66, 0.55, 1.0], 0.35),
    ("tongue", "Tongue", [0.45, 0.12, 0.11, 1.0], 0.45),
    ("lashes", "Lashes", [0.012, 0.009, 0.008, 1.0], 0.8),
];

impl Scene {
    /// The scene of a body.
    ///
    /// # Errors
    /// [`Error::Request`] when the number of influences is neither 4 nor 8.
    pub fn from_body(body: &Body, options: &SceneOptions) -> Result<Self> {
        let skeleton = body.skeleton();
        let skeleton = match options.joint_names {
            JointNames::Native => skeleton.clone(),
            names => Arc::new(skeleton.renamed(|name| renamed(name, names).into_owned())?),
        };
        let mut meshes = vec![body_mesh(body, options)?];
        let mut materials = vec![SceneMaterial::skin(options.skin_tone)];
        let character = body.character();
        for (index, accessory) in character.accessories().iter().enumerate() {
            let keep = options.accessories && (options.lod <= Lod::Lod1 || accessory.name == "eyes");
            let material = ACCESSORY_MATERIALS.iter().find(|material| material.0 == accessory.name);
            let (Some((positions, normals)), Some(&(_, title, color, roughness)), true) =
                (body.accessory(index), material, keep)
            else {
                continue;
            };
            let mut mesh = quad_mesh(title, positions, normals, &accessory.topology);
            skin(&mut mesh, &character.accessory_weights(accessory).influences(options.influences)?);
            let parts = if accessory.name == "eyes" {
                split_eyes(&mesh, character.accessory_mean(accessory))
            } else {
                vec![(mesh, color)]
            };
            for (mut mesh, color) in parts {
                mesh.material = materials.len() as u32;
                let mut material = SceneMaterial::dielectric(mesh.name.clone(), color, roughness);
                material.double_sided = accessory.name == "lashes";
                material.alpha_mode = AlphaMode::Opaque;
                materials.push(material);
                meshes.push(mesh);
            }
        }
        let report = body.report();
        let extras = json!({
            "anthronet": {
                "version": env!("CARGO_PKG_VERSION"),
                "lod": u8::from(options.lod),
                "vertices": character.vertex_count(options.lod),
                "sex": body.sex(),
                "seed": report.seed,
            }
        });
        Ok(Self {
            name: "Character".into(),
            skeleton: Some(skeleton),
            meshes,
            materials,
            extras,
            ..Self::default()
        })
    }
}

fn body_mesh(body: &Body, options: &SceneOptions) -> Result<SceneMesh> {
    let character = body.character();
    let (vertices, normals) = (body.vertices(), body.normals());
    let weights = character.body_weights()?;
    let mut mesh = match (options.lod, character.reduced(options.lod)) {
        (_, Some(reduced)) => {
            let pick = |from: &[Vec3]| -> Result<Vec<[f32; 3]>> {
                reduced
                    .vertices
                    .iter()
                    .map(|&v| from.get(v as usize).map(Vec3::to_array))
                    .collect::<Option<_>>()
                    .ok_or_else(|| Error::invalid("level of detail", "vertex out of range"))
            };
            SceneMesh {
                name: "Body".into(),
                positions: pick(vertices)?,
                normals: pick(normals)?,
                uvs: character.cage().uvs.iter().map(|&uv| flip_v(uv)).collect(),
                triangles: Corners {
                    positions: reduced.triangles.clone(),
                    uvs: reduced.triangle_uvs.clone(),
                },
                ..SceneMesh::default()
            }
        }
        (Lod::Lod0, None) => quad_mesh("Body", vertices, normals, character.subdivision().refined()),
        (_, None) => {
            let cage = character.cage();
            quad_mesh("Body", &vertices[..cage.vertex_count], &normals[..cage.vertex_count], cage)
        }
    };
    let rows = match character.reduced(options.lod) {
        Some(reduced) => weights.select(&reduced.vertices),
        None => weights.rows(0..character.vertex_count(options.lod)),
    };
    skin(&mut mesh, &rows.influences(options.influences)?);
    Ok(mesh)
}

/// Mesh, outer limit and base colour (linear) of the parts of an eyeball. Limits are angles from the eye's forward axis in
/// degrees, halfway between the eyeball's rings of faces.
const EYE_PARTS: [(&str, f32, [f32; 4]); 3] = [
    ("EyePupils", 11.5, [0.003, 0.003, 0.003, 1.0]),
    ("EyeIrises", 24.0, [0.075, 0.036, 0.016, 1.0]),
    ("Eyes", 180.0, [0.80, 0.78, 0.75, 1.0]),
];

/// Splits eyeballs into white, iris and pupil meshes, so that eyes have a direction of gaze without a texture. Faces are
/// assigned by the mean body's eyes, so that the parts have the same topology for all bodies.
fn split_eyes(eyes: &SceneMesh, mean: &[Vec3]) -> Vec<(SceneMesh, [f32; 4])> {
    let at = |v: u32| mean.get(v as usize).copied().unwrap_or_default();
    let centre = |left: bool| {
        let side: Vec<Vec3> = mean.iter().copied().filter(|p| (p.x > 0.0) == left).collect();
        side.iter().sum::<Vec3>() / side.len().max(1) as f32
    };
    let centres = [centre(false), centre(true)];
    let cosine = |quad: &[u32; 4]| {
        let middle = quad.iter().map(|&v| at(v)).sum::<Vec3>() / 4.0;
        (middle - centres[usize::from(middle.x > 0.0)]).normalize_or_zero().z
    };
    let mut parts: Vec<(SceneMesh, [f32; 4])> = Vec::new();
    let mut from = 1.1;
    for (name, degrees, color) in EYE_PARTS {
        let to = libm::cosf(degrees.to_radians());
        let faces: Vec<usize> = (0..eyes.quads.positions.len())
            .filter(|&f| {
                let c = cosine(&eyes.quads.positions[f]);
                c < from && (c >= to || degrees >= 180.0)
            })
            .collect();
        from = to;
        if !faces.is_empty() {
            parts.push((submesh(eyes, name, &faces), color));
        }
    }
    // The white, which is the largest, comes first.
    parts.reverse();
    parts
}

/// Some of the quads of a mesh, with only the vertices that they use.
fn submesh(mesh: &SceneMesh, name: &str, faces: &[usize]) -> SceneMesh {
    let mut used: Vec<u32> = faces.iter().flat_map(|&f| mesh.quads.positions[f]).collect();
    used.sort_unstable();
    used.dedup();
    let index = |v: u32| used.binary_search(&v).unwrap_or(0) as u32;
    let n = mesh.influences_per_vertex;
    let rows = |v: &u32| *v as usize * n..(*v as usize + 1) * n;
    SceneMesh {
        name: name.into(),
        positions: used.iter().map(|&v| mesh.positions[v as usize]).collect(),
        normals: used.iter().map(|&v| mesh.normals[v as usize]).collect(),
        uvs: mesh.uvs.clone(),
        quads: Corners {
            positions: faces.iter().map(|&f| mesh.quads.positions[f].map(index)).collect(),
            uvs: faces.iter().map(|&f| mesh.quads.uvs[f]).collect(),
        },
        influences_per_vertex: n,
        joint_indices: used.iter().flat_map(|v| mesh.joint_indices[rows(v)].iter().copied()).collect(),
        joint_weights: used.iter().flat_map(|v| mesh.joint_weights[rows(v)].iter().copied()).collect(),
        ..SceneMesh::default()
    }
}

fn quad_mesh(name: &str, positions: &[Vec3], normals: &[Vec3], topology: &Topology) -> SceneMesh {
    SceneMesh {
        name: name.into(),
        positions: positions.iter().map(Vec3::to_array).collect(),
        normals: normals.iter().map(Vec3::to_array).collect(),
        uvs: topology.uvs.iter().map(|&uv| flip_v(uv)).collect(),
        quads: Corners { positions: topology.quads.clone(), uvs: topology.quad_uvs.clone() },
        ..SceneMesh::default()
    }
}

fn skin(mesh: &mut SceneMesh, influences: &Influences) {
    mesh.influences_per_vertex = influences.per_vertex;
    mesh.joint_indices.clone_from(&influences.joints);
    mesh.joint_weights.clone_from(&influences.weights);
}
