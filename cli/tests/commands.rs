//! The commands on good input, end to end through files. Needs the built-in model.

mod common;

use std::fs;

use anthronet::measure::MEASURE_COUNT;
use common::{anthronet, files_in, folder, write};
use serde_json::Value;

#[test]
fn help_is_for_people() {
    for command in
        ["generate", "animate", "convert", "measure", "info", "preview", "contact-sheet", "evaluate", "train"]
    {
        let run = anthronet(&[command, "--help"], &[]).succeeds();
        assert!(run.out.contains("Example"), "{command}: {}", run.out);
    }
    assert!(anthronet(&["--help"], &[]).succeeds().out.contains("170cm"));
    assert!(anthronet(&["--version"], &[]).succeeds().out.starts_with("anthronet "));
}

#[test]
fn what_is_asked_is_measured_again_from_the_file() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let asked = [
        ("height", "170cm", 1.70),
        ("waist_circumference", "29in", 29.0 * 0.0254),
        ("arm_length", "0.33", 0.33),
    ];
    let measures: Vec<String> = asked.iter().map(|(name, value, _)| format!("{name}={value}")).collect();
    let mut arguments = vec!["generate", "--sex", "female", "--report", "-"];
    for measure in &measures {
        arguments.extend(["-m", measure]);
    }
    for name in ["a.glb", "a.obj", "a.gltf"] {
        let out = path(name);
        let mut arguments = arguments.clone();
        arguments.extend(["-o", &out]);
        let run = anthronet(&arguments, &[]).succeeds();
        assert!(run.err.contains("female") && run.err.contains("1.700 m"), "{}", run.err);
        let report: Value = serde_json::from_str(&run.out).unwrap();
        assert_eq!(report["measures"].as_array().unwrap().len(), MEASURE_COUNT);

        let measured = anthronet(&["measure", &out, "--json"], &[]).succeeds();
        let measured: Value = serde_json::from_str(&measured.out).unwrap();
        let value = |wanted: &str| {
            let all = measured["measures"].as_array().unwrap();
            all.iter().find(|m| m["name"] == wanted).and_then(|m| m["value"].as_f64()).unwrap()
        };
        // The bar of the project: what was asked for stands in the file to a tenth of a millimetre.
        for (name, _, metres) in asked {
            let names =
                if name == "arm_length" { vec!["arm_length_left", "arm_length_right"] } else { vec![name] };
            for name in names {
                assert!((value(name) - metres).abs() < 1e-4, "{name}: {} for {metres}", value(name));
            }
        }
        let mass = measured["mass_kg"].as_f64().unwrap();
        assert!((35.0..110.0).contains(&mass), "{mass}");
    }
    assert_eq!(files_in(folder.path()), ["a.bin", "a.glb", "a.gltf", "a.obj"]);
}

#[test]
fn the_same_request_gives_the_same_bytes() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let make = |name: &str, seed: &str| {
        let out = path(name);
        anthronet(
            &["generate", "--sex", "male", "--fill", "sample", "--seed", seed, "--lod", "2", "-o", &out],
            &[],
        )
        .succeeds();
        fs::read(out).unwrap()
    };
    let first = make("a.glb", "7");
    assert_eq!(first, make("b.glb", "7"));
    assert_ne!(first, make("c.glb", "8"));
}

#[test]
fn interpolation_meets_its_ends() {
    let folder = folder();
    let short = write(&folder, "short.json", br#"{"sex": "female", "measures": {"height": 1.60}}"#);
    let tall = write(&folder, "tall.json", br#"{"sex": "female", "measures": {"height": 1.80}}"#);
    let out = folder.path().join("between.glb").to_string_lossy().into_owned();
    for (at, height) in [("0", "1.600 m"), ("0.5", "1.700 m"), ("1", "1.800 m")] {
        let run = anthronet(
            &["generate", "--request", &short, "--interpolate", &tall, "--at", at, "--lod", "2", "-o", &out],
            &[],
        )
        .succeeds();
        assert!(run.err.contains(height), "{at}: {}", run.err);
    }
}

#[test]
fn info_is_what_programs_expect() {
    let info: Value = serde_json::from_str(&anthronet(&["info", "--json"], &[]).succeeds().out).unwrap();
    let measures = info["measures"].as_array().unwrap();
    assert_eq!(measures.len(), MEASURE_COUNT);
    for measure in measures {
        assert!(["tape", "slice", "length", "extent"].contains(&measure["kind"].as_str().unwrap()));
        let points = measure["points"].as_array().unwrap();
        assert!(!points.is_empty());
        for point in points {
            let sum: f64 = point.as_array().unwrap().iter().map(|p| p[1].as_f64().unwrap()).sum();
            assert!((sum - 1.0).abs() < 1e-9, "{}", measure["name"]);
        }
        assert!(measure["min"].as_f64().unwrap() < measure["max"].as_f64().unwrap());
    }
    let joints = info["joints"].as_array().unwrap();
    assert!(joints[0]["parent"].is_null() && joints.len() > 50);
    assert!(anthronet(&["info"], &[]).succeeds().out.contains("waist_circumference"));
}

#[test]
fn a_preview_is_a_picture_of_the_asked_size() {
    let folder = folder();
    let request = write(&folder, "r.json", br#"{"sex": "male"}"#);
    let out = folder.path().join("p.png");
    anthronet(&["preview", &request, "-o", &out.to_string_lossy(), "--size", "160x72"], &[]).succeeds();
    let reader =
        png::Decoder::new(std::io::BufReader::new(fs::File::open(&out).unwrap())).read_info().unwrap();
    assert_eq!((reader.info().width, reader.info().height), (160, 72));
}
