//! Animations of the skeleton as clips: every joint sampled at a fixed frame rate.
//!
//! Our own files state the rate and the number of frames. For other files the rate is one at which all keys fall on
//! frames, else the fallback rate. Key values on frames are used unchanged. Tracks of nodes outside the skeleton are
//! ignored.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3, Vec3};
use gltf_json::{Animation, animation::Property};

use super::skeleton::{JointNodes, chain_transform, named, to_local, written};
use crate::clip::{Clip, MAX_FRAMES, TranslationTrack};
use crate::error::{Fault, Within};
use crate::format::gltf::Result;
use crate::format::gltf::animation::{self, Keys, MAX_NUMBERS, ON_FRAME, Timing, Track};
use crate::format::gltf::document::Document;
use crate::format::gltf::weights::{self, WeightKeys};
use crate::math::{RigidTransform, Rotation};
use crate::scene::titles::Titles;
use crate::skeleton::Skeleton;

/// How far a scale may be from 1.
const SCALE_TOLERANCE: f32 = 1e-4;
/// Limit on the rotations of all clips of a document together.
const MAX_ROTATIONS: usize = 1 << 25;

/// A clip, and the morph target weights over its frames.
pub(super) struct Read {
    pub(super) clip: Clip,
    pub(super) weights: Vec<NodeWeights>,
}

/// The morph target weights of the meshes of one node.
pub(super) struct NodeWeights {
    pub(super) node: usize,
    /// For each target, one weight per frame.
    pub(super) of_targets: Vec<Vec<f32>>,
}

/// All animations that move a joint or animate morph target weights.
pub(super) fn read(document: &Document, joints: &JointNodes) -> Result<Vec<Read>> {
    if document.root.animations.is_empty() {
        return Ok(Vec::new());
    }
    let tree = joints.skeleton.tree().clone();
    let rest = Skeleton::from_rest_pose(tree, joints.locals.clone(), vec![None; joints.skeleton.len()]);
    let rest = Arc::new(rest.map_err(Box::new)?);
    let mut motions = Vec::new();
    let (mut left, mut keys) = (MAX_ROTATIONS, MAX_NUMBERS);
    for (i, animation) in document.root.animations.iter().enumerate() {
        let motion = AnimationTracks::read(document, joints, animation, &mut keys);
        let Some(motion) = motion.within(format_args!("animations[{i}]"))? else { continue };
        let (frames, joint_count) = (motion.frames, joints.skeleton.len());
        // A weight takes less memory than the rotation it is counted as.
        let numbers = joint_count + motion.weights.iter().map(|keys| keys.targets).sum::<usize>();
        let rotations = frames.checked_mul(numbers).and_then(|rotations| left.checked_sub(rotations));
        left = rotations.ok_or_else(|| {
            let most = format!("{MAX_ROTATIONS} rotations in all clips");
            Fault::too_many(
                most,
                format_args!("{frames} frames of {joint_count} joints in animations[{i}] alone"),
            )
        })?;
        motions.push((i, animation, motion));
    }
    let mut names = Titles::default();
    let mut clips = Vec::new();
    for (i, animation, motion) in motions {
        let name = names.unique(animation.name.as_deref().unwrap_or("Animation"));
        let clip = motion.clip(document, joints, &rest, name);
        let clip = clip.within(format_args!("animations[{i}]"))?;
        clips.push(Read { clip, weights: motion.node_weights() });
    }
    Ok(clips)
}

/// The tracks that move a node.
#[derive(Default)]
struct NodeTracks {
    translation: Option<Track>,
    rotation: Option<Track>,
}

struct AnimationTracks {
    nodes: BTreeMap<usize, NodeTracks>,
    weights: Vec<WeightKeys>,
    start: f64,
    rate: f64,
    frames: usize,
}

impl AnimationTracks {
    /// `None` if no joint and no morph target weight is animated.
    fn read(
        document: &Document,
        joints: &JointNodes,
        animation: &Animation,
        left: &mut usize,
    ) -> Result<Option<Self>> {
        let mut nodes: BTreeMap<usize, NodeTracks> = BTreeMap::new();
        for node in joints.chains.iter().flatten() {
            nodes.entry(*node).or_default();
        }
        let mut tracks = animation::read(document, animation, left)?;
        tracks.retain(|track| nodes.contains_key(&track.node));
        let weights = weights::read(document, animation, left)?;
        // The timing is that of the joint tracks or, without any, that of the weights.
        let keys: Vec<&Keys> = match tracks.is_empty() {
            true => weights.iter().map(|weights| &weights.keys).collect(),
            false => tracks.iter().map(|track| &track.keys).collect(),
        };
        if keys.is_empty() {
            return Ok(None);
        }
        let Timing { start, rate, frames, .. } = Timing::of(animation, &keys, None);
        for track in tracks {
            let node = track.node;
            let Some(of_node) = nodes.get_mut(&node) else { continue };
            let place = match track.property {
                Property::Translation => &mut of_node.translation,
                Property::Rotation => &mut of_node.rotation,
                _ => {
                    let mut scale = track.key_values().flat_map(|[x, y, z, _]| [x, y, z]);
                    if let Some(scale) = scale.find(|s| (s - 1.0).abs() > SCALE_TOLERANCE) {
                        let found = format!("a scale of {scale}");
                        return Err(Fault::unexpected("a rigid skeleton", found).into())
                            .within(named(document, node));
                    }
                    continue;
                }
            };
            if place.replace(track).is_some() {
                let message = format!("a second track of {}", named(document, node));
                return Err(Fault::inconsistent(message).into());
            }
        }
        if !(1.0..=MAX_FRAMES as f64).contains(&frames) {
            let found = format!("{frames} at {rate} a second");
            return Err(Fault::unexpected(format_args!("1 to {MAX_FRAMES} frames"), found).into());
        }
        Ok(Some(Self { nodes, weights, start, rate, frames: frames as usize }))
    }

    fn clip(
        &self,
        document: &Document,
        joints: &JointNodes,
        rest: &Arc<Skeleton>,
        name: String,
    ) -> Result<Clip> {
        let joint_count = joints.skeleton.len();
        let mut rotations = vec![Rotation::IDENTITY; self.frames * joint_count];
        let mut translations = Vec::new();
        for (j, (chain, at_rest)) in joints.chains.iter().zip(&joints.locals).enumerate() {
            let still = chain.iter().all(|n| self.nodes.get(n).is_none_or(|t| t.is_still()));
            let locals: Vec<RigidTransform> = (0..if still { 1 } else { self.frames })
                .map(|frame| self.local(document, chain, frame))
                .collect::<Result<_>>()?;
            let local = |frame: usize| locals[frame.min(locals.len() - 1)];
            for frame in 0..self.frames {
                rotations[frame * joint_count + j] = local(frame).rotation;
            }
            if locals.iter().any(|l| l.translation != at_rest.translation) {
                let values = (0..self.frames).map(|frame| local(frame).translation).collect();
                translations.push(TranslationTrack { joint: j as u32, values });
            }
        }
        Ok(Clip::new(name, rest.clone(), self.rate, rotations, translations).map_err(Box::new)?)
    }

    /// The weights at every frame.
    fn node_weights(&self) -> Vec<NodeWeights> {
        let at = |frame: usize| self.start + frame as f64 / self.rate;
        let near = ON_FRAME / self.rate;
        let of_node = |keys: &WeightKeys| {
            let of_target =
                |target| (0..self.frames).map(|frame| keys.value(target, at(frame), near)).collect();
            NodeWeights { node: keys.node, of_targets: (0..keys.targets).map(of_target).collect() }
        };
        self.weights.iter().map(of_node).collect()
    }

    /// `parent_from_joint` of a joint at a frame.
    fn local(&self, document: &Document, chain: &[usize], frame: usize) -> Result<RigidTransform> {
        let time = self.start + frame as f64 / self.rate;
        let near = ON_FRAME / self.rate;
        let mut product: Option<DAffine3> = None;
        for (n, &node) in chain.iter().enumerate() {
            let tracks = self.nodes.get(&node);
            let rotation = tracks.and_then(|t| t.rotation.as_ref()).map(|t| quaternion(t.value(time, near)));
            let translation =
                tracks.and_then(|t| t.translation.as_ref()).map(|t| vector(t.value(time, near)));
            let found = document.root.nodes.get(node);
            let at_rest = match found.and_then(written) {
                Some(at_rest) => at_rest,
                None => to_local(&chain_transform(document, &chain[n..=n])?),
            };
            let local = RigidTransform {
                rotation: rotation.unwrap_or(at_rest.rotation),
                translation: translation.unwrap_or(at_rest.translation),
            };
            if chain.len() == 1 {
                // The file's numbers, with no conversion through a matrix.
                return Ok(local);
            }
            let q = local.rotation;
            let affine = DAffine3::from_rotation_translation(
                DQuat::from_array(q.to_array().map(f64::from)).normalize(),
                DVec3::from_array(local.translation.to_array().map(f64::from)),
            );
            product = Some(product.map_or(affine, |above| above * affine));
        }
        Ok(to_local(&product.unwrap_or(DAffine3::IDENTITY)))
    }
}

fn quaternion(value: [f64; 4]) -> Rotation {
    Rotation::from_array(value.map(|v| v as f32))
}

fn vector([x, y, z, _]: [f64; 4]) -> Vec3 {
    DVec3::new(x, y, z).as_vec3()
}

impl NodeTracks {
    /// Whether each track has at most one key.
    fn is_still(&self) -> bool {
        [&self.translation, &self.rotation].into_iter().flatten().all(Track::is_still)
    }
}
