//! Animations of glTF 2.0 files, binary or JSON (section 3.11 of the specification).
//!
//! Joints are the nodes listed by skins or, without a skin, the animated nodes and all their descendants; nodes between
//! and above them are folded in. The rest pose is that of the inverse bind matrices where the nodes hold another; without a skin
//! it is the nodes' own transforms, which the format calls the initial pose.
//! Every animation is sampled at the rate of its keys.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine3, DMat4, DQuat, DVec3, Mat4};
use gltf_json::Node;
use gltf_json::animation::Property;
use gltf_json::validation::Checked;

use super::animation::{self, FALLBACK_RATE, Keys, ON_FRAME, Timing, Track, unit};
use super::character::skeleton::skin_joints;
use super::document::{Document, Tree};
use super::humanoid;
use crate::error::{Fault, GltfError, Within};
use crate::format::gltf::Result;
use crate::format::motion::bind::rest_from_bind;
use crate::format::motion::raw::{self, RawMotion, Recorder, Take, parent_from_joints};
use crate::format::motion::{Found, ReadOptions};
use crate::math::{RigidTransform, RigidTransformF64};
use crate::skeleton::{MAX_JOINTS, RigJoint, Skeleton};
use crate::space::{Axis, Unit};

/// Limit on the nodes of a document.
const MAX_NODES: usize = 1 << 16;

/// Reads every animation that moves nodes.
pub(super) fn read(document: &Document, options: &ReadOptions) -> Result<RawMotion> {
    let nodes = &document.root.nodes;
    if nodes.len() > MAX_NODES {
        return Err(Fault::too_many(format_args!("{MAX_NODES} nodes"), nodes.len()).into());
    }
    let tree = document.tree()?;
    let animations = tracks(document)?;
    let humanoid = humanoid::read(document)?;
    let rig = Rig::of(document, &tree, &animations, &humanoid)?;
    let at_rest: Vec<Transform> = nodes.iter().map(Transform::of).collect();
    let mut warnings = idle(document);
    let scales = |node: &usize| {
        let animated = |track: &Track| track.node == *node && track.property == Property::Scale;
        !at_rest[*node].scale.abs_diff_eq(DVec3::ONE, 1e-3) || animations.iter().flatten().any(animated)
    };
    if let Some(&node) = rig.joints.iter().find(|node| scales(node)) {
        let name = name(&nodes[node], node);
        warnings.push(format!("joint `{name}` and perhaps others are scaled: folded into translations"));
    }
    let nodes_rest = rig.pose(&at_rest);
    let rest = rig.bound(document, &nodes_rest)?.unwrap_or(nodes_rest);

    let mut takes = Vec::new();
    let mut rate_found = Found::Asked;
    let mut frames_so_far = 0;
    for (i, tracks) in animations.iter().enumerate().filter(|(_, tracks)| !tracks.is_empty()) {
        let animation = &document.root.animations[i];
        let title =
            animation.name.clone().filter(|t| !t.is_empty()).unwrap_or_else(|| format!("animation{i}"));
        let keys: Vec<&Keys> = tracks.iter().map(|track| &track.keys).collect();
        let timing = Timing::of(animation, &keys, options.frames_per_second);
        if timing.found == Found::Assumed {
            warnings.push(format!(
                "`{title}`: keys lie on the frames of no usual rate: sampled at {FALLBACK_RATE}"
            ));
        }
        if takes.is_empty() {
            rate_found = timing.found;
        }
        let frames = raw::frame_count(timing.end - timing.start, timing.rate, rig.order.len());
        let frames = frames.map_err(GltfError::from).within(format_args!("`{title}`"))?;
        frames_so_far += frames;
        raw::frame_count(frames_so_far as f64, 1.0, rig.order.len())?;
        takes.push(rig.take(title, tracks, &timing, frames, (&at_rest, &rest)));
    }

    let mut names: Vec<String> = rig.joints.iter().map(|&node| name(&nodes[node], node)).collect();
    raw::make_unique(&mut names, &mut warnings);
    let ends = vec![None; names.len()];
    let humanoid = rig.humanoid(&humanoid);
    let skeleton = Skeleton::new(names, rig.parents, rest, ends).map_err(Box::new)?.with_humanoid(humanoid);
    Ok(RawMotion {
        format: "glTF",
        skeleton,
        takes,
        unit: Some(Unit::Metre),
        up: Some(Axis::Y),
        rest_is_upright: false,
        rate_found,
        warnings,
    })
}

/// A word on the channels that move no node.
fn idle(document: &Document) -> Vec<String> {
    let channels = document.root.animations.iter().flat_map(|animation| &animation.channels);
    let pointers = channels.filter(|channel| channel.target.path == Checked::Invalid).count();
    match document.idle_channels + pointers {
        0 => Vec::new(),
        1 => vec!["a channel of an animation moves no node: it is left out".to_owned()],
        count => vec![format!("{count} channels of animations move no node: they are left out")],
    }
}

/// The node tracks of every animation; at least one has some.
fn tracks(document: &Document) -> Result<Vec<Vec<Track>>> {
    let mut left = animation::MAX_NUMBERS;
    let mut animations = Vec::with_capacity(document.root.animations.len());
    for (i, animation) in document.root.animations.iter().enumerate() {
        let tracks = animation::read(document, animation, &mut left);
        animations.push(tracks.within(format_args!("animations[{i}]"))?);
    }
    if animations.iter().all(Vec::is_empty) {
        return Err(Fault::missing("animation of nodes").into());
    }
    Ok(animations)
}

/// The nodes that are joints, and what is needed to pose them.
struct Rig<'a> {
    tree: &'a Tree,
    /// Node indices, parents first.
    joints: Vec<usize>,
    /// For each joint, the index of its parent joint.
    parents: Vec<Option<u32>>,
    /// Joints and all their ancestors, parents first: no other node moves a joint.
    order: Vec<usize>,
}

impl<'a> Rig<'a> {
    fn of(
        document: &Document,
        tree: &'a Tree,
        animations: &[Vec<Track>],
        humanoid: &[(RigJoint, usize)],
    ) -> Result<Self> {
        let joints = joints(document, tree, animations, humanoid)?;
        let nodes = document.root.nodes.len();
        let mut place = vec![None; nodes];
        for (joint, &node) in joints.iter().enumerate() {
            place[node] = Some(joint as u32);
        }
        let mut above: Vec<Option<u32>> = vec![None; nodes];
        for &node in &tree.order {
            above[node] = tree.parents[node].and_then(|parent| place[parent].or(above[parent]));
        }
        let parents = joints.iter().map(|&node| above[node]).collect();
        let mut needed = place.iter().map(Option::is_some).collect::<Vec<_>>();
        for &node in tree.order.iter().rev() {
            if let (true, Some(parent)) = (needed[node], tree.parents[node]) {
                needed[parent] = true;
            }
        }
        let order = tree.order.iter().copied().filter(|&node| needed[node]).collect();
        Ok(Self { tree, joints, parents, order })
    }

    /// The joints of a table of nodes.
    fn humanoid(&self, nodes: &[(RigJoint, usize)]) -> Vec<(RigJoint, u32)> {
        let place = |node: usize| self.joints.iter().position(|joint| *joint == node);
        nodes.iter().filter_map(|(ours, node)| Some((*ours, place(*node)? as u32))).collect()
    }

    /// The pose that the skins were bound in, as `parent_from_joint`; `None` if it is the same as `rest`, or unknown.
    fn bound(&self, document: &Document, rest: &[RigidTransform]) -> Result<Option<Vec<RigidTransform>>> {
        let mut known: BTreeMap<usize, RigidTransformF64> = BTreeMap::new();
        let mut skins: Vec<usize> = (0..document.root.skins.len()).collect();
        skins.sort_by_key(|skin| std::cmp::Reverse(document.root.skins[*skin].joints.len()));
        for skin in skins {
            if document.root.skins[skin].inverse_bind_matrices.is_none() {
                continue;
            }
            let joints = skin_joints(document, skin).within(format_args!("skins[{skin}]"))?;
            let joints = joints.iter().map(|(node, bind)| (*node, RigidTransformF64::without_scale(bind)));
            let joints: Vec<(usize, RigidTransformF64)> = joints.collect();
            // Each skin is in the space of its own mesh: a shared joint leads from one to the other.
            let into =
                match joints.iter().find_map(|(node, bind)| Some(known.get(node)?.then(bind.inverse()))) {
                    None if !known.is_empty() => continue,
                    into => into,
                };
            for (node, bind) in joints {
                known.entry(node).or_insert(into.map_or(bind, |into| into.then(bind)));
            }
        }
        if known.is_empty() {
            return Ok(None);
        }
        let world = document.world_from_nodes(self.tree);
        let meshes =
            document.root.nodes.iter().enumerate().filter(|(_, node)| node.skin.is_some()).map(|(i, _)| i);
        let above = self.joints.iter().zip(&self.parents).filter(|(_, parent)| parent.is_none());
        let spaces = meshes.chain(above.filter_map(|(joint, _)| self.tree.parents[*joint]));
        let turn = |node: usize| {
            RigidTransformF64::without_scale(&DAffine3::from_mat4(Mat4::from(world[node]).as_dmat4()))
                .rotation
        };
        let turns: Vec<DQuat> = [DQuat::IDENTITY].into_iter().chain(spaces.map(turn)).collect();
        let bind: Vec<_> = self.joints.iter().map(|node| known.get(node).copied()).collect();
        Ok(rest_from_bind(rest, &self.parents, &bind, &turns))
    }

    /// `parent_from_joint` of every joint, from the local transforms of all nodes.
    fn pose(&self, transforms: &[Transform]) -> Vec<RigidTransform> {
        let mut world = vec![DAffine3::IDENTITY; transforms.len()];
        for &node in &self.order {
            let own = transforms[node].to_affine();
            world[node] = self.tree.parents[node].map_or(own, |parent| world[parent] * own);
        }
        let rigid: Vec<RigidTransformF64> =
            self.joints.iter().map(|&node| RigidTransformF64::without_scale(&world[node])).collect();
        parent_from_joints(&rigid, &self.parents)
    }

    /// Samples an animation at its frames. `at_rest` holds all nodes, `rest` the joints' `parent_from_joint`.
    fn take(
        &self,
        name: String,
        tracks: &[Track],
        timing: &Timing,
        frames: usize,
        (at_rest, rest): (&[Transform], &[RigidTransform]),
    ) -> Take {
        let mut recorder = Recorder::new(self.joints.len());
        let mut transforms = at_rest.to_vec();
        for frame in 0..frames {
            let time = (timing.start + frame as f64 / timing.rate).min(timing.end);
            for track in tracks {
                transforms[track.node].set(track.property, track.value(time, ON_FRAME / timing.rate));
            }
            recorder.push(&self.pose(&transforms));
        }
        recorder.take(name, timing.rate, rest)
    }
}

/// The nodes that are joints, parents first.
fn joints(
    document: &Document,
    tree: &Tree,
    animations: &[Vec<Track>],
    humanoid: &[(RigJoint, usize)],
) -> Result<Vec<usize>> {
    let nodes = document.root.nodes.len();
    let mut chosen = BTreeSet::new();
    for (i, skin) in document.root.skins.iter().enumerate() {
        for joint in &skin.joints {
            if joint.value() >= nodes {
                return Err(Fault::dangling("node", joint.value(), nodes).into())
                    .within(format_args!("skins[{i}].joints"));
            }
            chosen.insert(joint.value());
        }
    }
    if chosen.is_empty() {
        chosen.extend(animations.iter().flatten().map(|track| track.node));
        for &node in &tree.order {
            if tree.parents[node].is_some_and(|parent| chosen.contains(&parent)) {
                chosen.insert(node);
            }
        }
    }
    chosen.extend(humanoid.iter().map(|(_, node)| *node));
    if chosen.len() > MAX_JOINTS {
        return Err(Fault::too_many(format_args!("{MAX_JOINTS} joints"), chosen.len()).into());
    }
    Ok(tree.order.iter().copied().filter(|node| chosen.contains(node)).collect())
}

fn name(node: &Node, index: usize) -> String {
    node.name.clone().filter(|name| !name.is_empty()).unwrap_or_else(|| format!("node{index}"))
}

/// The transform from a node's space to its parent's.
#[derive(Clone, Copy, Debug)]
struct Transform {
    translation: DVec3,
    rotation: DQuat,
    scale: DVec3,
}

impl Transform {
    fn of(node: &Node) -> Self {
        if let Some(matrix) = node.matrix {
            let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
            let affine = DAffine3::from_mat4(matrix);
            let scale = DVec3::new(
                affine.matrix3.x_axis.length(),
                affine.matrix3.y_axis.length(),
                affine.matrix3.z_axis.length(),
            );
            let unscaled = DAffine3 { translation: DVec3::ZERO, ..affine };
            return Self {
                translation: affine.translation,
                rotation: RigidTransformF64::without_scale(&unscaled).rotation,
                scale,
            };
        }
        let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
        let rotation = node.rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.0.map(f64::from)));
        Self {
            translation: node.translation.map_or(DVec3::ZERO, vector),
            rotation: unit(rotation),
            scale: node.scale.map_or(DVec3::ONE, vector),
        }
    }

    /// Sets a property to the value of a track.
    fn set(&mut self, property: Property, value: [f64; 4]) {
        let [x, y, z, _] = value;
        match property {
            Property::Translation => self.translation = DVec3::new(x, y, z),
            Property::Scale => self.scale = DVec3::new(x, y, z),
            Property::Rotation => self.rotation = unit(DQuat::from_array(value)),
            Property::MorphTargetWeights => {}
        }
    }

    fn to_affine(self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

#[cfg(test)]
mod tests;
