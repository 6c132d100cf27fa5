//! Bad input gives the right exit code and a message that names the field, never a panic, never half a file.

mod common;

use std::fs;

use anthronet::measure::MEASURE_COUNT;
use common::{Run, anthronet, files_in, folder, write};

/// Runs `generate` with these options into a fresh folder, which must stay empty.
fn generate(options: &[&str]) -> Run {
    let folder = folder();
    let out = folder.path().join("out.glb");
    let mut all = vec!["generate"];
    all.extend_from_slice(options);
    let out = out.to_string_lossy().into_owned();
    all.extend(["-o", &out]);
    let run = anthronet(&all, &[]);
    assert_eq!(files_in(folder.path()), Vec::<String>::new(), "{options:?} left files behind");
    run
}

#[test]
fn values_that_are_no_length_are_bad_usage() {
    for value in ["NaN", "inf", "-inf", "-1.7", "0", "", "tall", "1,70", "1.7.0", "5ft13in", "1e999", "170kg"]
    {
        generate(&["-m", &format!("height={value}")]).fails(2, &["height"]);
    }
    generate(&["-m", "height"]).fails(2, &["NAME=VALUE"]);
    generate(&["-m", "=1.7"]).fails(2, &["name"]);
    generate(&["-m", "height=1.7", "-m", "height=1.8"]).fails(2, &["height", "twice"]);
}

#[test]
fn an_unknown_name_gets_a_suggestion() {
    generate(&["-m", "heigth=1.7"]).fails(2, &["heigth", "did you mean", "height"]);
    generate(&["-m", "waist=0.8"]).fails(2, &["waist", "waist_circumference"]);
    generate(&["-m", "stature=1.7"]).fails(2, &["stature", "height"]);
    generate(&["-m", "weight=70"]).fails(2, &["weight", "cannot be set"]);
}

#[test]
fn options_that_do_not_exist_are_bad_usage() {
    generate(&["--sex", "other"]).fails(2, &["--sex", "female", "male"]);
    generate(&["--lod", "4"]).fails(2, &["--lod"]);
    generate(&["--influences", "5"]).fails(2, &["--influences", "4", "8"]);
    generate(&["--joint-names", "maya"]).fails(2, &["--joint-names", "native", "mixamo"]);
    generate(&["--skin-tone", "11"]).fails(2, &["--skin-tone", "11"]);
    generate(&["--skin-tone", "#12345"]).fails(2, &["--skin-tone"]);
    generate(&["--seed", "-1"]).fails(2, &["--seed"]);
    generate(&["--z", "1,two"]).fails(2, &["--z", "two"]);
    generate(&["--fill", "zero"]).fails(2, &["--fill", "mean", "sample"]);
    generate(&["--at", "0.5"]).fails(2, &["--interpolate"]);
    generate(&["--interpolate", "other.json"]).fails(2, &["--at"]);
    generate(&["--interpolate", "other.json", "--at", "1.5"]).fails(2, &["--at", "0 to 1"]);
    generate(&["--no-such-option"]).fails(2, &["--no-such-option"]);
}

#[test]
fn the_output_is_required_and_its_ending_known() {
    anthronet(&["generate", "-m", "height=1.7"], &[]).fails(2, &["--output"]);
    anthronet(&["preview", "a.glb"], &[]).fails(2, &["--output"]);
    anthronet(&["contact-sheet"], &[]).fails(2, &["--output"]);
    let folder = folder();
    for name in ["a.stl", "a", "a.glb.txt", "glb"] {
        let path = folder.path().join(name);
        let path = path.to_string_lossy();
        anthronet(&["generate", "-o", &path], &[])
            .fails(2, &[name, ".glb .gltf .vrm .usda .usdc .usdz .obj"]);
        anthronet(&["contact-sheet", "-o", &path], &[]).fails(2, &[name, ".png"]);
    }
    assert!(files_in(folder.path()).is_empty());
    anthronet(&["measure", "a.fbx"], &[]).fails(2, &["a.fbx", ".glb .gltf .vrm .usda .usdc .usdz .obj"]);
    anthronet(&["preview", "a.fbx", "-o", "a.png"], &[]).fails(2, &["a.fbx", ".json"]);
    anthronet(&["preview", "a.glb", "-o", "a.png", "--size", "0x4"], &[]).fails(2, &["--size", "0x4"]);
    anthronet(&["preview", "a.glb", "-o", "a.png", "--views", "below"], &[]).fails(2, &["--views", "front"]);
    anthronet(&["contact-sheet", "-o", "a.png", "--count", "0"], &[]).fails(2, &["--count"]);
    anthronet(&[], &[]).fails(2, &["Usage"]);
    anthronet(&["no-such-command"], &[]).fails(2, &["no-such-command"]);
}

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
fn a_millimetre_value_without_its_unit_gets_a_hint() {
    generate(&["-m", "height=1700"]).fails(2, &["height", "did you mean 1.7"]);
    generate(&["-m", "height=170"]).fails(2, &["height", "did you mean 1.7"]);
    generate(&["-m", "height=0.3"]).fails(2, &["height"]);
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

#[test]
fn a_damaged_model_file_is_named() {
    let folder = folder();
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/../model/anthronet.safetensors");
    let mut cases = vec![
        ("empty.safetensors", Vec::new()),
        ("noise.safetensors", (0..5000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect()),
        ("huge_header.safetensors", b"\xff\xff\xff\xff\xff\xff\xff\x7f{}".to_vec()),
        ("no_tensors.safetensors", b"\x02\0\0\0\0\0\0\0{}".to_vec()),
    ];
    let good = fs::read(source).unwrap();
    cases.push(("truncated.safetensors", good[..good.len() / 2].to_vec()));
    cases.push(("short.safetensors", good[..good.len() - 1].to_vec()));
    for (name, at) in [("header.safetensors", 40), ("flipped.safetensors", good.len() / 2)] {
        let mut flipped = good.clone();
        flipped[at] ^= 0x55;
        cases.push((name, flipped));
    }
    for (name, bytes) in cases {
        let model = write(&folder, name, &bytes);
        let out = folder.path().join("out.glb");
        let run = anthronet(&["generate", "-o", &out.to_string_lossy()], &[("ANTHRONET_MODEL", &model)]);
        run.fails(1, &[name, if name.starts_with("flipped") { "the file is damaged" } else { "" }]);
        assert!(!out.exists(), "{name}");
    }
    let out = folder.path().join("out.glb");
    let missing = [("ANTHRONET_MODEL", "/no/such/model.safetensors")];
    anthronet(&["generate", "-o", &out.to_string_lossy()], &missing)
        .fails(1, &["/no/such/model.safetensors"]);
    anthronet(&["info"], &missing).fails(1, &["/no/such/model.safetensors"]);
}

#[test]
fn a_place_that_cannot_be_written_is_named_and_left_alone() {
    let folder = folder();
    let file = write(&folder, "file", b"a file, not a folder");
    let inside = format!("{file}/out.glb");
    anthronet(&["generate", "-o", &inside], &[]).fails(1, &["out.glb"]);
    anthronet(&["generate", "-o", &format!("{}/no/such/out.glb", folder.path().display())], &[])
        .fails(1, &["out.glb", "cannot create"]);
    fs::create_dir(folder.path().join("dir.glb")).unwrap();
    anthronet(&["generate", "-o", &folder.path().join("dir.glb").to_string_lossy()], &[])
        .fails(1, &["dir.glb"]);
    if cfg!(target_os = "linux") {
        // A file system that takes no files, whoever asks.
        anthronet(&["generate", "-o", "/proc/out.glb"], &[]).fails(1, &["/proc/out.glb", "cannot create"]);
    }
    assert_eq!(files_in(folder.path()), ["dir.glb", "file"]);
    assert_eq!(fs::read(&file).unwrap(), b"a file, not a folder");
}

#[cfg(unix)]
#[test]
fn a_read_only_folder_is_named_and_left_alone() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    use std::os::unix::process::CommandExt;
    use std::path::Path;
    use std::process::Command;
    /// The user that owns nothing.
    const NOBODY: u32 = 65_534;
    let folder = folder();
    let read_only = folder.path().join("read-only");
    fs::create_dir(&read_only).unwrap();
    let mode = |path: &Path, mode| fs::set_permissions(path, PermissionsExt::from_mode(mode)).unwrap();
    mode(&read_only, 0o555);
    let mut command = if fs::metadata(&read_only).unwrap().uid() == 0 {
        // Root may write anywhere, so somebody else tries, who may be unable to reach the command in its own place.
        let copy = folder.path().join("anthronet");
        // By a process of its own: a file that this one has open for writing cannot be run while other tests fork.
        let copied = Command::new("cp").arg(env!("CARGO_BIN_EXE_anthronet")).arg(&copy).status().unwrap();
        assert!(copied.success());
        mode(folder.path(), 0o755);
        let mut command = Command::new(copy);
        command.uid(NOBODY).gid(NOBODY).current_dir(folder.path());
        command
    } else {
        Command::new(env!("CARGO_BIN_EXE_anthronet"))
    };
    let out = read_only.join("out.glb");
    command.env_remove("ANTHRONET_MODEL").args(["generate", "-o"]).arg(&out);
    common::run(&mut command).fails(1, &["out.glb: cannot create", "denied"]);
    assert!(files_in(&read_only).is_empty());
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_is_named_and_stays_a_device() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let folder = folder();
    let out = folder.path().join("null.glb");
    symlink("/dev/null", &out).unwrap();
    anthronet(&["generate", "-o", &out.to_string_lossy()], &[]).fails(1, &["null.glb", "not a regular file"]);
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    assert_eq!(files_in(folder.path()), ["null.glb"]);
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_that_is_full_is_named() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_anthronet"));
    let status = command.arg("info").stdout(full).output().unwrap();
    assert_eq!(status.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&status.stderr).starts_with("error: standard output"));
}

/// A disk that takes 4 KiB of a file and no more, as far as the command can tell: the system's limit on the size of
/// files, which fails writes half-way as a full disk does.
#[cfg(unix)]
fn on_a_full_disk(arguments: &[&str]) -> Run {
    let script = "trap '' XFSZ && ulimit -f 8 && exec \"$0\" \"$@\"";
    let mut command = std::process::Command::new("sh");
    command.args(["-c", script, env!("CARGO_BIN_EXE_anthronet")]).args(arguments);
    common::run(command.env_remove("ANTHRONET_MODEL"))
}

#[cfg(unix)]
#[test]
fn a_full_disk_is_named_and_nothing_half_written_stays() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let request = write(&folder, "r.json", br#"{"sex": "male"}"#);
    let refused = ["-m", "height=1.95", "-m", "thigh_length=0.30", "-m", "calf_length=0.30"];
    let report = path("report.json");
    let mut there = vec!["r.json"];
    for (name, command) in [
        ("a.glb", vec!["generate", "--lod", "3"]),
        ("a.vrm", vec!["generate", "--lod", "3"]),
        ("a.obj", vec!["generate", "--lod", "3"]),
        ("a.usdc", vec!["generate", "--lod", "3"]),
        ("a.usdz", vec!["generate", "--lod", "3"]),
        // The buffer is what fills the disk.
        ("a.gltf", vec!["generate", "--lod", "3"]),
        ("a.png", vec!["preview", &request, "--size", "160x72"]),
        ("sheet.png", vec!["contact-sheet", "--count", "1"]),
        ("b.glb", [&["generate", "--sex", "female", "--report", &report][..], &refused].concat()),
    ] {
        let out = path(name);
        let command = [&command[..], &["-o", &out]].concat();
        let named = match name {
            "a.gltf" => "a.bin: cannot write",
            "b.glb" => "report.json: cannot write",
            _ => &format!("{name}: cannot write"),
        };
        on_a_full_disk(&command).fails(1, &[named, "too large"]);
        assert_eq!(files_in(folder.path()), there, "{name}");
        // Nor is what was there before touched.
        if name == "a.glb" {
            fs::write(&out, b"old").unwrap();
            on_a_full_disk(&command).fails(1, &[named]);
            assert_eq!(fs::read(&out).unwrap(), b"old");
            there.insert(0, "a.glb");
        }
    }
}

#[test]
fn files_that_are_no_characters_are_refused_by_name() {
    let folder = folder();
    for (name, bytes) in [
        ("empty.glb", &b""[..]),
        ("short.glb", b"glTF\x02\0\0\0\xff\xff\xff\x7f"),
        ("noise.obj", b"v 1 2\nf 1 2 3\n"),
        ("nan.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("index.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
        ("triangle.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("text.gltf", b"{}"),
    ] {
        let file = write(&folder, name, bytes);
        anthronet(&["measure", &file], &[]).fails(1, &[name]);
        if name != "triangle.obj" {
            let out = folder.path().join("out.png");
            anthronet(&["preview", &file, "-o", &out.to_string_lossy()], &[]).fails(1, &[name]);
            assert!(!out.exists(), "{name}");
        }
    }
    anthronet(&["measure", "/no/such/file.glb"], &[]).fails(1, &["/no/such/file.glb"]);
}
