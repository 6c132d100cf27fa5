//! What the cross-boundary tests need, installed into `target/test-env` with pinned versions.
//!
//! - `venv`: a Python virtual environment with `tests/requirements.txt` (numpy, scipy, Node, Blender as a module,
//!   CMake and Ninja)
//! - `blender-…`: likewise for older Blenders, with `tests/requirements-blender.txt`
//! - `bench`: likewise for `cargo xtask bench` alone, with `tests/requirements-bench.txt`
//! - `python3.…`: for every Python that there is, the Python package's wheel, numpy and pytest alone
//! - `node`: the packages of `tests/package-lock.json` (Khronos glTF validator, three.js, three-vrm)
//!
//! Godot, mono and the compilers of C and C++ with valgrind come from the system's packages.
//!
//! A stamp beside each holds what it was made from; while that is unchanged nothing is installed again.

use crate::tools::{self, Outcome};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Blender's shared libraries on Debian and Ubuntu, which its Python module does not carry.
const BLENDER_LIBRARIES: &[&str] = &[
    "libgl1",
    "libglvnd0",
    "libglx0",
    "libsm6",
    "libice6",
    "libx11-6",
    "libxext6",
    "libxfixes3",
    "libxi6",
    "libxrender1",
    "libxkbcommon0",
];

/// The Blender that every test runs in; its version is that of `tests/requirements.txt`.
const BLENDER: &str = "5.0.1";
/// The older ones that the extension supports, each in a virtual environment of its own.
const OLDER_BLENDERS: [&str; 2] = ["4.5.15", "4.2.23"];
/// What builds and watches the consumers of the C ABI, and the packages of Debian and Ubuntu that have it.
const C_PROGRAMS: [&str; 6] = ["gcc", "g++", "strip", "nm", "readelf", "valgrind"];
const C_PACKAGES: &[&str] = &["gcc", "g++", "libc6-dev", "binutils", "valgrind", "libc6-dbg"];

/// The compiler, the run time and the tests of C#, which Unity's are of the family of, and the packages that have them.
const MONO_PROGRAMS: [&str; 3] = ["mcs", "mono", "nunit-console"];
const MONO_PACKAGES: &[&str] =
    &["mono-mcs", "mono-runtime", "mono-devel", "libnunit-cil-dev", "nunit-console", "pkg-config"];
/// Compiles with NUnit, which tests of Unity's are written for, too.
pub(crate) const NUNIT: &str = "-pkg:nunit";

/// What is there to test with. An `Err` is the reason for which the tests that need it are skipped.
pub(crate) struct Environment {
    /// Python with numpy and scipy.
    pub(crate) python: Result<PathBuf, String>,
    /// That Python can `import bpy`.
    pub(crate) blender: Result<(), String>,
    /// Folder with `node_modules`, in which scripts have to lie, and the node program.
    pub(crate) node: Result<(PathBuf, PathBuf), String>,
    /// The headless Godot 3.
    pub(crate) godot: Result<PathBuf, String>,
    /// Compilers of C and C++ with sanitizers, valgrind and binutils.
    pub(crate) c: Result<(), String>,
}

impl Environment {
    /// Python with a script of `tests`, ready for its arguments.
    pub(crate) fn python_script(&self, script: &str) -> Result<Command, String> {
        let program = self.python.as_ref().map_err(String::clone)?;
        let mut command = Command::new(program);
        command.env("PYTHONDONTWRITEBYTECODE", "1").arg(tools::root().join("tests").join(script));
        Ok(command)
    }

    /// Python of every Blender that the extension supports, with its version, or why it is not there.
    pub(crate) fn blenders(&self) -> Outcome<Vec<(&'static str, Result<PathBuf, String>)>> {
        let newest = self.blender.clone().and_then(|()| self.python.clone());
        let mut all = vec![(BLENDER, newest.clone())];
        for version in OLDER_BLENDERS {
            let found = match &newest {
                Ok(python) => older_blender(python, version)?,
                Err(reason) => Err(reason.clone()),
            };
            all.push((version, found));
        }
        Ok(all)
    }

    /// A program that the virtual environment brings, such as CMake.
    pub(crate) fn program(&self, name: &str) -> Result<PathBuf, String> {
        let python = self.python.as_ref().map_err(String::clone)?;
        let folder = python.parent().unwrap_or(Path::new("."));
        let found = folder.join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
        if found.is_file() { Ok(found) } else { Err(format!("{name} has no wheel for this platform")) }
    }

    /// Node with a script of `tests`, ready for its arguments. The outer error is a failure, the inner a reason to
    /// skip.
    pub(crate) fn node_script(&self, script: &str) -> Outcome<Result<Command, String>> {
        let (home, program) = match &self.node {
            Ok(found) => found,
            Err(reason) => return Ok(Err(reason.clone())),
        };
        // Node looks for packages from the script's own folder upwards.
        let copy = home.join(script);
        tools::write(&copy, &tools::read(&tools::root().join("tests").join(script))?)?;
        let mut command = Command::new(program);
        command.arg(copy);
        Ok(Ok(command))
    }
}

/// Installs whatever is not there yet.
///
/// What this machine cannot have (an old Python, a platform without a wheel) is a reason to skip; an installation
/// that should work and does not is an error.
pub(crate) fn prepare() -> Outcome<Environment> {
    let home = tools::target().join("test-env");
    let (base, version) = match find_python() {
        Ok(found) => found,
        Err(reason) => {
            return Ok(Environment {
                python: Err(reason.clone()),
                blender: Err(reason.clone()),
                node: Err(reason),
                godot: godot(),
                c: c_programs(),
            });
        }
    };
    let python = virtual_environment(&home.join("venv"), &base)?;
    let blender = match version {
        (3, 11) => import_blender(&python)?,
        (major, minor) => Err(format!("bpy 5.0.1 needs Python 3.11, found {major}.{minor}")),
    };
    let node = node_packages(&home.join("node"), &python)?;
    Ok(Environment { python: Ok(python), blender, node: Ok(node), godot: godot(), c: c_programs() })
}

/// Python 3.11 if there is one, which Blender needs, else the first new enough for the pinned packages.
fn find_python() -> Result<(PathBuf, (u32, u32)), String> {
    let mut best: Option<(PathBuf, (u32, u32))> = None;
    let mut seen = Vec::new();
    for name in ["python3.11", "python3", "python"] {
        let script = "import sys; print(sys.version_info[0], sys.version_info[1])";
        let Ok(text) = tools::output(Command::new(name).args(["-c", script])) else { continue };
        let mut numbers = text.split_whitespace().filter_map(|word| word.parse().ok());
        let (Some(major), Some(minor)) = (numbers.next(), numbers.next()) else { continue };
        seen.push(format!("{name} {major}.{minor}"));
        let better = match best {
            None => (major, minor) >= (3, 11),
            Some((_, version)) => (major, minor) == (3, 11) && version != (3, 11),
        };
        if better {
            best = Some((name.into(), (major, minor)));
        }
    }
    best.ok_or_else(|| format!("Python 3.11 or newer is needed, found {}", or_none(&seen)))
}

fn or_none(seen: &[String]) -> String {
    if seen.is_empty() { "none".to_owned() } else { seen.join(", ") }
}

/// A program of a virtual environment.
fn program(venv: &Path, name: &str) -> PathBuf {
    let folder = if cfg!(windows) { "Scripts" } else { "bin" };
    venv.join(folder).join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
}

/// The virtual environment's Python, after installing the pinned packages.
fn virtual_environment(venv: &Path, base: &Path) -> Outcome<PathBuf> {
    virtual_environment_of(venv, base, "tests/requirements.txt")
}

fn virtual_environment_of(venv: &Path, base: &Path, requirements: &str) -> Outcome<PathBuf> {
    let requirements = tools::root().join(requirements);
    let python = program(venv, "python");
    installed_once(venv, &tools::read(&requirements)?, || {
        let create = || tools::run(Command::new(base).args(["-m", "venv", "--clear"]).arg(venv));
        // Debian and Ubuntu ship Python without its `venv` module.
        if let Err(message) = create() {
            apt_install(&["python3-venv"]).map_err(|e| format!("{message}; {e}"))?;
            create()?;
        }
        let pip =
            ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--requirement"];
        tools::run(Command::new(&python).args(pip).arg(&requirements))
    })?;
    Ok(python)
}

/// Python with what the benchmarks alone need, `tests/requirements-bench.txt`: PyTorch is several gigabytes.
pub(crate) fn bench_python() -> Outcome<PathBuf> {
    let venv = tools::target().join("test-env/bench");
    virtual_environment_of(&venv, &python()?, "tests/requirements-bench.txt")
}

/// The versions of Python that the Python package is tested with: first the one that Blender 5.0 has.
pub(crate) const PYTHONS: [&str; 5] = ["3.11", "3.9", "3.10", "3.12", "3.13"];

/// Any Python new enough for the tests; nothing is installed for it.
pub(crate) fn python() -> Outcome<PathBuf> {
    Ok(find_python()?.0)
}

/// Python of a version in an environment with a wheel of ours, numpy and pytest, and nothing else. The outer error is a failure,
/// the inner a reason to skip.
pub(crate) fn python_with(version: &str, wheel: &Path) -> Outcome<Result<PathBuf, String>> {
    let Some(base) = python_of(version) else {
        return Ok(Err(format!("there is no Python {version}: neither in the path nor of pyenv")));
    };
    let venv = tools::target().join("test-env").join(format!("python{version}"));
    let python = program(&venv, "python");
    let requirements = tools::root().join("tests/requirements.txt");
    let pip = |arguments: &[&str]| {
        let mut command = Command::new(&python);
        command.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).args(arguments);
        command
    };
    let made_from = format!("{}\n{}", base.display(), tools::read(&requirements)?);
    installed_once(&venv, &made_from, || {
        tools::run(Command::new(&base).args(["-m", "venv", "--clear"]).arg(&venv))?;
        tools::run(pip(&["numpy", "pytest", "--constraint"]).arg(&requirements))
    })?;
    // The wheel is another one each time, its number is not.
    tools::run(pip(&["--force-reinstall", "--no-deps"]).arg(wheel))?;
    Ok(Ok(python))
}

/// A Python of exactly this version, from the path or among those of pyenv.
fn python_of(version: &str) -> Option<PathBuf> {
    let is = |python: &Path| {
        let script = "import sys; print('%d.%d' % sys.version_info[:2])";
        tools::output(Command::new(python).args(["-c", script])).is_ok_and(|found| found.trim() == version)
    };
    let named = PathBuf::from(format!("python{version}"));
    if is(&named) {
        return Some(named);
    }
    let pyenv = std::env::var_os("PYENV_ROOT").map(PathBuf::from);
    let pyenv = pyenv.or_else(|| Some(std::env::home_dir()?.join(".pyenv")))?;
    let mut installed: Vec<_> = std::fs::read_dir(pyenv.join("versions")).ok()?.flatten().collect();
    installed.sort_by_key(std::fs::DirEntry::file_name);
    let of_version = |name: &str| name.strip_prefix(version).is_some_and(|rest| rest.starts_with('.'));
    installed.retain(|entry| of_version(&entry.file_name().to_string_lossy()));
    installed.into_iter().map(|entry| program(&entry.path(), "python")).find(|python| is(python))
}

/// Imports Blender, installing its shared libraries where that is needed and allowed.
fn import_blender(python: &Path) -> Outcome<Result<(), String>> {
    let import =
        || tools::output(Command::new(python).args(["-c", "import bpy; print(bpy.app.version_string)"]));
    let Err(message) = import() else { return Ok(Ok(())) };
    if message.contains("No module named 'bpy'") {
        return Ok(Err("bpy 5.0.1 has no wheel for this platform".to_owned()));
    }
    match apt_install(BLENDER_LIBRARIES) {
        Ok(()) => import().map(|_| Ok(())),
        Err(reason) => Ok(Err(format!("{message}; {reason}"))),
    }
}

/// Python of an older Blender, in a virtual environment beside the others.
fn older_blender(python: &Path, version: &str) -> Outcome<Result<PathBuf, String>> {
    let venv = tools::target().join("test-env").join(format!("blender-{version}"));
    let module = format!("bpy=={version}");
    let blender = program(&venv, "python");
    let needs = tools::root().join("tests/requirements-blender.txt");
    installed_once(&venv, &format!("{module}\n{}", tools::read(&needs)?), || {
        tools::run(Command::new(python).args(["-m", "venv", "--clear"]).arg(&venv))?;
        let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps"];
        tools::run(Command::new(&blender).args(pip).arg(&module).arg("--requirement").arg(&needs))
    })?;
    Ok(import_blender(&blender)?.map(|()| blender))
}

/// Debian's Godot 3 without a window, installed where that is needed and allowed.
fn godot() -> Result<PathBuf, String> {
    let program = "godot3-server";
    // It has no argument at which it would end well and quickly: that it starts is enough.
    let starts = || Command::new(program).arg("--version").output().map_err(|e| format!("{program}: {e}"));
    if starts().is_err() {
        apt_install(&[program])?;
        starts()?;
    }
    Ok(program.into())
}

/// Compilers, valgrind and binutils, installed where that is needed and allowed.
pub(crate) fn c_programs() -> Result<(), String> {
    if !cfg!(target_os = "linux") {
        return Err("the consumers in C are built and watched on Linux alone".to_owned());
    }
    let missing =
        || C_PROGRAMS.into_iter().find(|name| tools::output(Command::new(name).arg("--version")).is_err());
    let Some(name) = missing() else { return Ok(()) };
    apt_install(C_PACKAGES).map_err(|reason| format!("{name} is missing; {reason}"))?;
    missing().map_or(Ok(()), |name| Err(format!("{name} does not start, although it is installed")))
}

/// Mono, installed where that is needed and allowed.
pub(crate) fn mono() -> Result<(), String> {
    if !cfg!(target_os = "linux") {
        return Err("the Unity package is tested with mono on Linux alone".to_owned());
    }
    let missing =
        || MONO_PROGRAMS.into_iter().find(|name| tools::output(Command::new(name).arg("--version")).is_err());
    let Some(name) = missing() else { return Ok(()) };
    apt_install(MONO_PACKAGES).map_err(|reason| format!("{name} is missing; {reason}"))?;
    missing().map_or(Ok(()), |name| Err(format!("{name} does not start, although it is installed")))
}

/// Installs system packages where that is possible without asking anybody.
fn apt_install(packages: &[&str]) -> Outcome {
    let wanted = packages.join(" ");
    let root = cfg!(unix) && tools::output(Command::new("id").arg("-u")).is_ok_and(|id| id.trim() == "0");
    if !root || tools::output(Command::new("apt-get").arg("--version")).is_err() {
        return Err(format!("install by hand: {wanted}"));
    }
    let quiet = |command: &mut Command| tools::run(command.env("DEBIAN_FRONTEND", "noninteractive"));
    quiet(Command::new("apt-get").args(["update", "-qq"]))?;
    quiet(Command::new("apt-get").args(["install", "-qq", "-y", "--no-install-recommends"]).args(packages))
}

/// The folder with the npm packages and the node program.
fn node_packages(folder: &Path, python: &Path) -> Outcome<(PathBuf, PathBuf)> {
    let bin = python.parent().unwrap_or(Path::new("."));
    let [node, npm] = ["node", "npm"].map(|name| bin.join(format!("{name}{}", std::env::consts::EXE_SUFFIX)));
    let tests = tools::root().join("tests");
    let lock = tools::read(&tests.join("package-lock.json"))?;
    installed_once(folder, &lock, || {
        tools::write(&folder.join("package.json"), &tools::read(&tests.join("package.json"))?)?;
        tools::write(&folder.join("package-lock.json"), &lock)?;
        tools::run(Command::new(&npm).current_dir(folder).args([
            "ci",
            "--no-audit",
            "--no-fund",
            "--loglevel=error",
        ]))
    })?;
    Ok((folder.to_path_buf(), node))
}

/// Runs an installation unless the folder's stamp says that it was made from the same description.
fn installed_once(folder: &Path, description: &str, install: impl FnOnce() -> Outcome) -> Outcome {
    let stamp = folder.join("installed-from");
    if std::fs::read_to_string(&stamp).is_ok_and(|made_from| made_from == description) {
        return Ok(());
    }
    install()?;
    tools::write(&stamp, description)
}
