use std::f64::consts::FRAC_PI_2;
use std::io::Cursor;
use std::path::Path;

use glam::Vec3;
use npyz::WriterBuilder;
use npyz::npz::NpzWriter;

use super::array::decode;
use crate::format::{Found, Motion, ReadOptions, read_motion_from_bytes};
use crate::space::Axis;

/// An array: name, shape, values.
type Named<'a> = (&'a str, &'a [u64], Vec<f64>);

fn archive(arrays: &[Named]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut zip = NpzWriter::new(&mut bytes);
    for (name, shape, values) in arrays {
        let mut array =
            zip.array(name, Default::default()).unwrap().default_dtype().shape(shape).begin_nd().unwrap();
        array.extend(values.iter().copied()).unwrap();
        array.finish().unwrap();
    }
    drop(zip);
    bytes.into_inner()
}

fn read(bytes: &[u8]) -> crate::Result<Motion> {
    read_motion_from_bytes(bytes, Path::new("walk.npz"), &ReadOptions::default())
}

/// Two frames of a standing person, +Z up, with the left knee bent in the second.
fn standing(joints: usize) -> [Named<'static>; 3] {
    let mut poses = vec![0.0; 2 * 3 * joints];
    for frame in 0..2 {
        poses[frame * 3 * joints] = FRAC_PI_2;
    }
    poses[3 * joints + 3 * 4] = 1.0;
    let shape: &[u64] = match joints {
        22 => &[2, 66],
        24 => &[2, 72],
        52 => &[2, 156],
        53 => &[2, 159],
        _ => &[2, 165],
    };
    [
        ("poses", shape, poses),
        ("trans", &[2, 3], vec![0.0, 0.0, 0.95, 0.1, 0.2, 0.95]),
        ("mocap_framerate", &[], vec![120.0]),
    ]
}

#[test]
fn every_model_of_the_family_stands_on_its_feet() {
    let models = [(22, "AMASS (body)"), (24, "SMPL"), (52, "SMPL-H"), (53, "SMPL-X"), (55, "SMPL-X")];
    for (joints, format) in models {
        let motion = read(&archive(&standing(joints))).unwrap();
        let clip = &motion.clips[0];
        assert_eq!(
            (motion.report.format, motion.report.up, motion.report.up_found),
            (format, Axis::Z, Found::File)
        );
        assert_eq!((clip.name(), clip.frame_count(), clip.frames_per_second()), ("walk", 2, 120.0));
        assert_eq!(clip.skeleton().len(), joints);
        let place = |frame: usize, name: &str| {
            let pose = clip.pose(frame).model_from_joints(clip.skeleton().parents());
            pose[clip.skeleton().find(name).unwrap()].translation
        };
        // Root rotation and up axis cancel out: the rest pose.
        for (joint, rest) in clip.skeleton().names().iter().zip(clip.skeleton().model_from_joints()) {
            assert!(place(0, joint).distance(rest.translation) < 1e-5, "{joint}");
        }
        assert!(place(1, "pelvis").distance(Vec3::new(0.1, 0.95, -0.2)) < 1e-6);
        let shin = place(1, "left_ankle") - place(1, "left_knee");
        assert!(shin.z < -0.2, "bent about its +X, a knee puts the foot behind: {shin}");
        assert!(place(0, "left_wrist").x > 0.6 && place(0, "left_foot").z > 0.05);
    }
}

#[test]
fn rest_poses_are_of_a_person_and_mirror_images() {
    for model in super::smpl::MODELS {
        let joints = model.count();
        let skeleton = super::smpl::body_model(model).unwrap().skeleton;
        assert!(skeleton.len() == joints && skeleton.tree().has_one_root());
        for (joint, name) in skeleton.names().iter().enumerate() {
            let Some(right) = name.strip_prefix("left_") else { continue };
            let right = skeleton.find(&format!("right_{right}")).unwrap();
            let place = |joint: usize| skeleton.rest_pose().locals[joint].translation;
            let mirror = place(right) * Vec3::new(-1.0, 1.0, 1.0);
            assert!(mirror.distance(place(joint)) < 1e-6, "{name}");
        }
    }
    let stature = read(&archive(&standing(55))).unwrap().report.stature;
    assert!((stature - 1.7).abs() < 0.1, "{stature}");
}

#[test]
fn parts_make_the_whole() {
    let [poses, trans, _] = standing(55);
    let part = |from: usize, to: usize| [0, 165].map(|f| &poses.2[f + from..f + to]).concat();
    let parts = archive(&[
        ("pose_hand", &[2, 90], part(75, 165)),
        ("pose_jaw", &[2, 3], part(66, 69)),
        ("pose_eye", &[2, 6], part(69, 75)),
        ("pose_body", &[2, 21, 3], part(3, 66)),
        ("root_orient", &[2, 3], part(0, 3)),
        trans,
        ("mocap_frame_rate", &[1], vec![120.0]),
    ]);
    assert_eq!(read(&parts).unwrap().clips, read(&archive(&standing(55))).unwrap().clips);
}

#[test]
fn a_body_that_stands_along_y_is_taken_so() {
    let [(name, shape, mut poses), _, rate] = standing(24);
    (poses[0], poses[72]) = (0.0, 0.0);
    let trans: Named = ("trans", &[2, 3], vec![0.0, 0.95, 0.0, 0.0, 0.95, 0.0]);
    let motion = read(&archive(&[(name, shape, poses), trans, rate])).unwrap();
    assert_eq!((motion.report.up, motion.report.up_found), (Axis::Y, Found::Detected));
    assert_eq!(motion.clips[0].pose(0).locals[0].translation, Vec3::Y * 0.95);
}

/// Rows of axis-angle vectors as rows of matrices.
fn matrices(vectors: &[f64]) -> Vec<f64> {
    let matrix = |v: &[f64]| {
        let turn = glam::DVec3::from_slice(v);
        let matrix = glam::DMat3::from_quat(glam::DQuat::from_scaled_axis(turn));
        matrix.transpose().to_cols_array()
    };
    vectors.chunks(3).flat_map(matrix).collect()
}

#[test]
fn matrices_are_vectors_in_another_form() {
    let [poses, trans, rate] = standing(24);
    let expected = read(&archive(&[poses.clone(), trans.clone(), rate.clone()])).unwrap();
    let of = |from: usize, to: usize| [0, 72].map(|f| matrices(&poses.2[f + from..f + to])).concat();
    let trans = |key| (key, trans.1, trans.2.clone());
    let tram: [Named; 3] =
        [("pred_rotmat", &[2, 24, 3, 3], of(0, 72)), ("pred_trans", &[2, 1, 3], trans("").2), rate.clone()];
    let hmr: [Named; 4] = [
        ("global_orient", &[2, 1, 3, 3], of(0, 3)),
        ("body_pose", &[2, 23, 3, 3], of(3, 72)),
        trans("pred_cam_t"),
        rate.clone(),
    ];
    for arrays in [&tram[..], &hmr[..]] {
        let motion = read(&archive(arrays)).unwrap();
        for frame in 0..2 {
            let [a, b] = [&expected, &motion].map(|m| m.clips[0].pose(frame));
            for (a, b) in a.locals.iter().zip(&b.locals) {
                assert!(a.rotation.angle_between(b.rotation) < 1e-3 && a.translation == b.translation);
            }
        }
    }
    let mut damaged = of(0, 72);
    damaged[0] = 2.0;
    let error = read(&archive(&[("rotmat", &[2, 24, 3, 3], damaged), rate])).unwrap_err().to_string();
    assert!(error.contains("rotmat: expected rotation matrices, got"), "{error}");
}

#[test]
fn one_of_several_people_is_read() {
    let [poses, trans, rate] = standing(24);
    let (mut other, mut there) = (poses.2.clone(), trans.2.clone());
    other[3 * 5] = 0.5;
    there[0] = 3.0;
    let person = |poses: &[f64], trans: &[f64]| {
        read(&archive(&[
            ("poses", &[2, 72], poses.to_vec()),
            ("trans", &[2, 3], trans.to_vec()),
            rate.clone(),
        ]))
        .unwrap()
    };
    let expected = [person(&poses.2, &trans.2), person(&other, &there)];
    // Two people in two frames: people come first.
    let both: [Named; 3] = [
        ("poses", &[2, 2, 72], [poses.2.clone(), other.clone()].concat()),
        ("trans", &[2, 2, 3], [trans.2.clone(), there.clone()].concat()),
        rate.clone(),
    ];
    let named: [Named; 5] = [
        ("person3/poses", &[2, 72], poses.2.clone()),
        ("person3/trans", &[2, 3], trans.2.clone()),
        ("person7/poses", &[2, 72], other.clone()),
        ("person7/trans", &[2, 3], there.clone()),
        rate.clone(),
    ];
    for arrays in [&both[..], &named[..]] {
        let bytes = archive(arrays);
        for (person, expected) in expected.iter().enumerate() {
            let options = ReadOptions { person: Some(person), ..ReadOptions::default() };
            let motion = read_motion_from_bytes(&bytes, Path::new("walk.npz"), &options).unwrap();
            assert_eq!(motion.clips, expected.clips);
            assert!(!motion.report.warnings.iter().any(|w| w.contains("people")));
        }
        let motion = read(&bytes).unwrap();
        assert_eq!(motion.clips, expected[0].clips);
        assert!(motion.report.warnings.iter().any(|w| w.contains("of 2 people the first was read")));
        let options = ReadOptions { person: Some(2), ..ReadOptions::default() };
        let error = read_motion_from_bytes(&bytes, Path::new("a.npz"), &options).unwrap_err().to_string();
        assert!(error.contains("expected an index of a person below 2, got 2"), "{error}");
    }
    // Three frames of two people: there are fewer people than frames.
    let frame = |poses: &[f64], other: &[f64]| [&poses[..72], &other[..72]].concat();
    let frames = [frame(&poses.2, &other), frame(&poses.2, &other), frame(&poses.2, &other)].concat();
    let motion = read(&archive(&[("poses", &[3, 2, 72], frames), rate.clone()])).unwrap();
    assert_eq!(motion.clips[0].frame_count(), 3);
}

#[test]
fn without_a_place_the_lowest_joint_is_on_the_floor() {
    let [mut poses, _, rate] = standing(24);
    // The right leg is bent, too.
    poses.2[72 + 3 * 5] = 1.0;
    let motion = read(&archive(&[poses, rate])).unwrap();
    let clip = &motion.clips[0];
    for frame in 0..2 {
        let joints = clip.pose(frame).model_from_joints(clip.skeleton().parents());
        let lowest = joints.iter().zip(clip.skeleton().ends()).map(|(joint, end)| {
            joint.translation.y.min((joint.translation + joint.rotation * end.unwrap_or_default()).y)
        });
        assert!(lowest.fold(f32::INFINITY, f32::min).abs() < 1e-5, "{frame}");
    }
    assert!(clip.pose(1).locals[0].translation.y < clip.pose(0).locals[0].translation.y - 0.05);
    assert!(motion.report.warnings.iter().any(|w| w.contains("no place of the body")));
}

#[test]
fn the_axes_of_the_world_count_and_those_of_cameras_are_found() {
    let turned = |angle: f64| {
        let mut poses = vec![0.0; 2 * 72];
        (poses[0], poses[72]) = (angle, angle);
        poses
    };
    let rate: Named = ("fps", &[], vec![30.0]);
    let camera: [Named; 2] = [
        ("pose", &[2, 72], turned(2.0 * FRAC_PI_2)),
        ("trans", &[2, 3], vec![0.1, -0.2, 3.0, 0.1, -0.2, 3.0]),
    ];
    let world: [Named; 2] = [
        ("pose_world", &[2, 72], turned(0.0)),
        ("trans_world", &[2, 3], vec![0.0, 0.95, 0.0, 0.0, 0.95, 0.0]),
    ];
    let both = [&camera[..], &world, std::slice::from_ref(&rate)].concat();
    let motion = read(&archive(&both)).unwrap();
    assert_eq!((motion.report.up, motion.report.up_found), (Axis::Y, Found::Detected));
    assert_eq!(motion.clips[0].pose(0).locals[0].translation, Vec3::Y * 0.95);

    let alone = archive(&[&camera[..], &[rate]].concat());
    let found = read(&alone).unwrap();
    assert_eq!((found.report.up, found.report.up_found), (Axis::NegativeY, Found::Detected));
    assert!(
        found.report.warnings.iter().any(|w| w.contains("taken as -Y up")),
        "{:?}",
        found.report.warnings
    );
    let options = ReadOptions { up: Some(Axis::NegativeY), ..ReadOptions::default() };
    let asked = read_motion_from_bytes(&alone, Path::new("walk.npz"), &options).unwrap();
    assert_eq!(asked.clips, found.clips);
    let pose = asked.clips[0].pose(0).model_from_joints(asked.clips[0].skeleton().parents());
    let head = pose[asked.clips[0].skeleton().find("head").unwrap()].translation;
    assert!(head.distance(Vec3::new(0.1, 0.2 + 0.58, -3.0)) < 1e-5, "{head}");
    let options = ReadOptions { up: Some(Axis::Z), ..ReadOptions::default() };
    let lying = read_motion_from_bytes(&alone, Path::new("walk.npz"), &options).unwrap();
    assert!(
        lying.report.warnings.iter().any(|w| w.contains("the person lies")),
        "{:?}",
        lying.report.warnings
    );
}

#[test]
fn components_of_hands_are_left_out_with_a_word() {
    let [poses, trans, rate] = standing(22);
    let part = |from: usize, to: usize| [0, 66].map(|f| &poses.2[f + from..f + to]).concat();
    let bytes = archive(&[
        ("global_orient", &[2, 3], part(0, 3)),
        ("body_pose", &[2, 63], part(3, 66)),
        ("left_hand_pose", &[2, 12], vec![0.1; 24]),
        ("right_hand_pose", &[2, 12], vec![0.1; 24]),
        trans.clone(),
        rate.clone(),
    ]);
    let motion = read(&bytes).unwrap();
    assert_eq!(motion.clips, read(&archive(&[poses, trans, rate])).unwrap().clips);
    let word = "`left_hand_pose` has 12 numbers a frame, components of a PCA";
    assert!(motion.report.warnings.iter().any(|w| w.contains(word)), "{:?}", motion.report.warnings);
}

#[test]
fn turns_that_nobody_makes_are_told() {
    let [mut poses, trans, rate] = standing(24);
    poses.2[3] = 1e30;
    let error = read(&archive(&[poses, trans, rate])).unwrap_err().to_string();
    assert!(error.contains("poses: an angle:") && error.contains("is too large"), "{error}");
}

#[test]
fn names_what_lacks_or_does_not_fit() {
    let cases: [(&str, Vec<Named>); 11] = [
        (
            "poses: expected 66, 72, 156, 159 or 165 numbers a frame (SMPL, SMPL-H, SMPL-X), or three times as many of \
             matrices, got a shape of [1, 3000000] of float64",
            vec![("poses", &[1, 3_000_000], vec![0.0; 3_000_000])],
        ),
        ("poses: expected 1 to 1048576 frames by joints, got a shape of [2000000, 1]", {
            vec![("poses", &[2_000_000, 1], vec![0.0; 2_000_000])]
        }),
        ("mocap_framerate: expected one number of 0.1 to 1000, got [NaN]", {
            let [poses, trans, _] = standing(24);
            vec![poses, trans, ("mocap_framerate", &[], vec![f64::NAN])]
        }),
        ("pose_body: expected 2 frames, got a shape of [3, 63]", {
            let [_, trans, rate] = standing(24);
            vec![("root_orient", &[2, 3], vec![0.0; 6]), ("pose_body", &[3, 63], vec![0.0; 189]), trans, rate]
        }),
        (
            "has no array poses, or root_orient and pose_body; the file has betas",
            vec![("betas", &[1], vec![0.0])],
        ),
        ("has no array mocap_framerate; the file has poses ([2, 72] of float64)", standing(24)[..1].to_vec()),
        (
            "has no array mocap_framerate; the file has poses ([2, 72] of float64), trans ([2, 3] of float64)",
            standing(24)[..2].to_vec(),
        ),
        (
            "of matrices, got a shape of [1, 70] of float64, perhaps with hands as components of a PCA",
            vec![("poses", &[1, 70], vec![0.0; 70])],
        ),
        (
            "poses: expected 1 to 1048576 frames by joints, got a shape of [0, 72]",
            vec![("poses", &[0, 72], vec![])],
        ),
        ("trans: expected a shape of (2, 3), got [1, 3]", {
            let [poses, _, rate] = standing(24);
            vec![poses, ("trans", &[1, 3], vec![0.0; 3]), rate]
        }),
        ("mocap_framerate: expected one number of 0.1 to 1000, got [0.0]", {
            let [poses, trans, _] = standing(24);
            vec![poses, trans, ("mocap_framerate", &[], vec![0.0])]
        }),
    ];
    for (expected, arrays) in cases {
        let error = read(&archive(&arrays)).unwrap_err().to_string();
        assert!(error.contains(expected), "expected `{expected}`, got `{error}`");
    }
    let [(name, shape, mut poses), trans, rate] = standing(24);
    poses[75] = f64::NAN;
    let error = read(&archive(&[(name, shape, poses), trans, rate])).unwrap_err().to_string();
    assert!(error.contains("frame 1, joint `left_hip`"), "{error}");
    let [poses, (name, shape, mut trans), rate] = standing(24);
    trans[4] = f64::INFINITY;
    let error = read(&archive(&[poses, (name, shape, trans), rate])).unwrap_err().to_string();
    assert!(error.contains("frame 1, joint `pelvis`"), "{error}");
}

#[test]
fn the_constant_of_the_body_model_is_told_and_shifts_the_whole() {
    let read_with = |shift: f64| {
        let [poses, (name, shape, trans), rate] = standing(24);
        read(&archive(&[poses, (name, shape, trans.iter().map(|t| t + shift).collect()), rate])).unwrap()
    };
    let (plain, shifted) = (read_with(0.0), read_with(0.25));
    assert!(plain.report.warnings.iter().any(|w| w.contains("`trans` is taken for the place of the pelvis")));
    for frame in 0..2 {
        let [a, b] = [&plain, &shifted].map(|m| m.clips[0].pose(frame));
        let by = b.locals[0].translation - a.locals[0].translation;
        assert!(by.abs_diff_eq(Vec3::new(0.25, 0.25, -0.25), 1e-6), "{by}");
        assert_eq!(a.locals[1..], b.locals[1..]);
    }
}

/// A `.npy` with this header.
fn npy(header: &str, data: &[u8]) -> Vec<u8> {
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00".as_slice(), &length, header.as_bytes(), data].concat()
}

#[test]
fn arrays_of_other_kinds() {
    let data: Vec<u8> = [1.0f32, 2.0, 3.0, 4.0, 5.0, 6.0].iter().flat_map(|x| x.to_be_bytes()).collect();
    let c = decode(&npy("{'descr': '>f4', 'fortran_order': False, 'shape': (2, 3), }", &data)).unwrap();
    assert_eq!((c.shape.as_slice(), c.values), ([2, 3].as_slice(), vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let fortran = decode(&npy("{'descr': '>f4', 'fortran_order': True, 'shape': (2, 3), }", &data)).unwrap();
    assert_eq!(fortran.values, [1.0, 3.0, 5.0, 2.0, 4.0, 6.0]);
    let deep = decode(&npy("{'descr': '>f4', 'fortran_order': True, 'shape': (1, 3, 2), }", &data)).unwrap();
    assert_eq!(deep.values, [1.0, 4.0, 2.0, 5.0, 3.0, 6.0]);
    let halves: Vec<u8> =
        [0x3c00u16, 0xc000, 0x3555, 0x0001, 0x7c00].iter().flat_map(|x| x.to_le_bytes()).collect();
    let halves = decode(&npy("{'descr': '<f2', 'fortran_order': False, 'shape': (5,), }", &halves)).unwrap();
    assert_eq!(halves.values, [1.0, -2.0, 0.333251953125, 5.960464477539063e-8, f64::INFINITY]);
    assert_eq!(halves.to_string(), "[5] of float16");
    let bytes =
        decode(&npy("{'descr': '|i1', 'fortran_order': False, 'shape': (2,), }", &[1, 0xff])).unwrap();
    assert_eq!(bytes.values, [1.0, -1.0]);
    let whole = decode(&npy("{'descr': '<i8', 'fortran_order': False, 'shape': (), }", &60i64.to_le_bytes()))
        .unwrap();
    assert_eq!((whole.rows(), whole.values), (1, vec![60.0]));
}

#[test]
fn headers_cannot_ask_for_more_than_is_there() {
    let shape = |descr: &str, shape: &str| {
        npy(&format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}"), &[0; 8])
    };
    let deep = format!("{}{}", "(".repeat(400), ")".repeat(400));
    let cases = [
        (
            "truncated: expected an array of shape [1048576, 165], got 8 bytes",
            shape("'<f8'", "(1048576, 165)"),
        ),
        ("expected a plain array", shape("'<f8'", "(4294967296, 4294967296, 4)")),
        ("expected a plain array", shape("'<f8'", &deep)),
        ("expected floating-point or whole numbers", shape("'<U2'", "(1,)")),
        ("expected an array of numbers, got a shape of [1] of Python objects", shape("'|O'", "(1,)")),
        (
            "expected at most a header of 1024 bytes, and no more than are there, got 4294967295",
            b"\x93NUMPY\x02\x00\xff\xff\xff\xff{}".to_vec(),
        ),
        ("expected the header of a numpy array", b"\x93NUMPY\x09\x00".to_vec()),
    ];
    for (expected, bytes) in cases {
        let error = decode(&bytes).err().unwrap().to_string();
        assert!(error.contains(expected), "expected `{expected}`, got `{error}`");
    }
}

#[test]
fn damage_is_an_error_or_another_motion() {
    let bytes = archive(&standing(24));
    for end in (0..bytes.len()).step_by(7) {
        assert!(read(&bytes[..end]).is_err(), "{end}");
    }
    for at in 0..bytes.len() {
        for byte in [0x00, 0x7f, 0xff] {
            let mut bytes = bytes.clone();
            bytes[at] = byte;
            // The zip directory's fields have no checksum; the arrays have.
            if let Ok(motion) = read(&bytes) {
                assert_eq!(motion.clips[0].frame_count(), 2);
            }
        }
    }
}
