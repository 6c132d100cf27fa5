//! A small asymmetric character for the writers' tests: a bent sleeve of quads with a texture seam, and a nail of triangles.

use std::sync::Arc;

use glam::{Affine3A, Vec3};

use crate::clip::{Clip, TranslationTrack};
use crate::math::Rotation;
use crate::scene::{AlphaMode, MorphTarget, MorphTrack, SkinTone};
use crate::scene::{Corners, Scene, SceneMaterial, SceneMesh, flip_v};
use crate::skeleton::{JointTree, Skeleton};

/// Sides of the sleeve.
const SIDES: u32 = 5;

/// One joint of a scene in its bind pose, for tests that change single joints.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Joint {
    pub(crate) name: String,
    pub(crate) parent: Option<u32>,
    pub(crate) model_from_joint: Affine3A,
    pub(crate) bone_length: Option<f32>,
}

/// The skeleton of these joints.
pub(crate) fn skeleton(joints: Vec<Joint>) -> Arc<Skeleton> {
    let parents = joints.iter().map(|joint| joint.parent).collect();
    let bind = joints.iter().map(|joint| joint.model_from_joint).collect();
    let lengths = joints.iter().map(|joint| joint.bone_length).collect();
    let tree = JointTree::new(joints.into_iter().map(|joint| joint.name).collect(), parents).unwrap();
    Arc::new(Skeleton::from_bind(Arc::new(tree), bind, lengths).unwrap())
}

/// The joints of a scene; none of one without a skeleton.
pub(crate) fn joints(scene: &Scene) -> Vec<Joint> {
    let joint = |skeleton: &Skeleton, j: usize| Joint {
        name: skeleton.names()[j].clone(),
        parent: skeleton.parents()[j],
        model_from_joint: skeleton.bind()[j],
        bone_length: skeleton.bone_length(j),
    };
    scene.skeleton.iter().flat_map(|own| (0..own.len()).map(move |j| joint(own, j))).collect()
}

/// Changes joints of a scene.
pub(crate) fn edit(scene: &mut Scene, change: impl FnOnce(&mut Vec<Joint>)) {
    let mut joints = joints(scene);
    change(&mut joints);
    scene.skeleton = Some(skeleton(joints));
}

/// Renames the joints of a scene.
pub(crate) fn rename(scene: &mut Scene, name: impl Fn(&str) -> String) {
    edit(scene, |joints| joints.iter_mut().for_each(|joint| joint.name = name(&joint.name)));
}

/// Three rotated joints, a sleeve of 3 × 5 vertices with a texture seam, and one triangle without texture coordinates on the
/// last joint.
pub(crate) fn arm(influences: usize) -> Scene {
    sleeve(influences, 3)
}

/// The same with this many rings of vertices, for tests of large files.
pub(crate) fn sleeve(influences: usize, rings: u32) -> Scene {
    let place = |axis: Vec3, angle: f32, at: [f32; 3]| {
        Affine3A::from_rotation_translation(
            Rotation::from_axis_angle(axis.normalize_or_zero(), angle).into(),
            Vec3::from(at),
        )
    };
    let joint = |name: &str, parent, model_from_joint| Joint {
        name: name.into(),
        parent,
        model_from_joint,
        bone_length: Some(0.1 + 0.013 * name.len() as f32),
    };
    let joints = vec![
        joint("upper", None, place(Vec3::new(1.0, 2.0, -0.5), 0.7, [0.1, 1.2, -0.03])),
        joint("lower", Some(0), place(Vec3::new(-1.0, 0.3, 0.9), 2.9, [0.37, 1.25, 0.02])),
        joint("thumb", Some(1), place(Vec3::new(0.2, -1.0, 0.4), -1.3, [0.61, 1.11, 0.08])),
    ];
    let materials = vec![
        SceneMaterial::skin(SkinTone::default()),
        SceneMaterial {
            alpha_mode: AlphaMode::Blend,
            double_sided: true,
            specular: 0.25,
            ..SceneMaterial::dielectric("Nail", [0.8, 0.6, 0.55, 0.9], 0.2)
        },
    ];
    Scene {
        name: "Arm".into(),
        skeleton: Some(skeleton(joints)),
        meshes: vec![tube(influences, rings), cap(influences)],
        materials,
        extras: serde_json::json!({"asked": {"arm_length": 0.6}}),
        ..Scene::default()
    }
}

/// Three frames in which every joint of a scene rotates about its own axis and the root moves.
pub(crate) fn bent(scene: &Scene) -> Clip {
    let rest = Arc::new(scene.skeleton_with_ends(str::to_owned).unwrap());
    let rotation = |frame: usize, joint: usize| {
        let axis = Vec3::new(1.0, joint as f32, 0.5).normalize_or_zero();
        Rotation::from_axis_angle(axis, 0.4 * frame as f32 + 0.1 * joint as f32)
    };
    let rotations = (0..3)
        .flat_map(|f| {
            rest.rest_rotations().enumerate().map(move |(j, q)| q * rotation(f, j)).collect::<Vec<_>>()
        })
        .collect();
    let start = rest.rest_pose().locals[0].translation;
    let values = (0..3).map(|f| start + Vec3::new(0.1, -0.02, 0.3) * f as f32).collect();
    Clip::new("bent".into(), rest, 25.0, rotations, vec![TranslationTrack { joint: 0, values }]).unwrap()
}

/// The scene with another mesh that has two morph targets: a cushion of two quads with a texture seam between them. If the
/// scene has clips, the first animates both targets, and a clip of the rest pose is added that animates the second alone.
pub(crate) fn bulging(mut scene: Scene) -> Scene {
    let mesh = scene.meshes.len() as u32;
    scene.meshes.push(cushion(scene.meshes[0].influences_per_vertex));
    if let Some(clip) = scene.clips.first() {
        let frames = clip.frame_count();
        let rest = Arc::clone(clip.skeleton());
        let rotations = (0..frames).flat_map(|_| rest.rest_rotations().collect::<Vec<_>>()).collect();
        let still = Clip::new("still".into(), rest, clip.frames_per_second(), rotations, vec![]).unwrap();
        let track = |clip: usize, target, weight: fn(f32) -> f32| MorphTrack {
            clip: clip as u32,
            mesh,
            target,
            weights: (0..frames).map(|frame| weight(frame as f32)).collect(),
        };
        let last = scene.clips.len();
        scene.morph_tracks.push(track(0, 0, |frame| 0.5 * frame));
        scene.morph_tracks.push(track(0, 1, |frame| 1.0 - 0.25 * frame));
        scene.morph_tracks.push(track(last, 1, |frame| 0.125 * frame));
        scene.clips.push(still);
    }
    scene
}

/// Six vertices in two rows of three; `bulge` lifts the middle column, `lean` moves two vertices sideways and has no
/// normals.
fn cushion(influences: usize) -> SceneMesh {
    let mut mesh = SceneMesh {
        name: "Cushion".into(),
        influences_per_vertex: influences,
        normals: vec![[0.0, 0.0, 1.0]; 6],
        quads: Corners { positions: vec![[0, 1, 4, 3], [1, 2, 5, 4]], uvs: vec![[0, 1, 3, 2], [4, 5, 7, 6]] },
        ..SceneMesh::default()
    };
    for row in 0..2 {
        for column in 0..3 {
            mesh.positions.push([0.2 + 0.1 * column as f32, 1.3 + 0.1 * row as f32, 0.05]);
            let t = column as f32 / 2.0;
            push_influences(&mut mesh, [1.0 - t, t, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], influences);
        }
    }
    for island in [0.0, 0.5] {
        for (u, v) in [(0.0, 0.0), (0.4, 0.0), (0.0, 1.0), (0.4, 1.0)] {
            mesh.uvs.push(flip_v([island + u, v]));
        }
    }
    let offsets = |rows: [(usize, [f32; 3]); 2]| {
        let mut offsets = vec![[0.0; 3]; 6];
        rows.into_iter().for_each(|(vertex, offset)| offsets[vertex] = offset);
        offsets
    };
    mesh.morph_targets = vec![
        MorphTarget {
            name: "bulge".into(),
            positions: offsets([(1, [0.0, 0.01, 0.04]), (4, [0.0, -0.01, 0.04])]),
            normals: offsets([(0, [-0.25, 0.0, -0.125]), (2, [0.25, 0.0, -0.125])]),
        },
        MorphTarget {
            name: "lean 1".into(),
            positions: offsets([(3, [0.03, 0.0, 0.0]), (5, [0.02, 0.005, 0.0])]),
            normals: Vec::new(),
        },
    ];
    mesh
}

fn tube(influences: usize, rings: u32) -> SceneMesh {
    let mut mesh =
        SceneMesh { name: "Sleeve".into(), influences_per_vertex: influences, ..SceneMesh::default() };
    for ring in 0..rings {
        let t = ring as f32 / (rings - 1) as f32;
        for side in 0..SIDES {
            let angle = f64::from(side) / f64::from(SIDES) * std::f64::consts::TAU;
            let (c, s) = (libm::cos(angle) as f32, libm::sin(angle) as f32);
            let radius = 0.05 + 0.01 * t + 0.003 * side as f32;
            mesh.positions.push([0.1 + 0.5 * t, 1.2 + radius * c, 0.1 * t * t - 0.03 + radius * s]);
            mesh.normals.push([0.0, c, s]);
            let mut weights = [0.0; 8];
            weights[..3].copy_from_slice(&[1.0 - t, t * 0.7, t * 0.3]);
            push_influences(&mut mesh, weights, influences);
        }
        // One texture column more than sides, for the seam.
        for column in 0..=SIDES {
            mesh.uvs.push(flip_v([column as f32 / SIDES as f32, 0.1 + 0.8 * t]));
        }
    }
    for ring in 1..rings {
        for side in 0..SIDES {
            let next = (side + 1) % SIDES;
            let (low, high) = ((ring - 1) * SIDES, ring * SIDES);
            mesh.quads.positions.push([low + side, low + next, high + next, high + side]);
            let (low, high) = ((ring - 1) * (SIDES + 1), ring * (SIDES + 1));
            mesh.quads.uvs.push([low + side, low + side + 1, high + side + 1, high + side]);
        }
    }
    mesh
}

fn cap(influences: usize) -> SceneMesh {
    let mut mesh = SceneMesh {
        name: "Nail".into(),
        positions: vec![[0.6, 1.2, 0.1], [0.62, 1.21, 0.1], [0.61, 1.2, 0.13]],
        triangles: Corners { positions: vec![[0, 1, 2]], uvs: vec![] },
        influences_per_vertex: influences,
        material: 1,
        ..SceneMesh::default()
    };
    for _ in 0..3 {
        push_influences(&mut mesh, [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0], influences);
    }
    mesh
}

/// Appends the largest weights in descending order; slots of weight 0 have a joint other than 0 on purpose.
fn push_influences(mesh: &mut SceneMesh, weights: [f32; 8], influences: usize) {
    let mut slots: Vec<_> = weights.iter().enumerate().map(|(joint, w)| (joint as u16, *w)).collect();
    slots.sort_by(|a, b| b.1.total_cmp(&a.1));
    for (joint, weight) in &slots[..influences] {
        mesh.joint_indices.push(*joint);
        mesh.joint_weights.push(*weight);
    }
}
