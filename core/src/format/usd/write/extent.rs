//! The bounding box of a character, at rest and over a clip.
//!
//! A skinned vertex is a weighted mean of the vertex as transformed by each of its joints. The joints' boxes, each around
//! all vertices that the joint influences and transformed with it, therefore contain all skinned vertices. Their union is
//! at least as large as the tightest box, and costs a few matrices per frame instead of skinning the whole mesh.

use glam::{Affine3A, Vec3A};
use openusd::gf::Vec3f;
use openusd::sdf::{FieldKey, Value};

use super::layer::Layer;
use crate::Result;
use crate::math::RigidTransform;
use crate::scene::{MorphTrack, Scene, SceneMesh};
use crate::skeleton::model_from_joints;

/// Metres added on every side to allow for single-precision rounding.
const MARGIN: f32 = 1e-4;

/// An axis-aligned bounding box.
#[derive(Clone, Copy)]
struct Bounds {
    low: Vec3A,
    high: Vec3A,
}

impl Bounds {
    const EMPTY: Self = Self { low: Vec3A::INFINITY, high: Vec3A::NEG_INFINITY };

    fn add(&mut self, point: Vec3A) {
        self.low = self.low.min(point);
        self.high = self.high.max(point);
    }

    /// Adds the axis-aligned box around `inner` after a transform.
    fn add_moved(&mut self, inner: &Self, transform: &Affine3A) {
        let center = transform.transform_point3a((inner.low + inner.high) * 0.5);
        let half = (inner.high - inner.low) * 0.5;
        let m = transform.matrix3;
        let reach = m.x_axis.abs() * half.x + m.y_axis.abs() * half.y + m.z_axis.abs() * half.z;
        self.add(center - reach - MARGIN);
        self.add(center + reach + MARGIN);
    }

    fn value(self) -> Value {
        Value::Vec3fVec([self.low, self.high].map(|corner| Vec3f::from(corner.to_array())).to_vec())
    }
}

/// The extent of a mesh in the bind pose.
pub(super) fn of_mesh(mesh: &SceneMesh) -> Value {
    let mut bounds = Bounds::EMPTY;
    mesh.positions.iter().for_each(|p| bounds.add(Vec3A::from_array(*p)));
    bounds.value()
}

/// Writes the extent of the whole character: at rest, and over the frames of its first clip.
pub(super) fn write(layer: &mut Layer, root: &str, scene: &Scene) -> Result<()> {
    let mut rest = Bounds::EMPTY;
    let meshes = scene.standing_meshes()?;
    meshes.iter().flat_map(|m| &m.positions).for_each(|p| rest.add(Vec3A::from_array(*p)));
    let extent = layer.attribute(root, "extent", "float3[]", rest.value())?;
    let Some(clip) = scene.clips.first() else { return Ok(()) };

    let boxes = joint_boxes(scene);
    let mut pose = crate::skeleton::Pose::default();
    let mut joints: Vec<RigidTransform> = Vec::new();
    let sample = |frame: usize| {
        clip.pose_into(frame, &mut pose);
        model_from_joints(clip.skeleton().parents(), &pose.locals, &mut joints);
        let mut bounds = Bounds::EMPTY;
        for (moved, at) in boxes.iter().zip(&joints) {
            if moved.low.cmple(moved.high).all() {
                bounds.add_moved(moved, &at.to_affine());
            }
        }
        (frame as f64, bounds.value())
    };
    let samples = (0..clip.frame_count()).map(sample).collect();
    layer.set(&extent, FieldKey::TimeSamples, Value::TimeSamples(samples))
}

/// For each joint, in its own space, the box around the vertices it influences; empty if it influences none.
fn joint_boxes(scene: &Scene) -> Vec<Bounds> {
    let bind = scene.skeleton.as_ref().map_or(&[][..], |skeleton| skeleton.bind());
    let joint_from_model: Vec<Affine3A> = bind.iter().map(Affine3A::inverse).collect();
    let mut boxes = vec![Bounds::EMPTY; bind.len()];
    for (index, mesh) in scene.meshes.iter().enumerate() {
        let shares = shares(scene, index);
        for (vertex, position) in mesh.positions.iter().enumerate() {
            let position = Vec3A::from_array(*position);
            for (joint, _) in mesh.influences(vertex).take_while(|(_, weight)| *weight > 0.0) {
                let joint = usize::from(joint);
                let (moved, joint_from_model) = (&mut boxes[joint], &joint_from_model[joint]);
                if shares.is_empty() {
                    moved.add(joint_from_model.transform_point3a(position));
                } else {
                    moved.add_moved(&reach(mesh, vertex, &shares), joint_from_model);
                }
            }
        }
    }
    boxes
}

/// A morph target of a mesh with its minimum and maximum weight over the first clip and 0.
type Share = (usize, f32, f32);

/// The weight ranges of the targets that the first clip animates.
fn shares(scene: &Scene, mesh: usize) -> Vec<Share> {
    let tracks = scene.morph_tracks_of(0).filter(|track| track.mesh as usize == mesh);
    let share = |track: &MorphTrack| {
        let (low, high) = track.weights.iter().fold((0.0_f32, 0.0_f32), |(a, b), w| (a.min(*w), b.max(*w)));
        (track.target as usize, low, high)
    };
    tracks.map(share).collect()
}

/// The box that a vertex of the bind pose can reach by morph targets.
fn reach(mesh: &SceneMesh, vertex: usize, shares: &[Share]) -> Bounds {
    let position = Vec3A::from_array(mesh.positions[vertex]);
    let mut bounds = Bounds { low: position, high: position };
    for (target, least, most) in shares {
        let offset = Vec3A::from_array(mesh.morph_targets[*target].positions[vertex]);
        let (a, b) = (offset * *least, offset * *most);
        bounds.low += a.min(b);
        bounds.high += a.max(b);
    }
    bounds
}
