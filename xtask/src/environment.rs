//! What the cross-boundary tests need, installed into `target/test-env` with pinned versions.
//!
//! - `venv`: a Python virtual environment with `tests/requirements.txt` (numpy, scipy, Node, Blender as a module,
//!   CMake and Ninja)
//! - `blender-…`: likewise for older Blenders, with `tests/requirements-blender.txt`
//! - `bench`: likewise for `cargo xtask bench`, with `tests/requirements-bench.txt`
//! - `python3.…`: for every Python on the machine, our Python package's wheel, numpy and pytest only
//! - `node`: the packages of `tests/package-lock.json` (Khronos glTF validator, three.js, three-vrm)
//!
//! Godot, mono and the compilers of C and C++ with valgrind come from the system's packages.
//!
//! A stamp in each folder records what it was installed from; while that is unchanged nothing is installed again.

use crate::tools::{self, Available, Missing};
use anyhow::{Context as _, Result, anyhow, bail};
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
/// What builds and checks the programs in C, and the packages of Debian and Ubuntu that contain it.
const C_PROGRAMS: &[&str] = &["gcc", "g++", "strip", "nm", "readelf", "valgrind"];
const C_PACKAGES: &[&str] = &["gcc", "g++", "libc6-dev", "binutils", "valgrind", "libc6-dbg"];

/// Compiler, runtime and test runner for C#, relatives of Unity's own, and the packages that contain them.
const MONO_PROGRAMS: &[&str] = &["mcs", "mono", "nunit-console"];
const MONO_PACKAGES: &[&str] =
    &["mono-mcs", "mono-runtime", "mono-devel", "libnunit-cil-dev", "nunit-console", "pkg-config"];
/// Argument of the compiler that adds NUnit, the framework of Unity's tests.
pub(crate) const NUNIT: &str = "-pkg:nunit";

/// The programs to test with. An `Err` is the reason for which the tests that need one are skipped.
pub(crate) struct Environment {
    /// Python with numpy and scipy.
    pub(crate) python: Available<PathBuf>,
    /// That Python can `import bpy`.
    pub(crate) blender: Available<()>,
    /// Folder with `node_modules` and the scripts, and the node program.
    pub(crate) node: Available<(PathBuf, PathBuf)>,
    /// The headless Godot 3.
    pub(crate) godot: Available<PathBuf>,
}

impl Environment {
    /// Python with a script of `tests`, ready for its arguments.
    pub(crate) fn python_script(&self, script: &str) -> Available<Command> {
        let program = self.python.clone()?;
        let mut command = Command::new(program);
        command.env("PYTHONDONTWRITEBYTECODE", "1").arg(tools::root().join("tests").join(script));
        Ok(command)
    }

    /// Every version of Blender that the extension supports, each with its Python.
    pub(crate) fn blenders(&self) -> Result<Vec<(&'static str, Available<PathBuf>)>> {
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

    /// A program in the virtual environment, such as CMake.
    pub(crate) fn program(&self, name: &str) -> Available<PathBuf> {
        let python = self.python.clone()?;
        let folder = python.parent().unwrap_or(Path::new("."));
        let found = folder.join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
        if found.is_file() {
            Ok(found)
        } else {
            Err(Missing(format!("{name} has no wheel for this platform")))
        }
    }

    /// Node with a script of `tests`, ready for its arguments.
    pub(crate) fn node_script(&self, script: &str) -> Available<Command> {
        let (home, program) = self.node.clone()?;
        let mut command = Command::new(program);
        command.arg(home.join(script));
        Ok(command)
    }
}

/// Installs whatever is not there yet.
///
/// What this machine cannot have (a newer Python, a wheel for its platform) is [`Missing`]; an installation that should
/// work and does not is an error.
pub(crate) fn prepare() -> Result<Environment> {
    let home = tools::target().join("test-env");
    let (base, version) = match find_python() {
        Ok(found) => found,
        Err(reason) => {
            return Ok(Environment {
                python: Err(reason.clone()),
                blender: Err(reason.clone()),
                node: Err(reason),
                godot: godot(),
            });
        }
    };
    let python = virtual_environment(&home.join("venv"), &base)?;
    let blender = match version {
        (3, 11) => import_blender(&python)?,
        (major, minor) => Err(Missing(format!("bpy 5.0.1 needs Python 3.11, found {major}.{minor}"))),
    };
    let node = node_packages(&home.join("node"), &python)?;
    Ok(Environment { python: Ok(python), blender, node: Ok(node), godot: godot() })
}

/// Python 3.11 if there is one, which Blender needs, else the first new enough for the pinned packages.
fn find_python() -> Available<(PathBuf, (u32, u32))> {
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
    best.ok_or_else(|| Missing(format!("Python 3.11 or newer is needed, found {}", or_none(&seen))))
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
fn virtual_environment(venv: &Path, base: &Path) -> Result<PathBuf> {
    virtual_environment_of(venv, base, "tests/requirements.txt")
}

fn virtual_environment_of(venv: &Path, base: &Path, requirements: &str) -> Result<PathBuf> {
    let requirements = tools::root().join(requirements);
    let python = program(venv, "python");
    installed_once(venv, &tools::read(&requirements)?, || {
        let create = || tools::run(Command::new(base).args(["-m", "venv", "--clear"]).arg(venv));
        // Debian and Ubuntu ship Python without its `venv` module.
        if let Err(error) = create() {
            apt_install(&["python3-venv"]).map_err(|also| anyhow!("{error:#}; {also:#}"))?;
            create()?;
        }
        let pip =
            ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--requirement"];
        tools::run(Command::new(&python).args(pip).arg(&requirements))
    })?;
    Ok(python)
}

/// Python with the packages of `tests/requirements-bench.txt`, kept apart as PyTorch is several gigabytes.
pub(crate) fn bench_python() -> Result<PathBuf> {
    let venv = tools::target().join("test-env/bench");
    virtual_environment_of(&venv, &python()?, "tests/requirements-bench.txt")
}

/// The versions of Python that the Python package is tested with; the first is that of Blender 5.0.
pub(crate) const PYTHONS: [&str; 5] = ["3.11", "3.9", "3.10", "3.12", "3.13"];

/// Any Python new enough for the tests; installs nothing.
pub(crate) fn python() -> Result<PathBuf> {
    Ok(find_python()?.0)
}

/// Python of a version in an environment with this wheel of our package, numpy and pytest, and nothing else.
pub(crate) fn python_with(version: &str, wheel: &Path) -> Result<Available<PathBuf>> {
    let Some(base) = python_of(version) else {
        return Ok(Err(Missing(format!("there is no Python {version}: neither in the path nor in pyenv"))));
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
    // The wheel differs each time, its version number does not.
    tools::run(pip(&["--force-reinstall", "--no-deps"]).arg(wheel))?;
    Ok(Ok(python))
}

/// A Python of exactly this version, from the path or from pyenv.
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
fn import_blender(python: &Path) -> Result<Available<()>> {
    let import =
        || tools::output(Command::new(python).args(["-c", "import bpy; print(bpy.app.version_string)"]));
    let Err(error) = import() else { return Ok(Ok(())) };
    let message = format!("{error:#}");
    if message.contains("No module named 'bpy'") {
        return Ok(Err(Missing("bpy 5.0.1 has no wheel for this platform".to_owned())));
    }
    match apt_install(BLENDER_LIBRARIES) {
        Ok(()) => import().map(|_| Ok(())),
        Err(reason) => Ok(Err(Missing(format!("{message}; {reason:#}")))),
    }
}

/// Python of an older Blender, in a virtual environment beside the others.
fn older_blender(python: &Path, version: &str) -> Result<Available<PathBuf>> {
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
fn godot() -> Available<PathBuf> {
    let program = "godot3-server";
    // No argument makes it exit quickly with success; that it starts is enough.
    let starts = || Command::new(program).arg("--version").output();
    if starts().is_err() {
        apt_install(&[program])?;
        starts().map_err(|error| Missing(format!("{program}: {error}")))?;
    }
    Ok(program.into())
}

/// Compilers of C and C++ with sanitizers, valgrind and binutils, installed where that is needed and allowed.
pub(crate) fn c_programs() -> Available<()> {
    system_programs("the programs in C are built and checked", C_PROGRAMS, C_PACKAGES)
}

/// Mono, installed where that is needed and allowed.
pub(crate) fn mono() -> Available<()> {
    system_programs("the Unity package is tested with mono", MONO_PROGRAMS, MONO_PACKAGES)
}

/// Programs of the system, on Linux only, installed where that is needed and allowed.
fn system_programs(purpose: &str, programs: &[&str], packages: &[&str]) -> Available<()> {
    if !cfg!(target_os = "linux") {
        return Err(Missing(format!("{purpose} on Linux only")));
    }
    let missing = || programs.iter().find(|name| tools::output(Command::new(name).arg("--version")).is_err());
    let Some(name) = missing() else { return Ok(()) };
    apt_install(packages).map_err(|reason| Missing(format!("{name} is missing; {reason:#}")))?;
    missing().map_or(Ok(()), |name| Err(Missing(format!("{name} does not start, although it is installed"))))
}

/// Installs system packages if that needs no password: as root on Debian or Ubuntu.
fn apt_install(packages: &[&str]) -> Result<()> {
    let wanted = packages.join(" ");
    let root = cfg!(unix) && tools::output(Command::new("id").arg("-u")).is_ok_and(|id| id.trim() == "0");
    if !root || tools::output(Command::new("apt-get").arg("--version")).is_err() {
        bail!("install by hand: {wanted}");
    }
    let quiet = |command: &mut Command| tools::run(command.env("DEBIAN_FRONTEND", "noninteractive"));
    quiet(Command::new("apt-get").args(["update", "-qq"]))?;
    quiet(Command::new("apt-get").args(["install", "-qq", "-y", "--no-install-recommends"]).args(packages))
}

/// The folder with the npm packages and the node program.
fn node_packages(folder: &Path, python: &Path) -> Result<(PathBuf, PathBuf)> {
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
    // Node looks for packages from the script's own folder upwards.
    for entry in
        std::fs::read_dir(&tests).with_context(|| format!("{}: cannot read", tests.display()))?.flatten()
    {
        let (script, copy) = (entry.path(), folder.join(entry.file_name()));
        if script.extension().is_some_and(|extension| extension == "mjs") {
            let text = tools::read(&script)?;
            // Parts of the tests run side by side, none of which shall rewrite what another is reading.
            if std::fs::read_to_string(&copy).ok().as_ref() != Some(&text) {
                tools::write(&copy, &text)?;
            }
        }
    }
    Ok((folder.to_path_buf(), node))
}

/// Runs an installation unless the folder's stamp says that it was made from the same description.
fn installed_once(folder: &Path, description: &str, install: impl FnOnce() -> Result<()>) -> Result<()> {
    let stamp = folder.join("installed-from");
    if std::fs::read_to_string(&stamp).is_ok_and(|made_from| made_from == description) {
        return Ok(());
    }
    install()?;
    tools::write(&stamp, description)
}
