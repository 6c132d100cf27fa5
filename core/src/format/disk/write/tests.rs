use super::*;
use crate::format::{WriteOptions, write_scene};
use crate::scene::Scene;
use crate::testing::scene::arm;

fn write(scene: &Scene, path: impl AsRef<Path>) -> Result<()> {
    write_scene(scene, path, &WriteOptions::default())
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn writes_replaces_and_leaves_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.json");
    write_atomic(&path, b"one").unwrap();
    write_atomic(&path, b"two").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"two");
    assert_eq!(names(folder.path()), ["a.json"]);
}

#[test]
fn a_failing_write_keeps_the_old_file_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    write_atomic(&path, b"old").unwrap();
    let full = |file: &mut fs::File| {
        file.write_all(b"half of the n")?;
        Err(io::ErrorKind::StorageFull.into())
    };
    let Err(error) = Pending::new(&path, full) else { panic!("expected an error") };
    let message = error.to_string();
    assert!(message.starts_with(&*path.to_string_lossy()) && message.contains("cannot write"), "{message}");
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(folder.path()), ["a.glb"]);
}

#[test]
fn refuses_missing_folders_folders_and_extensions_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let scene = arm(4);
    fs::create_dir(folder.path().join("dir.glb")).unwrap();
    for (name, expected) in [
        ("missing/a.glb", "cannot create: entity not found"),
        ("dir.glb", "is a folder"),
        ("a.stl", "expected one of .glb .gltf .vrm .vrma .usda .usdc .usdz .obj"),
        ("a", "expected one of .glb .gltf .vrm .vrma .usda .usdc .usdz .obj"),
        ("glb", "expected one of .glb .gltf .vrm .vrma .usda .usdc .usdz .obj"),
    ] {
        let message = write(&scene, folder.path().join(name)).unwrap_err().to_string();
        assert!(message.contains(name) && message.contains(expected), "{message}");
        assert!(!message.contains(".part"), "{message}");
    }
    assert_eq!(names(folder.path()), ["dir.glb"]);
}

#[test]
fn an_invalid_scene_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = arm(4);
    scene.meshes[0].positions[0][0] = f32::NAN;
    for name in ["a.glb", "a.gltf", "a.obj", "a.usda", "a.usdc", "a.usdz"] {
        write(&scene, folder.path().join(name)).unwrap_err();
    }
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_gltf_comes_with_its_buffer_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let scene = arm(4);
    write(&scene, folder.path().join("my ärm.GLTF")).unwrap();
    assert_eq!(names(folder.path()), ["my ärm.GLTF", "my ärm.bin"]);
    let json = fs::read_to_string(folder.path().join("my ärm.GLTF")).unwrap();
    assert!(json.contains("\"uri\": \"my%20%C3%A4rm.bin\""));

    fs::create_dir(folder.path().join("b.bin")).unwrap();
    write(&scene, folder.path().join("b.gltf")).unwrap_err();
    fs::create_dir(folder.path().join("c.gltf")).unwrap();
    write(&scene, folder.path().join("c.gltf")).unwrap_err();
    assert_eq!(names(folder.path()), ["b.bin", "c.gltf", "my ärm.GLTF", "my ärm.bin"]);
}

#[test]
fn an_old_buffer_comes_back_when_its_document_cannot_be_replaced() {
    for had_buffer in [true, false] {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        if had_buffer {
            fs::write(path("a.bin"), b"old").unwrap();
        }
        let pending = |name: &str| Pending::new(&path(name), |file| file.write_all(b"new")).unwrap();
        let (bin, json) = (pending("a.bin"), pending("a.gltf"));
        // A folder with the target's name makes the last rename fail.
        fs::create_dir(path("a.gltf")).unwrap();
        let message = commit_pair(bin, json).unwrap_err().to_string();
        assert!(message.contains("a.gltf: cannot write"), "{message}");
        if had_buffer {
            assert_eq!(fs::read(path("a.bin")).unwrap(), b"old");
        }
        assert_eq!(names(folder.path()), if had_buffer { vec!["a.bin", "a.gltf"] } else { vec!["a.gltf"] });

        fs::remove_dir(path("a.gltf")).unwrap();
        commit_pair(pending("a.bin"), pending("a.gltf")).unwrap();
        assert_eq!(fs::read(path("a.bin")).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["a.bin", "a.gltf"]);
    }
}

#[cfg(unix)]
#[test]
fn follows_links_refuses_devices_and_has_ordinary_permissions() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let (real, link) = (folder.path().join("real"), folder.path().join("link"));
    fs::write(&real, b"old").unwrap();
    symlink(&real, &link).unwrap();
    write_atomic(&link, b"new").unwrap();
    assert_eq!(fs::read(&real).unwrap(), b"new");
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());

    let device = folder.path().join("null");
    symlink("/dev/null", &device).unwrap();
    let message = write_atomic(&device, b"new").unwrap_err().to_string();
    assert!(message.contains("not a regular file"), "{message}");

    let plain = folder.path().join("plain");
    fs::write(&plain, b"").unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&real), mode(&plain));
}

#[cfg(unix)]
#[test]
fn a_folder_that_takes_no_files_is_named() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), b"a file, not a folder").unwrap();
    let read_only = folder.path().join("read-only");
    fs::create_dir(&read_only).unwrap();
    fs::set_permissions(&read_only, PermissionsExt::from_mode(0o555)).unwrap();

    let mut refused = vec![folder.path().join("file"), folder.path().join("missing")];
    if cfg!(target_os = "linux") {
        // A file system where nobody can create files.
        refused.push("/proc".into());
    }
    // Root may write to any other folder; the command's tests drop root's rights for this case.
    if fs::metadata(&read_only).unwrap().uid() != 0 {
        refused.push(read_only.clone());
    }
    for place in refused {
        let path = place.join("a.glb");
        let message = write_atomic(&path, b"bytes").unwrap_err().to_string();
        assert!(message.starts_with(&format!("{}: cannot create", path.display())), "{message}");
    }
    assert_eq!(names(folder.path()), ["file", "read-only"]);
    assert!(names(&read_only).is_empty());
}
