//! FBX, binary and text, through the `ufbx` library, which knows its pre- and post-rotations, pivots and layers.
//!
//! Nodes are evaluated in the file's own unit and composed here to the world, scale and all; joints are those nodes
//! that are bones, whatever stands between and above them is folded in. They rest in the file's bind pose where it
//! has one. Axes other than +Y or +Z up are turned here, as the format lets any axis point anywhere.

#[cfg(test)]
mod binary;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use glam::{DAffine3, DMat3, DQuat, DVec3};
use ufbx::{CoordinateAxis, Node, Scene};

use super::raw::{self, Raw, Recorder, Rigid};
use super::{Found, ReadOptions};
use crate::error::Outcome;
use crate::skeleton::MAX_JOINTS;
use crate::space::{Axis, Unit};

/// Most bytes that `ufbx` may take for a scene and while it reads one.
const MAX_MEMORY: usize = 1 << 31;
/// Most nodes of a file.
const MAX_NODES: usize = 1 << 16;
/// Deepest nesting of nodes.
const MAX_DEPTH: u32 = 1 << 12;
/// Most animations of a file.
const MAX_TAKES: usize = 1 << 10;

/// Reads a file; a clip without a name of its own is named `name`.
pub(super) fn read(bytes: &[u8], name: &str, options: &ReadOptions) -> Outcome<Raw> {
    let memory = || ufbx::AllocatorOpts { memory_limit: MAX_MEMORY, ..Default::default() };
    let opts = ufbx::LoadOpts {
        temp_allocator: memory(),
        result_allocator: memory(),
        ignore_geometry: true,
        ignore_embedded: true,
        node_depth_limit: MAX_DEPTH,
        file_format: ufbx::FileFormat::Fbx,
        ..Default::default()
    };
    if !bytes.starts_with(b"Kaydara FBX Binary") {
        check_braces(bytes)?;
    }
    let scene = ufbx::load_memory(bytes, opts).map_err(|error| {
        let info = error.info();
        let more = if info.is_empty() { String::new() } else { format!(" ({info})") };
        format!("is damaged or truncated: {}{more}", &*error.description)
    })?;
    let nodes = Nodes::of(&scene)?;
    let joints = joints(&scene, &nodes)?;
    let (up, turn) = axes(&scene, options)?;
    let mut warnings = Vec::new();
    if options.up.is_none() && up.is_none() {
        warnings.push("the file's axes are neither +Y nor +Z up: they were turned".to_owned());
    }

    let place = BTreeMap::<usize, u32>::from_iter(joints.iter().zip(0..).map(|(&node, joint)| (node, joint)));
    let parents: Vec<Option<u32>> = joints
        .iter()
        .map(|&node| nodes.ancestors(node).find_map(|above| place.get(&above).copied()))
        .collect();
    let still: Vec<ufbx::Transform> = scene.nodes.iter().map(|node| node.local_transform).collect();
    finite(&scene, &still)?;
    if let Some(&joint) = joints.iter().find(|&&joint| !is_one(still[joint].scale)) {
        let scaled = &*scene.nodes[joint].element.name;
        warnings.push(format!("joint `{scaled}` and perhaps others are scaled: folded into translations"));
    }
    let bind = nodes.bind_pose(&scene, &joints, &still);
    let rigid: Vec<Rigid> = bind.iter().map(|world| Rigid::of(&(turn * *world))).collect();
    let rest = Rigid::locals(&rigid, &parents);

    let (rate, rate_found) = match options.frames_per_second {
        Some(rate) => (rate, Found::Asked),
        None => match scene.settings.frames_per_second {
            rate if (0.1..=1000.0).contains(&rate) => (rate, Found::File),
            _ => (30.0, Found::Assumed),
        },
    };
    if scene.anim_stacks.is_empty() {
        return Err("expected an animation, got none".to_owned());
    }
    if scene.anim_stacks.len() > MAX_TAKES {
        return Err(format!("expected at most {MAX_TAKES} animations, got {}", scene.anim_stacks.len()));
    }
    let mut takes = Vec::new();
    let mut frames_so_far = 0;
    for stack in &scene.anim_stacks {
        let title = &*stack.element.name;
        let title = if title.is_empty() { name } else { title };
        let (begin, end) = span(stack);
        let frames = raw::frame_count(end - begin, rate, scene.nodes.len());
        let frames = frames.map_err(|e| format!("animation `{title}`: {e}"))?;
        frames_so_far += frames;
        raw::frame_count(frames_so_far as f64, 1.0, scene.nodes.len())?;
        let mut recorder = Recorder::new(joints.len());
        for frame in 0..frames {
            let time = begin + frame as f64 / rate;
            let locals: Vec<ufbx::Transform> =
                scene.nodes.iter().map(|node| ufbx::evaluate_transform(&stack.anim, node, time)).collect();
            finite(&scene, &locals).map_err(|e| format!("animation `{title}`: frame {frame}: {e}"))?;
            let world = nodes.world(&scene, &locals);
            let rigid: Vec<Rigid> = joints.iter().map(|&node| Rigid::of(&(turn * world[node]))).collect();
            recorder.push(&Rigid::locals(&rigid, &parents));
        }
        takes.push(recorder.take(title.to_owned(), rate, &rest));
    }

    let mut names: Vec<String> = joints.iter().map(|&j| scene.nodes[j].element.name.to_string()).collect();
    for (joint, name) in names.iter_mut().enumerate().filter(|(_, name)| name.is_empty()) {
        *name = format!("joint{joint}");
    }
    raw::make_unique(&mut names, &mut warnings);
    Ok(Raw {
        format: "FBX",
        ends: vec![None; names.len()],
        names,
        parents,
        rest,
        takes,
        unit: Unit::of_metres(scene.settings.unit_meters),
        up: if options.up.is_some() { None } else { Some(up.unwrap_or(Axis::Y)) },
        rest_is_upright: false,
        rate_found,
        warnings,
    })
}

/// Refuses numbers that are none: places and turns would become others of them.
fn finite(scene: &Scene, locals: &[ufbx::Transform]) -> Outcome<()> {
    let is = |t: &ufbx::Transform| {
        vec3(t.translation).is_finite() && quat(t.rotation).is_finite() && vec3(t.scale).is_finite()
    };
    match locals.iter().position(|local| !is(local)) {
        None => Ok(()),
        Some(node) => {
            Err(format!("node `{}`: its transform is not finite", &*scene.nodes[node].element.name))
        }
    }
}

/// Refuses text that ends within a node, which the parser takes for the end of it.
fn check_braces(text: &[u8]) -> Outcome<()> {
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
        Some(line) => Err(format!("is damaged or truncated: what line {line} opens has no end")),
        None => Ok(()),
    }
}

/// The nodes of a scene by their place in `Scene::nodes`, which is their `typed_id`.
struct Nodes {
    parents: Vec<Option<usize>>,
    /// Parents first.
    order: Vec<usize>,
}

impl Nodes {
    fn of(scene: &Scene) -> Outcome<Self> {
        let count = scene.nodes.len();
        if count > MAX_NODES {
            return Err(format!("expected at most {MAX_NODES} nodes, got {count}"));
        }
        let parent = |node: &Node| node.parent.as_ref().map(|p| p.element.typed_id as usize);
        let parents: Vec<Option<usize>> = scene.nodes.iter().map(|node| parent(node)).collect();
        let mut children = vec![Vec::new(); count];
        let mut order: Vec<usize> = Vec::with_capacity(count);
        for (node, parent) in parents.iter().enumerate() {
            match parent {
                Some(parent) => children.get_mut(*parent).ok_or("a node's parent does not exist")?.push(node),
                None => order.push(node),
            }
        }
        let mut next = 0;
        while let Some(&node) = order.get(next) {
            order.extend(&children[node]);
            next += 1;
        }
        if order.len() != count {
            return Err("nodes are their own ancestors".to_owned());
        }
        Ok(Self { parents, order })
    }

    fn ancestors(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        std::iter::successors(self.parents[node], |&above| self.parents[above])
    }

    /// World transforms of all nodes, by the way that each takes on its parent's scale.
    fn world(&self, scene: &Scene, locals: &[ufbx::Transform]) -> Vec<DAffine3> {
        let mut world = vec![DAffine3::IDENTITY; locals.len()];
        // Rotations alone, for nodes that do without their parent's scale.
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

    /// World transforms of joints in the bind pose: of a skin, else of a pose, else as the nodes stand without
    /// motion. Joints that the bind pose does not know follow their parents.
    fn bind_pose(&self, scene: &Scene, joints: &[usize], still: &[ufbx::Transform]) -> Vec<DAffine3> {
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

/// The time that the file says an animation lasts; where it does not, from the first to the last key.
fn span(stack: &ufbx::AnimStack) -> (f64, f64) {
    if stack.time_begin < stack.time_end {
        return (stack.time_begin, stack.time_end);
    }
    let values = stack.layers.iter().flat_map(|layer| layer.anim_values.iter());
    let curves = values.flat_map(|value| value.curves.iter().flatten()).filter(|c| !c.keyframes.is_empty());
    let (begin, end) = curves.fold((f64::INFINITY, f64::NEG_INFINITY), |(begin, end), curve| {
        (begin.min(curve.min_time), end.max(curve.max_time))
    });
    if begin < end { (begin, end) } else { (stack.time_begin, stack.time_begin) }
}

/// The nodes that are bones, parents first; where there are none, those that are animated.
fn joints(scene: &Scene, nodes: &Nodes) -> Outcome<Vec<usize>> {
    let mut joints: Vec<usize> =
        nodes.order.iter().copied().filter(|&node| scene.nodes[node].bone.is_some()).collect();
    if joints.is_empty() {
        let animated: std::collections::BTreeSet<u32> = scene
            .anim_layers
            .iter()
            .flat_map(|layer| layer.anim_props.iter().map(|prop| prop.element.element_id))
            .collect();
        let moves = |node: &usize| animated.contains(&scene.nodes[*node].element.element_id);
        joints = nodes.order.iter().copied().filter(moves).collect();
    }
    match joints.len() {
        0 => Err("expected bones or animated nodes, got none".to_owned()),
        count if count > MAX_JOINTS => Err(format!("expected at most {MAX_JOINTS} joints, got {count}")),
        _ => Ok(joints),
    }
}

/// The axis that the file says is up, and a turn for files of other axes, for which it is `None`.
fn axes(scene: &Scene, options: &ReadOptions) -> Outcome<(Option<Axis>, DAffine3)> {
    let axes = scene.settings.axes;
    let said = match axes.up {
        _ if options.up.is_some() => return Ok((options.up, DAffine3::IDENTITY)),
        CoordinateAxis::PositiveY | CoordinateAxis::Unknown => Some(Axis::Y),
        CoordinateAxis::PositiveZ => Some(Axis::Z),
        _ => None,
    };
    let columns = [axes.right, axes.up, axes.front].map(direction);
    let [Some(right), Some(up), Some(front)] = columns else { return Ok((said, DAffine3::IDENTITY)) };
    let ours = DMat3::from_cols(right, up, front).transpose();
    match (ours.determinant(), said) {
        (determinant, _) if determinant < 0.5 => Err(format!(
            "axes: expected right-handed ones, got {:?}, {:?}, {:?}",
            axes.right, axes.up, axes.front
        )),
        (_, Some(_)) => Ok((said, DAffine3::IDENTITY)),
        (_, None) => Ok((None, DAffine3::from_mat3(ours))),
    }
}

fn direction(axis: CoordinateAxis) -> Option<DVec3> {
    Some(match axis {
        CoordinateAxis::PositiveX => DVec3::X,
        CoordinateAxis::NegativeX => DVec3::NEG_X,
        CoordinateAxis::PositiveY => DVec3::Y,
        CoordinateAxis::NegativeY => DVec3::NEG_Y,
        CoordinateAxis::PositiveZ => DVec3::Z,
        CoordinateAxis::NegativeZ => DVec3::NEG_Z,
        CoordinateAxis::Unknown => return None,
    })
}

fn is_one(scale: ufbx::Vec3) -> bool {
    vec3(scale).abs_diff_eq(DVec3::ONE, 1e-3)
}

fn vec3(v: ufbx::Vec3) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

fn quat(q: ufbx::Quat) -> DQuat {
    DQuat::from_xyzw(q.x, q.y, q.z, q.w)
}

fn affine(m: &ufbx::Matrix) -> DAffine3 {
    DAffine3::from_cols_array(&[
        m.m00, m.m10, m.m20, m.m01, m.m11, m.m21, m.m02, m.m12, m.m22, m.m03, m.m13, m.m23,
    ])
}
