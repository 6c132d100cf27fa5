//! `anthronet info`: the measures, the joints and the model.

use std::fmt::Write;

use anthronet::model::Model;
use clap::Args;
use serde_json::Value;

use crate::failure::Result;
use crate::terminal::print;

/// List the measures with their ranges, the landmarks, the joints, and the model's version and scores.
#[derive(Args)]
#[command(after_help = "Examples:\n  anthronet info\n  anthronet info --json > definitions.json")]
pub(crate) struct Arguments {
    /// Print JSON: {"measures": [{"name", "kind", "points", "normal", "axis", "standard", "min", "max"}, …],
    /// "landmarks": [{"name", "place", "point"}, …], "joints": [{"name", "parent"}, …], …}. Vertices are those of level of detail 0, lengths metres.
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<()> {
    let info = Model::from_environment()?.info();
    if arguments.json {
        let json = serde_json::to_string(&info)?;
        return print(&(json + "\n"));
    }
    print(&text(&info))
}

/// The same as readable text; missing fields are skipped.
fn text(info: &Value) -> String {
    let mut out = String::new();
    let list = |key: &str| info[key].as_array().map(Vec::as_slice).unwrap_or_default();
    let word = |value: &Value| value.as_str().unwrap_or("").to_owned();
    let metres = |value: &Value| value.as_f64().map_or(String::new(), |v| format!("{v:.3}"));
    // Writing to a string cannot fail.
    let _ = writeln!(out, "{:28} {:7} {:>7} {:>7}  nearest standard", "measure", "kind", "min m", "max m");
    for measure in list("measures") {
        let _ = writeln!(
            out,
            "{:28} {:7} {:>7} {:>7}  {}",
            word(&measure["name"]),
            word(&measure["kind"]),
            metres(&measure["min"]),
            metres(&measure["max"]),
            word(&measure["standard"])
        );
    }
    let _ = writeln!(out, "\n{:28} place", "landmark");
    for landmark in list("landmarks") {
        let _ = writeln!(out, "{:28} {}", word(&landmark["name"]), word(&landmark["place"]));
    }
    let _ = writeln!(out, "\n{} joints:", list("joints").len());
    let joints: Vec<_> = list("joints").iter().map(|joint| word(&joint["name"])).collect();
    for row in joints.chunks(6) {
        let _ = writeln!(out, "  {}", row.join(" "));
    }
    for (key, value) in info.as_object().into_iter().flatten() {
        if !matches!(value, Value::Array(_)) {
            let _ = writeln!(out, "\n{key}: {}", serde_json::to_string_pretty(value).unwrap_or_default());
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_lists_measures_joints_and_the_rest() {
        let text = text(&serde_json::json!({
            "measures": [{"name": "height", "kind": "length", "standard": null, "min": 1.4, "max": 2.1}],
            "landmarks": [{"name": "menton", "place": "lowest point of the chin", "point": [[732, 1.0]]}],
            "joints": [{"name": "root", "parent": null}],
            "model": {"version": 1}
        }));
        for expected in ["height", "1.400", "lowest point of the chin", "1 joints", "root", "\"version\": 1"]
        {
            assert!(text.contains(expected), "{expected} in {text}");
        }
        assert!(!text.contains("null"));
    }
}
