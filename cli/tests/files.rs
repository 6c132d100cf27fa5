//! Files that cannot be read or written end with exit code 1 and a message that names them, never with half a file.

mod common;

use std::fs;

use common::{Run, anthronet, files_in, folder, write};

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
