//! The joint tree of a document: the joints of all its skins, each with the nodes between it and its parent joint.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::{Affine3A, DAffine3, DMat3, DMat4, DQuat, DVec3, Vec3};
use gltf_json::{Index, Node, Skin, Value};

use crate::error::{Fault, GltfError, Within};
use crate::format::gltf::Result;
use crate::format::gltf::document::{Document, Tree};
use crate::math::{RigidTransform, Rotation};
use crate::scene::titles::Titles;
use crate::skeleton::written::rounded;
use crate::skeleton::{JointTree, MAX_JOINTS, Skeleton};

/// How far a scale may be from 1, and axes from a right angle.
const RIGID_TOLERANCE: f64 = 1e-4;
/// Largest difference per matrix element for the rest pose to count as the bind pose.
const BIND_TOLERANCE: f32 = 1e-4;

/// Limit on the total length of all `chains`, a node shared by several joints counted for each.
const MAX_LINKS: usize = 1 << 20;

/// The joints of a document and their nodes.
pub(super) struct JointNodes {
    /// The joints in the bind pose, with one root.
    pub(super) skeleton: Arc<Skeleton>,
    /// `parent_from_joint` of each in the bind pose, as exact as the file.
    pub(super) locals: Vec<RigidTransform>,
    /// `parent_from_joint` of each as the nodes stand.
    pub(super) nodes: Vec<RigidTransform>,
    /// For each joint, the nodes from its parent joint (excluded), or from the top of the scene, to its own.
    pub(super) chains: Vec<Vec<usize>>,
    /// Node index of a joint to its index in `skeleton`.
    pub(super) places: BTreeMap<usize, u16>,
}

impl JointNodes {
    /// `None` for a document in which no mesh has a skin.
    pub(super) fn read(document: &Document, tree: &Tree) -> Result<Option<Self>> {
        let root = &document.root;
        let mut used: Vec<usize> = root.nodes.iter().filter_map(|n| n.skin).map(|s| s.value()).collect();
        used.sort_unstable();
        used.dedup();
        let mut nodes: Vec<usize> = Vec::new();
        let mut binds: BTreeMap<usize, DAffine3> = BTreeMap::new();
        for skin in used {
            for (node, bind) in skin_joints(document, skin).within(format_args!("skins[{skin}]"))? {
                match binds.insert(node, bind) {
                    None => nodes.push(node),
                    Some(other) if close(&other, &bind) => {}
                    Some(_) => {
                        return Err(Fault::inconsistent("has two bind poses").into())
                            .within(named(document, node));
                    }
                }
            }
        }
        if nodes.is_empty() {
            return Ok(None);
        }
        if nodes.len() > MAX_JOINTS {
            return Err(Fault::too_many(format_args!("{MAX_JOINTS} joints"), nodes.len()).into());
        }
        let mut above: Vec<Option<usize>> = vec![None; root.nodes.len()];
        for &node in &tree.order {
            let parent = tree.parents[node];
            above[node] = parent.filter(|p| binds.contains_key(p)).or(parent.and_then(|p| above[p]));
        }
        // The skin's order if it has parents first, else the tree's.
        let mut seen = BTreeSet::new();
        if !nodes.iter().all(|n| above[*n].is_none_or(|a| seen.contains(&a)) && seen.insert(*n)) {
            nodes = tree.order.iter().copied().filter(|n| binds.contains_key(n)).collect();
        }
        let mut roots = nodes.iter().filter(|n| above[**n].is_none());
        if let (Some(a), Some(b)) = (roots.next(), roots.next()) {
            let [a, b] = [a, b].map(|n| named(document, *n));
            let found = format!("several roots, {a} and {b}");
            return Err(Fault::unexpected("one joint above all others", found).into());
        }
        let places: BTreeMap<usize, u16> = (0u16..).zip(&nodes).map(|(i, n)| (*n, i)).collect();
        let parent = |node: &usize| above[*node].and_then(|a| places.get(&a)).map(|p| u32::from(*p));
        let parents: Vec<Option<u32>> = nodes.iter().map(parent).collect();
        let chains = chains(&nodes, tree, |node| binds.contains_key(&node))?;

        let mut names = Titles::default();
        let mut rest: Vec<DAffine3> = Vec::with_capacity(nodes.len());
        let mut locals = Vec::with_capacity(nodes.len());
        let mut joint_names = Vec::with_capacity(nodes.len());
        let mut lengths = Vec::with_capacity(nodes.len());
        for ((node, parent), chain) in nodes.iter().zip(&parents).zip(&chains) {
            let local = chain_transform(document, chain)?;
            locals.push(local_of(document, chain, &local));
            let above = parent.and_then(|p| rest.get(p as usize)).copied().unwrap_or(DAffine3::IDENTITY);
            let model_from_joint = above * local;
            rest.push(model_from_joint);
            let name = root.nodes[*node].name.clone().unwrap_or_else(|| format!("node {node}"));
            joint_names.push(names.unique(&name));
            lengths.push(bone_length(&root.nodes[*node]).within(named(document, *node))?);
        }
        let standing = locals.clone();
        let mut model: Vec<Affine3A> = rest.iter().map(rounded).collect();
        let bind: Vec<DAffine3> = nodes.iter().filter_map(|n| binds.get(n)).copied().collect();
        let same = |(bind, rest): (&DAffine3, &Affine3A)| rounded(bind).abs_diff_eq(*rest, BIND_TOLERANCE);
        if !bind.iter().zip(&model).all(same) {
            (model, locals) = bind_pose(document, &nodes, &parents, &bind)?;
        }
        let tree = Arc::new(JointTree::new(joint_names, parents).map_err(Box::new)?);
        let skeleton = Arc::new(Skeleton::from_bind(tree, model, lengths).map_err(Box::new)?);
        Ok(Some(Self { skeleton, locals, nodes: standing, chains, places }))
    }
}

/// The bind pose, from which a scene starts where the rest pose differs: `model_from_joint` and `parent_from_joint` of
/// each joint.
fn bind_pose(
    document: &Document,
    nodes: &[usize],
    parents: &[Option<u32>],
    bind: &[DAffine3],
) -> Result<(Vec<Affine3A>, Vec<RigidTransform>)> {
    let (mut model, mut locals) = (Vec::with_capacity(nodes.len()), Vec::with_capacity(nodes.len()));
    for ((node, parent), bind_of_node) in nodes.iter().zip(parents).zip(bind) {
        let rigid = rigid(bind_of_node).ok_or_else(|| {
            let found = format!("{}", bind_of_node.inverse());
            GltfError::from(Fault::unexpected("a rigid inverse bind matrix", found))
        });
        let rigid = rigid.within(named(document, *node))?;
        let parent = parent.map_or(DAffine3::IDENTITY, |p| bind[p as usize]);
        locals.push(to_local(&(parent.inverse() * rigid)));
        model.push(rounded(&rigid));
    }
    Ok((model, locals))
}

/// For each joint, the nodes from its parent joint (excluded), or from the top of the scene, to its own.
fn chains(joints: &[usize], tree: &Tree, is_joint: impl Fn(usize) -> bool) -> Result<Vec<Vec<usize>>> {
    let mut chains = Vec::with_capacity(joints.len());
    let mut links = 0;
    for &joint in joints {
        let above = |node: &usize| tree.parents[*node].filter(|parent| !is_joint(*parent));
        let mut chain: Vec<usize> = std::iter::successors(Some(joint), above).take(MAX_LINKS).collect();
        chain.reverse();
        links += chain.len();
        if links > MAX_LINKS {
            let most = format!("{MAX_LINKS} nodes between the joints");
            return Err(Fault::too_many(most, "more").into());
        }
        chains.push(chain);
    }
    Ok(chains)
}

/// The length of a joint's bone, which our own files state.
fn bone_length(node: &Node) -> Result<Option<f32>> {
    let extras = node.extras.as_ref().and_then(|e| gltf_json::deserialize::from_str::<Value>(e.get()).ok());
    let Some(length) = extras.as_ref().and_then(|e| e.pointer("/anthronet/bone_length")) else {
        return Ok(None);
    };
    match length.as_f64().map(|length| length as f32) {
        Some(length) if (0.0..f32::INFINITY).contains(&length) => Ok(Some(length)),
        _ => Err(Fault::unexpected("metres", length).into()).within("extras.anthronet.bone_length"),
    }
}

/// The joints of a skin: node indices and `model_from_joint` in the bind pose.
pub(in crate::format::gltf) fn skin_joints(
    document: &Document,
    skin: usize,
) -> Result<Vec<(usize, DAffine3)>> {
    let nodes = document.root.nodes.len();
    let found = document.root.skins.get(skin);
    let skin: &Skin = found.ok_or_else(|| Fault::dangling("skin", skin, document.root.skins.len()))?;
    if skin.joints.is_empty() {
        return Err(Fault::missing("joints").into());
    }
    let matrices = match skin.inverse_bind_matrices {
        Some(matrices) => document.numbers::<16>(matrices).within("inverseBindMatrices")?,
        None => vec![glam::Mat4::IDENTITY.to_cols_array(); skin.joints.len()],
    };
    if matrices.len() < skin.joints.len() {
        let expected = format!("{}, one per joint", skin.joints.len());
        return Err(Fault::unexpected(expected, matrices.len()).into()).within("inverseBindMatrices");
    }
    let joint = |(joint, matrix): (&Index<Node>, &[f32; 16])| {
        let node = joint.value();
        if node >= nodes {
            return Err(Fault::dangling("node", node, nodes).into()).within("joints");
        }
        let inverse = DAffine3::from_mat4(DMat4::from_cols_array(&matrix.map(f64::from))).inverse();
        if inverse.is_finite() {
            Ok((node, inverse))
        } else {
            Err(Fault::unexpected("a matrix with an inverse", format_args!("{matrix:?}")).into())
                .within(format_args!("inverse bind matrix of nodes[{node}]"))
        }
    };
    skin.joints.iter().zip(&matrices).map(joint).collect()
}

/// The product of the transforms along a chain of nodes, from the top down; each must be rigid.
pub(super) fn chain_transform(document: &Document, chain: &[usize]) -> Result<DAffine3> {
    chain.iter().try_fold(DAffine3::IDENTITY, |above, &i| {
        let node = &document.root.nodes[i];
        let local = match (node.matrix, written(node)) {
            (None, Some(written)) => written.to_affine_f64(),
            _ => transform_f64(node),
        };
        if rigid(&local).is_some() {
            return Ok(above * local);
        }
        let scale = local.matrix3.x_axis.length() as f32;
        let found = format!("scale ({scale}) or shear; apply it to the mesh first");
        Err(Fault::unexpected("a rotation and a translation", found).into()).within(named(document, i))
    })
}

/// Translation and rotation of a node without a matrix or a scale other than 1.
pub(super) fn written(node: &Node) -> Option<RigidTransform> {
    (node.matrix.is_none() && node.scale.is_none_or(|s| s == [1.0; 3])).then(|| RigidTransform {
        translation: node.translation.map_or(Vec3::ZERO, Vec3::from_array),
        rotation: node.rotation.map_or(Rotation::IDENTITY, |r| Rotation::from_array(r.0)),
    })
}

fn transform_f64(node: &Node) -> DAffine3 {
    if let Some(matrix) = node.matrix {
        return DAffine3::from_mat4(DMat4::from_cols_array(&matrix.map(f64::from)));
    }
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |r| DQuat::from_array(r.0.map(f64::from)));
    DAffine3::from_scale_rotation_translation(
        node.scale.map_or(DVec3::ONE, |s| DVec3::from_array(s.map(f64::from))),
        rotation,
        node.translation.map_or(DVec3::ZERO, |t| DVec3::from_array(t.map(f64::from))),
    )
}

/// The nearest rigid transform; `None` if the transform is not rigid but for rounding.
fn rigid(transform: &DAffine3) -> Option<DAffine3> {
    let m = transform.matrix3;
    let off = (m.transpose() * m - DMat3::IDENTITY).to_cols_array();
    let good = transform.is_finite()
        && off.iter().all(|v| v.abs() <= 2.0 * RIGID_TOLERANCE)
        && m.determinant() > 0.0;
    good.then(|| DAffine3 {
        matrix3: DMat3::from_quat(DQuat::from_mat3(&m).normalize()),
        translation: transform.translation,
    })
}

fn close(a: &DAffine3, b: &DAffine3) -> bool {
    rounded(a).abs_diff_eq(rounded(b), BIND_TOLERANCE)
}

/// A joint's local transform: the node's own numbers where there is only one node.
fn local_of(document: &Document, chain: &[usize], product: &DAffine3) -> RigidTransform {
    let single = match chain {
        [node] => document.root.nodes.get(*node).and_then(written),
        _ => None,
    };
    single.unwrap_or_else(|| to_local(product))
}

pub(super) fn to_local(transform: &DAffine3) -> RigidTransform {
    RigidTransform {
        rotation: DQuat::from_mat3(&transform.matrix3).normalize().into(),
        translation: transform.translation.as_vec3(),
    }
}

/// How error messages name a node.
pub(super) fn named(document: &Document, node: usize) -> String {
    match document.root.nodes.get(node).and_then(|n| n.name.as_deref()) {
        Some(name) => format!("nodes[{node}] `{name}`"),
        None => format!("nodes[{node}]"),
    }
}

/// The nearest joint at or above a node, and the node's transform to model space in the bind pose.
pub(super) fn joint_above(
    document: &Document,
    tree: &Tree,
    joints: &JointNodes,
    node: usize,
) -> Result<(u16, Affine3A)> {
    let mut joint_from_node = DAffine3::IDENTITY;
    let mut at = Some(node);
    while let Some(n) = at {
        if let Some(place) = joints.places.get(&n) {
            let model_from_joint = joints.skeleton.bind()[usize::from(*place)];
            return Ok((*place, model_from_joint * rounded(&joint_from_node)));
        }
        joint_from_node = transform_f64(&document.root.nodes[n]) * joint_from_node;
        at = tree.parents[n];
    }
    Err(Fault::inconsistent("its mesh has no skin and is below no joint").into())
        .within(named(document, node))
}
