//! Wrong requests: exit code 1 for a field of the file, 2 for one that was typed, and a message that names both.

mod common;

use std::fs;

use anthronet::measure::MEASURE_COUNT;
use common::{anthronet, files_in, folder, generate, write};

#[test]
fn a_bad_request_file_is_a_failure_that_names_file_and_field() {
    let folder = folder();
    for (text, expected) in [
        ("", "request"),
        ("{\"measures\": {\"height\": 1.7", "line 1"),
        ("[1, 2]", "request"),
        ("{\"measures\": {\"heigth\": 1.7}}", "did you mean"),
        ("{\"measures\": {\"height\": \"tall\"}}", "height"),
        ("{\"measure\": {}}", "measure"),
        ("{\"sex\": \"other\"}", "sex"),
        ("{\"seed\": -4}", "line 1"),
    ] {
        let file = write(&folder, "r.json", text.as_bytes());
        generate(&["--request", &file]).fails(1, &["r.json", expected]);
    }
    let file = write(&folder, "r.json", b"\xff\xfe\x00");
    generate(&["--request", &file]).fails(1, &["r.json"]);
    generate(&["--request", "/no/such/file.json"]).fails(1, &["/no/such/file.json", "cannot read"]);
    generate(&["--request", "/"]).fails(1, &["cannot read"]);
}

#[test]
fn a_request_is_read_in_any_encoding() {
    let folder = folder();
    let text = "\u{feff}{\"sex\": \"male\", \"measures\": {\"height\": 1.83}}";
    let utf16 = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    for bytes in [text.as_bytes().to_vec(), utf16] {
        let file = write(&folder, "r.json", &bytes);
        let out = folder.path().join("a.glb").to_string_lossy().into_owned();
        let run = anthronet(&["generate", "--lod", "3", "--request", &file, "-o", &out], &[]).succeeds();
        assert!(run.err.contains("1.830 m"), "{run:#?}");
    }
}

#[test]
fn contradictions_are_named() {
    generate(&["-m", "height=1.6", "-m", "waist_circumference=1.62"])
        .fails(2, &["waist_circumference", "height"]);
    let folder = folder();
    let file = write(&folder, "r.json", br#"{"measures": {"height": 1.6, "waist_circumference": 1.62}}"#);
    generate(&["--request", &file]).fails(1, &["waist_circumference", "height"]);
    // Each in its range, not in one body.
    generate(&["--sex", "female", "-m", "height=1.95", "-m", "thigh_length=0.30", "-m", "calf_length=0.30"])
        .fails(1, &["thigh_length"]);
    generate(&["--z", "0,0"]).fails(2, &["z", "2"]);
    generate(&["--z", "NaN,0,0,0,0,0,0,0,0,0"]).fails(2, &["z"]);
    generate(&["--z", "0,0,0,99,0,0,0,0,0,0"]).fails(2, &["z: expected numbers from -6 to 6, got 99"]);
}

#[test]
fn what_is_wrong_in_a_request_file_names_the_file() {
    let folder = folder();
    let bad = write(&folder, "bad.json", br#"{"measures": {"height": 1700}}"#);
    let good = write(&folder, "good.json", br#"{"sex": "female", "measures": {"height": 1.7}}"#);
    let nobody =
        br#"{"sex": "female", "measures": {"height": 1.95, "thigh_length": 0.3, "calf_length": 0.3}}"#;
    let nobody = write(&folder, "nobody.json", nobody);
    generate(&["--request", &bad]).fails(1, &["bad.json: height", "did you mean 1.7"]);
    generate(&["--request", &nobody]).fails(1, &["nobody.json: ", "thigh_length"]);
    // What is typed beside a file is still typed.
    generate(&["--request", &good, "-m", "height=1700"]).fails(2, &["height", "did you mean 1.7"]);
    generate(&["--request", &good, "--z", "1"]).fails(2, &["z"]);
    generate(&["--request", &bad, "-m", "waist_circumference=0.8"]).fails(1, &["bad.json: height"]);
    let between = |options: &[&str], other: &str| {
        generate(&[options, &["--interpolate", other, "--at", "0.5"]].concat())
    };
    between(&["--request", &good], &bad).fails(1, &["bad.json: height"]);
    between(&["--request", &bad], &good).fails(1, &["bad.json: height"]);
    between(&["--request", &good], &nobody).fails(1, &["nobody.json: ", "thigh_length"]);
    between(&["-m", "height=1700"], &good).fails(2, &["height", "did you mean 1.7"]);
    between(&[], "/no/such/file.json").fails(1, &["/no/such/file.json", "cannot read"]);
    let out = folder.path().join("p.png");
    anthronet(&["preview", &bad, "-o", &out.to_string_lossy()], &[]).fails(1, &["bad.json: height"]);
}

#[test]
fn a_refused_request_is_reported_and_makes_no_file() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let nobody =
        br#"{"sex": "female", "measures": {"height": 1.95, "thigh_length": 0.3, "calf_length": 0.3}}"#;
    let nobody = write(&folder, "nobody.json", nobody);
    let (out, report) = (path("out.glb"), path("report.json"));
    let ends = ["--interpolate", &nobody, "--at", "0.5"];
    for options in [&["--request", &nobody][..], &ends] {
        let all = [&["generate", "-o", &out, "--report", &report], options].concat();
        anthronet(&all, &[]).fails(1, &["thigh_length"]);
        let text = fs::read_to_string(&report).unwrap();
        let report: serde_json::Value = serde_json::from_str(&text).unwrap();
        let conflict = report["conflicts"][0]["measures"].as_array().unwrap();
        assert!(conflict.len() > 1, "{report}");
        for measure in conflict {
            assert!(measure["asked"].is_number() && measure["nearest"].is_number(), "{measure}");
        }
        assert_eq!(report["measures"].as_array().unwrap().len(), MEASURE_COUNT);
        assert_eq!(files_in(folder.path()), ["nobody.json", "report.json"]);
        fs::remove_file(path("report.json")).unwrap();
    }
}
