//! Motion from the command line: built-in clips, a file of somebody else's, every format, and what is refused.

mod common;

use std::fs;

use common::{anthronet, files_in, folder, write};
use serde_json::Value;

/// A person of a few joints in centimetres, who bends a knee and has a tail.
fn bvh() -> String {
    let joint = |name: &str, offset: &str, inside: &str| {
        format!("JOINT {name}\n{{\nOFFSET {offset}\nCHANNELS 3 Zrotation Xrotation Yrotation\n{inside}\n}}\n")
    };
    let end = |offset: &str| format!("End Site\n{{\nOFFSET {offset}\n}}");
    let leg = |side: &str, x: i32| {
        let toe = joint(&format!("{side}ToeBase"), "0 -6 12", &end("0 0 6"));
        let foot = joint(&format!("{side}Foot"), "0 -42 0", &toe);
        let knee = joint(&format!("{side}Leg"), "0 -42 0", &foot);
        joint(&format!("{side}UpLeg"), &format!("{x} -4 0"), &knee)
    };
    let arm = |side: &str, x: i32| {
        let hand =
            joint(&format!("{side}Hand"), &format!("{} 0 0", 25 * x), &end(&format!("{} 0 0", 15 * x)));
        let elbow = joint(&format!("{side}ForeArm"), &format!("{} 0 0", 28 * x), &hand);
        let upper = joint(&format!("{side}Arm"), &format!("{} 0 0", 12 * x), &elbow);
        joint(&format!("{side}Shoulder"), &format!("{} 40 0", 4 * x), &upper)
    };
    let head = joint("Head", "0 10 0", &end("0 20 0"));
    let neck = joint("Neck", "0 45 0", &head);
    let spine = joint("Spine", "0 10 0", &[neck, arm("Left", 1), arm("Right", -1)].concat());
    let tail = joint("Tail", "0 0 -10", &end("0 0 -20"));
    let tree = [leg("Left", 9), leg("Right", -9), spine, tail].concat();
    let joints = tree.matches("CHANNELS").count();
    let knee = 2; // hips, LeftUpLeg, LeftLeg
    let frames: String = (0..4)
        .map(|frame| {
            let angles =
                (0..=joints).map(|j| if j == knee { format!("0 {} 0", 20 * frame) } else { "0 0 0".into() });
            format!("0 96 {} {}\n", 3 * frame, angles.collect::<Vec<_>>().join(" "))
        })
        .collect();
    format!(
        "HIERARCHY\nROOT Hips\n{{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation \
         Yrotation\n{tree}}}\nMOTION\nFrames: 4\nFrame Time: 0.04\n{frames}"
    )
}

#[test]
fn somebody_elses_motion_comes_onto_a_person_and_through_every_format() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let clip = write(&folder, "bend.bvh", bvh().as_bytes());
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
    assert!(run.err.contains("drive nothing: Tail"), "{}", run.err);
    let report: Value = serde_json::from_str(&run.out).unwrap();
    let motion = &report["motions"][0];
    assert_eq!((motion["file"]["unit"].as_str(), motion["file"]["up"].as_str()), (Some("cm"), Some("Y")));
    let quality = &motion["onto"]["clips"][0];
    assert_eq!((quality["frames"].as_u64(), quality["frames_per_second"].as_f64()), (Some(4), Some(25.0)));
    assert_eq!(motion["onto"]["joints"]["unmatched"], serde_json::json!(["Tail"]));
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

#[test]
fn what_cannot_be_is_refused_and_nothing_is_left() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let cut = write(&folder, "cut.bvh", &bvh().as_bytes()[..900]);
    let whole = write(&folder, "whole.bvh", bvh().as_bytes());
    let map = write(&folder, "map.json", br#"{"Hip": "pelvis"}"#);
    let out = path("a.glb");
    let generate = |more: &[&str], code, words: &[&str]| {
        anthronet(&[&["generate", "--sex", "female", "--lod", "3", "-o", &out], more].concat(), &[])
            .fails(code, words);
    };
    generate(&["--clip", "moonwalk"], 2, &["--clip moonwalk", "idle, walk, wave"]);
    generate(&["--clip", &cut], 1, &["cut.bvh", "line "]);
    generate(&["--clip", &whole, "--mapping", &map], 1, &["whole.bvh", "`Hip`", "did you mean `Hips`"]);
    generate(&["--clip", "walk", "--fps", "0"], 2, &["1 to 240 frames"]);
    generate(&["--motion-report", "-"], 2, &["--motion-report", "--clip"]);
    anthronet(&["generate", "--clip", "walk", "-o", &path("a.vrm")], &[]).fails(2, &[".vrm holds no motion"]);
    anthronet(&["animate", &whole, "--clip", "walk", "-o", &out], &[])
        .fails(1, &["whole.bvh", "unknown ending"]);
    anthronet(&["convert", &path("none.glb"), &out], &[]).fails(1, &["none.glb"]);
    assert_eq!(files_in(folder.path()), ["cut.bvh", "map.json", "whole.bvh"]);
}
