//! The files of one call: nothing is written over an input or over another output, whatever its name.

use std::path::{Component, Path, PathBuf};
use std::{env, fs};

use anthronet::format::{Format, files_beside};

use crate::failure::{Failure, Result};

/// Symbolic links that are followed to find a file that does not exist yet.
const MAX_LINKS: usize = 40;

/// The files that a call reads and writes, collected before it writes anything.
#[derive(Default)]
pub(crate) struct FileSet {
    inputs: Vec<Entry>,
    outputs: Vec<Entry>,
}

/// A file of a call.
struct Entry {
    /// The option that names it, or names the file that it belongs to; empty for an argument.
    option: &'static str,
    path: PathBuf,
    /// Whether it is the character that is read, changed and written in place, or belongs to it.
    in_place: bool,
}

impl FileSet {
    /// Adds the model file that the environment names.
    pub(crate) fn model(mut self) -> Self {
        let path = env::var_os("ANTHRONET_MODEL").filter(|path| !path.is_empty());
        self.inputs.extend(path.map(|path| Entry {
            option: "ANTHRONET_MODEL",
            path: path.into(),
            in_place: false,
        }));
        self
    }

    /// Adds an input and the files that it refers to.
    pub(crate) fn reads(self, option: &'static str, path: Option<&Path>) -> Self {
        self.add_input(option, path, false)
    }

    fn add_input(mut self, option: &'static str, path: Option<&Path>, in_place: bool) -> Self {
        let files = path.into_iter().flat_map(|path| [vec![path.to_owned()], files_beside(path)].concat());
        self.inputs.extend(files.map(|path| Entry { option, path, in_place }));
        self
    }

    /// Adds an output, but not standard output, `-`.
    pub(crate) fn writes(mut self, option: &'static str, path: Option<&Path>) -> Self {
        let path = path.filter(|path| *path != Path::new("-"));
        self.outputs.extend(path.map(|path| Entry { option, path: path.to_owned(), in_place: false }));
        self
    }

    /// Adds the file of a scene, with the buffer that a `.gltf` has beside it.
    pub(crate) fn writes_scene(mut self, option: &'static str, path: &Path) -> Self {
        let buffer = Format::of_extension(&crate::files::extension(path)) == Some(Format::Gltf);
        let files = [Some(path.to_owned()), buffer.then(|| path.with_extension("bin"))];
        self.outputs.extend(files.into_iter().flatten().map(|path| Entry { option, path, in_place: true }));
        self
    }

    /// Adds a character that is read and written. The same path for both is no mistake: it is changed in place.
    pub(crate) fn converts(self, input: &Path, option: &'static str, output: &Path) -> Self {
        self.add_input("", Some(input), input == output).writes_scene(option, output)
    }

    /// Refuses outputs that are one file, and an output that is an input.
    pub(crate) fn check(&self) -> Result<()> {
        for (i, output) in self.outputs.iter().enumerate() {
            let written = self.outputs[..i].iter().map(|other| (other, "writes"));
            let read = self.inputs.iter().filter(|input| !(input.in_place && output.in_place));
            let mut others = written.chain(read.map(|other| (other, "reads")));
            if let Some((other, verb)) = others.find(|(other, _)| same_file(&output.path, &other.path)) {
                let of = if other.option.is_empty() { "the command" } else { other.option };
                let named = format!("{} {}", output.option, output.path.display());
                let message = format!(
                    "{}: is the same file as {}, which {of} {verb}; expected a file of its own",
                    named.trim_start(),
                    other.path.display()
                );
                return Err(Failure::usage(message));
            }
        }
        Ok(())
    }
}

/// Whether two paths name one file, or will when it is written.
fn same_file(a: &Path, b: &Path) -> bool {
    if a == b || identity(a).is_some_and(|a| Some(a) == identity(b)) {
        return true;
    }
    let (a, b) = (canonical(a, MAX_LINKS), canonical(b, MAX_LINKS));
    let lower = |path: &Path| path.file_name().map(|name| name.to_string_lossy().to_lowercase());
    a == b || a.parent() == b.parent() && lower(&a) == lower(&b) && a.parent().is_some_and(ignores_case)
}

/// What hard links of one file have in common; `None` for a file that does not exist.
#[cfg(unix)]
fn identity(path: &Path) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    fs::metadata(path).ok().map(|found| (found.dev(), found.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path) -> Option<PathBuf> {
    fs::canonicalize(path).ok()
}

/// The absolute path without symbolic links and `..`, also of a file, or in a folder, that does not exist yet.
fn canonical(path: &Path, links: usize) -> PathBuf {
    if let Ok(found) = fs::canonicalize(path) {
        return found;
    }
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    if let Some(target) = fs::read_link(path).ok().filter(|_| links > 0) {
        return canonical(&folder.join(target), links - 1);
    }
    match path.components().next_back() {
        Some(Component::Normal(name)) => canonical(folder, links).join(name),
        Some(Component::ParentDir) => {
            let below = canonical(folder, links);
            below.parent().map_or(below.clone(), Path::to_owned)
        }
        _ => path.to_owned(),
    }
}

/// Whether names in a folder that differ in the case of letters name one file. Only the file system knows: a file is made
/// for a moment and looked for under the other case.
fn ignores_case(folder: &Path) -> bool {
    let probe = tempfile::Builder::new().prefix(".anthronet-case-").tempfile_in(folder);
    probe.is_ok_and(|probe| {
        let name = probe.path().file_name().map(|name| name.to_string_lossy().to_uppercase());
        name.is_some_and(|name| folder.join(name).exists())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_file_under_two_names() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("d")).unwrap();
        fs::write(at("old"), "").unwrap();
        fs::write(at("other"), "").unwrap();
        for (a, b, same) in [
            ("a", "./a", true),
            ("a", "d/../a", true),
            ("a", "missing/../a", true),
            ("missing/a", "missing/./a", true),
            ("old", "d/../old", true),
            ("a", "b", false),
            ("a", "d/a", false),
            ("old", "other", false),
            ("old", "a", false),
        ] {
            assert_eq!(same_file(&at(a), &at(b)), same, "{a} {b}");
        }
        assert_eq!(same_file(&at("a"), &at("A")), ignores_case(folder.path()));
        assert!(same_file(Path::new("no-such"), &env::current_dir().unwrap().join("no-such")));
        #[cfg(unix)]
        {
            use std::os::unix::fs::symlink;
            symlink("old", at("soft")).unwrap();
            symlink("a", at("dangling")).unwrap();
            symlink("loop", at("loop")).unwrap();
            symlink("d", at("e")).unwrap();
            fs::hard_link(at("old"), at("hard")).unwrap();
            assert!(same_file(&at("soft"), &at("old")) && same_file(&at("old"), &at("hard")));
            assert!(same_file(&at("dangling"), &at("a")) && same_file(&at("d/x"), &at("e/x")));
            assert!(!same_file(&at("loop"), &at("old")) && !same_file(&at("dangling"), &at("b")));
        }
    }

    #[test]
    fn only_the_character_itself_is_changed_in_place() {
        let [a, b, report] = ["a.glb", "b.glb", "r.json"].map(Path::new);
        assert!(FileSet::default().converts(a, "-o", a).check().is_ok());
        assert!(FileSet::default().converts(Path::new("./x/../a.glb"), "-o", a).check().is_err());
        let with =
            |path| FileSet::default().converts(a, "-o", b).writes("--motion-report", Some(path)).check();
        assert!(with(report).is_ok() && with(Path::new("-")).is_ok());
        assert!(with(a).is_err() && with(b).is_err());
        let message = with(b).unwrap_err().to_string();
        assert_eq!(
            message,
            "--motion-report b.glb: is the same file as b.glb, which -o writes; expected a file of its own"
        );
    }

    #[test]
    fn a_gltf_comes_with_its_buffer_and_its_images() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let json = r#"{"asset": {"version": "2.0"}, "buffers": [{"uri": "b%20c.bin", "byteLength": 1}],
            "images": [{"uri": "../skin.png"}, {"uri": "data:,"}]}"#;
        fs::write(at("in.gltf"), json).unwrap();
        let check = |output: &Path| FileSet::default().converts(&at("in.gltf"), "-o", output).check();
        let picture = |output: &Path| {
            FileSet::default().reads("", Some(&at("in.gltf"))).writes("-o", Some(output)).check()
        };
        assert!(check(&at("out.gltf")).is_ok() && check(&at("in.gltf")).is_ok());
        assert!(check(&at("b c.gltf")).is_err(), "its buffer is that of the input");
        assert!(picture(&at("../skin.png")).is_err() && picture(&at("skin.png")).is_ok());
        let report =
            FileSet::default().writes_scene("-o", &at("a.gltf")).writes("--report", Some(&at("a.bin")));
        assert!(report.check().unwrap_err().to_string().contains("which -o writes"));
    }
}
