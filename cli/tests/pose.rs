//! Static poses and pictures of motion from the command line: what files hold, and what is refused.

mod common;

use std::fs;

use anthronet::format::read_scene;
use anthronet::scene::SceneSkinner;
use common::{anthronet, files_in, folder, generate, write};
use glam::Vec3;

/// A person of a few joints in centimetres, 25 frames a second, who bends a knee.
const BVH: &str = include_str!("../../tests/data/bend.bvh");

/// The positions of an OBJ.
fn vertices(text: &str) -> Vec<Vec3> {
    let of_line = |line: &str| {
        let mut numbers = line.strip_prefix("v ")?.split(' ').map(|number| number.parse().expect("a number"));
        Some(Vec3::new(numbers.next()?, numbers.next()?, numbers.next()?))
    };
    text.lines().filter_map(of_line).collect()
}

#[test]
fn a_pose_is_in_the_joints_of_files_that_have_them_and_in_the_vertices_of_those_that_do_not() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (plain, obj) = (path("plain.glb"), path("a.obj"));
    let person = ["generate", "--sex", "male", "-m", "height=1.81", "--lod", "1"];
    let make = |options: &[&str], file: &str| {
        anthronet(&[&person[..], options, &["-o", file]].concat(), &[]).succeeds();
    };
    make(&[], &plain);
    make(&["--pose", "sitting"], &obj);
    let posed = vertices(&fs::read_to_string(&obj).unwrap());
    let measured = |file: &str| anthronet(&["measure", file, "--json"], &[]).succeeds().out;
    for name in ["a.glb", "a.usdc", "a.usda"] {
        let file = path(name);
        make(&["--pose", "sitting"], &file);
        let scene = read_scene(&file).unwrap();
        let pose = scene.pose.as_ref().unwrap();
        let meshes = SceneSkinner::new(&scene).unwrap().pose(pose).unwrap();
        let found: Vec<Vec3> =
            meshes.iter().flat_map(|m| &m.positions).map(|p| Vec3::from_array(*p)).collect();
        assert_eq!(found.len(), posed.len(), "{name}");
        let worst = found.iter().zip(&posed).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
        assert!(worst < 1e-4, "{name}: {worst} m");
        // The bind pose, of which measures are taken, is the same.
        assert_eq!(measured(&file), measured(&plain), "{name}");
    }
    anthronet(&["measure", &obj], &[])
        .fails(1, &["a.obj", "expected a body in the T-pose, got a posed surface"]);
    // The pose goes through conversion, but not into a format that demands the T-pose.
    let (back, vrm) = (path("back.obj"), path("a.vrm"));
    anthronet(&["convert", &path("a.usda"), &back], &[]).succeeds();
    let converted = vertices(&fs::read_to_string(&back).unwrap());
    assert!(converted.iter().zip(&posed).all(|(a, b)| a.distance(*b) < 1e-4));
    let run = anthronet(&["convert", &path("a.glb"), &vrm], &[]).succeeds();
    assert!(run.err.contains("a.vrm: the format demands the T-pose, the pose is left out"), "{}", run.err);
    // Clips stay what they are, and the T-pose is no pose.
    let (clips, rest) = (path("clips.glb"), path("t.glb"));
    make(&["--pose", "sitting", "--clip", "wave"], &clips);
    let scene = read_scene(&clips).unwrap();
    assert!(scene.pose.is_some() && scene.clips[0].name() == "wave");
    assert_eq!(measured(&clips), measured(&plain));
    make(&["--pose", "t-pose"], &rest);
    assert_eq!(fs::read(&rest).unwrap(), fs::read(&plain).unwrap());
}

#[test]
fn a_pose_is_a_moment_of_a_motion_or_the_numbers_of_a_body_model() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let bvh = write(&folder, "bend.bvh", BVH.as_bytes());
    let smpl = write(&folder, "bow.json", format!("{:?}", vec![0.0; 72]).as_bytes());
    let lowest = |pose: &str, ground: bool| {
        let out = path("out.obj");
        let mut call = vec!["generate", "--sex", "female", "--lod", "3", "--pose", pose, "-o", &out];
        call.extend(ground.then_some("--ground"));
        anthronet(&call, &[]).succeeds();
        vertices(&fs::read_to_string(&out).unwrap()).iter().map(|p| p.y).fold(f32::INFINITY, f32::min)
    };
    for pose in ["walk@0.4", "walk#12", &format!("{bvh}@0.08"), &format!("{bvh}#2"), &smpl] {
        assert!(lowest(pose, true).abs() < 1e-5, "{pose}");
        assert!(lowest(pose, false).abs() < 0.05, "{pose}");
    }
    for (pose, expected) in [
        (format!("{bvh}@9"), "expected 0 to 0.120 seconds of `bend`, got 9"),
        (format!("{bvh}#4"), "expected frame 0 to 3 of `bend`, got 4"),
        (bvh.clone(), "expected a moment of its 4 frames"),
    ] {
        // After a note on the joints of the file.
        let run = generate(&["--pose", &pose]);
        assert_eq!(run.code, Some(2), "{run:#?}");
        assert!(
            run.err.contains(&format!("error: --pose {pose}: ")) && run.err.contains(expected),
            "{run:#?}"
        );
    }
    for (pose, expected) in [
        ("walk", "expected a moment of the clip, such as walk@0.5 (seconds) or walk#15 (frame)"),
        ("lotus", "no such file, expected one of t-pose, a-pose, standing, sitting"),
    ] {
        generate(&["--pose", pose]).fails(2, &["--pose", expected]);
    }
    generate(&["--ground"]).fails(2, &["--pose"]);
    generate(&["--pose", "sitting", "--no-feet"]).fails(2, &["--no-feet"]);
    generate(&["--pose", "walk@0.1", "--no-feet"]).fails(2, &["applies to motion files only"]);
    generate(&["--pose", "missing.bvh@1"]).fails(1, &["missing.bvh"]);
    let vrm = path("a.vrm");
    let refused = anthronet(&["generate", "--pose", "sitting", "-o", &vrm], &[]);
    refused.fails(2, &["--pose sitting: a .vrm must rest in the T-pose, expected .glb"]);
    let bad = write(&folder, "bad.json", b"[1, 2, 3]");
    generate(&["--pose", &bad]).fails(1, &["bad.json", "66, 72"]);
}

/// The frames of a picture that plays, and how long each is shown, seconds.
fn played(bytes: &[u8]) -> (usize, f64) {
    let mut reader = gif::DecodeOptions::new().read_info(bytes).expect("a GIF");
    let (mut count, mut delay) = (0, 0);
    while let Some(frame) = reader.read_next_frame().expect("a frame") {
        (count, delay) = (count + 1, frame.delay);
    }
    (count, f64::from(delay) / 100.0)
}

#[test]
fn pictures_show_motions_and_poses() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let person = path("walking.glb");
    let make = ["generate", "--sex", "female", "--lod", "3", "--clip", "walk", "-o", &person];
    anthronet(&make, &[]).succeeds();
    let draw = |options: &[&str], name: &str| {
        let out = path(name);
        anthronet(&[&["preview", &person][..], options, &["-o", &out]].concat(), &[]).succeeds();
        fs::read(out).unwrap()
    };
    let size = |bytes: &[u8]| {
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        (reader.info().width, reader.info().height, reader.info().animation_control.map(|all| all.num_frames))
    };
    let small = ["--size", "96x64"];
    // The character's own clip, a built-in one, a moment, a pose: all differ, and each call repeats exactly.
    let stills = [
        draw(&[&["--time", "0.5"][..], &small].concat(), "a.png"),
        draw(&[&["--frame", "3"][..], &small].concat(), "b.png"),
        draw(&[&["--clip", "squat", "--time", "1.8"][..], &small].concat(), "c.png"),
        draw(&[&["--pose", "sitting"][..], &small].concat(), "d.png"),
        draw(&small, "e.png"),
    ];
    for (i, still) in stills.iter().enumerate() {
        assert_eq!(size(still), (96, 64, None));
        assert!(!stills[..i].contains(still), "picture {i}");
    }
    assert_eq!(draw(&[&["--time", "0.5"][..], &small].concat(), "a.png"), stills[0]);
    let sheet = draw(&["--frames", "4", "--size", "200x160", "--follow"], "sheet.png");
    assert_eq!(size(&sheet), (200, 160, None));
    let apng = draw(&[&["--frames", "3", "--clip", "squat"][..], &small].concat(), "a.apng");
    assert_eq!(size(&apng), (96, 64, Some(3)));
    let gif = draw(&[&["--frames", "5"][..], &small].concat(), "a.gif");
    let (count, delay) = played(&gif);
    assert_eq!(count, 5);
    let seconds = read_scene(&person).unwrap().clips[0].duration();
    assert!((count as f64 * delay - seconds).abs() < 0.03, "{delay} for {seconds}");
}

#[test]
fn pictures_that_make_no_sense_are_refused() {
    let folder = folder();
    let person = write(&folder, "r.json", br#"{"sex": "male"}"#);
    let out = folder.path().join("x.png").to_string_lossy().into_owned();
    let webp = folder.path().join("x.webp").to_string_lossy().into_owned();
    let gif = folder.path().join("x.gif").to_string_lossy().into_owned();
    let fails = |options: &[&str], out: &str, words: &[&str]| {
        anthronet(&[&["preview", &person][..], options, &["-o", out]].concat(), &[]).fails(2, words);
    };
    fails(&["--clip", "walk"], &webp, &["x.webp", ".png .gif .apng"]);
    fails(&["--time", "1"], &out, &["--time: ", "r.json has no motion, expected one with --clip"]);
    fails(&[], &gif, &["-o: ", "has no motion"]);
    fails(&["--clip", "walk", "--time", "60"], &out, &["--time: expected 0 to", "of `walk`, got 60"]);
    fails(&["--clip", "walk", "--frame", "600"], &out, &["--frame: expected frame 0 to"]);
    fails(&["--clip", "walk", "--time", "0.1"], &gif, &["--time: shows one moment, expected a .png"]);
    fails(&["--clip", "walk", "--time", "0", "--frame", "0"], &out, &["--time", "--frame"]);
    fails(&["--clip", "walk", "--clip", "idle"], &out, &["--clip: expected one for a picture, got 2"]);
    fails(&["--pose", "sitting", "--clip", "walk"], &out, &["--pose: expected without --clip"]);
    fails(&["--pose", "sitting", "--views", "face"], &out, &["--views: face shows a head"]);
    fails(&["--frames", "0", "--clip", "walk"], &out, &["--frames"]);
    fails(&["--clip-up", "y"], &out, &["--clip-up: expected together with --clip"]);
    assert_eq!(files_in(folder.path()), ["r.json"]);
}
