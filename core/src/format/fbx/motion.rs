//! Converts a scene's bones and animations to a motion.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DAffine3, DMat3, DVec3};
use ufbx::{CoordinateAxis, Scene};

use super::document::{self, BINARY, Nodes, finite, vec3};
use crate::Error;
use crate::error::{Fault, FbxError, Within};
use crate::format::fbx::Result;
use crate::format::motion::raw::{self, RawMotion, Recorder, Take, parent_from_joints};
use crate::format::motion::{Found, ReadOptions, check_start, clip_name};
use crate::math::{RigidTransform, RigidTransformF64};
use crate::skeleton::{MAX_JOINTS, Skeleton};
use crate::space::{Axis, Unit};
use crate::text;

/// Maximum number of animations of a file.
const MAX_TAKES: usize = 1 << 10;

/// Reads a file; an unnamed clip is named after it.
pub(super) fn read(bytes: &[u8], path: &Path, options: &ReadOptions) -> crate::Result<RawMotion> {
    motion(bytes, &clip_name(path), options).map_err(|error| Error::file(path, error))
}

fn motion(bytes: &[u8], name: &str, options: &ReadOptions) -> Result<RawMotion> {
    let text = if bytes.starts_with(BINARY) { bytes.into() } else { text::decode(bytes)? };
    check_start(&text, &[BINARY, b";"], "an FBX file")?;
    let scene = document::open(&text)?;
    let nodes = Nodes::of(&scene)?;
    document::check_keys(&scene)?;
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
    let rigid: Vec<RigidTransformF64> =
        bind.iter().map(|world| RigidTransformF64::without_scale(&(turn * *world))).collect();
    let rest = parent_from_joints(&rigid, &parents);

    let (rate, rate_found) = match options.frames_per_second {
        Some(rate) => (rate, Found::Asked),
        None => match scene.settings.frames_per_second {
            rate if (0.1..=1000.0).contains(&rate) => (rate, Found::File),
            _ => (30.0, Found::Assumed),
        },
    };
    let takes =
        Animated { scene: &scene, nodes: &nodes, joints: &joints, parents: &parents, turn, rest: &rest };
    let takes = takes.read(rate, name)?;

    let mut names: Vec<String> = joints.iter().map(|&j| scene.nodes[j].element.name.to_string()).collect();
    for (joint, name) in names.iter_mut().enumerate().filter(|(_, name)| name.is_empty()) {
        *name = format!("joint{joint}");
    }
    raw::make_unique(&mut names, &mut warnings);
    let ends = vec![None; names.len()];
    let skeleton = Skeleton::new(names, parents, rest, ends).map_err(Box::new)?;
    Ok(RawMotion {
        format: "FBX",
        skeleton,
        takes,
        unit: Unit::from_metres(scene.settings.unit_meters),
        up: if options.up.is_some() { None } else { Some(up.unwrap_or(Axis::Y)) },
        rest_is_upright: false,
        rate_found,
        warnings,
    })
}

/// The animated skeleton and its rest pose.
struct Animated<'a> {
    scene: &'a Scene,
    nodes: &'a Nodes,
    /// Indices into `Scene::nodes`, parents first.
    joints: &'a [usize],
    parents: &'a [Option<u32>],
    /// Rotation from the file's axes to those of the result.
    turn: DAffine3,
    rest: &'a [RigidTransform],
}

impl Animated<'_> {
    /// Every animation, sampled at a rate; an unnamed one is called `name`.
    fn read(&self, rate: f64, name: &str) -> Result<Vec<Take>> {
        let Self { scene, nodes, joints, parents, turn, rest } = *self;
        if scene.anim_stacks.is_empty() {
            return Err(Fault::missing("animation").into());
        }
        if scene.anim_stacks.len() > MAX_TAKES {
            let most = format!("{MAX_TAKES} animations");
            return Err(Fault::too_many(most, scene.anim_stacks.len()).into());
        }
        let mut takes = Vec::new();
        let mut frames_so_far = 0;
        for stack in &scene.anim_stacks {
            let title = &*stack.element.name;
            let title = if title.is_empty() { name } else { title };
            let (begin, end) = span(stack);
            let frames = raw::frame_count(end - begin, rate, scene.nodes.len());
            let frames = frames.map_err(FbxError::from).within(format_args!("animation `{title}`"))?;
            frames_so_far += frames;
            raw::frame_count(frames_so_far as f64, 1.0, scene.nodes.len())?;
            let mut recorder = Recorder::new(joints.len());
            for frame in 0..frames {
                let time = begin + frame as f64 / rate;
                let locals: Vec<ufbx::Transform> = scene
                    .nodes
                    .iter()
                    .map(|node| ufbx::evaluate_transform(&stack.anim, node, time))
                    .collect();
                finite(scene, &locals).within(format_args!("animation `{title}`: frame {frame}"))?;
                let world = nodes.world(scene, &locals);
                let rigid: Vec<RigidTransformF64> = joints
                    .iter()
                    .map(|&node| RigidTransformF64::without_scale(&(turn * world[node])))
                    .collect();
                recorder.push(&parent_from_joints(&rigid, parents));
            }
            takes.push(recorder.take(title.to_owned(), rate, rest));
        }
        Ok(takes)
    }
}

/// Start and end of an animation: as stated in the file, else from the first to the last key.
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

/// The bone nodes, parents first; the animated nodes where there are no bones.
fn joints(scene: &Scene, nodes: &Nodes) -> Result<Vec<usize>> {
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
        0 => Err(Fault::missing("bones or animated nodes").into()),
        count if count > MAX_JOINTS => {
            Err(Fault::too_many(format_args!("{MAX_JOINTS} joints"), count).into())
        }
        _ => Ok(joints),
    }
}

/// The file's up axis, `None` unless +Y or +Z, and the rotation to +Y up for files with other axes.
fn axes(scene: &Scene, options: &ReadOptions) -> Result<(Option<Axis>, DAffine3)> {
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
        (determinant, _) if determinant < 0.5 => Err(Fault::unexpected(
            "right-handed axes",
            format_args!("{:?}, {:?}, {:?}", axes.right, axes.up, axes.front),
        )
        .into()),
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
