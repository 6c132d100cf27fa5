//! The neutral scene: a character as file writers need it, independent of any format.
//!
//! The whole scene is in model space: metres, right-handed, +Y up, +Z forward, +X the character's left, feet on y = 0,
//! in the bind pose. Texture coordinates follow glTF: the origin is the image's *upper* left corner and v points down;
//! writers of formats in which v points up convert with [`flip_v`].

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::Vec3;

use super::morph::{MorphTarget, MorphTrack, validate_targets};
use super::titles::Titles;
use crate::clip::Clip;
use crate::scene::SkinTone;
use crate::skeleton::{Pose, Skeleton};
use crate::{Error, Result};

/// Tolerance on the sum of one vertex's weights: the rounding of a sum of eight `f32`, with a margin.
const WEIGHT_SUM_TOLERANCE: f32 = 1e-5;
/// Tolerance on the length of a normal.
const NORMAL_LENGTH_TOLERANCE: f32 = 1e-3;
/// Largest distance from its parent's +Y axis, divided by the distance along it, of a joint that ends the parent's bone.
const AXIS_TOLERANCE: f32 = 1e-3;
/// Tolerance on the entries of `model_from_joint` of a clip's rest pose against the bind pose: the rounding of a chain of
/// joints.
const REST_TOLERANCE: f32 = 1e-4;

/// A character: a joint tree, skinned meshes, materials. The body is the first mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Name of the character.
    pub name: String,
    /// The joints in the bind pose, which is the rest pose of every written file unless there is a [`pose`](Scene::pose); the
    /// first joint is the only root. `None` for meshes without a skin.
    pub skeleton: Option<Arc<Skeleton>>,
    /// The pose in which a written file stands, one `parent_from_joint` per joint, metres; `None` for the bind pose. Meshes,
    /// joints and clips do not depend on it: files store it as the transforms of the joints, beside the bind pose of the skin,
    /// and formats without joints get the skinned vertices.
    pub pose: Option<Pose>,
    /// The meshes, the body first.
    pub meshes: Vec<SceneMesh>,
    /// The materials that meshes refer to.
    pub materials: Vec<SceneMaterial>,
    /// Motions of the skeleton: each clip has the joints of [`Scene::skeleton`] in the same order, under any names, and the
    /// bind pose as its rest pose. Names of clips are unique; [`add_clip`](Scene::add_clip) makes them so.
    pub clips: Vec<Clip>,
    /// Weights of the meshes' morph targets over the clips, in any order.
    pub morph_tracks: Vec<MorphTrack>,
    /// Data to be stored in the file, such as the report: an object, or `null` for none.
    pub extras: serde_json::Value,
}

/// One mesh with one material. Positions and texture coordinates are indexed separately.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneMesh {
    /// Name, unique among the meshes.
    pub name: String,
    /// Vertices in model order: `(V, 3)`, metres, model space.
    pub positions: Vec<[f32; 3]>,
    /// One unit normal per vertex, `(V, 3)`, or empty for none.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates `(T, 2)`, v pointing down, indexed by the faces' `uvs`; empty for none.
    pub uvs: Vec<[f32; 2]>,
    /// Faces of four corners, counter-clockwise as seen from outside. A quad with a repeated corner is a triangle.
    pub quads: Corners<4>,
    /// Faces of three corners, counter-clockwise as seen from outside; they follow the quads.
    pub triangles: Corners<3>,
    /// Slots per vertex in the next two fields: 4 or 8, or 0 for a mesh without a skin.
    pub influences_per_vertex: usize,
    /// `(V, influences_per_vertex)` indices into [`Scene::skeleton`]; unused slots may hold anything.
    pub joint_indices: Vec<u16>,
    /// `(V, influences_per_vertex)` weights, per vertex in descending order with sum 1; 0 marks an unused slot.
    pub joint_weights: Vec<f32>,
    /// Index in [`Scene::materials`].
    pub material: u32,
    /// Morph targets, with names that are unique in the mesh.
    pub morph_targets: Vec<MorphTarget>,
}

/// Faces of `N` corners each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Corners<const N: usize> {
    /// Position indices per corner, `(F, N)`.
    pub positions: Vec<[u32; N]>,
    /// Texture coordinate indices per corner, `(F, N)`; empty if and only if the mesh has no texture coordinates.
    pub uvs: Vec<[u32; N]>,
}

/// How a surface treats the alpha of its base colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Alpha is coverage, blended.
    Blend,
}

/// A physically based dielectric in glTF's parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneMaterial {
    /// Name, unique among the materials.
    pub name: String,
    /// Linear red, green, blue and alpha, each in 0..=1.
    pub base_color: [f32; 4],
    /// Perceptual roughness in 0..=1.
    pub roughness: f32,
    /// Metalness in 0..=1.
    pub metallic: f32,
    /// Index of refraction, at least 1.
    pub ior: f32,
    /// Strength of the dielectric reflection in 0..=1.
    pub specular: f32,
    /// How the alpha of `base_color` is used.
    pub alpha_mode: AlphaMode,
    /// Whether back faces are drawn too.
    pub double_sided: bool,
}

impl SceneMaterial {
    /// An opaque, single-sided dielectric with glTF's default index of refraction, 1.5.
    pub fn dielectric(name: impl Into<String>, base_color: [f32; 4], roughness: f32) -> Self {
        Self {
            name: name.into(),
            base_color,
            roughness,
            metallic: 0.0,
            ior: 1.5,
            specular: 1.0,
            alpha_mode: AlphaMode::Opaque,
            double_sided: false,
        }
    }

    /// Skin of this tone: roughness 0.5, index of refraction 1.4 (that of the epidermis).
    pub fn skin(tone: SkinTone) -> Self {
        Self { ior: 1.4, ..Self::dielectric("Skin", tone.base_color(), 0.5) }
    }
}

impl SceneMesh {
    /// Every face as triangles of corners `(position index, texture coordinate index)`: the quads first, each split
    /// along its diagonal from corner 0 to corner 2, then the triangles, in order. Triangles that a repeated corner
    /// leaves without area are left out. A mesh without texture coordinates has 0 for all of them.
    pub fn triangulated(&self) -> Vec<[(u32, u32); 3]> {
        let quads = self.quads.iter().flat_map(|c| [[c[0], c[1], c[2]], [c[0], c[2], c[3]]]);
        let mut triangles =
            Vec::with_capacity(2 * self.quads.positions.len() + self.triangles.positions.len());
        triangles.extend(
            quads.chain(self.triangles.iter()).filter(|[a, b, c]| a.0 != b.0 && b.0 != c.0 && c.0 != a.0),
        );
        triangles
    }

    /// The `(joint, weight)` slots of one vertex; empty for a mesh without a skin.
    pub fn influences(&self, vertex: usize) -> impl Iterator<Item = (u16, f32)> + '_ {
        let slots = vertex * self.influences_per_vertex..(vertex + 1) * self.influences_per_vertex;
        let joints = self.joint_indices.get(slots.clone()).unwrap_or_default();
        joints.iter().copied().zip(self.joint_weights.get(slots).unwrap_or_default().iter().copied())
    }
}

impl<const N: usize> Corners<N> {
    /// The faces, each corner as `(position index, texture coordinate index or 0)`.
    pub(crate) fn iter(&self) -> impl Iterator<Item = [(u32, u32); N]> + '_ {
        self.positions.iter().enumerate().map(|(face, positions)| {
            let uvs = self.uvs.get(face);
            std::array::from_fn(|corner| (positions[corner], uvs.map_or(0, |uvs| uvs[corner])))
        })
    }
}

/// Converts a texture coordinate between v pointing down (glTF, this crate) and up (OBJ, USD, Blender).
pub fn flip_v([u, v]: [f32; 2]) -> [f32; 2] {
    [u, 1.0 - v]
}

impl Scene {
    /// Checks what the writers rely on: every index in range, every number finite, names unique, parents first
    /// with one root, a pose of all joints, rotations without scale, normals of unit length, weights sorted, non-negative and summing to 1,
    /// morph targets with one row per vertex, morph tracks with one weight per frame of their clip.
    ///
    /// # Errors
    /// [`Error::Invalid`] naming the joint, mesh, material, clip or track and the first value that is wrong.
    pub fn validate(&self) -> Result<()> {
        if !(self.extras.is_object() || self.extras.is_null()) {
            return Err(Error::invalid("scene", "extras must be an object or null"));
        }
        self.validate_joints()?;
        self.pose.as_ref().map_or(Ok(()), |pose| self.validate_pose(pose))?;
        self.validate_materials()?;
        if self.meshes.is_empty() {
            return Err(Error::invalid("scene", "expected at least one mesh, got none"));
        }
        unique("mesh", self.meshes.iter().map(|m| m.name.as_str()))?;
        self.validate_clips()?;
        self.validate_morph_tracks()?;
        self.meshes.iter().try_for_each(|mesh| self.validate_mesh(mesh))
    }

    fn validate_joints(&self) -> Result<()> {
        let Some(skeleton) = &self.skeleton else { return Ok(()) };
        let mut roots = skeleton.parents().iter().enumerate().filter(|(_, parent)| parent.is_none());
        if let Some((joint, _)) = roots.nth(1) {
            let message = format!(
                "`{}`: joint {joint} has no parent, only joint 0 may be a root",
                skeleton.names()[joint]
            );
            return Err(Error::invalid("joint", message));
        }
        unique("joint", skeleton.names().iter().map(String::as_str))
    }

    /// Number of joints; 0 for meshes without a skin.
    pub fn joint_count(&self) -> usize {
        self.skeleton.as_ref().map_or(0, |skeleton| skeleton.len())
    }

    /// The scene's skeleton with the ends of bones that retargeting needs; `name` maps the names of joints.
    ///
    /// Where a bone's length is unknown, as in most characters from other programs, the bone ends at the farthest of its
    /// joint's children on the +Y axis, if there are any.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a scene without joints; otherwise as [`Skeleton::renamed`].
    pub fn skeleton_with_ends(&self, name: impl Fn(&str) -> String) -> Result<Skeleton> {
        let skeleton = self.skeleton.as_ref().ok_or_else(|| Error::invalid("scene", "has no joints"))?;
        let skeleton = skeleton.renamed(name)?;
        let known: Vec<Option<f32>> = (0..skeleton.len()).map(|joint| skeleton.bone_length(joint)).collect();
        if known.iter().all(Option::is_some) {
            return Ok(skeleton);
        }
        let mut lengths = known.clone();
        for (parent, local) in skeleton.parents().iter().zip(&skeleton.rest_pose().locals) {
            let at = local.translation;
            let on_axis = at.y > 0.0 && (at.x * at.x + at.z * at.z).sqrt() < AXIS_TOLERANCE * at.y;
            if let (Some(parent), true) = (*parent, on_axis)
                && known[parent as usize].is_none()
            {
                let length = &mut lengths[parent as usize];
                *length = Some(length.map_or(at.y, |l| l.max(at.y)));
            }
        }
        Skeleton::from_bind(skeleton.tree().clone(), skeleton.bind().to_vec(), lengths)
    }

    /// Removes the skeleton, the pose and the meshes' influences: still meshes in the bind pose remain. Clips and their morph tracks, which
    /// move the skeleton, are the caller's to remove.
    pub(crate) fn remove_skin(&mut self) {
        self.skeleton = None;
        self.pose = None;
        for mesh in &mut self.meshes {
            mesh.influences_per_vertex = 0;
            mesh.joint_indices.clear();
            mesh.joint_weights.clear();
        }
    }

    /// Adds a clip. Control characters are removed from its name, and a number is appended where another clip has it.
    pub fn add_clip(&mut self, clip: Clip) {
        let name = Titles::taken(self.clips.iter().map(Clip::name)).unique(clip.name());
        self.clips.push(clip.with_name(name));
    }

    fn validate_clips(&self) -> Result<()> {
        for clip in &self.clips {
            let fault =
                |message: String| Err(Error::invalid("clip", format!("`{}`: {message}", clip.name())));
            let rest = clip.skeleton();
            let own = self.skeleton.as_ref().filter(|own| own.parents() == rest.parents());
            let Some(own) = own else {
                let (got, expected) = (rest.len(), self.joint_count());
                return fault(format!("its {got} joints are not the {expected} of the scene"));
            };
            for ((at, bind), name) in rest.model_from_joints().iter().zip(own.bind()).zip(own.names()) {
                if !at.to_affine().abs_diff_eq(*bind, REST_TOLERANCE) {
                    return fault(format!("joint `{name}` does not rest in the bind pose"));
                }
            }
        }
        // Names of clips are free text; writers of formats with stricter names adapt them.
        unique("clip", self.clips.iter().map(|c| c.name()))
    }

    fn validate_materials(&self) -> Result<()> {
        for material in &self.materials {
            let fault =
                |message: String| Err(Error::invalid("material", format!("`{}`: {message}", material.name)));
            let SceneMaterial { base_color, roughness, metallic, specular, ior, .. } = material;
            for value in base_color.iter().chain([roughness, metallic, specular]) {
                if !(0.0..=1.0).contains(value) {
                    return fault(format!("expected colours and factors in 0..=1, got {value}"));
                }
            }
            if !(1.0..f32::INFINITY).contains(ior) {
                return fault(format!("expected a refractive index of at least 1, got {ior}"));
            }
        }
        unique("material", self.materials.iter().map(|m| m.name.as_str()))
    }

    fn validate_mesh(&self, mesh: &SceneMesh) -> Result<()> {
        let vertices = mesh.positions.len();
        if vertices == 0 || (mesh.quads.positions.is_empty() && mesh.triangles.positions.is_empty()) {
            return Err(fault(mesh, "has no vertices or no faces"));
        }
        if vertices > i32::MAX as usize || mesh.uvs.len() > i32::MAX as usize {
            return Err(fault(mesh, format_args!("expected at most {} vertices, got {vertices}", i32::MAX)));
        }
        if mesh.material as usize >= self.materials.len() {
            return Err(fault(mesh, format_args!("material {} of {}", mesh.material, self.materials.len())));
        }
        if let Some(i) = mesh.positions.iter().position(|p| !p.iter().all(|v| v.is_finite())) {
            return Err(fault(mesh, format_args!("position {i} is not finite: {:?}", mesh.positions[i])));
        }
        if let Some(i) = mesh.uvs.iter().position(|p| !p.iter().all(|v| v.is_finite())) {
            return Err(fault(mesh, format_args!("texture coordinate {i} is not finite: {:?}", mesh.uvs[i])));
        }
        if !mesh.normals.is_empty() && mesh.normals.len() != vertices {
            return Err(fault(
                mesh,
                format_args!("expected {vertices} normals or none, got {}", mesh.normals.len()),
            ));
        }
        for (i, normal) in mesh.normals.iter().enumerate() {
            let length = Vec3::from(*normal).length();
            if length.is_nan() || (length - 1.0).abs() > NORMAL_LENGTH_TOLERANCE {
                return Err(fault(mesh, format_args!("normal {i} has length {length}, expected 1")));
            }
        }
        validate_corners(&mesh.quads, mesh)?;
        validate_corners(&mesh.triangles, mesh)?;
        validate_targets(mesh)?;
        self.validate_influences(mesh)
    }

    fn validate_influences(&self, mesh: &SceneMesh) -> Result<()> {
        let per_vertex = mesh.influences_per_vertex;
        if !matches!(per_vertex, 0 | 4 | 8) {
            return Err(fault(
                mesh,
                format_args!("influences per vertex must be 4 or 8, or 0 without a skin, got {per_vertex}"),
            ));
        }
        if (per_vertex == 0) != self.skeleton.is_none() {
            return Err(fault(
                mesh,
                format_args!(
                    "{per_vertex} influences per vertex in a scene of {} joints",
                    self.joint_count()
                ),
            ));
        }
        let expected = mesh.positions.len() * per_vertex;
        if mesh.joint_indices.len() != expected || mesh.joint_weights.len() != expected {
            return Err(fault(
                mesh,
                format_args!(
                    "expected {expected} joint indices and weights, got {} and {}",
                    mesh.joint_indices.len(),
                    mesh.joint_weights.len()
                ),
            ));
        }
        for vertex in 0..if per_vertex == 0 { 0 } else { mesh.positions.len() } {
            let slots = vertex * per_vertex..(vertex + 1) * per_vertex;
            let (joints, weights) = (&mesh.joint_indices[slots.clone()], &mesh.joint_weights[slots]);
            let sum: f32 = weights.iter().sum();
            if sum.is_nan() || (sum - 1.0).abs() > WEIGHT_SUM_TOLERANCE {
                return Err(fault(mesh, format_args!("weights of vertex {vertex} sum to {sum}, expected 1")));
            }
            if weights.iter().any(|w| *w < 0.0) || weights.windows(2).any(|w| w[0] < w[1]) {
                return Err(fault(
                    mesh,
                    format_args!(
                        "weights of vertex {vertex} are not descending and non-negative: {weights:?}"
                    ),
                ));
            }
            let used = &joints[..weights.iter().take_while(|w| **w > 0.0).count()];
            for (slot, joint) in used.iter().enumerate() {
                if usize::from(*joint) >= self.joint_count() {
                    return Err(fault(
                        mesh,
                        format_args!("vertex {vertex} uses joint {joint} of {}", self.joint_count()),
                    ));
                }
                if used[..slot].contains(joint) {
                    return Err(fault(mesh, format_args!("vertex {vertex} uses joint {joint} twice")));
                }
            }
        }
        Ok(())
    }
}

/// What is wrong with a mesh.
pub(super) fn fault(mesh: &SceneMesh, message: impl std::fmt::Display) -> Error {
    Error::invalid("mesh", format!("`{}`: {message}", mesh.name))
}

fn validate_corners<const N: usize>(corners: &Corners<N>, mesh: &SceneMesh) -> Result<()> {
    let expected_uvs = if mesh.uvs.is_empty() { 0 } else { corners.positions.len() };
    if corners.uvs.len() != expected_uvs {
        return Err(fault(
            mesh,
            format_args!(
                "{} faces of {N} corners need {expected_uvs} rows of texture coordinate indices, got {}",
                corners.positions.len(),
                corners.uvs.len()
            ),
        ));
    }
    let outside =
        |rows: &[[u32; N]], len: usize| rows.iter().position(|r| r.iter().any(|i| *i as usize >= len));
    if let Some(face) = outside(&corners.positions, mesh.positions.len()) {
        return Err(fault(
            mesh,
            format_args!("face {face} {:?} of {} vertices", corners.positions[face], mesh.positions.len()),
        ));
    }
    if let Some(face) = outside(&corners.uvs, mesh.uvs.len()) {
        return Err(fault(
            mesh,
            format_args!("face {face} {:?} of {} texture coordinates", corners.uvs[face], mesh.uvs.len()),
        ));
    }
    Ok(())
}

fn unique<'a>(what: &'static str, names: impl Iterator<Item = &'a str>) -> Result<()> {
    let mut seen = BTreeSet::new();
    for name in names {
        if name.is_empty() || name.chars().any(char::is_control) {
            return Err(Error::invalid(what, format!("name {name:?} is empty or holds control characters")));
        }
        if !seen.insert(name) {
            return Err(Error::invalid(what, format!("two are called `{name}`, names must be unique")));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::Affine3A;

    use super::*;
    use crate::math::{RigidTransform, Rotation};
    use crate::testing::scene::{arm, bent, edit, rename};

    /// The rest pose without its last joint.
    fn short(scene: &Scene) -> Pose {
        let mut pose = scene.skeleton.as_ref().unwrap().rest_pose().clone();
        pose.locals.pop();
        pose
    }

    /// The rest pose with another second joint.
    fn spoilt(scene: &Scene, rotation: Rotation, translation: Vec3) -> Pose {
        let mut pose = scene.skeleton.as_ref().unwrap().rest_pose().clone();
        pose.locals[1] = RigidTransform { rotation, translation };
        pose
    }

    #[test]
    fn the_synthetic_arm_is_valid() {
        arm(4).validate().unwrap();
        arm(8).validate().unwrap();
    }

    #[test]
    fn names_what_is_wrong() {
        type Case = (&'static str, fn(&mut Scene));
        let cases: &[Case] = &[
            ("extras must be an object", |s| s.extras = serde_json::json!([1])),
            ("at least one mesh", |s| s.meshes.clear()),
            ("name \"a\\tb\"", |s| {
                rename(s, |name| if name == "lower" { "a\tb".into() } else { name.into() });
            }),
            ("name \"a\\nb\"", |s| s.meshes[1].name = "a\nb".into()),
            ("only joint 0 may be a root", |s| edit(s, |joints| joints[2].parent = None)),
            ("`Skin`: expected colours", |s| s.materials[0].base_color[1] = f32::NAN),
            ("refractive index", |s| s.materials[0].ior = 0.5),
            ("`Sleeve`: has no vertices or no faces", |s| s.meshes[0].quads = Corners::default()),
            ("material 7 of 2", |s| s.meshes[0].material = 7),
            ("position 3 is not finite", |s| s.meshes[0].positions[3][2] = f32::INFINITY),
            ("texture coordinate 1 is not finite", |s| s.meshes[0].uvs[1][0] = f32::NAN),
            ("normals or none, got 1", |s| s.meshes[0].normals.truncate(1)),
            ("normal 2 has length 0", |s| s.meshes[0].normals[2] = [0.0; 3]),
            ("normal 2 has length NaN", |s| s.meshes[0].normals[2] = [f32::NAN; 3]),
            ("face 1 [", |s| s.meshes[0].quads.positions[1][3] = 1000),
            ("texture coordinates", |s| s.meshes[0].quads.uvs[1][3] = 1000),
            ("rows of texture coordinate indices", |s| s.meshes[0].quads.uvs.clear()),
            ("must be 4 or 8", |s| s.meshes[0].influences_per_vertex = 5),
            ("joint indices and weights", |s| s.meshes[0].joint_weights.truncate(3)),
            ("vertex 0 sum to 1.5", |s| s.meshes[0].joint_weights[0] += 0.5),
            ("vertex 0 sum to NaN", |s| s.meshes[0].joint_weights[0] = f32::NAN),
            ("vertex 0 are not descending", |s| {
                s.meshes[0].joint_weights[..4].copy_from_slice(&[0.4, 0.6, 0., 0.]);
            }),
            ("vertex 0 are not descending", |s| {
                s.meshes[0].joint_weights[..4].copy_from_slice(&[1.1, 0., 0., -0.1]);
            }),
            ("vertex 0 uses joint 9 of 3", |s| s.meshes[0].joint_indices[0] = 9),
            ("uses joint 1 twice", |s| {
                s.meshes[0].joint_indices[..2].fill(1);
                s.meshes[0].joint_weights[..4].copy_from_slice(&[0.5, 0.5, 0., 0.]);
            }),
            ("its 3 joints are not the 2", |s| {
                s.clips.push(bent(s));
                edit(s, |joints| drop(joints.pop()));
                s.meshes.pop();
            }),
            ("`lower` does not rest in the bind pose", |s| {
                s.clips.push(bent(s));
                edit(s, |joints| joints[1].model_from_joint.translation.x += 0.01);
            }),
            ("two are called `bent`", |s| s.clips = vec![bent(s); 2]),
            ("4 influences per vertex in a scene of 0 joints", |s| s.skeleton = None),
            ("expected 3 joints, got 2", |s| s.pose = Some(short(s))),
            ("`lower` is not finite", |s| s.pose = Some(spoilt(s, Rotation::IDENTITY, Vec3::NAN))),
            ("`lower`: expected a rotation of unit length", |s| {
                s.pose = Some(spoilt(s, Rotation::from_xyzw(0.0, 0.0, 0.0, 0.5), Vec3::ZERO));
            }),
        ];
        for (expected, spoil) in cases {
            let mut scene = arm(4);
            spoil(&mut scene);
            let message = scene.validate().unwrap_err().to_string();
            assert!(message.contains(expected), "expected `{expected}` in `{message}`");
        }
    }

    #[test]
    fn clips_get_unique_printable_names() {
        let mut scene = arm(4);
        let clip = bent(&scene);
        for name in ["walk", "walk", "walk 2", "walk", "a\nb", ""] {
            scene.add_clip(clip.clone().with_name(name));
        }
        let names: Vec<&str> = scene.clips.iter().map(Clip::name).collect();
        assert_eq!(names, ["walk", "walk 2", "walk 2 2", "walk 3", "ab", "unnamed"]);
        scene.validate().unwrap();
    }

    #[test]
    fn bones_without_a_length_end_at_the_next_joint_on_their_axis() {
        let mut scene = arm(4);
        edit(&mut scene, |joints| {
            joints[0].model_from_joint = Affine3A::IDENTITY;
            joints[1].model_from_joint = Affine3A::from_translation(Vec3::Y * 0.3);
            joints.iter_mut().for_each(|joint| joint.bone_length = None);
        });
        let ends = |scene: &Scene| scene.skeleton_with_ends(str::to_owned).unwrap().ends().to_vec();
        assert_eq!(ends(&scene), [Some(Vec3::Y * 0.3), None, None]);
        edit(&mut scene, |joints| {
            joints[0].bone_length = Some(0.25);
            joints[2].bone_length = Some(0.1);
        });
        assert_eq!(ends(&scene), [Some(Vec3::Y * 0.25), None, Some(Vec3::Y * 0.1)]);
    }

    #[test]
    fn quads_are_split_along_the_diagonal_from_corner_0_without_degenerate_triangles() {
        let mesh = SceneMesh {
            quads: Corners { positions: vec![[5, 6, 7, 8], [1, 2, 3, 1]], uvs: vec![] },
            triangles: Corners { positions: vec![[9, 8, 7]], uvs: vec![] },
            ..SceneMesh::default()
        };
        let positions: Vec<_> = mesh.triangulated().iter().map(|t| t.map(|c| c.0)).collect();
        assert_eq!(positions, [[5, 6, 7], [5, 7, 8], [1, 2, 3], [9, 8, 7]]);
    }
}
