//! Clips from the command line: built-in ones, a motion file, every format, and what is refused.

mod common;

use std::fs;

use anthronet::clip::Clip;
use anthronet::format::read_scene;
use anthronet::scene::Scene;
use anthronet::skeleton::humanoid::{JointNames, renamed};
use common::{anthronet, files_in, folder, write};
use serde_json::Value;
use tempfile::TempDir;

/// A person of a few joints in centimetres, 25 frames a second, who bends a knee and has a tail.
const BVH: &str = include_str!("../../tests/data/bend.bvh");

#[test]
fn a_motion_file_is_retargeted_and_converted_through_every_format() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let clip = write(&folder, "bend.bvh", BVH.as_bytes());
    let (glb, usdc, back, moves) = (path("a.glb"), path("a.usdc"), path("b.glb"), path("c.usda"));
    let run = anthronet(
        &[
            "generate",
            "--sex",
            "male",
            "--lod",
            "3",
            "--clip",
            &clip,
            "--clip",
            "wave",
            "--motion-report",
            "-",
            "-o",
            &glb,
        ],
        &[],
    )
    .succeeds();
    assert!(run.err.contains("unmatched joints: Tail"), "{}", run.err);
    let report: Value = serde_json::from_str(&run.out).unwrap();
    let motion = &report["motions"][0];
    assert_eq!((motion["file"]["unit"].as_str(), motion["file"]["up"].as_str()), (Some("cm"), Some("Y")));
    let quality = &motion["retarget"]["clips"][0];
    assert_eq!((quality["frames"].as_u64(), quality["frames_per_second"].as_f64()), (Some(4), Some(25.0)));
    assert_eq!(motion["retarget"]["joints"]["unmatched"], serde_json::json!(["Tail"]));
    assert_eq!(report["motions"][1]["source"], "wave");

    // To USD and back nothing of the skin or the motion is lost: the measures stay, and so do both clips.
    anthronet(&["convert", &glb, &usdc], &[]).succeeds();
    anthronet(&["convert", &usdc, &back], &[]).succeeds();
    let names = |file: &str| {
        let bytes = fs::read(file).unwrap();
        let end = 20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        let json: Value = serde_json::from_slice(&bytes[20..end]).unwrap();
        let names =
            json["animations"].as_array().unwrap().iter().map(|a| a["name"].as_str().unwrap().to_owned());
        (names.collect::<Vec<_>>(), json["skins"][0]["joints"].as_array().unwrap().len())
    };
    assert_eq!(names(&glb).0, ["bend", "wave"]);
    assert_eq!(names(&back), names(&glb));
    let measured = |file: &str| anthronet(&["measure", file, "--json"], &[]).succeeds().out;
    assert_eq!(measured(&back), measured(&glb));

    // Joints under other names are known again, and clips of one name get a number.
    anthronet(&["convert", &glb, &glb, "--joint-names", "mixamo"], &[]).succeeds();
    anthronet(&["animate", &glb, "--clip", "wave", "--fps", "10", "-o", &moves], &[]).succeeds();
    let text = fs::read_to_string(&moves).unwrap();
    assert_eq!(text.matches("def SkelAnimation").count(), 3);
    assert!(text.contains("wave 2") && text.contains("mixamorig:Hips"));
    assert_eq!(files_in(folder.path()), ["a.glb", "a.usdc", "b.glb", "bend.bvh", "c.usda"]);
}

/// A person without motion, in a folder with the motion of others.
struct Still {
    folder: TempDir,
    file: String,
    clip: String,
}

impl Still {
    fn new() -> Self {
        let folder = folder();
        let clip = write(&folder, "bend.bvh", BVH.as_bytes());
        let file = folder.path().join("still.glb").to_string_lossy().into_owned();
        anthronet(&["generate", "--sex", "female", "--lod", "3", "-o", &file], &[]).succeeds();
        Self { folder, file, clip }
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_string_lossy().into_owned()
    }

    /// `anthronet animate` with these options: the scene that it wrote, and its report of the first motion.
    fn animated(&self, options: &[&str]) -> (Scene, Value) {
        let out = self.path("out.glb");
        let all = [&["animate", &self.file, "--motion-report", "-", "-o", &out], options].concat();
        let report: Value = serde_json::from_str(&anthronet(&all, &[]).succeeds().out).expect("a report");
        (read_scene(&out).expect("a character"), report["motions"][0].clone())
    }
}

fn clip_names(scene: &Scene) -> Vec<&str> {
    scene.clips.iter().map(Clip::name).collect()
}

#[test]
fn clips_added_at_once_or_to_the_file_give_the_same_bytes() {
    let still = Still::new();
    let [once, then, first] = ["once.glb", "then.glb", "first.usda"].map(|name| still.path(name));
    let made = ["generate", "--sex", "female", "--lod", "3"];
    let clips = ["--clip", "walk", "--clip", &still.clip];
    anthronet(&[&made[..], &clips, &["-o", &once]].concat(), &[]).succeeds();
    anthronet(&[&["animate", &still.file][..], &clips, &["-o", &then]].concat(), &[]).succeeds();
    assert!(fs::read(&once).unwrap() == fs::read(&then).unwrap(), "other bytes");

    // The same through USD: the skeleton with its animations; texture coordinates turn over and are rounded there.
    let [once, then] = ["once.usda", "then.usda"].map(|name| still.path(name));
    anthronet(&[&made[..], &["-o", &first]].concat(), &[]).succeeds();
    anthronet(&[&made[..], &clips, &["-o", &once]].concat(), &[]).succeeds();
    anthronet(&[&["animate", &first][..], &clips, &["-o", &then]].concat(), &[]).succeeds();
    let [a, b] = [once, then].map(|file| {
        let text = fs::read_to_string(file).unwrap();
        let start = text.find("def Skeleton").unwrap();
        let end = text[start..].find("def Mesh").unwrap();
        text[start..start + end].to_owned()
    });
    assert!(a.matches("def SkelAnimation").count() == 2 && a == b, "other animations");
}

#[test]
fn clips_of_one_name_are_numbered_each_time_and_names_become_printable() {
    let mut still = Still::new();
    let odd = write(&still.folder, "be\tnd.bvh", BVH.as_bytes());
    let (scene, _) =
        still.animated(&["--clip", "idle", "--clip", "idle", "--clip", &odd, "--clip", &still.clip]);
    assert_eq!(clip_names(&scene), ["idle", "idle 2", "bend", "bend 2"]);
    still.file = still.path("out.glb");
    let (scene, _) = still.animated(&["--clip", "idle", "--clip", &odd]);
    assert_eq!(clip_names(&scene), ["idle", "idle 2", "bend", "bend 2", "idle 3", "bend 3"]);
}

#[test]
fn every_option_of_motion_does_what_it_says() {
    let still = Still::new();
    let clip = ["--clip", still.clip.as_str()];
    let with = |options: &[&str]| still.animated(&[&clip[..], options].concat());
    let way = |scene: &Scene| {
        let clip = &scene.clips[0];
        let pelvis = clip.skeleton().find("pelvis").unwrap();
        let at =
            |frame: usize| clip.pose(frame).model_from_joints(clip.skeleton().parents())[pelvis].translation;
        (at(clip.frame_count() - 1) - at(0)).with_y(0.0).length()
    };
    let (plain, report) = with(&[]);
    assert_eq!((plain.clips[0].frame_count(), plain.clips[0].frames_per_second()), (4, 25.0));
    assert!(way(&plain) > 0.05 && report["retarget"]["clips"][0]["feet"].is_object());

    let (closed, _) = with(&["--loop"]);
    let last = closed.clips[0].frame_count() - 1;
    for (a, b) in closed.clips[0].rotations(0).iter().zip(closed.clips[0].rotations(last)) {
        // Rounding of f32; of two signs both are the same turn.
        assert!(a.dot(*b).abs() > 1.0 - 1e-6);
    }
    assert!(way(&with(&["--in-place"]).0) < 1e-5);
    let (slides, report) = with(&["--no-feet"]);
    assert!(report["retarget"]["clips"][0]["feet"].is_null() && slides.clips != plain.clips);

    let finger = plain.clips[0].skeleton().find("index_02_l").unwrap();
    let bent = |scene: &Scene| {
        let clip = &scene.clips[0];
        clip.rotations(0)[finger].angle_between(clip.skeleton().rest_pose().locals[finger].rotation)
    };
    assert!(bent(&plain) > 0.1 && bent(&with(&["--fingers", "relaxed"]).0) > 0.1);
    assert!(bent(&with(&["--fingers", "rest"]).0) < 1e-3);

    let (_, report) = with(&["--clip-unit", "in"]);
    assert_eq!([&report["file"]["unit"], &report["file"]["unit_found"]], ["in", "asked"]);
    let (_, report) = with(&["--clip-up", "z"]);
    assert_eq!([&report["file"]["up"], &report["file"]["up_found"]], ["Z", "asked"]);
    let (fast, report) = with(&["--clip-fps", "50"]);
    assert_eq!((fast.clips[0].frames_per_second(), &report["file"]["rate_found"]), (50.0, &"asked".into()));
    let (fine, _) = with(&["--fps", "50"]);
    assert_eq!((fine.clips[0].frames_per_second(), fine.clips[0].frame_count()), (50.0, 7));

    let (_, report) = with(&["--clip-up", "-y"]);
    assert_eq!([&report["file"]["up"], &report["file"]["up_found"]], ["-Y", "asked"]);
    let mapping = "\u{feff}{\"Tail\": \"jaw\", \"Neck\": null}".as_bytes();
    let (_, report) = with(&["--mapping", &write(&still.folder, "map.json", mapping)]);
    assert_eq!(report["retarget"]["joints"]["matched"].as_array().map(Vec::is_empty), Some(false));

    let mapping = write(&still.folder, "map.json", br#"{"Tail": "jaw", "Neck": null}"#);
    let (_, report) = with(&["--mapping", &mapping]);
    let matched = report["retarget"]["joints"]["matched"].as_array().unwrap();
    assert!(matched.iter().any(|m| m["source"] == "Tail" && m["target"] == "jaw" && m["by"] == "mapping"));
    assert!(matched.iter().all(|m| m["source"] != "Neck"));

    let backwards = write(&still.folder, "back.bvh", BVH.replace("0 60 0", "0 -60 0").as_bytes());
    let beyond = |options: &[&str]| {
        let (_, report) = still.animated(&[&["--clip", backwards.as_str()], options].concat());
        report["retarget"]["clips"][0]["beyond_limits"].as_f64().unwrap()
    };
    assert!(beyond(&["--no-feet"]) < 5.0 && beyond(&["--no-feet", "--no-limits"]) > 30.0);
}

#[test]
fn joints_have_the_names_that_are_asked_for() {
    let still = Still::new();
    for names in JointNames::ALL {
        let (scene, _) = still.animated(&["--clip", "idle", "--joint-names", names.name()]);
        for joint in ["pelvis", "lowerarm_l", "thumb_02_r", "ball_l"] {
            let expected = renamed(joint, names);
            assert!(
                scene.skeleton.as_ref().is_some_and(|s| s.find(&expected).is_some()),
                "{}: {expected}",
                names.name()
            );
        }
        // The written joints are recognised under every name: clips can be added.
        let (named, again) = (still.path("out.glb"), still.path("again.glb"));
        anthronet(&["animate", &named, "--clip", "wave", "--joint-names", "native", "-o", &again], &[])
            .succeeds();
        let scene = read_scene(&again).unwrap();
        assert_eq!(clip_names(&scene), ["idle", "wave"]);
        assert!(scene.skeleton.is_some_and(|s| s.find("thumb_02_r").is_some()));
    }
}

#[test]
fn motion_goes_to_a_vrma_and_comes_back_from_it() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (glb, vrma, other, back) = (path("a.glb"), path("a.vrma"), path("b.vrma"), path("c.glb"));
    let generate =
        |more: &[&str]| anthronet(&[&["generate", "--sex", "male", "--lod", "3"], more].concat(), &[]);
    generate(&["--clip", "walk", "-o", &glb]).succeeds();
    generate(&["--clip", "walk", "-o", &vrma]).succeeds();
    let run = anthronet(&["convert", &glb, &other], &[]).succeeds();
    assert!(run.err.contains("b.vrma: the format holds no meshes"), "{}", run.err);
    let run = generate(&["--clip", &vrma, "--motion-report", "-", "-o", &back]).succeeds();
    let report: Value = serde_json::from_str(&run.out).unwrap();
    let matched = report["motions"][0]["retarget"]["joints"]["matched"].as_array().unwrap();
    assert_eq!(matched.iter().filter(|joint| joint["by"] == "table").count(), 55);
    generate(&["-o", &path("d.vrma")]).fails(1, &["a .vrma holds a motion"]);
    assert_eq!(files_in(folder.path()), ["a.glb", "a.vrma", "b.vrma", "c.glb"]);
}

#[test]
fn half_a_person_is_refused_unless_it_is_forced() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let frame = format!("0 90 0{}\n", " 0".repeat(27));
    let above = &BVH[..BVH.find("JOINT Spine").unwrap()];
    let legs = format!("{above}}}\nMOTION\nFrames: 2\nFrame Time: 0.04\n{frame}{frame}");
    let legs = write(&folder, "legs.bvh", legs.as_bytes());
    let map = write(&folder, "map.json", br#"{"Hips": "pelvis"}"#);
    let (out, report) = (path("a.glb"), path("report.json"));
    let generate = |more: &[&str]| {
        let given = ["generate", "--sex", "male", "--lod", "3", "-o", &out, "--motion-report", &report];
        anthronet(&[&given[..], &["--clip", &legs], more].concat(), &[])
    };
    let confidence = || {
        let text: Value = serde_json::from_str(&fs::read_to_string(&report).unwrap()).unwrap();
        text["motions"][0]["retarget"]["confidence"].clone()
    };
    generate(&[]).fails(1, &["legs.bvh", "no person", "it lacks the trunk, the head", "0.5"]);
    assert!(!fs::exists(&out).unwrap());
    let refused = confidence();
    assert!(refused["value"].as_f64().unwrap() < 0.5, "{refused}");
    for more in [&["--force"][..], &["--mapping", &map]] {
        let run = generate(more).succeeds();
        assert!(run.err.contains("warning: ") && run.err.contains("it lacks the trunk"), "{}", run.err);
        assert_eq!(confidence(), refused);
    }
}

#[test]
fn what_cannot_be_is_refused_and_nothing_is_left() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let cut = write(&folder, "cut.bvh", &BVH.as_bytes()[..900]);
    let whole = write(&folder, "whole.bvh", BVH.as_bytes());
    let map = write(&folder, "map.json", br#"{"Hip": "pelvis"}"#);
    let out = path("a.glb");
    let generate = |more: &[&str], code, words: &[&str]| {
        anthronet(&[&["generate", "--sex", "female", "--lod", "3", "-o", &out], more].concat(), &[])
            .fails(code, words);
    };
    generate(&["--clip", "moonwalk"], 2, &["--clip moonwalk", "idle, walk, wave"]);
    generate(&["--clip", &cut], 1, &["cut.bvh", "line "]);
    generate(&["--clip", &whole, "--mapping", &map], 1, &["whole.bvh", "`Hip`", "did you mean `Hips`"]);
    generate(&["--clip", &whole, "--clip-up", "w"], 2, &["--clip-up", "w", "-y"]);
    generate(&["--clip", "walk", "--fps", "0"], 2, &["1 to 240 frames"]);
    generate(&["--motion-report", "-"], 2, &["--motion-report", "--clip"]);
    generate(&["--in-place"], 2, &["--in-place", "--clip"]);
    for option in [
        &["--no-feet"][..],
        &["--no-limits"],
        &["--fingers", "rest"],
        &["--mapping", &map],
        &["--clip-unit", "m"],
        &["--clip-up", "z"],
        &["--clip-fps", "50"],
        &["--clip-person", "1"],
        &["--force"],
    ] {
        generate(option, 2, &[option[0], "together with --clip"]);
        let built_in = [&["--clip", "walk", "--clip", "idle"], option].concat();
        generate(&built_in, 2, &[option[0], "applies to motion files only", "walk, idle"]);
    }
    anthronet(&["generate", "--clip", "walk", "-o", &path("a.vrm")], &[]).fails(2, &[".vrm holds no motion"]);
    anthronet(&["animate", &whole, "--clip", "walk", "-o", &out], &[])
        .fails(1, &["whole.bvh", "unknown file extension"]);
    anthronet(&["convert", &path("none.glb"), &out], &[]).fails(1, &["none.glb"]);
    assert_eq!(files_in(folder.path()), ["cut.bvh", "map.json", "whole.bvh"]);
}
