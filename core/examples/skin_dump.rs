//! Writes skinned surfaces, to be compared with other programs' skinning.
//!
//!     skin_dump FOLDER [--time]
//!
//! Writes `skin.json` (counts, joint names, parents) to FOLDER and, per surface and pose, arrays of little-endian numbers;
//! `tests/skin_reference.py` reads them. With `--time`, every line on standard input is answered with the nanoseconds
//! that one linear skinning of LOD 0 and one copy of as many bytes took, on one thread; `tests/skin_speed.py` uses it.

use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Instant;

use anthronet::condition::Request;
use anthronet::math::{RigidTransform, Rotation};
use anthronet::measure::Sex;
use anthronet::model::Model;
use anthronet::random::Random;
use anthronet::scene::{Scene, SceneOptions};
use anthronet::skeleton::Influences;
use anthronet::skeleton::{Pose, Skeleton};
use anthronet::skin::{SkinContext, SkinMethod, Skinner, SurfaceMut};
use glam::Vec3;

type Outcome<T = ()> = Result<T, Box<dyn std::error::Error>>;

const POSES: u64 = 3;
const METHODS: [(&str, SkinMethod); 3] = [
    ("linear", SkinMethod::Linear),
    ("dual_quaternion", SkinMethod::DualQuaternion),
    ("joint_translation", SkinMethod::JointTranslation),
];

fn main() -> Outcome {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (folder, time) = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [folder] => (Path::new(folder), false),
        [folder, "--time"] => (Path::new(folder), true),
        _ => return Err("usage: skin_dump FOLDER [--time]".into()),
    };
    std::fs::create_dir_all(folder)?;
    let body = Model::embedded()?.generate(&Request { sex: Some(Sex::Female), ..Request::default() })?;
    let rest = body.skeleton().clone();
    let bind = rest.model_from_joints();
    let poses: Vec<Vec<RigidTransform>> =
        (0..POSES).map(|seed| random_pose(&rest, seed).model_from_joints(rest.parents())).collect();
    write_locals(&folder.join("bind"), &bind)?;
    for (p, pose) in poses.iter().enumerate() {
        write_locals(&folder.join(format!("pose{p}")), pose)?;
    }

    for per_vertex in [4, 8] {
        let scene =
            Scene::from_body(&body, &SceneOptions { influences: per_vertex, ..SceneOptions::default() })?;
        let mesh = scene.meshes.first().ok_or("the scene has no body")?;
        let vectors = |from: &[[f32; 3]]| from.iter().map(|v| Vec3::from_array(*v)).collect::<Vec<_>>();
        let influences = Influences {
            per_vertex,
            joints: mesh.joint_indices.clone(),
            weights: mesh.joint_weights.clone(),
        };
        let skinner = Skinner::new(&vectors(&mesh.positions), &vectors(&mesh.normals), &influences, &bind)?;
        write(&folder.join("positions.f32"), mesh.positions.as_flattened(), |x| x.to_le_bytes())?;
        write(&folder.join("normals.f32"), mesh.normals.as_flattened(), |x| x.to_le_bytes())?;
        write(&folder.join(format!("joints{per_vertex}.u16")), &influences.joints, |x| x.to_le_bytes())?;
        write(&folder.join(format!("weights{per_vertex}.f32")), &influences.weights, |x| x.to_le_bytes())?;
        let (mut out, mut context) = ((mesh.positions.clone(), mesh.normals.clone()), SkinContext::default());
        for (p, pose) in poses.iter().enumerate() {
            for (name, method) in METHODS {
                skinner.skin(method, pose, SurfaceMut::packed(&mut out.0, &mut out.1), &mut context)?;
                let stem = format!("{name}_{per_vertex}_pose{p}");
                for (what, array) in [("positions", &out.0), ("normals", &out.1)] {
                    let file = folder.join(format!("{stem}_{what}.f32"));
                    write(&file, array.as_flattened(), |x| x.to_le_bytes())?;
                }
            }
        }
        if per_vertex == 4 && time {
            answer_times(&skinner, &influences, &poses[0])?;
        }
    }
    let description = serde_json::json!({
        "poses": POSES,
        "methods": METHODS.map(|m| m.0),
        "names": rest.names(),
        "parents": rest.parents(),
    });
    std::fs::write(folder.join("skin.json"), description.to_string())?;
    Ok(())
}

/// Every joint rotated about a random axis, by a normally distributed angle of standard deviation 0.5 rad.
fn random_pose(rest: &Skeleton, seed: u64) -> Pose {
    let mut random = Random::new(seed, 0);
    let mut pose = rest.rest_pose().clone();
    for local in &mut pose.locals {
        let axis = Vec3::from_array(std::array::from_fn(|_| random.normal() as f32)).normalize_or(Vec3::X);
        local.rotation =
            (local.rotation * Rotation::from_axis_angle(axis, 0.5 * random.normal() as f32)).normalize();
    }
    pose
}

/// Quaternions x, y, z, w and translations, seven numbers a joint.
fn write_locals(stem: &Path, locals: &[RigidTransform]) -> Outcome {
    let numbers: Vec<f32> = locals
        .iter()
        .flat_map(|l| [&l.rotation.to_array()[..], &l.translation.to_array()].concat())
        .collect();
    write(&stem.with_extension("f32"), &numbers, |x| x.to_le_bytes())
}

fn write<T: Copy, const N: usize>(file: &Path, numbers: &[T], bytes: impl Fn(T) -> [u8; N]) -> Outcome {
    Ok(std::fs::write(file, numbers.iter().flat_map(|x| bytes(*x)).collect::<Vec<_>>())?)
}

/// Answers each line with the times, in nanoseconds, of one linear skinning and of one copy that moves as many bytes.
///
/// Both use the next of many characters each time, so that their memory is not in a cache.
fn answer_times(skinner: &Skinner, influences: &Influences, pose: &[RigidTransform]) -> Outcome {
    const CROWD: usize = 64;
    let skinners = vec![skinner.clone(); CROWD];
    let mut vectors =
        vec![(vec![[1.0; 3]; skinner.vertex_count()], vec![[1.0; 3]; skinner.vertex_count()]); CROWD];
    // A copy reads and writes: half of the bytes each.
    let from = vec![vec![1_u8; bytes_moved(influences) / 2]; CROWD];
    let mut to = from.clone();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let (mut out, mut context) = (std::io::stdout(), SkinContext::default());
    for (turn, line) in std::io::stdin().lock().lines().enumerate() {
        line?;
        let turn = turn % CROWD;
        let (skinner, (positions, normals)) = (&skinners[turn], &mut vectors[turn]);
        let skinned = pool.install(|| {
            let start = Instant::now();
            skinner.skin(SkinMethod::Linear, pose, SurfaceMut::packed(positions, normals), &mut context)?;
            anthronet::Result::Ok(start.elapsed())
        })?;
        let start = Instant::now();
        to[turn].copy_from_slice(&from[turn]);
        let copied = start.elapsed();
        std::hint::black_box((&vectors, &to));
        writeln!(out, "{} {}", skinned.as_nanos(), copied.as_nanos())?;
        out.flush()?;
    }
    Ok(())
}

/// Bytes read and written by one skinning: positions and normals twice each, plus joints and weights, where four adjacent
/// vertices use as many slots as the one of them with most influences.
fn bytes_moved(influences: &Influences) -> usize {
    let vertices = influences.weights.chunks(influences.per_vertex);
    let used: Vec<usize> = vertices.map(|w| w.iter().filter(|w| **w > 0.0).count()).collect();
    let slots: usize = used.chunks(4).map(|four| 4 * four.iter().max().unwrap_or(&0)).sum();
    used.len() * 4 * size_of::<[f32; 3]>() + slots * (size_of::<f32>() + size_of::<u16>())
}
