//! The table of which rooms may use which. ARCHITECTURE.md has it too, for readers, and a test compares the two.

/// A room and the rooms it may use, all of them above it; `lib.rs` may use every room.
const TABLE: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("random", &[]),
    ("side", &[]),
    ("text", &[]),
    ("math", &[]),
    ("space", &["math"]),
    ("mesh", &[]),
    ("measure", &["mesh"]),
    ("skeleton", &["math", "mesh", "space"]),
    ("pose", &["math", "skeleton", "space"]),
    ("network", &["measure"]),
    ("condition", &["math", "measure", "mesh"]),
    ("model", &["condition", "math", "measure", "mesh", "network", "skeleton", "space"]),
    ("body", &["condition", "measure", "mesh", "model", "skeleton"]),
    ("skin", &["math", "mesh", "pose", "skeleton"]),
    ("clip", &["math", "pose", "skeleton"]),
    ("retarget", &["clip", "math", "pose", "skeleton"]),
    ("scene", &["body", "clip", "math", "measure", "mesh", "model", "pose", "skeleton", "skin", "space"]),
    (
        "format",
        &["clip", "math", "measure", "mesh", "model", "pose", "retarget", "scene", "skeleton", "space"],
    ),
];

/// Rooms that know nothing of bodies: every room may use them.
const OPEN: &[&str] = &["error", "random", "side", "text"];

/// The room that tests share: it may use every room and every room may use it, so it is not in the table. The compiler
/// refuses uses outside of tests, as the room does not exist there.
pub(super) const TESTING: &str = "testing";

/// Whether it is a room of the library.
pub(super) fn is_room(name: &str) -> bool {
    name == TESTING || TABLE.iter().any(|(room, _)| *room == name)
}

/// Whether one room may use another.
pub(super) fn may_use(room: &str, used: &str) -> bool {
    let granted = || TABLE.iter().any(|(name, granted)| *name == room && granted.contains(&used));
    room == used || room == TESTING || used == TESTING || OPEN.contains(&used) || granted()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools;

    #[test]
    fn the_table_has_no_cycle_and_knows_its_rooms() {
        for (i, (room, granted)) in TABLE.iter().enumerate() {
            for used in *granted {
                let place = TABLE.iter().position(|(name, _)| name == used);
                assert!(
                    place.is_some_and(|p| p < i),
                    "`{room}` uses `{used}`, which is not above it in the table"
                );
            }
        }
    }

    /// The names in backticks.
    fn quoted(text: &str) -> Vec<&str> {
        text.split('`').skip(1).step_by(2).collect()
    }

    /// The rows of the table for readers: a room each, and what it may use.
    fn rows(text: &str) -> Vec<(&str, Vec<&str>)> {
        let (_, section) = text.split_once("\n## Rooms of the library\n").unwrap();
        let table = section
            .lines()
            .skip_while(|line| !line.starts_with('|'))
            .take_while(|line| line.starts_with('|'));
        let mut lines =
            table.map(|line| line.trim_matches('|').split('|').map(str::trim).collect::<Vec<_>>());
        assert_eq!(lines.next().unwrap(), ["Room", "Holds", "May use"]);
        lines.next();
        let rooms = lines.map(|columns| {
            let [room, _, may_use] = columns[..] else { panic!("three columns are expected: {columns:?}") };
            let granted = quoted(may_use);
            let plain: Vec<String> = granted.iter().map(|name| format!("`{name}`")).collect();
            let plain = if plain.is_empty() { "–".to_owned() } else { plain.join(", ") };
            assert_eq!(may_use, plain, "{room} may use: rooms in backticks with commas between, or a dash");
            (quoted(room)[0], granted)
        });
        rooms.collect()
    }

    #[test]
    fn architecture_has_the_same_table() {
        let text = tools::read(&tools::root().join("ARCHITECTURE.md")).unwrap();
        let (theirs, here) = (rows(&text), "xtask/src/layering/table.rs");
        for ((room, mut granted), (our_room, our_granted)) in theirs.iter().cloned().zip(TABLE) {
            assert_eq!(room, *our_room, "ARCHITECTURE.md and {here} have another room in this row");
            let mut our_granted = our_granted.to_vec();
            granted.sort_unstable();
            our_granted.sort_unstable();
            assert_eq!(granted, our_granted, "ARCHITECTURE.md and {here} allow `{room}` different rooms");
        }
        assert_eq!(theirs.len(), TABLE.len(), "ARCHITECTURE.md and {here} have a different number of rooms");
        let (_, rest) = text.split_once("\nEverybody may use ").unwrap();
        let open = quoted(rest.split('.').next().unwrap());
        assert_eq!(open, OPEN, "ARCHITECTURE.md and {here} open different rooms to every room");
    }

    #[test]
    fn only_the_room_for_tests_is_open_both_ways() {
        assert!(is_room(TESTING) && may_use("error", TESTING) && may_use(TESTING, "import"));
        assert!(may_use("mesh", "error") && may_use("measure", "mesh") && may_use("mesh", "mesh"));
        assert!(!may_use("mesh", "measure") && !may_use("error", "mesh"));
    }
}
