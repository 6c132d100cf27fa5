//! The table of who may use whom, as ARCHITECTURE.md has it in words.

/// A room and the rooms it may use, each of which stands above it; `lib.rs` may use everybody.
const TABLE: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("random", &[]),
    ("space", &[]),
    ("mesh", &[]),
    ("measure", &["mesh"]),
    ("rig", &["mesh"]),
    ("condition", &["measure", "mesh"]),
    ("model", &["condition", "measure", "mesh", "rig"]),
    ("body", &["model", "condition", "measure", "mesh", "rig"]),
    ("input", &[]),
    ("pose", &["rig", "space"]),
    ("clip", &["pose", "rig", "space", "input"]),
    ("skin", &["pose", "rig", "mesh"]),
    ("export", &["body", "model", "condition", "measure", "mesh", "rig", "pose", "clip", "space"]),
    ("import", &["export", "model", "measure", "mesh", "rig", "pose", "clip", "space", "input"]),
];

/// Rooms without a view of bodies, open to everybody.
const OPEN: &[&str] = &["error", "random"];

/// What tests share, where the library has such a room: it stands above and below all others, and so it is not in the
/// table. Where it may be named is the compiler's to say, as the room is not there outside of tests.
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

    #[test]
    fn what_tests_share_is_open_both_ways_and_nothing_else_is() {
        assert!(is_room(TESTING) && may_use("error", TESTING) && may_use(TESTING, "import"));
        assert!(may_use("mesh", "error") && may_use("measure", "mesh") && may_use("mesh", "mesh"));
        assert!(!may_use("mesh", "measure") && !may_use("error", "mesh"));
    }
}
