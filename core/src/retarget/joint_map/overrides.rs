//! The user's own word about joints: a JSON object `{"source joint": "native joint" | null}`.

use std::{collections::BTreeMap, path::Path};

use super::Slot;
use crate::error::FormatError;
use crate::skeleton::Skeleton;
use crate::{Error, Result};

/// Source joint to our joint, or to nothing where it shall drive nothing.
pub type Overrides = BTreeMap<String, Option<String>>;

/// Reads a mapping file; `path` is only for messages.
///
/// # Errors
/// [`Error::File`] when it is no JSON object of names and nulls, with line and column.
pub fn read_overrides(json: &str, path: &Path) -> Result<Overrides> {
    serde_json::from_str(json).map_err(|error| Error::file(path, FormatError::Mapping(error)))
}

/// Checks both sides: our joint to source joint, and source joints that shall drive nothing.
pub(super) fn check(source: &Skeleton, overrides: &Overrides) -> Result<(BTreeMap<Slot, usize>, Vec<usize>)> {
    let fail = |message| Err(Error::invalid("joint mapping", message));
    let mut mapped = BTreeMap::new();
    let mut nothing = Vec::new();
    for (theirs, ours) in overrides {
        let Some(joint) = source.find(theirs) else {
            let near = near(theirs, source.names().iter().map(String::as_str));
            return fail(format!("the clip has no joint `{theirs}`: did you mean {near}?"));
        };
        let Some(ours) = ours else {
            nothing.push(joint);
            continue;
        };
        let Some(slot) = Slot::from_name(ours) else {
            let near = near(ours, Slot::all().map(Slot::name));
            return fail(format!("`{theirs}`: our rig has no joint `{ours}`: did you mean {near}?"));
        };
        if let Some(other) = mapped.insert(slot, joint) {
            let other = &source.names()[other];
            return fail(format!("both `{other}` and `{theirs}` shall drive `{ours}`"));
        }
    }
    Ok((mapped, nothing))
}

/// The up to three names most like this one.
fn near<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> String {
    let wanted = name.to_lowercase();
    let mut list: Vec<(usize, &str)> =
        candidates.map(|c| (crate::error::edit_distance(&wanted, &c.to_lowercase()), c)).collect();
    list.sort_unstable();
    let names: Vec<String> = list.iter().take(3).map(|(_, c)| format!("`{c}`")).collect();
    names.join(", ")
}
