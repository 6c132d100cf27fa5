//! Files appear on the disk whole or not at all.
//!
//! Bytes go to a temporary file in the folder of the target, which is then renamed over it. If anything fails before
//! that, what was there stays as it was and nothing is left behind.

use std::{
    ffi::OsStr,
    fs, io,
    io::Write,
    path::{Path, PathBuf},
};

use tempfile::{Builder, NamedTempFile};

use super::gltf::{self, GltfOptions};
use super::vrm::VrmMeta;
use super::{obj, usd, vrm};
use crate::scene::Scene;
use crate::{Error, Result};

/// The endings that [`write_scene`] knows.
pub const ENDINGS: [&str; 7] = [".glb", ".gltf", ".vrm", ".usda", ".usdc", ".usdz", ".obj"];

/// How the formats that leave a choice are written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WriteOptions {
    /// Of `.glb` and `.gltf`.
    pub gltf: GltfOptions,
    /// Of `.vrm`.
    pub vrm: VrmMeta,
}

/// Writes the scene in the format of the path's ending, in any case: one of [`ENDINGS`]. A `.gltf` gets its buffer as
/// a second file, `.bin` for `.gltf`.
///
/// # Errors
/// [`Error::File`] for another ending, [`Error::Invalid`] for a scene that does not validate, [`Error::Io`] when the
/// system refuses; the target is then as it was.
pub fn write_scene(scene: &Scene, path: impl AsRef<Path>) -> Result<()> {
    write_scene_with(scene, path, &WriteOptions::default())
}

/// [`write_scene`] with a choice of how.
///
/// # Errors
/// As [`write_scene`].
pub fn write_scene_with(scene: &Scene, path: impl AsRef<Path>, options: &WriteOptions) -> Result<()> {
    let path = path.as_ref();
    let ending = path.extension().and_then(OsStr::to_str).unwrap_or_default().to_ascii_lowercase();
    if ending != "gltf" {
        let Some(bytes) = in_one_file(scene, &ending, options) else {
            return Err(Error::file(path, format!("unknown ending, expected one of {}", ENDINGS.join(" "))));
        };
        return write_atomic(path, &bytes?);
    }
    let bin_path = path.with_extension("bin");
    let Some(bin_name) = bin_path.file_name().and_then(OsStr::to_str) else {
        return Err(Error::file(path, "the name of a .gltf must be valid Unicode"));
    };
    let files = gltf::to_gltf_with(scene, bin_name, &options.gltf)?;
    let bin = Pending::new(&bin_path, |file| file.write_all(&files.bin))?;
    let json = Pending::new(path, |file| file.write_all(&files.json))?;
    commit_pair(bin, json)
}

/// Gives a document and its buffer their names, when both are on the disk. The document comes last, as it is what is
/// opened; if it cannot have its name, the buffer that was there before is put back.
///
/// No file system renames two files at once: a program that is killed between the two renames leaves the new buffer
/// beside the old document.
fn commit_pair(bin: Pending, json: Pending) -> Result<()> {
    let bin_target = bin.target.clone();
    let before = bin_target.exists().then(|| keep(&bin)).transpose()?;
    bin.commit()?;
    json.commit().inspect_err(|_| {
        // The failure itself is what the caller must hear of.
        let _ = match before {
            Some(before) => before.persist(&bin_target).map_err(|e| e.error),
            None => fs::remove_file(&bin_target),
        };
    })
}

/// A second name for the file that is about to be replaced, removed when dropped; a copy where the file system has no
/// second names.
fn keep(pending: &Pending) -> Result<NamedTempFile<()>> {
    let target = &pending.target;
    let kept = temporary().make_in(folder_of(target), |place| {
        fs::hard_link(target, place).or_else(|_| fs::copy(target, place).map(drop))
    });
    kept.map_err(|source| fault(&pending.path, "create", source))
}

/// The scene as the bytes of one file, in the format of an ending without its dot, in any case: `glb`, `vrm`, `usda`,
/// `usdc`, `usdz` or `obj`.
///
/// # Errors
/// [`Error::Request`] for another format, [`Error::Invalid`] for a scene that does not validate.
pub fn scene_to_bytes(scene: &Scene, format: &str, options: &WriteOptions) -> Result<Vec<u8>> {
    in_one_file(scene, &format.to_ascii_lowercase(), options).unwrap_or_else(|| {
        let expected = "expected one of glb vrm usda usdc usdz obj, which are one file each";
        Err(Error::request("format", format!("{expected}, got `{format}`")))
    })
}

/// `None` for a format that is none, or that is more than one file.
fn in_one_file(scene: &Scene, format: &str, options: &WriteOptions) -> Option<Result<Vec<u8>>> {
    Some(match format {
        "glb" => gltf::to_glb_with(scene, &options.gltf),
        "vrm" => vrm::to_vrm(scene, &options.vrm),
        "obj" => obj::to_obj(scene),
        "usda" => usd::to_usda(scene),
        "usdc" => usd::to_usdc(scene),
        "usdz" => usd::to_usdz(scene),
        _ => return None,
    })
}

/// Writes a file whole or not at all; an existing regular file is replaced, through a symbolic link too.
///
/// # Errors
/// [`Error::Io`] names the path: the folder is missing or read-only, the target is a folder or a device, the disk is full.
pub fn write_atomic(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    Pending::new(path.as_ref(), |file| file.write_all(bytes))?.commit()
}

/// A file that is written completely but has not got its name yet. Dropping it removes it.
struct Pending {
    file: NamedTempFile,
    target: PathBuf,
    /// The path as the caller wrote it, for messages.
    path: PathBuf,
}

impl Pending {
    fn new(path: &Path, write: impl FnOnce(&mut fs::File) -> io::Result<()>) -> Result<Self> {
        let create = || {
            let target = target_of(path)?;
            let mut builder = temporary();
            // The default is private to the user; the finished file shall be like any other that the user makes.
            #[cfg(unix)]
            builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
            // Only the kind: the message would name the temporary file.
            let file = builder.tempfile_in(folder_of(&target)).map_err(|e| io::Error::from(e.kind()))?;
            Ok((file, target))
        };
        let (mut file, target) = create().map_err(|source| fault(path, "create", source))?;
        // A full disk may only be reported when the data is really written.
        let written = write(file.as_file_mut()).and_then(|()| file.as_file().sync_all());
        written.map_err(|source| fault(path, "write", source))?;
        Ok(Self { file, target, path: path.into() })
    }

    fn commit(self) -> Result<()> {
        let path = self.path;
        self.file.persist(&self.target).map(drop).map_err(|e| fault(&path, "write", e.error))
    }
}

fn temporary() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(".anthronet-").suffix(".part");
    builder
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| *parent != Path::new("")).unwrap_or(Path::new("."))
}

/// The regular file that a path names or will name. Renaming over a folder fails late and over a device destroys it.
fn target_of(path: &Path) -> io::Result<PathBuf> {
    if path.file_name().is_none() {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "is a folder, expected a file name"));
    }
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => {
            Err(io::Error::new(io::ErrorKind::IsADirectory, "is a folder, expected a file name"))
        }
        Ok(found) if !found.is_file() => {
            Err(io::Error::new(io::ErrorKind::InvalidInput, "is not a regular file"))
        }
        Ok(_) => fs::canonicalize(path),
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(path.into()),
        Err(e) => Err(e),
    }
}

fn fault(path: &Path, action: &'static str, source: io::Error) -> Error {
    Error::Io { path: path.into(), action, source }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::scene::arm;

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
        assert!(
            message.starts_with(&*path.to_string_lossy()) && message.contains("cannot write"),
            "{message}"
        );
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["a.glb"]);
    }

    #[test]
    fn refuses_missing_folders_folders_and_endings_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let scene = arm(4);
        fs::create_dir(folder.path().join("dir.glb")).unwrap();
        for (name, expected) in [
            ("missing/a.glb", "cannot create: entity not found"),
            ("dir.glb", "is a folder"),
            ("a.stl", "expected one of .glb .gltf .vrm .usda .usdc .usdz .obj"),
            ("a", "expected one of .glb .gltf .vrm .usda .usdc .usdz .obj"),
            ("glb", "expected one of .glb .gltf .vrm .usda .usdc .usdz .obj"),
        ] {
            let message = write_scene(&scene, folder.path().join(name)).unwrap_err().to_string();
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
            write_scene(&scene, folder.path().join(name)).unwrap_err();
        }
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn a_gltf_comes_with_its_buffer_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let scene = arm(4);
        write_scene(&scene, folder.path().join("my ärm.GLTF")).unwrap();
        assert_eq!(names(folder.path()), ["my ärm.GLTF", "my ärm.bin"]);
        let json = fs::read_to_string(folder.path().join("my ärm.GLTF")).unwrap();
        assert!(json.contains("\"uri\": \"my%20%C3%A4rm.bin\""));

        fs::create_dir(folder.path().join("b.bin")).unwrap();
        write_scene(&scene, folder.path().join("b.gltf")).unwrap_err();
        fs::create_dir(folder.path().join("c.gltf")).unwrap();
        write_scene(&scene, folder.path().join("c.gltf")).unwrap_err();
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
            // What nothing can be renamed over comes into the way at the worst moment.
            fs::create_dir(path("a.gltf")).unwrap();
            let message = commit_pair(bin, json).unwrap_err().to_string();
            assert!(message.contains("a.gltf: cannot write"), "{message}");
            if had_buffer {
                assert_eq!(fs::read(path("a.bin")).unwrap(), b"old");
            }
            assert_eq!(
                names(folder.path()),
                if had_buffer { vec!["a.bin", "a.gltf"] } else { vec!["a.gltf"] }
            );

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
            // A file system that takes no files, whoever asks.
            refused.push("/proc".into());
        }
        // Root may write in any other folder; the command's tests drop root's rights for this one.
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
}
