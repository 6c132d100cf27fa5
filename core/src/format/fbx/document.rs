//! A scene as `ufbx` reads it, and its node tree.

use std::collections::BTreeMap;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use ufbx::{Node, Scene};

use crate::error::{Fault, FbxError, ParserError, Within};
use crate::format::fbx::Result;
use crate::format::motion::bounds;

/// Maximum memory, bytes, that `ufbx` may use for a scene, and again while reading it.
const MAX_MEMORY: usize = 1 << 31;
/// The same for a file of no bytes, and what each byte adds: a short file can claim arrays of any length.
const LEAST_MEMORY: usize = 1 << 26;
const MEMORY_OF_BYTE: usize = 256;
/// Maximum number of nodes of a file.
const MAX_NODES: usize = 1 << 16;
/// Maximum depth of the node tree.
const MAX_DEPTH: u32 = 1 << 12;
/// How a binary file starts; others are text.
pub(super) const BINARY: &[u8] = b"Kaydara FBX Binary";

/// Parses a file's bytes into a scene, without geometry.
pub(super) fn open(bytes: &[u8]) -> Result<ufbx::SceneRoot> {
    let most = bytes.len().saturating_mul(MEMORY_OF_BYTE).saturating_add(LEAST_MEMORY).min(MAX_MEMORY);
    let memory = || ufbx::AllocatorOpts { memory_limit: most, ..Default::default() };
    let opts = ufbx::LoadOpts {
        temp_allocator: memory(),
        result_allocator: memory(),
        ignore_geometry: true,
        ignore_embedded: true,
        node_depth_limit: MAX_DEPTH,
        file_format: ufbx::FileFormat::Fbx,
        ..Default::default()
    };
    if !bytes.starts_with(BINARY) {
        check_braces(bytes)?;
    }
    ufbx::load_memory(bytes, opts).map_err(|error| {
        let info = error.info();
        let more = if info.is_empty() { String::new() } else { format!(" ({info})") };
        ParserError::Refused(format!("{}{more}", &*error.description)).into()
    })
}

/// Refuses transforms that are not finite: removing the scale could make finite but wrong ones of them.
pub(super) fn finite(scene: &Scene, locals: &[ufbx::Transform]) -> Result<()> {
    let is = |t: &ufbx::Transform| {
        vec3(t.translation).is_finite() && quat(t.rotation).is_finite() && vec3(t.scale).is_finite()
    };
    match locals.iter().position(|local| !is(local)) {
        None => Ok(()),
        Some(node) => {
            let ufbx::Transform { translation, rotation, scale } = locals[node];
            let found = format!("{}, {}, {}", vec3(translation), quat(rotation), vec3(scale));
            Err(FbxError::from(Fault::not_finite("its transform", found)))
                .within(format_args!("node `{}`", &*scene.nodes[node].element.name))
        }
    }
}

/// Refuses keys that are no person's: a huge angle makes a rotation like any other.
pub(super) fn check_keys(scene: &Scene) -> Result<()> {
    for prop in scene.anim_layers.iter().flat_map(|layer| &layer.anim_props) {
        let check = match &*prop.prop_name {
            "Lcl Rotation" => bounds::check_degrees,
            "Lcl Translation" => bounds::check_length,
            _ => continue,
        };
        let keys = prop.anim_value.curves.iter().flatten().flat_map(|curve| &curve.keyframes);
        for key in keys {
            let place = format_args!("node `{}`: {}", &*prop.element.name, &*prop.prop_name);
            check(key.value).map_err(FbxError::from).within(place)?;
        }
    }
    Ok(())
}

/// Refuses text that ends inside a node, which the parser would accept as complete.
fn check_braces(text: &[u8]) -> Result<()> {
    let (mut open, mut quoted, mut comment, mut line) = (Vec::new(), false, false, 1);
    for byte in text {
        match byte {
            b'\n' => (comment, line) = (false, line + 1),
            _ if comment => {}
            b'"' => quoted = !quoted,
            _ if quoted => {}
            b';' => comment = true,
            b'{' => open.push(line),
            b'}' => drop(open.pop()),
            _ => {}
        }
    }
    match open.last() {
        Some(line) => Err(ParserError::Refused(format!("the brace of line {line} is not closed")).into()),
        None => Ok(()),
    }
}

/// The nodes of a scene by their index in `Scene::nodes`, which is their `typed_id`.
pub(super) struct Nodes {
    parents: Vec<Option<usize>>,
    /// Parents first.
    pub(super) order: Vec<usize>,
}

impl Nodes {
    pub(super) fn of(scene: &Scene) -> Result<Self> {
        let count = scene.nodes.len();
        if count > MAX_NODES {
            return Err(Fault::too_many(format_args!("{MAX_NODES} nodes"), count).into());
        }
        let parent = |node: &Node| node.parent.as_ref().map(|p| p.element.typed_id as usize);
        let parents: Vec<Option<usize>> = scene.nodes.iter().map(|node| parent(node)).collect();
        let mut children = vec![Vec::new(); count];
        let mut order: Vec<usize> = Vec::with_capacity(count);
        for (node, parent) in parents.iter().enumerate() {
            match parent {
                Some(parent) => {
                    let of_parent = children.get_mut(*parent);
                    of_parent.ok_or_else(|| Fault::dangling("node", *parent, count))?.push(node);
                }
                None => order.push(node),
            }
        }
        let mut next = 0;
        while let Some(&node) = order.get(next) {
            order.extend(&children[node]);
            next += 1;
        }
        if order.len() != count {
            return Err(Fault::inconsistent("nodes are their own ancestors").into());
        }
        Ok(Self { parents, order })
    }

    pub(super) fn ancestors(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(self.parents[node], |&above| self.parents[above])
    }

    /// World transforms of all nodes, each with its own scale inheritance mode.
    pub(super) fn world(&self, scene: &Scene, locals: &[ufbx::Transform]) -> Vec<DAffine3> {
        let mut world = vec![DAffine3::IDENTITY; locals.len()];
        // Rotations only, for nodes that do not inherit their parent's scale.
        let mut turned = vec![DQuat::IDENTITY; locals.len()];
        for &node in &self.order {
            let local = &locals[node];
            let rotation = quat(local.rotation);
            let own = DAffine3::from_scale_rotation_translation(
                vec3(local.scale),
                rotation,
                vec3(local.translation),
            );
            let Some(parent) = self.parents[node] else {
                (world[node], turned[node]) = (own, rotation);
                continue;
            };
            world[node] = world[parent] * own;
            turned[node] = turned[parent] * rotation;
            if scene.nodes[node].inherit_mode != ufbx::InheritMode::Normal {
                world[node].matrix3 =
                    DMat3::from_quat(turned[node]) * DMat3::from_diagonal(vec3(local.scale));
            }
        }
        world
    }

    /// World transforms of joints in the bind pose: from skin clusters, else from bind poses, else from the nodes at rest.
    /// Joints without a bind transform follow their parents.
    pub(super) fn bind_pose(
        &self,
        scene: &Scene,
        joints: &[usize],
        still: &[ufbx::Transform],
    ) -> Vec<DAffine3> {
        let mut known = BTreeMap::new();
        for pose in scene.poses.iter().filter(|pose| pose.is_bind_pose) {
            for bone in &pose.bone_poses {
                known.entry(bone.bone_node.element.typed_id as usize).or_insert(affine(&bone.bone_to_world));
            }
        }
        for cluster in &scene.skin_clusters {
            if let Some(bone) = &cluster.bone_node {
                known.insert(bone.element.typed_id as usize, affine(&cluster.bind_to_world));
            }
        }
        let mut world = self.world(scene, still);
        let is_joint: std::collections::BTreeSet<usize> = joints.iter().copied().collect();
        if !joints.iter().any(|joint| known.contains_key(joint)) {
            return joints.iter().map(|&joint| world[joint]).collect();
        }
        let standing = world.clone();
        for &node in &self.order {
            let bind =
                known.get(&node).filter(|m| is_joint.contains(&node) && m.matrix3.determinant() != 0.0);
            if let Some(bind) = bind {
                world[node] = *bind;
            } else if let Some(parent) = self.parents[node]
                && standing[parent].matrix3.determinant() != 0.0
            {
                world[node] = world[parent] * (standing[parent].inverse() * standing[node]);
            }
        }
        joints.iter().map(|&joint| world[joint]).collect()
    }
}

pub(super) fn vec3(v: ufbx::Vec3) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

pub(super) fn quat(q: ufbx::Quat) -> DQuat {
    DQuat::from_xyzw(q.x, q.y, q.z, q.w)
}

pub(super) fn affine(m: &ufbx::Matrix) -> DAffine3 {
    DAffine3::from_cols_array(&[
        m.m00, m.m10, m.m20, m.m01, m.m11, m.m21, m.m02, m.m12, m.m22, m.m03, m.m13, m.m23,
    ])
}
