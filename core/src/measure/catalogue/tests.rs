//! The catalogue; another measure takes a row in it and a definition, and no other code of this module.

use glam::DVec3;

use super::*;
use crate::measure::definition::{Kind, read_list};

/// The library's rows and two more, one in the middle and one on both sides.
const LARGER_ROWS: [Row; ROWS.len() + 2] = {
    let mut rows = [central!("neck_width", Head, None); ROWS.len() + 2];
    let mut r = 0;
    while r < ROWS.len() {
        rows[r + 1] = ROWS[r];
        r += 1;
    }
    rows[ROWS.len() + 1] = sided!("wrist_width", Hand, Some("ANSUR II wristbreadth"));
    rows
};
const LARGER_ENTRIES: [Entry; count(&LARGER_ROWS)] = entries(&LARGER_ROWS);
const LARGER: Catalogue = Catalogue(&LARGER_ENTRIES);

#[test]
fn another_row_is_another_measure() {
    assert_eq!(LARGER.0.len(), MEASURE_COUNT + 3);
    let mut names: Vec<&str> = CATALOGUE.names().collect();
    let right = CATALOGUE.0.iter().position(|entry| entry.side == Some(Side::Right)).unwrap();
    names.insert(right, "wrist_width_left");
    names.insert(0, "neck_width");
    names.push("wrist_width_right");
    assert_eq!(LARGER.names().collect::<Vec<_>>(), names);

    let [left, right] = ["wrist_width_left", "wrist_width_right"].map(|name| LARGER.find(name).unwrap());
    assert_eq!(LARGER.expand("wrist_width"), Some(vec![left, right]));
    assert_eq!(LARGER.expand("wrist_width_right"), Some(vec![right]));
    assert_eq!(LARGER.expand("neck_width"), Some(vec![0]));
    assert_eq!(LARGER.expand("wrist"), None);
    for (place, entry) in LARGER.0.iter().enumerate() {
        let mirrored = &LARGER.0[entry.mirrored];
        assert_eq!(mirrored.mirrored, place);
        assert_eq!((mirrored.base, mirrored.side), (entry.base, entry.side.map(Side::mirrored)));
        assert_eq!((mirrored.part, mirrored.standard), (entry.part, entry.standard));
        assert_eq!(Side::split_measure_name(entry.name), (entry.base, entry.side));
    }
    assert_eq!(LARGER.0[right].part, BodyPart::Hand);
    assert_eq!(LARGER.0[right].standard, Some("ANSUR II wristbreadth"));
}

#[test]
fn another_measure_is_defined_and_evaluated() {
    // A pyramid on four vertices: every measure is the straight distance between two of them.
    let surface = [DVec3::ZERO, DVec3::X, DVec3::Y * 2.0, DVec3::Z * 3.0];
    let definition = |(place, name): (usize, &str)| {
        format!(
            r#"{{"name": "{name}", "kind": "length", "points": [[[0, 1.0]], [[{}, 1.0]]],
                "normal": [0, 0, 0], "axis": null}}"#,
            place % 3 + 1
        )
    };
    let json = |names: &[&str]| {
        format!("[{}]", names.iter().copied().enumerate().map(definition).collect::<Vec<_>>().join(","))
    };
    let mut names: Vec<&str> = LARGER.names().collect();
    let list = read_list(&json(&names), LARGER.names(), surface.len()).unwrap();
    for (place, definition) in list.iter().enumerate() {
        assert_eq!(definition.kind, Kind::Length);
        assert_eq!(definition.read(|v| surface[v as usize]), (place % 3 + 1) as f64, "{}", definition.name);
    }

    let refused =
        |names: &[&str]| read_list(&json(names), LARGER.names(), surface.len()).unwrap_err().to_string();
    names.swap(0, 1);
    assert!(refused(&names).contains("expected neck_width, got waist_circumference"));
    names.pop();
    let count = LARGER.0.len();
    assert!(refused(&names).contains(&format!("expected {count} measures, got {}", count - 1)));
}

#[test]
fn every_part_of_the_body_has_measures() {
    for part in BodyPart::ALL {
        assert!(CATALOGUE.0.iter().any(|entry| entry.part == part), "{}", part.name());
    }
    let of = |name: &str| CATALOGUE.0[CATALOGUE.find(name).unwrap()].part;
    assert_eq!([of("height"), of("neck_length_midline")], [BodyPart::Trunk, BodyPart::Head]);
    assert_eq!([of("hand_size_left"), of("heel_to_toe_length_right")], [BodyPart::Hand, BodyPart::Foot]);
}
