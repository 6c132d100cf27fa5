//! `cargo xtask package blender`: the extension with its wheel, built and validated by Blender's own tool.

use crate::environment::Environment;
use crate::tools::{self, Available};
use anyhow::{Context as _, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The folder of the wheel in the extension, as in `blender_manifest.toml`.
const WHEELS: &str = "wheels";

/// Makes `target/dist/anthronet-blender-<version>.zip` from `blender_addon`, the wheel and the measures that the command
/// lists. `wheel` makes or finds the wheel, given a Python.
pub(crate) fn package_blender(
    environment: &Environment,
    anthronet: &Path,
    wheel: impl FnOnce(&Path) -> Result<PathBuf>,
) -> Result<Available<PathBuf>> {
    let python = match (&environment.python, &environment.blender) {
        (Ok(python), Ok(())) => python,
        (Err(reason), _) | (_, Err(reason)) => return Ok(Err(reason.clone())),
    };
    let wheel = wheel(python)?;
    let source = tools::root().join("blender_addon");
    let stage = tools::target().join("dist/stage/anthronet");
    tools::remove_folder(&stage)?;
    // Without what Python and earlier packaging leave in it.
    tools::copy_except(&source, &stage, &["__pycache__", "data", WHEELS])?;
    let name = wheel.file_name().and_then(|name| name.to_str()).context("the wheel has no name")?;
    let manifest = tools::read(&source.join("blender_manifest.toml"))?;
    if !manifest.contains(&format!("./{WHEELS}/{name}")) {
        bail!("blender_manifest.toml: expected the wheel {name}");
    }
    tools::copy(&wheel, &stage.join(WHEELS).join(name))?;
    tools::write(&stage.join("data/measures.json"), &measures(anthronet)?)?;

    let archive =
        tools::target().join("dist").join(format!("anthronet-blender-{}.zip", env!("CARGO_PKG_VERSION")));
    let tool = extension_tool(python)?;
    let run = |arguments: &[&std::ffi::OsStr]| {
        tools::output(Command::new(python).arg(&tool).args(arguments)).map(drop)
    };
    run(&[
        "build".as_ref(),
        "--source-dir".as_ref(),
        stage.as_ref(),
        "--output-filepath".as_ref(),
        archive.as_ref(),
    ])?;
    run(&["validate".as_ref(), archive.as_ref()])?;
    Ok(Ok(archive))
}

/// The measures, as JSON, for the extension to show before it loads the library.
fn measures(anthronet: &Path) -> Result<String> {
    let info = tools::output(Command::new(anthronet).args(["info", "--json"]))?;
    let info: serde_json::Value = serde_json::from_str(&info).context("info --json")?;
    let known = info["measures"].as_array().context("info --json: no measures")?.iter().map(|measure| {
        let fields = ["name", "kind", "standard", "min", "max"];
        let fields = fields.map(|field| (field.to_owned(), measure[field].clone()));
        serde_json::Value::Object(fields.into_iter().collect())
    });
    Ok(serde_json::json!({ "measures": known.collect::<Vec<_>>() }).to_string() + "\n")
}

/// Blender's program that builds and validates extensions; part of its Python module.
fn extension_tool(python: &Path) -> Result<PathBuf> {
    let script = "import glob, importlib.util, os; \
                  folder = os.path.dirname(importlib.util.find_spec('bpy').origin); \
                  print(glob.glob(folder + '/*/scripts/addons_core/bl_pkg/cli/blender_ext.py')[0])";
    Ok(PathBuf::from(tools::output(Command::new(python).args(["-c", script]))?.trim()))
}
