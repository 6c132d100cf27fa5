//! The joint tree as nodes, and the skin over them (glTF 2.0, sections 3.5 and 3.7.3).

use glam::{Affine3A, DAffine3, DMat3, DQuat, DVec3, Mat3A};
use gltf_json::{Index, Node, Skin, scene::UnitQuaternion};

use super::super::accessor::{DocumentBuilder, Usage};
use super::super::scene::{Scene, SceneJoint};

/// Finest step of metres and of components of quaternions, 2⁻²⁶: a quarter of the rounding of `f32` near 1.
const GRID: f64 = 1.0 / 67_108_864.0;
/// Roundings after which a transform stops being rounded further; nearly all settle in two or three.
const MAX_ROUNDINGS: usize = 64;

/// Appends the joint nodes, which become nodes `0..joints`, and the skin over them.
pub(super) fn push(
    builder: &mut DocumentBuilder,
    scene: &Scene,
    transforms: &[WrittenTransform],
) -> Index<Skin> {
    let mut children = vec![Vec::new(); scene.joints.len()];
    for (i, joint) in (0u32..).zip(&scene.joints) {
        if let Some(siblings) = joint.parent.and_then(|parent| children.get_mut(parent as usize)) {
            siblings.push(Index::new(i));
        }
    }
    for ((joint, written), children) in scene.joints.iter().zip(transforms).zip(children) {
        let NodeTransform { translation, rotation } = written.parent_from_joint;
        builder.root.push(Node {
            name: Some(joint.name.clone()),
            children: (!children.is_empty()).then_some(children),
            translation: Some(translation),
            rotation: (rotation != [0.0, 0.0, 0.0, 1.0]).then_some(UnitQuaternion(rotation)),
            ..Node::default()
        });
    }
    let inverse_bind = transforms.iter().map(|written| {
        let inverse = written.model_from_joint.inverse();
        let mut matrix = [0.0f32; 16];
        for (column, values) in [inverse.matrix3.x_axis, inverse.matrix3.y_axis, inverse.matrix3.z_axis]
            .into_iter()
            .chain([inverse.translation])
            .enumerate()
        {
            for (row, value) in values.to_array().into_iter().enumerate() {
                matrix[4 * column + row] = plain(value);
            }
        }
        matrix[15] = 1.0;
        matrix
    });
    let inverse_bind_matrices = Some(builder.push_accessor(inverse_bind, Usage::Other));
    builder.root.push(Skin {
        extensions: None,
        extras: None,
        inverse_bind_matrices,
        joints: (0..scene.joints.len() as u32).map(Index::new).collect(),
        name: (!scene.name.is_empty()).then(|| scene.name.clone()),
        skeleton: Some(Index::new(0)),
    })
}

/// What a joint's node says: `parent_from_joint`.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct NodeTransform {
    pub(crate) translation: [f32; 3],
    /// Unit quaternion x, y, z, w.
    pub(crate) rotation: [f32; 4],
}

impl NodeTransform {
    pub(crate) fn to_affine(self) -> DAffine3 {
        DAffine3::from_rotation_translation(
            DQuat::from_array(self.rotation.map(f64::from)),
            DVec3::from_array(self.translation.map(f64::from)),
        )
    }

    fn of(parent_from_joint: &DAffine3) -> Self {
        let rotation = DQuat::from_mat3(&parent_from_joint.matrix3).normalize();
        let rotation = if rotation.w < 0.0 { -rotation } else { rotation };
        Self {
            translation: parent_from_joint.translation.to_array().map(on_grid),
            rotation: rotation.to_array().map(on_grid),
        }
    }

    fn bits(self) -> ([u32; 3], [u32; 4]) {
        (self.translation.map(f32::to_bits), self.rotation.map(f32::to_bits))
    }
}

/// A joint's node as it stands in the file.
pub(super) struct WrittenTransform {
    pub(super) parent_from_joint: NodeTransform,
    /// Product of the written transforms from the root down.
    pub(super) model_from_joint: DAffine3,
}

/// Splits every bind pose into a translation and a rotation below its parent. What rounding to `f32` moves a parent by,
/// its children take back, so that errors do not add up along a chain.
pub(super) fn written_transforms(joints: &[SceneJoint]) -> Vec<WrittenTransform> {
    let mut written: Vec<WrittenTransform> = Vec::with_capacity(joints.len());
    for joint in joints {
        let parent = joint
            .parent
            .and_then(|p| written.get(p as usize))
            .map_or(DAffine3::IDENTITY, |p| p.model_from_joint);
        let parent_from_joint = settled(&parent, joint.model_from_joint);
        let model_from_joint = parent * parent_from_joint.to_affine();
        written.push(WrittenTransform { parent_from_joint, model_from_joint });
    }
    written
}

/// The node transform that writing and reading by turns ends up with. A bind pose is a matrix of `f32` and a node is
/// not, so either step rounds; written is what reading and writing again gives back, that a file survives it bit for
/// bit. Where the two steps take turns between several transforms, the first in the order of their bits is taken.
fn settled(parent: &DAffine3, model_from_joint: Affine3A) -> NodeTransform {
    let joint_from_model = parent.inverse();
    let mut wanted = model_from_joint;
    let mut seen: Vec<NodeTransform> = Vec::new();
    loop {
        let node = NodeTransform::of(&(joint_from_model * widened(wanted)));
        if let Some(first) = seen.iter().position(|s| *s == node) {
            return seen[first..].iter().copied().min_by_key(|s| s.bits()).unwrap_or(node);
        }
        if seen.len() == MAX_ROUNDINGS {
            return node;
        }
        seen.push(node);
        wanted = rounded(&(parent * node.to_affine()));
    }
}

/// A bind pose as the scene holds it.
pub(crate) fn rounded(transform: &DAffine3) -> Affine3A {
    let m = transform.matrix3;
    let columns = [m.x_axis, m.y_axis, m.z_axis].map(|c| c.as_vec3().into());
    Affine3A {
        matrix3: Mat3A::from_cols(columns[0], columns[1], columns[2]),
        translation: transform.translation.as_vec3().into(),
    }
}

fn widened(transform: Affine3A) -> DAffine3 {
    let m = transform.matrix3;
    DAffine3 {
        matrix3: DMat3::from_cols(m.x_axis.as_dvec3(), m.y_axis.as_dvec3(), m.z_axis.as_dvec3()),
        translation: transform.translation.as_dvec3(),
    }
}

/// To `f32`, without the digits of small numbers that a bind pose, whose numbers are near 1, knows nothing of: they
/// would be others each time.
fn on_grid(value: f64) -> f32 {
    plain((value / GRID).round() * GRID)
}

/// To `f32`, without a negative zero.
fn plain(value: f64) -> f32 {
    value as f32 + 0.0
}
