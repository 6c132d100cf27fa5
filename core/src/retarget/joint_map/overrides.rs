//! The user's joint mapping: a JSON object `{"source joint": "native joint" | null}`.

use std::{collections::BTreeMap, path::Path};

use super::Slot;
use crate::error::FormatError;
use crate::skeleton::Skeleton;
use crate::text::without_mark;
use crate::{Error, Result};

/// From source joint to joint of the rig, or to `None` for a joint that is to drive nothing; both by name.
pub type Overrides = BTreeMap<String, Option<String>>;

/// Parses the text of a mapping file; `path` is only used in messages.
///
/// # Errors
/// [`Error::File`] with line and column when it is not a JSON object of names and nulls.
pub fn read_overrides(json: &str, path: &Path) -> Result<Overrides> {
    serde_json::from_str(without_mark(json)).map_err(|error| Error::file(path, FormatError::Mapping(error)))
}

/// Resolves the names of a mapping: source joints by slot, and source joints that are to drive nothing.
pub(super) fn check(source: &Skeleton, overrides: &Overrides) -> Result<(BTreeMap<Slot, usize>, Vec<usize>)> {
    let fail = |message| Err(Error::invalid("joint mapping", message));
    let mut mapped = BTreeMap::new();
    let mut nothing = Vec::new();
    for (theirs, ours) in overrides {
        let Some(joint) = source.find(theirs) else {
            let similar = similar(theirs, source.names().iter().map(String::as_str));
            return fail(format!("the clip has no joint `{theirs}`: did you mean {similar}?"));
        };
        let Some(ours) = ours else {
            nothing.push(joint);
            continue;
        };
        let Some(slot) = Slot::from_name(ours) else {
            let similar = similar(ours, Slot::all().map(Slot::name));
            return fail(format!("`{theirs}`: our rig has no joint `{ours}`: did you mean {similar}?"));
        };
        if let Some(other) = mapped.insert(slot, joint) {
            let other = &source.names()[other];
            return fail(format!("both `{other}` and `{theirs}` shall drive `{ours}`"));
        }
    }
    Ok((mapped, nothing))
}

/// Up to three names that are most similar to this one, for messages.
fn similar<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> String {
    let wanted = name.to_lowercase();
    let mut list: Vec<(usize, &str)> =
        candidates.map(|c| (crate::error::edit_distance(&wanted, &c.to_lowercase()), c)).collect();
    list.sort_unstable();
    let names: Vec<String> = list.iter().take(3).map(|(_, c)| format!("`{c}`")).collect();
    names.join(", ")
}
