//! Motion files retargeted to bodies from short to tall: the table of `anthronet evaluate`, checked against its limits.

use super::Tally;
use crate::tools;
use anyhow::{Context as _, Result};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A number of the table, its limit and its unit.
const BARS: [(&str, f64, &str); 5] = [
    ("direction_worst_clip_mean_deg", 3.0, "°"),
    ("beyond_limits_deg", 5.0, "°"),
    ("under_floor_mm", 20.0, "mm"),
    ("slide_mm", 10.0, "mm"),
    ("not_finite", 0.0, "vertices"),
];

pub(crate) fn run(anthronet: &Path, tally: &mut Tally) {
    let folder = clips();
    if !folder.is_dir() {
        let why = format!("no motion files in {}, nor where ANTHRONET_SHARED says", folder.display());
        tally.skip("motion files on ten bodies", &why);
        return;
    }
    println!("-- motion files on ten bodies");
    let table = table(anthronet, &folder);
    let table = match table {
        Ok(table) => table,
        Err(why) => {
            tally.case("motion files on ten bodies", Err(why));
            return;
        }
    };
    for row in table["rows"].as_array().into_iter().flatten() {
        println!("  {row}");
    }
    for (name, most, unit) in BARS {
        // A missing number fails too.
        let within = table[name].as_f64().is_some_and(|value| value <= most);
        let said = format!("{name} {} {unit}, at most {most}", table[name]);
        tally.case(&format!("motion files: {said}"), within.then_some(()).context(said.clone()));
    }
    let counts = (table["bodies"].as_u64(), table["clips"].as_u64());
    let said = || format!("{} clips on {} bodies", table["clips"], table["bodies"]);
    let enough = counts >= (Some(10), Some(30));
    tally.case(&format!("motion files: {}", said()), enough.then_some(()).with_context(said));
}

fn clips() -> PathBuf {
    let shared = std::env::var_os("ANTHRONET_SHARED").map(PathBuf::from);
    shared.unwrap_or_else(|| tools::root().join("../shared")).join("data/clips")
}

fn table(anthronet: &Path, folder: &Path) -> Result<serde_json::Value> {
    let mut command = Command::new(anthronet);
    command.args(["evaluate", "--table", "motion", "--json", "--clips"]).arg(folder);
    let text = tools::output(&mut command)?;
    serde_json::from_str(&text).context("the table")
}
