//! `anthronet evaluate`: the table of motion, which needs no network.

mod common;

use common::{anthronet, folder, write};
use serde_json::Value;

#[test]
fn the_table_of_motion_has_a_row_for_every_file_and_built_in_clip() {
    let folder = folder();
    write(&folder, "bend.bvh", include_bytes!("../../tests/data/bend.bvh"));
    write(&folder, "notes.txt", b"no motion");
    let clips = folder.path().to_string_lossy();
    let options = ["evaluate", "--table", "motion", "--bodies", "1", "--clips", &clips];
    let json = anthronet(&[&options[..], &["--json"]].concat(), &[]).succeeds();
    let table: Value = serde_json::from_str(&json.out).unwrap();
    let rows = table["rows"].as_array().unwrap();
    let names: Vec<_> = rows.iter().filter_map(|row| row["clip"].as_str()).collect();
    assert_eq!(names, ["bend.bvh", "idle", "walk", "wave", "squat", "range_of_motion"]);
    assert_eq!((&rows[0]["frames"], &rows[0]["unmatched"]), (&4.into(), &1.into()));
    assert_eq!((&table["bodies"], &table["not_finite"]), (&1.into(), &0.into()));
}

#[test]
fn the_table_of_motion_needs_a_folder_of_motion_files() {
    let table = ["evaluate", "--table", "motion"];
    anthronet(&table, &[]).fails(2, &["--table motion", "--clips"]);
    let folder = folder();
    let clips = folder.path().to_string_lossy();
    anthronet(&[&table[..], &["--clips", &clips]].concat(), &[]).fails(1, &[&clips, "found none"]);
    anthronet(&[&table[..], &["--clips", "/no/such/folder"]].concat(), &[])
        .fails(1, &["/no/such/folder", "cannot read"]);
}
