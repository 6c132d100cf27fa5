//! The scene in a pose: static poses by name, skinned meshes, and what files keep of a pose.

use std::sync::Arc;

use glam::Vec3;
use serde_json::Value;

use super::scene::{Scene, SceneMesh};
use crate::pose::{self, Girth};
use crate::skeleton::humanoid::native_name;
use crate::skeleton::{Influences, Pose, RigJoint, Skeleton};
use crate::skin::{SkinContext, SkinMethod, Skinner, SurfaceMut};
use crate::{Error, Result};

/// How far a rotation of a pose may be from unit length.
const UNIT_TOLERANCE: f32 = 1e-3;
/// Key in `extras.anthronet` of a file whose joints stand in a pose.
const POSED: &str = "posed";
/// Its value in a file without joints whose surface is posed.
pub(crate) const POSED_SURFACE: &str = "surface";

/// The meshes of a scene, prepared to be skinned in any number of poses. Linear blend skinning, as programs that open the
/// files do it; morph targets are left out.
pub struct SceneSkinner {
    /// One per mesh: its skin, or the mesh itself where it has none.
    parts: Vec<Option<Skinner>>,
    still: Vec<SceneMesh>,
    parents: Vec<Option<u32>>,
    context: SkinContext,
}

impl Scene {
    /// A static pose by name for this character: see [`pose::named`](crate::pose::named), with the girth of its first mesh.
    /// Joints may be named in any vocabulary of [`JointNames`](crate::skeleton::humanoid::JointNames).
    ///
    /// # Errors
    /// [`Error::Invalid`] for a scene without joints; otherwise as [`pose::named`](crate::pose::named).
    pub fn named_pose(&self, name: &str) -> Result<Pose> {
        let rest = Arc::new(self.skeleton_with_ends(|name| native_name(name).into_owned())?);
        let girth = match self.meshes.first().filter(|mesh| mesh.influences_per_vertex > 0) {
            Some(body) => {
                let strongest = |v: usize| body.influences(v).next().map_or(0, |(joint, _)| joint.into());
                let positions = body.positions.iter().enumerate();
                Girth::of(&rest, positions.map(|(v, p)| (Vec3::from_array(*p), strongest(v))))?
            }
            None => Girth::slender(&rest)?,
        };
        pose::named(name, &rest, &girth)
    }

    /// The pose moved up or down so that the lowest vertex of the scene's meshes is on the floor, y = 0.
    ///
    /// # Errors
    /// As [`SceneSkinner::pose`].
    pub fn grounded(&self, pose: &Pose) -> Result<Pose> {
        let mut skinner = SceneSkinner::new(self)?;
        let mut pose = pose.clone();
        let meshes = skinner.pose(&pose)?;
        let heights = meshes.iter().flat_map(|mesh| &mesh.positions).map(|p| p[1]);
        let lowest = heights.fold(f32::INFINITY, f32::min);
        let parents = &skinner.parents;
        for (local, _) in pose.locals.iter_mut().zip(parents).filter(|(_, parent)| parent.is_none()) {
            local.translation.y -= lowest;
        }
        Ok(pose)
    }

    /// The pose moved along the floor so that the pelvis is where it is at rest: over the origin, in bodies of this library. A
    /// character without a pelvis keeps the place of its first joint.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a scene without joints.
    pub fn centred(&self, pose: &Pose) -> Result<Pose> {
        let skeleton =
            self.skeleton.as_ref().ok_or_else(|| Error::invalid("scene", "has no joints to pose"))?;
        let pelvis = skeleton.names().iter().position(|name| native_name(name) == RigJoint::Pelvis.name());
        let joint = pelvis.unwrap_or_default();
        let at = |pose: &Pose| pose.model_from_joints(skeleton.parents()).get(joint).map(|at| at.translation);
        let moved =
            at(pose).zip(at(skeleton.rest_pose())).map_or(Vec3::ZERO, |(at, rest)| (at - rest).with_y(0.0));
        let mut pose = pose.clone();
        for (local, _) in
            pose.locals.iter_mut().zip(skeleton.parents()).filter(|(_, parent)| parent.is_none())
        {
            local.translation -= moved;
        }
        Ok(pose)
    }

    pub(super) fn validate_pose(&self, pose: &Pose) -> Result<()> {
        let fault = |message: String| Err(Error::invalid("pose", message));
        let (expected, got) = (self.joint_count(), pose.locals.len());
        if expected != got {
            return fault(format!("expected {expected} joints, got {got}"));
        }
        let names = self.skeleton.iter().flat_map(|skeleton| skeleton.names());
        for (local, name) in pose.locals.iter().zip(names) {
            if !(local.translation.is_finite() && local.rotation.is_finite()) {
                return fault(format!("joint `{name}` is not finite"));
            }
            let length = local.rotation.length_squared().sqrt();
            if (length - 1.0).abs() > UNIT_TOLERANCE {
                return fault(format!("joint `{name}`: expected a rotation of unit length, got {length}"));
            }
        }
        Ok(())
    }

    /// The extras as files store them: `anthronet.posed` says whether the joints stand in a pose.
    pub(crate) fn written_extras(&self) -> Value {
        let mut extras = self.extras.clone();
        if self.pose.is_none() {
            if let Some(Value::Object(ours)) = extras.get_mut("anthronet") {
                ours.remove(POSED);
            }
            return extras;
        }
        if extras.is_null() {
            extras = Value::Object(serde_json::Map::new());
        }
        if let Some(all) = extras.as_object_mut()
            && let Value::Object(ours) =
                all.entry("anthronet").or_insert_with(|| Value::Object(serde_json::Map::new()))
        {
            ours.insert(POSED.into(), true.into());
        }
        extras
    }

    /// Whether the extras that were read say that the joints of the file stand in a pose.
    pub(crate) fn read_as_posed(&self) -> bool {
        self.extras.pointer("/anthronet/posed").and_then(Value::as_bool).unwrap_or_default()
    }

    /// Whether the extras that were read say that the surface itself is posed.
    pub(crate) fn has_posed_surface(&self) -> bool {
        self.extras.pointer("/anthronet/posed").and_then(Value::as_str) == Some(POSED_SURFACE)
    }

    /// The meshes in the scene's pose, skinned; as they are without one.
    pub(crate) fn standing_meshes(&self) -> Result<std::borrow::Cow<'_, [SceneMesh]>> {
        match &self.pose {
            Some(pose) => Ok(SceneSkinner::new(self)?.pose(pose)?.into()),
            None => Ok(self.meshes.as_slice().into()),
        }
    }
}

impl SceneSkinner {
    /// Prepares the meshes of a scene.
    ///
    /// # Errors
    /// [`Error::Invalid`] for a scene without joints; otherwise as [`Skinner::new`].
    pub fn new(scene: &Scene) -> Result<Self> {
        let skeleton =
            scene.skeleton.as_ref().ok_or_else(|| Error::invalid("scene", "has no joints to pose"))?;
        let still = scene.meshes.iter().map(without_skin).collect();
        let parts = scene.meshes.iter().map(|mesh| skinner(mesh, skeleton)).collect::<Result<_>>()?;
        Ok(Self { parts, still, parents: skeleton.parents().to_vec(), context: SkinContext::default() })
    }

    /// The meshes in a pose of the scene's skeleton: positions in model space, metres, unit normals where the mesh has any.
    ///
    /// # Errors
    /// As [`Skinner::skin`].
    pub fn pose(&mut self, pose: &Pose) -> Result<Vec<SceneMesh>> {
        let model = pose.model_from_joints(&self.parents);
        let mut meshes = self.still.clone();
        for (mesh, skinner) in meshes.iter_mut().zip(&self.parts) {
            let Some(skinner) = skinner else { continue };
            let mut spare = vec![[0.0; 3]; if mesh.normals.is_empty() { mesh.positions.len() } else { 0 }];
            let normals = if mesh.normals.is_empty() { &mut spare } else { &mut mesh.normals };
            let out = SurfaceMut::packed(&mut mesh.positions, normals);
            skinner.skin(SkinMethod::Linear, &model, out, &mut self.context)?;
        }
        Ok(meshes)
    }
}

/// The mesh in the bind pose, without joints and morph targets.
fn without_skin(mesh: &SceneMesh) -> SceneMesh {
    SceneMesh {
        influences_per_vertex: 0,
        joint_indices: Vec::new(),
        joint_weights: Vec::new(),
        morph_targets: Vec::new(),
        ..mesh.clone()
    }
}

fn skinner(mesh: &SceneMesh, skeleton: &Skeleton) -> Result<Option<Skinner>> {
    if mesh.influences_per_vertex == 0 {
        return Ok(None);
    }
    let positions: Vec<Vec3> = mesh.positions.iter().map(|p| Vec3::from_array(*p)).collect();
    let normals = match mesh.normals.is_empty() {
        true => vec![Vec3::Y; positions.len()],
        false => mesh.normals.iter().map(|n| Vec3::from_array(*n)).collect(),
    };
    // Unused slots may name any joint.
    let used = |(joint, weight): (&u16, &f32)| if *weight > 0.0 { *joint } else { 0 };
    let influences = Influences {
        per_vertex: mesh.influences_per_vertex,
        joints: mesh.joint_indices.iter().zip(&mesh.joint_weights).map(used).collect(),
        weights: mesh.joint_weights.clone(),
    };
    Skinner::new(&positions, &normals, &influences, &skeleton.model_from_joints()).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{RigidTransform, Rotation};
    use crate::testing::scene::{arm, bent};

    #[test]
    fn meshes_in_the_rest_pose_are_where_they_were() {
        let scene = arm(8);
        let rest = scene.skeleton.as_ref().unwrap().rest_pose().clone();
        for (posed, own) in SceneSkinner::new(&scene).unwrap().pose(&rest).unwrap().iter().zip(&scene.meshes)
        {
            assert_eq!((posed.influences_per_vertex, &posed.quads), (0, &own.quads));
            for (a, b) in posed.positions.iter().zip(&own.positions) {
                assert!(Vec3::from(*a).distance(Vec3::from(*b)) < 1e-5);
            }
        }
    }

    #[test]
    fn a_vertex_is_the_weighted_mean_of_where_its_joints_take_it() {
        let mut scene = arm(4);
        scene.pose = Some(bent(&scene).pose(2));
        let skeleton = scene.skeleton.as_ref().unwrap();
        let posed = scene.pose.as_ref().unwrap().model_from_joints(skeleton.parents());
        for (mesh, own) in scene.standing_meshes().unwrap().iter().zip(&scene.meshes) {
            for (v, at) in mesh.positions.iter().enumerate() {
                let from = Vec3::from(own.positions[v]);
                let moved = own.influences(v).filter(|(_, weight)| *weight > 0.0).map(|(joint, weight)| {
                    let joint = usize::from(joint);
                    let inverse = skeleton.bind()[joint].inverse();
                    posed[joint].to_affine().transform_point3(inverse.transform_point3(from)) * weight
                });
                assert!(moved.sum::<Vec3>().distance(Vec3::from(*at)) < 1e-5);
            }
        }
    }

    #[test]
    fn the_lowest_vertex_of_a_grounded_pose_is_on_the_floor() {
        let mut scene = arm(4);
        let mut pose = scene.skeleton.as_ref().unwrap().rest_pose().clone();
        let turn = Rotation::from_rotation_x(0.7);
        pose.locals[0] = RigidTransform { rotation: turn, translation: Vec3::new(0.0, 3.0, 1.0) };
        scene.pose = Some(scene.grounded(&pose).unwrap());
        let meshes = scene.standing_meshes().unwrap();
        let lowest =
            meshes.iter().flat_map(|mesh| &mesh.positions).map(|p| p[1]).fold(f32::INFINITY, f32::min);
        assert!(lowest.abs() < 1e-6, "{lowest}");
    }

    #[test]
    fn extras_tell_whether_a_file_is_posed() {
        let mut scene = arm(4);
        let before = scene.written_extras();
        assert_eq!(before, scene.extras);
        scene.pose = Some(scene.skeleton.as_ref().unwrap().rest_pose().clone());
        scene.extras = scene.written_extras();
        assert!(scene.read_as_posed() && scene.extras["asked"]["arm_length"] == 0.6);
        scene.pose = None;
        assert_eq!(scene.written_extras()["anthronet"], serde_json::json!({}));
    }
}
