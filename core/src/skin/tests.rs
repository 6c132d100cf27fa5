//! Compares the kernels with double precision, one vertex at a time.

use glam::{DMat4, DQuat, DVec3, Vec3};
use proptest::prelude::*;

use super::*;
use crate::math::{RigidTransform, Rotation};
use crate::random::Random;
use crate::skeleton::Influences;

/// A seeded surface of any size on a chain of joints, bound and posed at random.
struct Case {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    influences: Influences,
    bind: Vec<RigidTransform>,
    posed: Vec<RigidTransform>,
}

fn vector(random: &mut Random) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| random.normal()))
}

fn local(random: &mut Random) -> RigidTransform {
    let turn = DQuat::from_vec4(vector(random).extend(random.normal())).normalize();
    RigidTransform { rotation: turn.into(), translation: (vector(random) * 0.5).as_vec3() }
}

impl Case {
    fn new(seed: u64, vertices: usize, joints: usize, per_vertex: usize) -> Self {
        let random = &mut Random::new(seed, 0);
        let mut influences = Influences { per_vertex, ..Influences::default() };
        for _ in 0..vertices {
            let used = 1 + (random.uniform() * per_vertex as f64) as usize;
            let mut weights: Vec<f64> = (0..used).map(|_| random.uniform()).collect();
            weights.sort_by(|a, b| b.total_cmp(a));
            let sum: f64 = weights.iter().sum();
            for slot in 0..per_vertex {
                let weight = weights.get(slot).map_or(0.0, |w| w / sum);
                let joint = (random.uniform() * joints as f64) as u16;
                influences.joints.push(if weight > 0.0 { joint } else { 0 });
                influences.weights.push(weight as f32);
            }
        }
        Self {
            positions: (0..vertices).map(|_| vector(random).as_vec3()).collect(),
            normals: (0..vertices).map(|_| vector(random).normalize_or_zero().as_vec3()).collect(),
            influences,
            bind: (0..joints).map(|_| local(random)).collect(),
            posed: (0..joints).map(|_| local(random)).collect(),
        }
    }

    fn skinner(&self) -> Skinner {
        Skinner::new(&self.positions, &self.normals, &self.influences, &self.bind).unwrap()
    }

    fn skin(&self, method: SkinMethod, pose: &[RigidTransform]) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
        let mut out = (vec![[f32::NAN; 3]; self.positions.len()], vec![[f32::NAN; 3]; self.positions.len()]);
        self.skinner()
            .skin(method, pose, SurfaceMut::packed(&mut out.0, &mut out.1), &mut SkinContext::default())
            .unwrap();
        out
    }

    /// Joints and weights of a vertex, strongest first.
    fn row(&self, v: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let slots = v * self.influences.per_vertex..(v + 1) * self.influences.per_vertex;
        let weights = self.influences.weights[slots.clone()].iter().map(|w| f64::from(*w));
        self.influences.joints[slots].iter().map(|j| usize::from(*j)).zip(weights)
    }

    fn motion(&self, j: usize) -> (DQuat, DVec3) {
        let (bind, posed) = (self.bind[j], self.posed[j]);
        let turn =
            DQuat::from(posed.rotation).normalize() * DQuat::from(bind.rotation).normalize().conjugate();
        (turn, posed.translation.as_dvec3() - turn * bind.translation.as_dvec3())
    }

    fn linear(&self, v: usize) -> (DVec3, DVec3) {
        let mut matrix = DMat4::ZERO;
        for (j, weight) in self.row(v) {
            let (turn, shift) = self.motion(j);
            matrix += DMat4::from_rotation_translation(turn, shift) * weight;
        }
        let position = matrix.transform_point3(self.positions[v].as_dvec3());
        (position, matrix.transform_vector3(self.normals[v].as_dvec3()))
    }

    /// By definition: blend real and dual parts, normalise, rotate and translate. The last value is the minimum agreement of a
    /// joint with the sum before it: near 0, rounding decides the sign.
    fn dual_quaternion(&self, v: usize) -> (DVec3, DVec3, f64) {
        let (mut real, mut dual) = (DQuat::from_array([0.0; 4]), DQuat::from_array([0.0; 4]));
        let mut certain = f64::INFINITY;
        for (slot, (j, weight)) in self.row(v).filter(|(_, w)| *w > 0.0).enumerate() {
            let (turn, shift) = self.motion(j);
            let agreement = real.dot(turn);
            if slot > 0 {
                certain = certain.min(agreement.abs());
            }
            let weight = if agreement < 0.0 { -weight } else { weight };
            real += turn * weight;
            dual += DQuat::from_vec4(shift.extend(0.0)) * turn * (0.5 * weight);
        }
        let length = real.length();
        let (real, dual) = (real * (1.0 / length), dual * (1.0 / length));
        let shift = (dual * real.conjugate()).xyz() * 2.0;
        (real * self.positions[v].as_dvec3() + shift, real * self.normals[v].as_dvec3(), certain)
    }
}

fn near(got: [f32; 3], expected: DVec3, tolerance: f64) -> bool {
    (Vec3::from_array(got).as_dvec3() - expected).abs().max_element() <= tolerance
}

proptest! {
    // 19 vertices: whole blocks and an incomplete one.
    #[test]
    fn every_method_agrees_with_double_precision(seed: u64, eight: bool) {
        let case = Case::new(seed, 19, 7, if eight { 8 } else { 4 });
        let linear = case.skin(SkinMethod::Linear, &case.posed);
        let dual = case.skin(SkinMethod::DualQuaternion, &case.posed);
        let moved = case.skin(SkinMethod::JointTranslation, &case.posed);
        for v in 0..19 {
            // Tolerance: a dozen rounding errors of numbers up to about 8.
            let (position, normal) = case.linear(v);
            prop_assert!(near(linear.0[v], position, 1e-5));
            // Blending may shorten a normal, which increases its relative error.
            prop_assert!(near(linear.1[v], normal.normalize_or_zero(), 1e-6 / normal.length()));

            let (position, normal, certain) = case.dual_quaternion(v);
            if certain > 1e-5 {
                prop_assert!(near(dual.0[v], position, 3e-5));
                prop_assert!(near(dual.1[v], normal, 1e-5));
            }

            let shift: DVec3 = case.row(v).map(|(j, weight)| {
                (case.posed[j].translation.as_dvec3() - case.bind[j].translation.as_dvec3()) * weight
            }).sum();
            prop_assert!(near(moved.0[v], case.positions[v].as_dvec3() + shift, 1e-5));
            prop_assert_eq!(moved.1[v], case.normals[v].to_array());
        }
    }
}

#[test]
fn the_rest_pose_changes_nothing() {
    let case = Case::new(1, 101, 9, 4);
    for method in [SkinMethod::Linear, SkinMethod::DualQuaternion, SkinMethod::JointTranslation] {
        let (positions, normals) = case.skin(method, &case.bind);
        for v in 0..101 {
            // Weights sum to 1 and normals have length 1 up to rounding.
            assert!(Vec3::from_array(positions[v]).distance(case.positions[v]) <= 1e-6, "{method:?}");
            assert!(Vec3::from_array(normals[v]).distance(case.normals[v]) <= 1e-6, "{method:?}");
        }
    }
}

#[test]
fn what_follows_one_joint_moves_rigidly() {
    let mut case = Case::new(2, 6, 1, 4);
    case.influences =
        Influences { per_vertex: 4, joints: vec![0; 24], weights: [1.0, 0.0, 0.0, 0.0].repeat(6) };
    let (turn, shift) = case.motion(0);
    for method in [SkinMethod::Linear, SkinMethod::DualQuaternion] {
        let (positions, normals) = case.skin(method, &case.posed);
        for v in 0..6 {
            assert!(near(positions[v], turn * case.positions[v].as_dvec3() + shift, 1e-6));
            assert!(near(normals[v], turn * case.normals[v].as_dvec3(), 1e-6));
        }
    }
}

/// A ring of vertices halfway between two joints, one of them twisted.
fn twisted_ring(degrees: f32) -> Case {
    let around = |i: usize| Rotation::from_rotation_y(i as f32) * Vec3::X;
    let joint = |turn| RigidTransform { rotation: Rotation::from_rotation_y(turn), translation: Vec3::ZERO };
    Case {
        positions: (0..8).map(|i| around(i) * 0.1).collect(),
        normals: (0..8).map(around).collect(),
        influences: Influences { per_vertex: 2, joints: [0, 1].repeat(8), weights: vec![0.5; 16] },
        bind: vec![joint(0.0); 2],
        posed: vec![joint(0.0), joint(degrees.to_radians())],
    }
}

#[test]
fn a_half_turn_keeps_its_girth_by_dual_quaternions_alone() {
    let ring = twisted_ring(180.0);
    let (linear, linear_normals) = ring.skin(SkinMethod::Linear, &ring.posed);
    let (dual, dual_normals) = ring.skin(SkinMethod::DualQuaternion, &ring.posed);
    for v in 0..8 {
        assert!(Vec3::from_array(linear[v]).length() < 1e-6);
        assert!(Vec3::from_array(linear_normals[v]).is_finite());
        assert!((Vec3::from_array(dual[v]).length() - 0.1).abs() < 1e-6);
        assert!((Vec3::from_array(dual_normals[v]).length() - 1.0).abs() < 1e-6);
    }
    let cosine =
        |ring: &Case| Vec3::from_array(ring.skin(SkinMethod::Linear, &ring.posed).0[0]).length() / 0.1;
    // |1 + e^iφ| / 2.
    assert!((cosine(&twisted_ring(120.0)) - 0.5).abs() < 1e-6);
}

#[test]
fn a_collapsed_normal_is_zero_and_not_nan() {
    let mut ring = twisted_ring(180.0);
    ring.posed[1].rotation = Rotation::from_xyzw(0.0, 1.0, 0.0, 0.0);
    assert_eq!(ring.skin(SkinMethod::Linear, &ring.posed).1, [[0.0; 3]; 8]);
}

#[test]
fn every_layout_of_buffers_gets_the_same_numbers() {
    // More than one chunk, with an incomplete last block.
    let case = Case::new(3, 2050, 5, 4);
    let (positions, normals) = case.skin(SkinMethod::Linear, &case.posed);
    let skinner = case.skinner();
    let read = |bytes: &[u8], at: usize| -> [f32; 3] { bytemuck::pod_read_unaligned(&bytes[at..at + 12]) };

    for (stride, position_offset, normal_offset) in [(24, 0, 12), (33, 21, 3)] {
        let mut bytes = vec![0xA5; stride * 2050];
        let out = SurfaceMut::Interleaved {
            bytes: bytes.as_mut_slice().into(),
            stride,
            position_offset,
            normal_offset,
        };
        skinner.skin(SkinMethod::Linear, &case.posed, out, &mut SkinContext::default()).unwrap();
        for v in 0..2050 {
            assert_eq!(read(&bytes, v * stride + position_offset), positions[v]);
            assert_eq!(read(&bytes, v * stride + normal_offset), normals[v]);
        }
        if stride == 33 {
            let between = |v: &[u8]| [&v[..3], &v[15..21]].concat().iter().all(|b| *b == 0xA5);
            assert!(bytes.chunks(stride).all(between), "bytes between vertices are the caller's");
        }
    }

    // The smallest sufficient buffers.
    let mut wide = vec![0xA5; 5 + 16 * 2049 + 12];
    let mut packed = vec![[0.0; 3]; 2050];
    let out = SurfaceMut::Separate {
        positions: StridedMut { bytes: wide.as_mut_slice().into(), offset: 5, stride: 16 },
        normals: Some(packed.as_mut_slice().into()),
    };
    skinner.skin(SkinMethod::Linear, &case.posed, out, &mut SkinContext::default()).unwrap();
    assert_eq!(packed, normals);
    for (v, position) in positions.iter().enumerate() {
        assert_eq!(read(&wide, 5 + 16 * v), *position);
        let between = if v == 0 { 0..5 } else { 16 * v + 1..16 * v + 5 };
        assert!(wide[between].iter().all(|b| *b == 0xA5));
    }
    let out = SurfaceMut::Separate { positions: packed.as_mut_slice().into(), normals: None };
    skinner.skin(SkinMethod::Linear, &case.posed, out, &mut SkinContext::default()).unwrap();
    assert_eq!(packed, positions);
}

#[test]
fn offsets_come_before_the_pose() {
    let mut case = Case::new(4, 1030, 5, 4);
    let random = &mut Random::new(4, 1);
    let offsets: Vec<Vec3> = (0..1030).map(|_| vector(random).as_vec3() * 0.01).collect();
    for method in [SkinMethod::Linear, SkinMethod::DualQuaternion, SkinMethod::JointTranslation] {
        let skinner = case.skinner();
        let mut got = vec![[0.0; 3]; 1030];
        skin_many(
            vec![SkinJob {
                skinner: &skinner,
                method,
                model_from_joints: &case.posed,
                offsets: Some(&offsets),
                out: SurfaceMut::Separate { positions: got.as_mut_slice().into(), normals: None },
            }],
            &mut SkinContext::default(),
        )
        .unwrap();
        let plain = case.positions.clone();
        case.positions.iter_mut().zip(&offsets).for_each(|(p, o)| *p += *o);
        assert_eq!(got, case.skin(method, &case.posed).0);
        case.positions = plain;
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let cases = [Case::new(5, 5000, 20, 8), Case::new(6, 3, 2, 4), Case::new(7, 2048, 20, 4)];
    let skinners = cases.each_ref().map(Case::skinner);
    let by = |threads| {
        let mut out = cases.each_ref().map(|c| vec![[0.0_f32; 3]; 2 * c.positions.len()]);
        let jobs = skinners.iter().zip(&cases).zip(&mut out).map(|((skinner, case), out)| {
            let (positions, normals) = out.split_at_mut(case.positions.len());
            SkinJob {
                skinner,
                method: SkinMethod::DualQuaternion,
                model_from_joints: &case.posed,
                offsets: None,
                out: SurfaceMut::packed(positions, normals),
            }
        });
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| skin_many(jobs.collect(), &mut SkinContext::default())).unwrap();
        out.map(|o| o.into_iter().flatten().map(f32::to_bits).collect::<Vec<_>>())
    };
    let one = by(1);
    assert_eq!(one, by(2));
    assert_eq!(one, by(8));
    let (alone, _) = cases[0].skin(SkinMethod::DualQuaternion, &cases[0].posed);
    assert!(alone.iter().flatten().map(|x| x.to_bits()).eq(one[0][..15000].iter().copied()));
}

#[test]
fn a_context_that_was_used_before_gives_the_same_bits() {
    let cases = [Case::new(11, 50, 9, 8), Case::new(12, 1100, 3, 4), Case::new(13, 7, 30, 4)];
    let skinners = cases.each_ref().map(Case::skinner);
    let mut context = SkinContext::default();
    for method in [SkinMethod::DualQuaternion, SkinMethod::Linear, SkinMethod::JointTranslation] {
        // One more character each time, then each separately.
        for count in 1..=cases.len() {
            let mut out = cases.each_ref().map(|c| [(); 2].map(|()| vec![[f32::NAN; 3]; c.positions.len()]));
            let used = skinners.iter().zip(&cases).zip(&mut out).take(count);
            let jobs = used.map(|((skinner, case), [positions, normals])| SkinJob {
                skinner,
                method,
                model_from_joints: &case.posed,
                offsets: None,
                out: SurfaceMut::packed(positions, normals),
            });
            skin_many(jobs.collect(), &mut context).unwrap();
            for (case, out) in cases.iter().zip(&out).take(count) {
                assert_eq!(*out, <[_; 2]>::from(case.skin(method, &case.posed)), "{method:?}");
            }
        }
        for (skinner, case) in skinners.iter().zip(&cases) {
            let mut out = [(); 2].map(|()| vec![[f32::NAN; 3]; case.positions.len()]);
            let [positions, normals] = &mut out;
            let surface = SurfaceMut::packed(positions, normals);
            skinner.skin(method, &case.posed, surface, &mut context).unwrap();
            assert_eq!(out, <[_; 2]>::from(case.skin(method, &case.posed)), "{method:?}");
            // A refused call leaves the context usable.
            let short = SurfaceMut::packed(&mut [], &mut []);
            skinner.skin(method, &case.posed, short, &mut context).unwrap_err();
        }
    }
}

#[test]
fn a_surface_that_contradicts_itself_is_refused() {
    type Spoiled = (&'static str, fn(&mut Case));
    let cases: &[Spoiled] = &[
        ("normals: expected 5 for 5 vertices, got 4", |c| c.normals.truncate(4)),
        ("skin joints: expected 20 for 5 vertices, got 19", |c| c.influences.joints.truncate(19)),
        ("skin weights: expected 20 for 5 vertices, got 0", |c| c.influences.weights.clear()),
        ("expected 1 to 64 influences per vertex, got 0", |c| c.influences.per_vertex = 0),
        ("expected 1 to 64 influences per vertex, got", |c| c.influences.per_vertex = usize::MAX / 4 + 1),
        ("positions: vertex 3: expected finite", |c| c.positions[3].z = f32::NAN),
        ("normals: vertex 0: expected finite", |c| c.normals[0].x = f32::INFINITY),
        ("vertex 4: expected joints below 3, got 3", |c| c.influences.joints[16] = 3),
        ("vertex 4: expected weights from 0", |c| c.influences.weights[16] = f32::NAN),
        ("vertex 0: expected weights from 0", |c| c.influences.weights[3] = -0.5),
        ("vertex 1: expected weights from 0", |c| c.influences.weights[4..8].fill(0.0)),
        ("bind pose: joint 2: expected a unit", |c| {
            c.bind[2].rotation = Rotation::from_xyzw(0.0, 0.0, 0.0, 0.0);
        }),
        ("vertex 0: expected joints below 0", |c| c.bind.clear()),
    ];
    for (expected, spoil) in cases {
        let mut case = Case::new(8, 5, 3, 4);
        spoil(&mut case);
        let error = Skinner::new(&case.positions, &case.normals, &case.influences, &case.bind).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
    let nothing =
        Skinner::new(&[], &[], &Influences { per_vertex: 4, ..Influences::default() }, &[]).unwrap();
    nothing
        .skin(SkinMethod::Linear, &[], SurfaceMut::packed(&mut [], &mut []), &mut SkinContext::default())
        .unwrap();
}

#[test]
fn a_pose_or_offsets_that_do_not_fit_are_refused_and_nothing_is_written() {
    let case = Case::new(9, 5, 3, 4);
    let skinner = case.skinner();
    let mut nan = case.posed.clone();
    nan[1].translation.x = f32::NAN;
    let mut long = case.posed.clone();
    long[2].rotation.w *= 2.0;
    let five = [Vec3::ZERO; 5];
    type Wrong<'a> = (&'a str, &'a [RigidTransform], Option<&'a [Vec3]>);
    let cases: [Wrong<'_>; 5] = [
        ("pose: character 1: expected 3 joints, got 2", &case.posed[..2], None),
        ("pose: character 1: joint 1: expected a unit quaternion and finite", &nan, None),
        ("pose: character 1: joint 2: expected a unit", &long, None),
        ("offsets: character 1: expected 5 vertices, got 4", &case.posed, Some(&five[..4])),
        ("offsets: character 1: vertex 0: expected finite", &case.posed, Some(&[Vec3::NAN; 5])),
    ];
    for (expected, pose, offsets) in cases {
        let mut out = [[[7.0; 3]; 5]; 2];
        let [first, second] = &mut out;
        let job = |pose, offsets, out| SkinJob {
            skinner: &skinner,
            method: SkinMethod::Linear,
            model_from_joints: pose,
            offsets,
            out: SurfaceMut::Separate { positions: StridedMut::from(out), normals: None },
        };
        let jobs = vec![job(&case.posed[..], None, &mut first[..]), job(pose, offsets, &mut second[..])];
        let error = skin_many(jobs, &mut SkinContext::default()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
        assert_eq!(out, [[[7.0; 3]; 5]; 2]);
    }
}

#[test]
fn buffers_that_do_not_fit_are_refused() {
    let case = Case::new(10, 5, 3, 4);
    let skinner = case.skinner();
    let refuse = |expected: &str, out: SurfaceMut<'_>| {
        let error = skinner
            .skin(SkinMethod::Linear, &case.posed, out, &mut SkinContext::default())
            .unwrap_err()
            .to_string();
        assert!(error.contains(expected), "{error}");
    };
    let bytes = &mut [0; 200][..];
    for (offset, stride, expected) in [
        (0, 11, "position buffer: expected a stride of at least 12 bytes, got 11"),
        (0, 48, "expected 204 bytes for 5 vertices at offset 0 with stride 48, got 200 bytes"),
        (141, 12, "expected 201 bytes"),
        (usize::MAX, 12, "expected more than fits in memory"),
        (0, usize::MAX, "expected more than fits in memory"),
    ] {
        let positions = StridedMut { bytes: (&mut *bytes).into(), offset, stride };
        refuse(expected, SurfaceMut::Separate { positions, normals: None });
    }
    for (stride, position_offset, normal_offset, expected) in [
        (24, 0, 11, "side by side in a stride of 24 bytes, got offsets 0 and 11"),
        (24, 13, 0, "side by side"),
        (24, 0, usize::MAX, "side by side"),
        (44, 0, 32, "expected 220 bytes for 5 vertices"),
    ] {
        let bytes = (&mut *bytes).into();
        refuse(expected, SurfaceMut::Interleaved { bytes, stride, position_offset, normal_offset });
    }
    let mut normals = [[0.0; 3]; 4];
    let (mut positions, normals) = ([[0.0; 3]; 5], &mut normals[..]);
    refuse("normal buffer: expected 60 bytes", SurfaceMut::packed(&mut positions, normals));
}
