//! Animations of glTF 2.0 files, binary or JSON (section 3.11 of the specification).
//!
//! Joints are the nodes that skins name, or, where there is no skin, those that are animated and all below them; what
//! stands between and above them is folded in. They rest in the pose of the nodes, which is the one that the format
//! calls initial. Every animation is sampled at the rate of its keys.

#[cfg(test)]
mod tests;

use std::collections::BTreeSet;
use std::path::Path;

use glam::{DAffine3, DMat4, DQuat, DVec3};
use gltf_json::animation::Property;
use gltf_json::{Node, Value};

use super::track::{self, Track};
use crate::error::Outcome;
use crate::format::gltf::document::{Document, Tree};
use crate::format::raw::{self, Raw, Recorder, Rigid};
use crate::format::{Found, ReadOptions};
use crate::skeleton::MAX_JOINTS;
use crate::space::{Axis, Unit};
use crate::{Error, Result};

/// Most nodes of a document.
const MAX_NODES: usize = 1 << 16;

/// Reads a document, whose buffers may lie beside `path`.
pub(crate) fn read(bytes: &[u8], path: &Path, options: &ReadOptions) -> Result<Raw> {
    let document = Document::open(bytes, path)?;
    motion(&document, options).map_err(|message| Error::file(path, message))
}

fn motion(document: &Document, options: &ReadOptions) -> Outcome<Raw> {
    let nodes = &document.root.nodes;
    if nodes.len() > MAX_NODES {
        return Err(format!("expected at most {MAX_NODES} nodes, got {}", nodes.len()));
    }
    let tree = document.tree()?;
    let mut left = track::MAX_NUMBERS;
    let animations = document
        .root
        .animations
        .iter()
        .enumerate()
        .map(|(i, animation)| {
            track::read(document, animation, &mut left).map_err(|e| format!("animations[{i}]: {e}"))
        })
        .collect::<Outcome<Vec<Vec<Track>>>>()?;
    if animations.iter().all(Vec::is_empty) {
        return Err("expected an animation of nodes, got none".to_owned());
    }
    let joints = joints(document, &tree, &animations)?;
    let mut place = vec![None; nodes.len()];
    for (joint, &node) in joints.iter().enumerate() {
        place[node] = Some(joint as u32);
    }
    let mut above: Vec<Option<u32>> = vec![None; nodes.len()];
    for &node in &tree.order {
        above[node] = tree.parents[node].and_then(|parent| place[parent].or(above[parent]));
    }
    let parents: Vec<Option<u32>> = joints.iter().map(|&node| above[node]).collect();
    // Only what moves joints is evaluated.
    let mut needed = place.iter().map(Option::is_some).collect::<Vec<_>>();
    for &node in tree.order.iter().rev().filter(|&&node| needed[node]).collect::<Vec<_>>() {
        let mut up = tree.parents[node];
        while let Some(node) = up.filter(|&node| !needed[node]) {
            needed[node] = true;
            up = tree.parents[node];
        }
    }
    let order: Vec<usize> = tree.order.iter().copied().filter(|&node| needed[node]).collect();

    let mut warnings = Vec::new();
    let rest_nodes: Vec<Transform> = nodes.iter().map(Transform::of).collect();
    let scales = |node: &usize| {
        let animated = |track: &Track| track.node == *node && track.property == Property::Scale;
        !rest_nodes[*node].scale.abs_diff_eq(DVec3::ONE, 1e-3) || animations.iter().flatten().any(animated)
    };
    if let Some(&node) = joints.iter().find(|node| scales(node)) {
        let name = name(&nodes[node], node);
        warnings.push(format!("joint `{name}` and perhaps others are scaled: folded into translations"));
    }
    let pose = |transforms: &[Transform]| {
        let mut world = vec![DAffine3::IDENTITY; transforms.len()];
        for &node in &order {
            let own = transforms[node].to_affine();
            world[node] = tree.parents[node].map_or(own, |parent| world[parent] * own);
        }
        let rigid: Vec<Rigid> = joints.iter().map(|&node| Rigid::of(&world[node])).collect();
        Rigid::locals(&rigid, &parents)
    };
    let rest = pose(&rest_nodes);

    let mut takes = Vec::new();
    let mut rate_found = Found::Asked;
    let mut frames_so_far = 0;
    for (i, tracks) in animations.iter().enumerate().filter(|(_, tracks)| !tracks.is_empty()) {
        let title = document.root.animations[i].name.clone();
        let title = title.filter(|t| !t.is_empty()).unwrap_or_else(|| format!("animation{i}"));
        let told = told(&document.root.animations[i]);
        let (start, end) =
            told.map_or_else(|| track::span(tracks), |(rate, frames)| (0.0, (frames - 1.0) / rate));
        let (rate, found) = if let Some(rate) = options.frames_per_second {
            (rate, Found::Asked)
        } else if let Some((rate, _)) = told {
            (rate, Found::File)
        } else if let Some(rate) = track::rate(tracks) {
            (rate, Found::Detected)
        } else {
            let rate = track::FALLBACK_RATE;
            warnings.push(format!("`{title}`: keys lie on the frames of no usual rate: sampled at {rate}"));
            (rate, Found::Assumed)
        };
        if takes.is_empty() {
            rate_found = found;
        }
        let frames =
            raw::frame_count(end - start, rate, order.len()).map_err(|e| format!("`{title}`: {e}"))?;
        frames_so_far += frames;
        raw::frame_count(frames_so_far as f64, 1.0, order.len())?;
        let mut recorder = Recorder::new(joints.len());
        let mut transforms = rest_nodes.clone();
        for frame in 0..frames {
            let time = (start + frame as f64 / rate).min(end);
            for track in tracks {
                track.sample(time, track::ON_FRAME / rate, &mut transforms[track.node]);
            }
            recorder.push(&pose(&transforms));
        }
        takes.push(recorder.take(title, rate, &rest));
    }

    let mut names: Vec<String> = joints.iter().map(|&node| name(&nodes[node], node)).collect();
    raw::make_unique(&mut names, &mut warnings);
    Ok(Raw {
        format: "glTF",
        ends: vec![None; names.len()],
        names,
        parents,
        rest,
        takes,
        unit: Some(Unit::Metre),
        up: Some(Axis::Y),
        rest_is_upright: false,
        rate_found,
        warnings,
    })
}

/// Rate and number of frames, which our own files say: keys that change nothing are left out of them.
pub(crate) fn told(animation: &gltf_json::Animation) -> Option<(f64, f64)> {
    let extras: Value = gltf_json::deserialize::from_str(animation.extras.as_ref()?.get()).ok()?;
    let number = |key: &str| extras.get("anthronet")?.get(key)?.as_f64();
    let (rate, frames) = (number("frames_per_second")?, number("frames")?);
    ((0.1..=1000.0).contains(&rate) && frames >= 1.0).then_some((rate, frames))
}

/// The nodes that are joints, parents first.
fn joints(document: &Document, tree: &Tree, animations: &[Vec<Track>]) -> Outcome<Vec<usize>> {
    let nodes = document.root.nodes.len();
    let mut chosen = BTreeSet::new();
    for (i, skin) in document.root.skins.iter().enumerate() {
        for joint in &skin.joints {
            if joint.value() >= nodes {
                return Err(format!("skins[{i}].joints: {} of {nodes}", joint.value()));
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
    if chosen.len() > MAX_JOINTS {
        return Err(format!("expected at most {MAX_JOINTS} joints, got {}", chosen.len()));
    }
    Ok(tree.order.iter().copied().filter(|node| chosen.contains(node)).collect())
}

fn name(node: &Node, index: usize) -> String {
    node.name.clone().filter(|name| !name.is_empty()).unwrap_or_else(|| format!("node{index}"))
}

/// A node's transform to its parent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transform {
    pub(super) translation: DVec3,
    pub(super) rotation: DQuat,
    pub(super) scale: DVec3,
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
                rotation: Rigid::of(&unscaled).rotation(),
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

    fn to_affine(self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

/// A rotation of unit length; none for what is too short.
pub(super) fn unit(q: DQuat) -> DQuat {
    let length = q.length();
    if length > 1e-6 { q * (1.0 / length) } else { DQuat::IDENTITY }
}
