//! Time to skin one surface or a crowd: positions and normals.

use anthronet::Result;
use anthronet::condition::Request;
use anthronet::math::{RigidTransform, Rotation};
use anthronet::measure::Sex;
use anthronet::mesh::Lod;
use anthronet::model::Model;
use anthronet::scene::{Scene, SceneOptions};
use anthronet::skeleton::Influences;
use anthronet::skin::{SkinContext, SkinJob, SkinMethod, Skinner, SurfaceMut, skin_many};
use divan::Bencher;
use glam::Vec3;

fn main() {
    divan::main();
}

/// A surface and a pose that rotates every joint.
fn posed(lod: Lod, influences: usize) -> Result<(Skinner, Vec<RigidTransform>)> {
    let body = Model::embedded()?.generate(&Request { sex: Some(Sex::Female), ..Request::default() })?;
    let scene = Scene::from_body(&body, &SceneOptions { lod, influences, ..SceneOptions::default() })?;
    let mesh = &scene.meshes[0];
    let vectors = |from: &[[f32; 3]]| from.iter().map(|v| Vec3::from_array(*v)).collect::<Vec<_>>();
    let influences = Influences {
        per_vertex: influences,
        joints: mesh.joint_indices.clone(),
        weights: mesh.joint_weights.clone(),
    };
    let rest = body.skeleton().clone();
    let skinner = Skinner::new(
        &vectors(&mesh.positions),
        &vectors(&mesh.normals),
        &influences,
        &rest.model_from_joints(),
    )?;
    let mut pose = rest.rest_pose().clone();
    pose.locals.iter_mut().for_each(|l| l.rotation *= Rotation::from_rotation_x(0.2));
    Ok((skinner, pose.model_from_joints(rest.parents())))
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap_or_else(|e| panic!("{e}"))
}

/// `threads`: 0 for all.
fn bench(bencher: Bencher<'_, '_>, method: SkinMethod, lod: Lod, influences: usize, threads: usize) {
    let (skinner, pose) = posed(lod, influences).unwrap_or_else(|e| panic!("{e}"));
    let (mut positions, mut normals) = [(); 2].map(|()| vec![[0.0; 3]; skinner.vertex_count()]).into();
    let (pool, mut context) = (pool(threads), SkinContext::default());
    bencher.counter(divan::counter::ItemsCount::new(skinner.vertex_count())).bench_local(|| {
        let out = SurfaceMut::packed(&mut positions, &mut normals);
        pool.install(|| skinner.skin(method, &pose, out, &mut context))
    });
}

#[divan::bench(args = [1, 0])]
fn lod0_linear_4(bencher: Bencher<'_, '_>, threads: usize) {
    bench(bencher, SkinMethod::Linear, Lod::Lod0, 4, threads);
}

#[divan::bench(args = [1, 0])]
fn lod0_linear_8(bencher: Bencher<'_, '_>, threads: usize) {
    bench(bencher, SkinMethod::Linear, Lod::Lod0, 8, threads);
}

#[divan::bench(args = [1, 0])]
fn lod0_dual_quaternion_4(bencher: Bencher<'_, '_>, threads: usize) {
    bench(bencher, SkinMethod::DualQuaternion, Lod::Lod0, 4, threads);
}

#[divan::bench(args = [1, 0])]
fn lod0_joint_translation_4(bencher: Bencher<'_, '_>, threads: usize) {
    bench(bencher, SkinMethod::JointTranslation, Lod::Lod0, 4, threads);
}

#[divan::bench(args = [1, 0])]
fn lod1_linear_4(bencher: Bencher<'_, '_>, threads: usize) {
    bench(bencher, SkinMethod::Linear, Lod::Lod1, 4, threads);
}

#[divan::bench(args = [1, 0])]
fn lod1_linear_8(bencher: Bencher<'_, '_>, threads: usize) {
    bench(bencher, SkinMethod::Linear, Lod::Lod1, 8, threads);
}

#[divan::bench(args = [1, 0])]
fn lod1_dual_quaternion_4(bencher: Bencher<'_, '_>, threads: usize) {
    bench(bencher, SkinMethod::DualQuaternion, Lod::Lod1, 4, threads);
}

#[divan::bench(args = [1, 0])]
fn lod1_joint_translation_4(bencher: Bencher<'_, '_>, threads: usize) {
    bench(bencher, SkinMethod::JointTranslation, Lod::Lod1, 4, threads);
}

/// Forty characters of LOD 1 in one call.
#[divan::bench(args = [1, 0])]
fn crowd_of_40(bencher: Bencher<'_, '_>, threads: usize) {
    let (skinner, pose) = posed(Lod::Lod1, 4).unwrap_or_else(|e| panic!("{e}"));
    let crowd = vec![skinner; 40];
    let mut out = vec![[0.0; 3]; 40 * 2 * crowd[0].vertex_count()];
    let (pool, mut context) = (pool(threads), SkinContext::default());
    bencher.bench_local(|| {
        let halves = out.chunks_mut(2 * crowd[0].vertex_count());
        let jobs = crowd.iter().zip(halves).map(|(skinner, half)| {
            let (positions, normals) = half.split_at_mut(skinner.vertex_count());
            let out = SurfaceMut::packed(positions, normals);
            SkinJob { skinner, method: SkinMethod::Linear, model_from_joints: &pose, offsets: None, out }
        });
        pool.install(|| skin_many(jobs.collect(), &mut context))
    });
}
